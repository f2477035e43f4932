"""Linear frequency response of a rig in contact: amplitude per volt and electrical impedance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import OutsideRange
from sonolube.models.contact import ExponentialHeights
from sonolube.models.contact.rough import decay_length, normal_force, normal_stiffness, separation, separation_range
from sonolube.models.dynamics import ExponentialGap, GapLaw, TabulatedGap, modes
from sonolube.models.dynamics.structure import Structure, drive_receptance, electrical_admittance, with_contact_spring
from sonolube.rig.driven_rig import driven_rig
from sonolube.rig.record import Rig

_POINTS = 2101  # of the table of a contact's force: 50 for each standard deviation of summit heights


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


def frequency_response(rig: Rig, *, frequency: ArrayLike) -> FrequencyResponse:
    """Return the frequency response of a rig to small voltages, with the contact linearised at rest.

    Parameters
    ----------
    rig : Rig
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


def rest_separation(rig: Rig) -> float:
    """Return the separation of a rig's surfaces at rest. [m]

    Raises
    ------
    OutsideRange
        If the surfaces would be pressed through each other, so that no separation is left.
    """
    gap = float(separation(rig.contact, normal_load=rig.normal_load))
    if gap <= 0:
        raise OutsideRange(
            f"contact.normal_load {rig.normal_load:g} N leaves no separation between the surfaces (d = {gap:.3g} m): "
            "lower the load or enlarge contact.nominal_area"
        )
    return gap


def structure_in_contact(rig: Rig) -> Structure:
    """Return the structure of a rig with the contact as a spring of its stiffness at rest.

    Raises
    ------
    InvalidInput
        If the rig has no structure.
    OutsideRange
        If its load leaves no separation.
    """
    stiffness = float(normal_stiffness(rig.contact, separation=rest_separation(rig)))
    return with_contact_spring(driven_rig(rig).structure, normal_stiffness=stiffness)


def gap_law_of(rig: Rig) -> GapLaw:
    """Return the gap law of a rig's contact: exponential for exponential heights, tabulated otherwise.

    Notes
    -----
    Between the points of the table the force keeps within 1e-9 of that of the contact.
    """
    if isinstance(rig.contact.heights, ExponentialHeights):
        return ExponentialGap(decay_length=float(decay_length(rig.contact)))
    d = np.linspace(*separation_range(rig.contact), _POINTS)
    return TabulatedGap(
        separation=d,
        normal_force=normal_force(rig.contact, separation=d),
        normal_stiffness=normal_stiffness(rig.contact, separation=d),
    )


def frequency_grid(
    rig: Rig, *, lowest: float, highest: float, points: int = 2000, resonance_points: int = 201
) -> Floats:
    """Return frequencies spaced evenly on a logarithmic axis, and more densely at the resonances.

    Parameters
    ----------
    rig : Rig
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
