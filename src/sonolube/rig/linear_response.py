"""Linear frequency response of a rig in contact: amplitude per volt and electrical impedance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.models.contact.rough import normal_stiffness
from sonolube.models.dynamics import modes
from sonolube.models.dynamics.structure import Structure, drive_receptance, electrical_admittance, with_contact_spring
from sonolube.rig.driven_rig import driven_rig
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrequencyResponse:
    """Frequency response of a rig under its load, the contact linearised to its stiffness at rest.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Frequency of the drive. [Hz]
    amplitude_per_volt : ndarray, shape (n,)
        Amplitude of the contact, zero to peak, per volt peak to peak. [m/V]
    impedance : ndarray, shape (n,)
        Magnitude of the stack's electrical impedance. [ohm]
    phase : ndarray, shape (n,)
        Its phase: voltage ahead of current. [rad]
    """

    frequency: Floats
    amplitude_per_volt: Floats
    impedance: Floats
    phase: Floats


def frequency_response(rig: Rig | ResolvedRig, *, frequency: ArrayLike) -> FrequencyResponse:
    """Frequency response of a rig to small voltages, with the contact linearised at rest.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack and a structure.
    frequency : array_like, shape (n,)
        Frequencies of the drive. [Hz]

    Returns
    -------
    FrequencyResponse

    Raises
    ------
    InvalidInput
        If the rig has no structure, or a frequency is not positive.

    Notes
    -----
    D figure 3.12 in kind. Contact forces that are not small against the load need `simulate`.
    """
    f = np.atleast_1d(require_positive(frequency=frequency))
    touching = structure_in_contact(rig)
    impedance = 1 / electrical_admittance(touching, frequency=f)
    return FrequencyResponse(
        frequency=f,
        amplitude_per_volt=np.abs(drive_receptance(touching, frequency=f)) / 2,
        impedance=np.abs(impedance),
        phase=np.angle(impedance),
    )


def structure_in_contact(rig: Rig | ResolvedRig) -> Structure:
    """Structure of a rig with the contact as a spring of its stiffness at rest.

    Raises
    ------
    InvalidInput
        If the rig has no structure.
    OutsideRange
        If its load leaves no separation.
    """
    resolved = resolved_rig(rig)
    stiffness = float(normal_stiffness(resolved.rig.contact, separation=resolved.separation))
    return with_contact_spring(driven_rig(resolved.rig).structure, normal_stiffness=stiffness)


def frequency_grid(
    rig: Rig | ResolvedRig, *, lowest: float, highest: float, points: int = 2000, resonance_points: int = 201
) -> Floats:
    """Frequencies spaced evenly on a logarithmic axis, and more densely at the resonances.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack and a structure.
    lowest, highest : float
        Ends of the range, in Hz.
    points : int
        Number spaced evenly.
    resonance_points : int
        Number at each resonance.

    Returns
    -------
    ndarray
        In Hz, rising.
    """
    even = np.geomspace(lowest, highest, points)
    natural = modes(structure_in_contact(rig))
    offsets = np.sinh(np.linspace(-6, 6, resonance_points)) / np.sinh(6)
    widths = np.maximum(20 * natural.damping_ratio, 1e-4)
    near = (natural.natural_frequency[:, np.newaxis] * (1 + widths[:, np.newaxis] * offsets)).ravel()
    inside = near[(near > lowest) & (near < highest)]
    return np.unique(np.concatenate([even, inside]))
