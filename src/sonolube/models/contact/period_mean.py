"""Averages over the period of sampled motions, and over the separating half, in which the gap is wider (D 3.15)."""

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers, require_finite, require_non_negative, require_positive
from sonolube.errors import OutsideRange
from sonolube.models.contact.contact_motion import ContactMotion

_NODES = 40  # 1e-12 for exponentials over up to a hundred decay lengths, and any amplitude below the separation
_BLOCK = 4096  # points whose samples together still fit a processor's cache


def separating_half_period_mean(
    value: Callable[[Floats], Floats], *, separation: ArrayLike, vibration_amplitude: ArrayLike
) -> Floats:
    r"""Average of a function of the gap over the separating half period of a sine.

    In the unit of the quantity.

    .. math:: \bar g = \frac1\pi \int_0^\pi g(d + a \sin\theta)\, \mathrm{d}\theta

    by Gauss-Legendre quadrature in the phase. The separating half period does not close the gap at any amplitude; the
    other half does where the amplitude reaches the separation, unless the mean gap rises under vibration.

    See Also
    --------
    sampled_separating_mean : The same for a sampled motion.

    Source: D 3.15 and 3.28.
    """
    a = require_non_negative(vibration_amplitude=vibration_amplitude)
    d, a = np.broadcast_arrays(require_positive(separation=separation), a)
    sines, weights = separating_half_period_quadrature()
    gaps, amplitudes, means = d.ravel(), a.ravel(), np.empty(d.size)
    for start in range(0, d.size, _BLOCK):
        block = slice(start, start + _BLOCK)
        means[block] = weights @ value(gaps[block] + np.multiply.outer(sines, amplitudes[block]))
    return means.reshape(d.shape)


def sampled_separating_mean(value: Callable[[Floats], Floats], *, displacement: ArrayLike) -> Floats:
    """Average of a function of the displacement over the part of a sampled period in which it is positive.

    In the unit of the quantity; its value at rest if the displacement is never positive.

    Displacement and quantity are interpolated linearly between samples: second order in the phase step.

    See Also
    --------
    separating_half_period_mean : The same for a sine.
    """
    x = require_finite(displacement=displacement)
    before, values = np.roll(x, 1), value(np.maximum(x, 0.0))  # the rest of the period does not count
    values_before = np.roll(values, 1)
    rise = np.maximum(x, before) - np.minimum(x, before)
    fraction = np.clip(np.maximum(x, before) / np.where(rise > 0, rise, 1.0), 0.0, 1.0)  # of the step with x > 0
    fraction = np.where(rise > 0, fraction, np.where(x > 0, 1.0, 0.0))
    above, below = np.where(x > before, values, values_before), np.where(x > before, values_before, values)
    means = above + (below - above) * fraction / 2
    time = np.sum(fraction)
    return np.asarray(np.sum(fraction * means) / time if time > 0 else value(np.zeros(1))[0])


@cache
def separating_half_period_quadrature() -> tuple[Floats, Floats]:
    """Nodes and weights of a Gauss-Legendre rule for averages over the separating half period of a sine.

    Displacements over the amplitude at phases from rest to the peak, whose mirror images are the way back, and weights
    that sum to 1.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    sines, weights = np.sin((nodes + 1) * np.pi / 4), weights / 2
    sines.flags.writeable = weights.flags.writeable = False  # shared by all callers
    return sines, weights


_MINIMUM_SAMPLES, _MAXIMUM_SAMPLES = 256, 65536  # per period, between which a period average is refined
_UNCONVERGED = "the average over a period does not converge with {samples} samples of this motion"


def richardson_period_mean(
    mean: Callable[[ContactMotion], Floats], motion: ContactMotion, *, tolerance: float = 1e-5
) -> Floats:
    r"""Average over the period by doubling the samples and Richardson's extrapolation.

    With the averages m_n at n phases the result is :math:`m_{2n} + (m_{2n} - m_n)/3`, once the correction is within the
    tolerance.
    """
    samples = max(_MINIMUM_SAMPLES, motion.displacement.size)
    coarse = mean(motion.resampled(samples))
    while samples < _MAXIMUM_SAMPLES:
        samples *= 2
        fine = mean(motion.resampled(samples))
        change = fine - coarse
        # a third of the change is the error, which Richardson's extrapolation removes to the next order
        if np.all(np.abs(change) / 3 < tolerance * np.maximum(np.abs(fine), 1.0)):
            return fine + change / 3
        coarse = fine
    raise OutsideRange(_UNCONVERGED.format(samples=samples))


def richardson_period_means(
    mean: Callable[[Integers, Floats, Floats], Floats], motions: Sequence[ContactMotion], *, tolerance: float = 1e-5
) -> Floats:
    """Average over the period of each of many motions, each with the samples that it needs alone.

    As `richardson_period_mean` of each.
    """
    means = np.empty(len(motions))
    sizes = np.maximum([motion.displacement.size for motion in motions], _MINIMUM_SAMPLES)
    for size in np.unique(sizes).tolist():
        rows, samples = np.flatnonzero(sizes == size), size
        coarse = mean(rows, *_stacked(motions, rows, size))
        while rows.size:
            if samples >= _MAXIMUM_SAMPLES:
                raise OutsideRange(_UNCONVERGED.format(samples=samples))
            samples *= 2
            fine = mean(rows, *_stacked(motions, rows, samples))
            error = (fine - coarse) / 3
            done = np.abs(error) < tolerance * np.maximum(np.abs(fine), 1.0)
            means[rows[done]] = (fine + error)[done]
            rows, coarse = rows[~done], fine[~done]
    return means


def _stacked(motions: Sequence[ContactMotion], rows: Integers, samples: int) -> tuple[Floats, Floats]:
    """Displacement and normal force of some motions at a number of phases, a row each."""
    sampled = [motions[row].resampled(samples) for row in rows]
    return np.stack([each.displacement for each in sampled]), np.stack([each.normal_force for each in sampled])
