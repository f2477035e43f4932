"""Averages over the period of sampled motions, with as many phases as each needs."""

from collections.abc import Callable, Sequence

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.errors import OutsideRange
from sonolube.models.contact.contact_motion import ContactMotion

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
