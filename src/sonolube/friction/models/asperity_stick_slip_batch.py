"""Friction ratios of many motions at once by asperity stick-slip: tabulated for sines, exact quadrature otherwise."""

from functools import cache
from math import atan2, cos, exp, log, pi, sin, sqrt
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import i0e

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.contact.motion import HarmonicMotions
from sonolube.errors import InvalidInput
from sonolube.friction.models.asperity_stick_slip_sine import EMPIRICAL_MEMORY_LENGTH, sine_stick_slip_ratio

SINE_TOLERANCE = 8e-5
"""Largest error of a friction ratio for which a vibration may pass for a sine. []"""

_BETA, _SPEED = (-6.0, 4.1), (-11.0, 0.0)  # logarithms between which sines are tabulated
_ROWS, _COLUMNS = 300, 330
_NODES = np.polynomial.legendre.leggauss(32)
_STEEPEST = 40.0  # decay lengths of amplitude up to which the nodes suffice
_PLAIN = 0.5  # share of k^3 X_k in the first harmonic up to which a motion closes and opens once in a period
_SMALLEST = 1e-9  # harmonic, in decay lengths, that counts
_SLOWEST = 1e-4  # of sliding to the speed at which nothing grips, for the nodes


class _Table(NamedTuple):
    """Friction ratios under sines, over logarithms of beta and of v, evenly spaced."""

    ratio: Floats
    beta_start: float
    beta_step: float
    speed_start: float
    speed_step: float


def batched_stick_slip_ratio(
    motions: HarmonicMotions,
    *,
    decay_length: ArrayLike,
    sliding_speed: ArrayLike,
    motion: ArrayLike,
    memory_length: ArrayLike = EMPIRICAL_MEMORY_LENGTH,
) -> Floats:
    """Return friction ratios by asperity stick-slip under motions of balanced load, for very many sliding speeds. []

    Parameters
    ----------
    motions : HarmonicMotions
        Motions of the gap, each about the mean that balances the load.
    decay_length : float
        Length over which the normal force falls by a factor of e. [m]
    sliding_speed : array_like, shape (n,)
        Mean sliding speed. [m/s]
    motion : array_like of int, shape (n,)
        Row of `motions` at each speed.
    memory_length : float
        Sliding distance D_c in which an asperity pressed by one decay length reaches its friction limit. [m]

    Returns
    -------
    ndarray, shape (n,)
        NaN for motions outside the range of this method: of more than 40 decay lengths, or of harmonics so strong that
        the gap may close more than once in a period; `AsperityStickSlip.ratio` computes these.

    Raises
    ------
    InvalidInput
        If a length or speed is not positive, a value not finite, or the shapes do not match.

    Notes
    -----
    The force of an element is the least, over the past, of its limit then and the slide since. So it changes by no more
    than the gap does, and higher harmonics of together e change the friction of a sine about the same mean by a factor
    between exp(-e/l) and exp(e/l): where this is less than 8e-5 of the friction without vibration they are left out,
    and the ratio comes from a table for sines, interpolated by cubics to 3e-6.

    Elsewhere the force is followed exactly. With the height g = x + s theta of the gap over the sliding,
    s = v_r/(2 pi f D_c) decay lengths a radian, an element that touches in a valley of g grips across it, so that the
    friction lacking is the integral of exp(-x) (width of the valley) (-dg) over its closing side, all in decay
    lengths; 32 nodes give it to 1e-6.
    """
    length = float(require_positive(decay_length=decay_length))
    memory = float(require_positive(memory_length=memory_length))
    mean, swing, f = motions.mean_displacement / length, motions.harmonics / length, motions.frequency
    v_r, which = (
        np.atleast_1d(require_positive(sliding_speed=sliding_speed)),
        np.atleast_1d(np.asarray(motion, np.int64)),
    )
    if which.shape != v_r.shape:
        raise InvalidInput(f"sliding_speed and motion must have one shape, got {v_r.shape} and {which.shape}")
    if which.size and not 0 <= which.min() <= which.max() < mean.size:
        raise InvalidInput(f"motion must lie between 0 and {mean.size - 1}, got {which.min()} to {which.max()}")
    beta = np.abs(swing[:, 0])
    higher = np.abs(swing[:, 1:]).sum(axis=1)
    cubes = np.arange(2, swing.shape[1] + 1) ** 3
    closes_once = np.abs(swing[:, 1:]) @ cubes <= _PLAIN * beta
    # what the same sine would carry about this mean instead of its own
    pressing = i0e(beta) * np.exp(beta - mean)
    slide = 1 / (2 * np.pi * f * memory)
    ratio = np.empty(v_r.shape)
    nodes, weights = _NODES
    _every_ratio(_table(), swing, mean, beta, higher, closes_once, pressing, slide, v_r, which, nodes, weights, ratio)
    beyond = np.flatnonzero(np.isinf(ratio))
    if beyond.size:  # sines outside the table
        own = which[beyond]
        ratio[beyond] = pressing[own] * sine_stick_slip_ratio(
            decay_length=1.0,
            vibration_amplitude=beta[own],
            frequency=f[own],
            sliding_speed=v_r[beyond] / memory,
            memory_length=1.0,
        )
    return ratio


@cache
def _table() -> _Table:
    beta, speed = np.linspace(*_BETA, _ROWS), np.linspace(*_SPEED, _COLUMNS)
    ratio = sine_stick_slip_ratio(
        decay_length=1.0,
        vibration_amplitude=np.exp(beta)[:, np.newaxis],
        frequency=1 / (2 * np.pi),
        sliding_speed=np.exp(speed) * np.exp(beta)[:, np.newaxis],
        memory_length=1.0,
    )
    return _Table(ratio, beta[0], beta[1] - beta[0], speed[0], speed[1] - speed[0])


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _every_ratio(
    table: _Table,
    swing: Complexes,
    mean: Floats,
    beta: Floats,
    higher: Floats,
    closes_once: NDArray[np.bool_],
    pressing: Floats,
    slide: Floats,
    v_r: Floats,
    which: NDArray[np.int64],
    nodes: Floats,
    weights: Floats,
    ratio: Floats,
) -> None:
    """Write every ratio; infinity where a sine lies outside the table, NaN where the motion is none of these."""
    for i in range(v_r.size):
        j = which[i]
        s = v_r[i] * slide[j]
        sine = _tabulated(table, beta[j], s)
        if min(sine * pressing[j], 1.0) * higher[j] <= SINE_TOLERANCE:
            outside = sine == np.inf
            ratio[i] = sine if outside or sine == 1.0 else min(sine * pressing[j], 1.0)  # nothing grips where it is 1
        elif not closes_once[j] or beta[j] > _STEEPEST or s < _SLOWEST * beta[j]:
            ratio[i] = np.nan
        else:
            ratio[i] = 1 - _lacking(swing[j], mean[j], s, nodes, weights)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _tabulated(table: _Table, beta: float, s: float) -> float:
    """Return the ratio under a sine by cubics through four values each way, infinity outside the table."""
    if s >= beta:
        return 1.0
    p, q = (log(beta) - table.beta_start) / table.beta_step, (log(s / beta) - table.speed_start) / table.speed_step
    rows, columns = table.ratio.shape
    if p < 0 or p > rows - 1 or q < 0:
        return np.inf
    row, column = min(max(int(p) - 1, 0), rows - 4), min(max(int(q) - 1, 0), columns - 4)
    a, b, c, d = _cubic(p - row)
    e, f, g, h = _cubic(q - column)
    total = 0.0
    for k, weight in enumerate((a, b, c, d)):
        near = table.ratio[row + k]
        total += weight * (e * near[column] + f * near[column + 1] + g * near[column + 2] + h * near[column + 3])
    return total


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _cubic(t: float) -> tuple[float, float, float, float]:
    """Return the weights of values at 0, 1, 2 and 3 for the cubic through them at t."""
    a, b, c, d = t, t - 1, t - 2, t - 3
    return -b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _lacking(own: Complexes, mean: float, s: float, nodes: Floats, weights: Floats) -> float:
    """Return the friction that gripping elements lack, over the load, for a motion that closes once in a period."""
    count = own.size
    while count > 1 and abs(own[count - 1]) < _SMALLEST:
        count -= 1
    fastest = pi / 2 - atan2(own[0].imag, own[0].real)
    for _ in range(8):
        _, _, bend, third = _swing(own, count, fastest)
        step = bend / third
        fastest -= step
        if abs(step) < 1e-8:
            break
    if _swing(own, count, fastest)[1] + s >= 0:
        return 0.0
    begin, end = _closing_at(own, count, s, fastest, -1.0), _closing_at(own, count, s, fastest, 1.0)
    total, far = 0.0, end
    for j in range(nodes.size):  # from the bottom of the valley up, crowding where slow sliding makes it steep
        up = (1 - nodes[j]) / 2
        near = begin + (end - begin) * up * up
        x, rate, _, _ = _swing(own, count, near)
        far = _far_side(own, count, s, x + s * near, far, begin + 2 * pi)
        total -= weights[j] * up * (end - begin) * exp(-mean - x) * (far - near) * (rate + s)
    return total / (2 * pi)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _closing_at(own: Complexes, count: int, s: float, fastest: float, side: float) -> float:
    """Return the phase before (-1) or after (1) that of fastest closing at which the gap closes with speed s."""
    inside, outside = fastest, fastest + side * pi
    phase = fastest + side * pi / 3
    for _ in range(60):
        _, rate, bend, _ = _swing(own, count, phase)
        if rate + s < 0:
            inside = phase
        else:
            outside = phase
        step = (rate + s) / bend
        phase -= step
        if (phase - inside) * (phase - outside) >= 0:
            phase = (inside + outside) / 2
        elif abs(step) < _SMALLEST:
            break
    return phase


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _far_side(own: Complexes, count: int, s: float, level: float, low: float, high: float) -> float:
    """Return the phase between two at which the height of the gap over the sliding has risen to a level."""
    phase: float = low
    x, rate, bend, _ = _swing(own, count, phase)
    lacking = level - x - s * phase
    if lacking <= 0:
        return phase
    slope = rate + s
    phase += 2 * lacking / (slope + sqrt(max(slope * slope + 2 * bend * lacking, slope * slope)))  # by a parabola
    for _ in range(60):
        if not low < phase < high:
            phase = (low + high) / 2
        x, rate, _, _ = _swing(own, count, phase)
        over = x + s * phase - level
        if over > 0:
            high = phase
        else:
            low = phase
        step = over / (rate + s)
        phase -= step
        if abs(step) < 1e-7:
            break
    return phase


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _swing(own: Complexes, count: int, phase: float) -> tuple[float, float, float, float]:
    """Return displacement about the mean and its first three derivatives by phase."""
    cosine, sine = cos(phase), sin(phase)
    c, s, x, rate, bend, third = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(1, count + 1):
        c, s = c * cosine - s * sine, c * sine + s * cosine
        real, imaginary = own[k - 1].real * c - own[k - 1].imag * s, own[k - 1].real * s + own[k - 1].imag * c
        x += real
        rate -= k * imaginary
        bend -= k * k * real
        third += k * k * k * imaginary
    return x, rate, bend, third
