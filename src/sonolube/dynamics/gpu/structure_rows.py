"""A structure as a thread sees it: pairs of states as rows of one array, and sums over them."""

import math

import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.gpu.device import on_device
from sonolube.dynamics.harmonic_balance.receptance import ContactPort

MOST_PAIRS = 8
"""Most pairs of states of a structure that the kernel holds. []"""

GENERATOR, PUSH, DISPLACEMENT, DETERMINANT, TRACE, CONSTANT, SLOPE = 0, 4, 6, 8, 9, 10, 13
_FORCED, _DRIVEN, _CHARGED = 0, 1, 2  # of contact per force, contact per volt (and charge per force), charge per volt

_SMALL = 1e-2  # angle below which a series is exact


def structure_rows(port: ContactPort) -> Floats:
    """Return the pairs of states as columns of one array.

    Parameters
    ----------
    port : ContactPort

    Returns
    -------
    ndarray, shape (16, m)
        Rows in the order of the constants of this module.
    """
    return np.ascontiguousarray(
        np.vstack(
            [
                port.generator.reshape(-1, 4).T,
                port.push.T,
                port.displacement.T,
                port.determinant,
                port.trace,
                port.constant,
                port.slope,
            ]
        )
    )


@on_device
def receptance(pairs: Floats, which: int, omega: float) -> tuple[float, float]:
    """Return real and imaginary part of a receptance at an angular frequency."""
    real, imaginary = 0.0, 0.0
    for pair in range(pairs.shape[1]):
        re = pairs[DETERMINANT, pair] - omega * omega
        im = -pairs[TRACE, pair] * omega
        still, rise = pairs[CONSTANT + which, pair], pairs[SLOPE + which, pair] * omega
        inverse = 1.0 / (re * re + im * im)
        real += (still * re + rise * im) * inverse
        imaginary += (rise * re - still * im) * inverse
    return real, imaginary


@on_device
def forced(pairs: Floats, omega: float) -> tuple[float, float]:
    """Return displacement of the contact per force."""
    return receptance(pairs, _FORCED, omega)


@on_device
def driven(pairs: Floats, omega: float) -> tuple[float, float]:
    """Return displacement of the contact per volt, which is charge per force."""
    return receptance(pairs, _DRIVEN, omega)


@on_device
def charged(pairs: Floats, omega: float) -> tuple[float, float]:
    """Return charge per volt by motion."""
    return receptance(pairs, _CHARGED, omega)


@on_device
def receptance_bound(pairs: Floats, omega: float) -> float:
    """Return about the modulus of displacement per force, up to 1.4 times too large or too small."""
    bound = 0.0
    for pair in range(pairs.shape[1]):
        above = abs(pairs[CONSTANT, pair]) + abs(pairs[SLOPE, pair]) * omega
        bound += above / (abs(pairs[DETERMINANT, pair] - omega * omega) + abs(pairs[TRACE, pair]) * omega)
    return bound


@on_device
def free_motion(half_trace: float, square: float, time: float) -> tuple[float, float]:
    """Return what states and their image under the rest of A contribute to exp(A t); A is half its trace and a rest."""
    rate = math.sqrt(abs(square))
    angle = rate * time
    fading = math.exp(half_trace * time)
    series = 1 + square * time * time / 6 * (1 + square * time * time / 20 * (1 + square * time * time / 42))
    if square <= 0.0:
        even, odd = fading * math.cos(angle), fading * math.sin(angle)
    else:
        slow, fast = math.exp((half_trace + rate) * time), math.exp((half_trace - rate) * time)
        even, odd = 0.5 * (slow + fast), 0.5 * (slow - fast)
    return even, (fading * time * series if angle < _SMALL else odd / rate)
