"""Receptances of a structure in pole-residue form, by GPU threads.

The method is that of `sonolube.models.dynamics.harmonic_balance.receptance`; a structure is one array with a column per
pair of states.
"""

import math

import numpy as np

from sonolube.checks import Floats
from sonolube.models.dynamics.gpu.device import on_device
from sonolube.models.dynamics.harmonic_balance.receptance import (
    CHARGE_PER_VOLT,
    CONTACT_PER_FORCE,
    CONTACT_PER_VOLT,
    PoleResidueModel,
)

MOST_PAIRS = 8
"""Largest number of pairs of states of a structure that the kernels hold. []"""

STATE_MATRIX, CONTACT_INPUT, DISPLACEMENT_OUTPUT, DETERMINANT, TRACE = 0, 4, 6, 8, 9
NUMERATOR_CONSTANT, NUMERATOR_SLOPE = 10, 13
"""First rows of the groups of numbers of a pair of states. []"""

_SMALL = 1e-2  # phase below which a series is exact


def model_rows(model: PoleResidueModel) -> Floats:
    """Return the pole-residue model of a structure as one array.

    Parameters
    ----------
    model : PoleResidueModel

    Returns
    -------
    ndarray, shape (16, m)
        One column per pair of states, rows in the order of the constants of this module.
    """
    vectors = (model.state_matrix.reshape(-1, 4).T, model.contact_input.T, model.displacement_output.T)
    scalars = (model.determinant, model.trace, model.numerator_constant, model.numerator_slope)
    return np.ascontiguousarray(np.vstack([*vectors, *scalars]))


@on_device
def receptance(pairs: Floats, response: int, omega: float) -> tuple[float, float]:
    """Return real and imaginary part of a receptance at an angular frequency."""
    real, imaginary = 0.0, 0.0
    for pair in range(pairs.shape[1]):
        re = pairs[DETERMINANT, pair] - omega * omega
        im = -pairs[TRACE, pair] * omega
        constant = pairs[NUMERATOR_CONSTANT + response, pair]
        rise = pairs[NUMERATOR_SLOPE + response, pair] * omega
        inverse = 1.0 / (re * re + im * im)
        real += (constant * re + rise * im) * inverse
        imaginary += (rise * re - constant * im) * inverse
    return real, imaginary


@on_device
def contact_per_force(pairs: Floats, omega: float) -> tuple[float, float]:
    """Return the contact receptance, displacement per force, in m/N."""
    return receptance(pairs, CONTACT_PER_FORCE, omega)


@on_device
def contact_per_volt(pairs: Floats, omega: float) -> tuple[float, float]:
    """Return displacement of the contact per volt, which is charge per force, in m/V."""
    return receptance(pairs, CONTACT_PER_VOLT, omega)


@on_device
def charge_per_volt(pairs: Floats, omega: float) -> tuple[float, float]:
    """Return motional charge per volt, in C/V."""
    return receptance(pairs, CHARGE_PER_VOLT, omega)


@on_device
def receptance_bound(pairs: Floats, omega: float) -> float:
    """Return an estimate of the modulus of the contact receptance within a factor of 1.4 per pair of states, in m/N."""
    bound = 0.0
    for pair in range(pairs.shape[1]):
        numerator = abs(pairs[NUMERATOR_CONSTANT, pair]) + abs(pairs[NUMERATOR_SLOPE, pair]) * omega
        bound += numerator / (abs(pairs[DETERMINANT, pair] - omega * omega) + abs(pairs[TRACE, pair]) * omega)
    return bound


@on_device
def transition_factors(half_trace: float, square: float, time: float) -> tuple[float, float]:
    r"""Return the factors of identity and traceless part B in the state transition matrix exp(A t).

    Notes
    -----
    With :math:`A = h I + B`, h half the trace and :math:`B^2 = \delta^2 I`,

    .. math:: e^{At} = e^{ht}\cosh(\delta t)\,I + e^{ht}\,\frac{\sinh(\delta t)}{\delta}\,B .
    """
    rate = math.sqrt(abs(square))
    angle = rate * time
    decay = math.exp(half_trace * time)
    series = 1 + square * time * time / 6 * (1 + square * time * time / 20 * (1 + square * time * time / 42))
    if square <= 0.0:
        even, odd = decay * math.cos(angle), decay * math.sin(angle)
    else:
        slow, fast = math.exp((half_trace + rate) * time), math.exp((half_trace - rate) * time)
        even, odd = 0.5 * (slow + fast), 0.5 * (slow - fast)
    return even, (decay * time * series if angle < _SMALL else odd / rate)
