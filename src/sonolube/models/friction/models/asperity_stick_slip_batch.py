"""Friction ratios of asperity stick-slip for many motions at once: a table for sines, quadrature for other motions."""

from math import atan2, cos, exp, log, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel
from sonolube.models.contact.contact_motion import GapMotionBatch
from sonolube.models.friction.models.asperity_stick_slip_sine import (
    EMPIRICAL_MEMORY_LENGTH,
    LOG_BETA,
    sine_stick_slip_ratio,
    sine_table,
)
from sonolube.models.friction.scaled_bessel import scaled_bessel_i0
from sonolube.models.friction.uniform_spline import bicubic_value

SINE_TOLERANCE = 8e-5
"""Largest error of a friction ratio by neglecting the higher harmonics of a vibration. []"""

_FEW = 3000  # points for which plain Python takes less than compiling
_LOWEST, _HIGHEST = LOG_BETA
_NODES = np.polynomial.legendre.leggauss(32)
_MAXIMUM_BETA = 40.0  # amplitude over decay length up to which the quadrature is accurate
_MAXIMUM_CUBIC_SUM = 0.5  # sum of k^3 |X_k| over |X_1| up to which a motion closes and opens once in a period
_NEGLIGIBLE_HARMONIC = 1e-9  # in decay lengths
_MINIMUM_SPEED = 1e-4  # sliding speed over that at which no element sticks, for the quadrature


def batched_stick_slip_ratio(
    motions: GapMotionBatch,
    *,
    decay_length: ArrayLike,
    sliding_speed: ArrayLike,
    motion: ArrayLike,
    memory_length: ArrayLike = EMPIRICAL_MEMORY_LENGTH,
    tolerance: float = SINE_TOLERANCE,
) -> Floats:
    r"""Friction ratios by asperity stick-slip for very many points. []

    Parameters
    ----------
    motions : GapMotionBatch
        Motions of the gap, with mean normal forces that belong to them.
    decay_length : float
        Length over which the normal force falls by a factor of e. [m]
    sliding_speed : array_like, shape (n,)
        Mean sliding speed. [m/s]
    motion : array_like of int, shape (n,)
        Row of `motions` at each speed.
    memory_length : float
        Sliding distance D_c in which an asperity pressed by one decay length reaches its friction limit. [m]
    tolerance : float
        Largest error of a ratio by neglecting higher harmonics; the table of sines is used from 8e-5 on.

    Returns
    -------
    ndarray, shape (n,)
        NaN outside the range of this method: for amplitudes above 40 decay lengths, or harmonics so strong that the gap
        may close more than once in a period; use `AsperityStickSlip.ratio` for these.

    Raises
    ------
    InvalidInput
        If a length or speed is not positive, a value not finite, or the shapes do not match.

    Notes
    -----
    The force of an element is the minimum, over the past, of its limit at that time plus the slide since. It changes by
    no more than the gap, so that higher harmonics of the sum e change the friction of a sine about the same mean by a
    factor between exp(-e/l) and exp(e/l). Where this is below the tolerance, a share of the friction without
    vibration, they are neglected; from a tolerance of 8e-5 on the ratio is then interpolated in the table of
    `tabulated_stick_slip_ratio`, to 2e-6, else it has the closed form of a sine.

    Otherwise the force is integrated exactly. With the height :math:`g = x + s \theta` of the gap above the slide,
    :math:`s = v_r/(2 \pi f D_c)` decay lengths per radian, an element that comes into contact in a valley of g sticks
    across it, and friction falls short of that of the mean normal force by

    .. math:: \Delta = -\frac{1}{2\pi} \int e^{-x}\, w(g)\, \mathrm{d}g

    over the closing side of the valley, with its width w, all in decay lengths; 32 nodes give it to 1e-6.

    See Also
    --------
    sine_stick_slip_ratio : Closed form for sines.
    """
    length = float(require_positive(decay_length=decay_length))
    memory = float(require_positive(memory_length=memory_length))
    mean, harmonics, f = motions.mean_displacement / length, motions.harmonics / length, motions.frequency
    v_r = np.atleast_1d(require_positive(sliding_speed=sliding_speed))
    which = np.atleast_1d(np.asarray(motion, np.int64))
    if which.shape != v_r.shape:
        raise InvalidInput(f"sliding_speed and motion must have the same shape, got {v_r.shape} and {which.shape}")
    if which.size and not 0 <= which.min() <= which.max() < mean.size:
        raise InvalidInput(f"motion must lie between 0 and {mean.size - 1}, got {which.min()} to {which.max()}")
    beta = np.abs(harmonics[:, 0])
    higher = np.abs(harmonics[:, 1:]).sum(axis=1)
    cubes = np.arange(2, harmonics.shape[1] + 1) ** 3
    closes_once = np.abs(harmonics[:, 1:]) @ cubes <= _MAXIMUM_CUBIC_SUM * beta
    # mean normal force of the sine about this mean, over the load
    load_ratio = scaled_bessel_i0(beta) * np.exp(beta - mean)
    slide = 1 / (2 * np.pi * f * memory)
    ratio = np.empty(v_r.shape)
    table = sine_table() if tolerance >= SINE_TOLERANCE else np.empty((0, 0))
    write_ratios = _write_ratios.for_points(v_r.size, at_first=_FEW)
    write_ratios(
        table,
        tolerance,
        harmonics,
        mean,
        np.ascontiguousarray(motions.mean_force_ratio),
        beta,
        higher,
        closes_once,
        load_ratio,
        slide,
        v_r,
        which,
        *_NODES,
        ratio,
    )
    beyond = np.flatnonzero(np.isinf(ratio))
    if beyond.size:  # sines outside the table
        own = which[beyond]
        ratio[beyond] = load_ratio[own] * sine_stick_slip_ratio(
            decay_length=1.0,
            vibration_amplitude=beta[own],
            frequency=f[own],
            sliding_speed=v_r[beyond] / memory,
            memory_length=1.0,
        )
    return ratio


@kernel(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True, _nrt=False)
def _write_ratios(
    table: Floats,
    tolerance: float,
    harmonics: Complexes,
    mean: Floats,
    mean_force_ratio: Floats,
    beta: Floats,
    higher: Floats,
    closes_once: NDArray[np.bool_],
    load_ratio: Floats,
    slide: Floats,
    v_r: Floats,
    which: NDArray[np.int64],
    nodes: Floats,
    weights: Floats,
    ratio: Floats,
) -> None:
    """Write the ratio of every point; infinity for sines outside the table, NaN for motions outside the range."""
    for i in range(v_r.size):
        j = which[i]
        s = v_r[i] * slide[j]
        sine = _interpolated(table, beta[j], s)
        largest = mean_force_ratio[j]
        if min(sine * load_ratio[j], largest) * higher[j] <= tolerance:
            outside = sine == np.inf
            sticks = sine < 1.0
            ratio[i] = sine if outside else min(sine * load_ratio[j], largest) if sticks else largest
        elif not closes_once[j] or beta[j] > _MAXIMUM_BETA or s < _MINIMUM_SPEED * beta[j]:
            ratio[i] = np.nan
        else:
            ratio[i] = largest - _deficit(harmonics[j], mean[j], s, nodes, weights)


@kernel(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)
def _interpolated(table: Floats, beta: float, s: float) -> float:
    """Ratio under a sine by bicubic interpolation in the table, infinity outside of it."""
    if s >= beta:
        return 1.0
    if table.size == 0 or log(beta) > _HIGHEST:
        return np.inf
    rows, columns = table.shape
    v = s / beta
    row = (max(log(beta), _LOWEST) - _LOWEST) * ((rows - 3) / (_HIGHEST - _LOWEST))
    deficit = bicubic_value(table, row, sqrt(sqrt(v)) * (columns - 3)) * beta / (1 + beta) * (1 - v) ** 2
    return min(max(1 - deficit, 0.0), 1.0)


@kernel(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)
def _deficit(harmonics: Complexes, mean: float, s: float, nodes: Floats, weights: Floats) -> float:
    """Friction that sticking elements take away, over the load, for a motion that closes once in a period."""
    count = harmonics.size
    while count > 1 and abs(harmonics[count - 1]) < _NEGLIGIBLE_HARMONIC:
        count -= 1
    fastest = pi / 2 - atan2(harmonics[0].imag, harmonics[0].real)
    for _ in range(8):
        _, _, second, third = _displacement_derivatives(harmonics, count, fastest)
        step = second / third
        fastest -= step
        if abs(step) < 1e-8:
            break
    if _displacement_derivatives(harmonics, count, fastest)[1] + s >= 0:
        return 0.0
    start, end = _closing_phase(harmonics, count, s, fastest, -1.0), _closing_phase(harmonics, count, s, fastest, 1.0)
    total, opening = 0.0, end
    for j in range(nodes.size):  # from the bottom of the valley up, graded to where slow sliding makes it steep
        up = (1 - nodes[j]) / 2
        closing = start + (end - start) * up * up
        x, rate, _, _ = _displacement_derivatives(harmonics, count, closing)
        opening = _opening_phase(harmonics, count, s, x + s * closing, opening, start + 2 * pi)
        total -= weights[j] * up * (end - start) * exp(-mean - x) * (opening - closing) * (rate + s)
    return total / (2 * pi)


@kernel(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)
def _closing_phase(harmonics: Complexes, count: int, s: float, fastest: float, side: float) -> float:
    """Phase before (-1) or after (1) that of fastest closing at which the gap closes at the rate s."""
    inside, outside = fastest, fastest + side * pi
    phase = fastest + side * pi / 3
    for _ in range(60):
        _, rate, second, _ = _displacement_derivatives(harmonics, count, phase)
        if rate + s < 0:
            inside = phase
        else:
            outside = phase
        step = (rate + s) / second
        phase -= step
        if (phase - inside) * (phase - outside) >= 0:
            phase = (inside + outside) / 2
        elif abs(step) < _NEGLIGIBLE_HARMONIC:
            break
    return phase


@kernel(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)
def _opening_phase(harmonics: Complexes, count: int, s: float, level: float, low: float, high: float) -> float:
    """Phase between two at which the height of the gap above the slide has risen to a level."""
    phase: float = low
    x, rate, second, _ = _displacement_derivatives(harmonics, count, phase)
    missing = level - x - s * phase
    if missing <= 0:
        return phase
    slope = rate + s
    # first estimate by a parabola
    phase += 2 * missing / (slope + sqrt(max(slope * slope + 2 * second * missing, slope * slope)))
    for _ in range(60):
        if not low < phase < high:
            phase = (low + high) / 2
        x, rate, _, _ = _displacement_derivatives(harmonics, count, phase)
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


@kernel(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, _nrt=False)
def _displacement_derivatives(harmonics: Complexes, count: int, phase: float) -> tuple[float, float, float, float]:
    """Displacement about the mean and its first three derivatives with respect to the phase."""
    cosine, sine = cos(phase), sin(phase)
    c, s, x, rate, second, third = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(1, count + 1):
        c, s = c * cosine - s * sine, c * sine + s * cosine
        X = harmonics[k - 1]
        real, imaginary = X.real * c - X.imag * s, X.real * s + X.imag * c
        x += real
        rate -= k * imaginary
        second -= k * k * real
        third += k * k * k * imaginary
    return x, rate, second, third
