"""Free vibrations of a structure in contact: natural frequency over the amplitude, without damping and drive."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw, force_decay_length
from sonolube.models.dynamics.harmonic_balance.equations import HarmonicBalanceEquations
from sonolube.models.dynamics.linear import modes
from sonolube.models.dynamics.structure import Structure, with_contact_spring

_STEPS = 30
_TOLERANCE = 1e-10  # of the last step, in decay lengths and of the frequency
_LARGEST_STEP = 0.25  # of the frequency
_SAMPLES = 16  # a harmonic


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Backbone:
    """Free vibrations of a structure in contact.

    Parameters
    ----------
    frequency : ndarray, shape (m,)
        Natural frequency; NaN from the amplitude on at which no free vibration was found. [Hz]
    vibration_amplitude : ndarray, shape (m,)
        Half of the displacement of the contact from peak to peak. [m]
    """

    frequency: Floats
    vibration_amplitude: Floats


def backbone(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: float,
    displacement: ArrayLike,
    frequency: float,
    orders: int = 12,
) -> Backbone:
    r"""Natural frequency of free vibrations of a structure in contact over their amplitude, by harmonic balance.

    Parameters
    ----------
    structure : Structure
        Its damping is left out.
    gap_law : GapLaw
        Without damping.
    normal_load : float
        Dead load on the contact. [N]
    displacement : array_like, shape (m,)
        Amplitudes of the first harmonic of the contact, rising. [m]
    frequency : float
        Frequency of the mode, for small motions. [Hz]
    orders : int
        Number of harmonics of the contact.

    Returns
    -------
    Backbone

    Raises
    ------
    InvalidInput
        If an amplitude or the load is not positive, or the contact is damped.

    See Also
    --------
    response_curve

    Notes
    -----
    With the residual R of harmonic balance and the first harmonic X_1 of the amplitude a,

    .. math:: R(\bar x, X, \omega) = 0, \qquad X_1 = a,

    of which one equation follows from the others, since the energy is constant: solved in the sense of least squares.
    """
    amplitudes = np.atleast_1d(require_positive(displacement=displacement))
    load = float(require_positive(normal_load=normal_load))
    if gap_law.force_damping:
        raise InvalidInput(f"a backbone is that of a contact without damping, got {gap_law.force_damping:g} s/m")
    equations = HarmonicBalanceEquations(
        structure=replace(structure, damping_matrix=np.zeros_like(structure.damping_matrix)),
        gap_law=gap_law,
        normal_load=load,
        voltage_harmonics=np.zeros(1, dtype=np.complex128),
        voltage_offset=0.0,
        orders=orders,
        samples=max(_SAMPLES * orders, 512 if gap_law.has_corner else 0),
    )
    length = float(force_decay_length(gap_law, load))
    small = modes(with_contact_spring(structure, normal_stiffness=load / length)).natural_frequency
    omega = 2 * np.pi * float(small[np.abs(small - frequency).argmin()])
    unknowns = np.zeros(2 * orders + 1)
    natural, height = np.full(amplitudes.shape, np.nan), np.full(amplitudes.shape, np.nan)
    for place, amplitude in enumerate(amplitudes):
        unknowns[1] = amplitude
        solved = _free_vibration(equations, unknowns, omega, length)
        if solved is None:
            break
        unknowns, omega = solved
        natural[place] = omega / (2 * np.pi)
        height[place] = np.ptp((equations.basis @ equations.unstack(unknowns)[1]).real) / 2
    return Backbone(frequency=natural, vibration_amplitude=height)


def _free_vibration(
    equations: HarmonicBalanceEquations, unknowns: Floats, omega: float, length: float
) -> tuple[Floats, float] | None:
    """Unknowns and angular frequency of a free vibration of the first harmonic given, None where none is found."""
    imaginary = equations.orders + 1  # place of the imaginary part of the first harmonic
    free = np.setdiff1d(np.arange(unknowns.size), [1, imaginary])
    unit = np.full(unknowns.size, length)
    unit[0] = equations.normal_load
    y = unknowns.copy()
    for _ in range(_STEPS):
        balance = equations.at(y, omega=omega, scale=0.0)
        matrix = np.column_stack([balance.jacobian[:, free] * length, balance.by_omega * omega]) / unit[:, np.newaxis]
        step, *_ = np.linalg.lstsq(matrix, -balance.residual / unit, rcond=None)
        if not np.all(np.isfinite(step)) or abs(step[-1]) > _LARGEST_STEP:
            return None
        y[free] += step[:-1] * length
        omega *= 1 + float(step[-1])
        if np.abs(step).max() < _TOLERANCE:
            return y, omega
    return None
