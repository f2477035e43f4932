"""Points of a period that crowd where its motion turns, for means over it of what depends on the velocity.

The mean of v_r/sqrt(v_r^2 + v^2) over a period has branch points close to the real axis wherever the vibration velocity
v passes through zero, so that even samples converge slowly. For one sine, theta = am(u) with uniform u takes them away
from the axis, whatever the sliding speed; for a motion that turns twice, a Moebius map of the circle first moves its
two turns a half turn apart. What remains is analytic in a wide strip, and the trapezoidal rule converges geometrically.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.special import ellipkm1

from sonolube.checks import Complexes, Floats, Integers

TOGETHER = 4  # points that a kernel adds at once, which spares the sums' going to and fro
_ROWS = 4  # steps of crowding to a decade of the ratio of the slowest sliding to the vibration's peak velocity
_STEEPEST = 24  # most such steps
# Accelerations of the higher harmonics over that of the first, and up to each how many times as many points it takes.
_RICHNESS, _FINENESS = np.array([0.1, 1.0, 2.0]), np.array([1, 2, 4, 16])


class Crowded(NamedTuple):
    """Points exp(i phi) of the circle, crowded at +-i, one row to each step of crowding; weights sum to one."""

    cosine: Floats  # (rows, most)
    sine: Floats
    weight: Floats  # zero beyond the row's count
    count: Integers  # type: ignore[assignment]


@lru_cache(maxsize=64)
def crowded_points(extra: int, tolerance: float = 1e-6) -> Crowded:
    """Return the points for each step of the ratio of sliding speed to peak velocity.

    Parameters
    ----------
    extra : int
        Points added for the sake of a steep contact force.
    tolerance : float
        Relative error to hold.

    Returns
    -------
    Crowded
    """
    ratios = 10.0 ** (-np.arange(_STEEPEST + 1) / _ROWS)
    digits = -np.log10(tolerance)  # each takes one point per e-fold
    count = TOGETHER * np.ceil((digits * np.log(4 / ratios) + extra + 4) / TOGETHER).astype(np.int64)
    cosine, sine, weight = np.zeros((3, ratios.size, count.max()))
    for row, (ratio, samples) in enumerate(zip(ratios, count, strict=True)):
        complement = ratio**2 / (1 + ratio**2)
        u = 4 * ellipkm1(complement) * (np.arange(samples) + 0.5) / samples
        phase = _jacobi_amplitude(u, complement)
        density = np.sqrt(complement + (1 - complement) * np.cos(phase) ** 2)
        cosine[row, :samples], sine[row, :samples] = np.cos(phase), np.sin(phase)
        weight[row, :samples] = density / density.sum()
    return Crowded(cosine, sine, weight, count)


def _jacobi_amplitude(u: Floats, complement: float) -> Floats:
    """Return am(u | 1 - complement) by descending Landen steps, which a complement near zero does not disturb."""
    means, differences = [1.0], [0.0]
    root = np.sqrt(complement)
    while abs(means[-1] - root) > 1e-16 * means[-1] and len(means) < 12:
        differences.append(0.5 * (means[-1] - root))
        means, root = [*means, 0.5 * (means[-1] + root)], np.sqrt(means[-1] * root)
    phase = 2.0 ** (len(means) - 1) * means[-1] * u
    for mean, difference in zip(means[:0:-1], differences[:0:-1], strict=True):
        phase = 0.5 * (phase + np.arcsin(difference / mean * np.sin(phase)))
    return np.asarray(phase)


def turned_circle(turns: Floats) -> Floats:
    """Return what moves the points +-i of the circle to the two turns of each motion by (w + alpha)/(1 + alpha w).

    Parameters
    ----------
    turns : ndarray, shape (p, 2)
        Phases of the two turns.

    Returns
    -------
    ndarray, shape (3, p)
        alpha, and the turn of the circle that follows as cosine and sine.
    """
    half = 0.5 * (turns[:, 0] - turns[:, 1]) % np.pi
    return np.array([np.tan(0.25 * np.pi - 0.5 * half), np.cos(turns[:, 0] - half), np.sin(turns[:, 0] - half)])


def crowding_of(ratio: Floats) -> Integers:
    """Return the row of `crowded_points` for a ratio of sliding speed to peak velocity."""
    steps = np.ceil(-_ROWS * np.log10(np.fmax(ratio, 10.0 ** (-_STEEPEST / _ROWS))))  # also where it is not a number
    return np.asarray(np.maximum(steps, 0).astype(np.int64))


def fineness_of(harmonics: Complexes) -> Integers:
    """Return how many times as many points motions of two turns need, since their higher harmonics carry shoulders.

    Parameters
    ----------
    harmonics : ndarray of complex, shape (p, room)

    Returns
    -------
    ndarray of int, shape (p,)
        1, 2, 4 or 16.

    Notes
    -----
    A velocity that nearly vanishes between its turns brings further branch points near the axis. Doubling the points
    squares the error; the steps hold 1e-5 for speeds down to a thousandth of the peak velocity.
    """
    parts = np.abs(np.ascontiguousarray(harmonics).view(np.float64))
    accelerations = np.repeat(np.arange(1.0, harmonics.shape[1] + 1) ** 2, 2)
    first = parts[:, 0] + parts[:, 1]
    richness = (parts @ accelerations - first) / np.maximum(first, 1e-300)
    return np.asarray(_FINENESS[np.searchsorted(_RICHNESS, richness)])


def phases_of(turns: Floats, ratio: float, fineness: int) -> tuple[Complexes, Floats]:
    """Return points exp(i theta) and weights for means over one period, crowded at the turns where there are two.

    Parameters
    ----------
    turns : ndarray, shape (2,)
        Phases of the two turns, or NaN.
    ratio : float
        Least sliding speed over peak velocity.
    fineness : int
        As by `fineness_of`.

    Returns
    -------
    points, weights : ndarray, shape (samples,)
    """
    if np.isnan(turns[0]):
        samples = 2**15
        return np.exp(2j * np.pi * np.arange(samples) / samples), np.full(samples, 1 / samples)
    alpha, along, across = turned_circle(turns[np.newaxis])[:, 0]
    crowded = crowded_points(32, 1e-6**fineness)
    row = int(crowding_of(np.float64(ratio)))  # type: ignore[arg-type]
    inside = slice(0, crowded.count[row])
    w = crowded.cosine[row, inside] + 1j * crowded.sine[row, inside]
    density = (1 - alpha**2) / np.abs(1 + alpha * w) ** 2
    points = complex(along, across) * (w + alpha) / (1 + alpha * w)
    return points, crowded.weight[row, inside] * density
