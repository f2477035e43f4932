r"""Table of friction ratios of asperity stick-slip under load-balanced sines, for very many points.

The ratio R depends on the amplitude in decay lengths, beta, and on the reduced speed v alone. The table holds

.. math:: \frac{1 + \beta}{\beta}\, \frac{1 - R}{(1 - v)^2}

over ln beta and the fourth root of v, in which it is smooth from v = 0 to 1, both included. The factor before it keeps
the ratio exact without vibration and from v = 1 on.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.models.friction.models.asperity_stick_slip_sine import (
    EMPIRICAL_MEMORY_LENGTH,
    mindlin_memory_length,
    sine_stick_slip_ratio,
)
from sonolube.models.friction.scaled_bessel import scaled_bessel_i0
from sonolube.models.friction.uniform_spline import in_chunks, spline_coefficients, spline_values

__all__ = [  # the rest serves this package only
    "EMPIRICAL_MEMORY_LENGTH",
    "mindlin_memory_length",
    "sine_stick_slip_ratio",
    "tabulated_stick_slip_ratio",
]

LOG_BETA = (float(np.log(1e-4)), float(np.log(1e6)))
"""Range of the table. Below it the reduction is proportional to beta, to 1e-8."""

ROWS, COLUMNS = 225, 177
_NODES = np.polynomial.legendre.leggauss(40)
_BAND = 12  # rows that share the nodes of the quadrature
_NEGLIGIBLE_IN_TABLE = 45.0  # exponent beyond which the load of elements is negligible
_LAST_SPEED = 1 - 1e-6  # in place of 1, where the tabulated function is a limit


def tabulated_stick_slip_ratio(
    *,
    decay_length: ArrayLike,
    vibration_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
    memory_length: ArrayLike = EMPIRICAL_MEMORY_LENGTH,
) -> Floats:
    """Friction ratio by asperity stick-slip under a load-balanced sine, interpolated to 2e-6. []

    Parameters
    ----------
    decay_length : array_like
        Length over which the normal force falls by a factor of e. [m]
    vibration_amplitude : array_like, broadcast against `decay_length`
        Amplitude of the vibration along the surface normal. [m]
    frequency : array_like, broadcast against them
        Frequency of the vibration. [Hz]
    sliding_speed : array_like, broadcast against them
        Mean sliding speed. [m/s]
    memory_length : array_like, broadcast against them
        Sliding distance D_c in which an asperity pressed by one decay length reaches its friction limit. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Of `sine_stick_slip_ratio`, which is called for amplitudes above 1e6 decay lengths.

    Raises
    ------
    InvalidInput
        If a length, frequency or speed is not positive, an amplitude negative, or a value not finite.

    Notes
    -----
    A cubic spline over the logarithm of amplitude over decay length and the fourth root of the reduced speed, computed
    on the first call in some hundredths of a second. A hundred thousand points then take some milliseconds.

    See Also
    --------
    sine_stick_slip_ratio : Computed anew for each point, to 1e-12.
    tabulated_spring_ratio : The same for a flat spring contact.
    """
    length, a = (
        require_positive(decay_length=decay_length),
        require_non_negative(vibration_amplitude=vibration_amplitude),
    )
    f, v_r = require_positive(frequency=frequency), require_positive(sliding_speed=sliding_speed)
    beta = a / length
    scaled_speed = v_r * (length / require_positive(memory_length=memory_length))  # v times omega a, which may be 0
    v = scaled_speed / np.maximum(2 * np.pi * f * a, scaled_speed)
    ratio = in_chunks(_interpolated, beta, v)
    beyond = np.broadcast_to(beta > np.exp(LOG_BETA[1]), ratio.shape) & (v < 1)
    if np.any(beyond):
        many, fast = (np.broadcast_to(each, ratio.shape)[beyond] for each in (beta, v))
        ratio[beyond] = sine_stick_slip_ratio(
            decay_length=1.0,
            vibration_amplitude=many,
            frequency=1 / (2 * np.pi),
            sliding_speed=np.maximum(fast * many, np.finfo(float).tiny),
            memory_length=1.0,
        )
    return ratio


def _interpolated(beta: Floats, v: Floats) -> Floats:
    """Ratios for each amplitude over decay length, up to that of the last row, and each reduced speed up to 1."""
    (low, high), slower = LOG_BETA, 1 - v
    row = (np.log(np.clip(beta, np.exp(low), np.exp(high))) - low) * ((ROWS - 1) / (high - low))
    table = spline_values(sine_table(), row, np.sqrt(np.sqrt(v)) * (COLUMNS - 1))
    table *= beta / (1 + beta) * (slower * slower)
    return np.asarray(np.clip(1 - table, 0.0, 1.0))


@cache
def sine_table() -> Floats:
    """Coefficients of the spline, shape (ROWS + 2, COLUMNS + 2), computed once."""
    beta = np.exp(np.linspace(*LOG_BETA, ROWS))[:, None]
    v = np.minimum(np.linspace(0, 1, COLUMNS) ** 4, _LAST_SPEED)
    return spline_coefficients(_deficits(beta, v) * (1 + beta) / (beta * (1 - v) ** 2))


def _deficits(beta: Floats, v: Floats) -> Floats:
    """Reductions of friction on a grid, shape (n, m), by the integral over h of `sine_stick_slip_ratio`.

    Neighbouring rows share the phases h at which the integrand is evaluated, so that one exponential a node is left.
    """
    distance, last, speed = (1 - _NODES[0]) / 2, np.sqrt(1 - v * v), v[:, None]
    longest = _bisected(lambda h: np.sin(h) * (v * np.cos(h) + last * np.sin(h)) < v * h, np.full(v.size, np.pi))
    deficits = np.empty((beta.size, v.size))
    for start in range(0, beta.size, _BAND):
        b = beta[start : start + _BAND]
        cut = 1 - last + _NEGLIGIBLE_IN_TABLE / b[0]
        end = _bisected(lambda h, cut=cut: _motion(h, v)[2] > cut, longest)  # type: ignore[misc]
        h = end[:, None] * (1 - distance**2)  # graded to where slow sliding makes the integrand steep
        s, c, exponent = _motion(h, speed)
        density = h * (c * s - (speed * (s - h * np.cos(h))) ** 2 / (c * s**3)) * distance * end[:, None]
        load = np.exp(-b[:, :, None] * exponent)
        deficits[start : start + _BAND] = b * np.einsum("bvn,vn,n->bv", load, density, _NODES[1])
    return deficits / (np.pi * scaled_bessel_i0(beta))


def _motion(h: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Sine of half the phase of sticking h, cosine of its middle, and exponent of the load of these elements."""
    s = np.sin(h)
    c = np.sqrt(np.maximum(1 - (v * h / s) ** 2, 0.0))
    return s, c, 1 - c * np.cos(h) + v * h


def _bisected(beyond: Callable[[Floats], Any], end: Floats) -> Floats:
    """Phases between 0 and `end` from which on a condition holds, or `end`."""
    low, high = np.zeros_like(end), end
    for _ in range(32):
        middle = (low + high) / 2
        found = beyond(middle)
        low, high = np.where(found, low, middle), np.where(found, middle, high)
    return high
