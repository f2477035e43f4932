"""Stick-slip within the plane, along and across the sliding at once: of many asperities, and of one bristle."""

from itertools import pairwise
from math import exp, hypot

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import INNER, kernel
from sonolube.models.friction.bristle import MAXIMUM_PERIODS
from sonolube.models.friction.oscillating_contact.driven_spring import slide_spring, steady_spring_period

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_FARTHEST = 24.0  # decay lengths above the widest gap beyond which the load of elements is negligible
_ENDS = (0.0, 2.0, 8.0, _FARTHEST)  # of the panels of permanent contact, above the widest gap


def planar_stick_slip_ratio(gap: Floats, along: Floats, across: Floats, steady: Floats) -> Floats:
    r"""Mean friction over the mean limit of elements that come into contact at different gaps.

    Parameters
    ----------
    gap : ndarray, shape (n,)
        Displacement of one period, in decay lengths.
    along, across : ndarray, shape (n,)
        Displacement within the plane, in memory lengths.
    steady : ndarray, shape (m,)
        Steady slide of each step, in memory lengths.

    Returns
    -------
    ndarray, shape (m,)

    Notes
    -----
    The force of an element is the vector :math:`\boldsymbol\tau` within the plane, which follows the slide up to the
    length :math:`\max(y - x, 0)` and then its direction by a tractrix, as in `combined_oscillation_ratio`. Friction is
    its component along the sliding, weighted with exp(-y). Gauss-Legendre rules over the gaps y of first contact, in
    panels that the narrowest and widest gap bound; relative error 1e-4.
    """
    heights, weights = _elements(float(gap.min()), float(gap.max()))
    ratios = np.empty(steady.size)
    for i, slide in enumerate(steady.tolist()):
        x = np.append(along, along[0]) + slide * np.arange(along.size + 1)
        ratios[i] = _mean_ratio(np.append(-gap, -gap[0]), x, np.append(across, across[0]), heights, weights)
    return ratios


def _elements(lowest: float, highest: float) -> tuple[Floats, Floats]:
    """Gaps of first contact, with the weight of each, from the narrowest gap on."""
    stroke = min(highest - lowest, _FARTHEST)
    panels = [(0.0, stroke)] if stroke > 0 else []
    if highest - lowest < _FARTHEST:
        panels += [(stroke + low, stroke + high) for low, high in pairwise(_ENDS)]
    above = np.concatenate([low + (high - low) * (1 + _NODES) / 2 for low, high in panels])
    parts = np.concatenate([(high - low) / 2 * _WEIGHTS for low, high in panels])
    return lowest + above, parts * np.exp(-above)


@kernel(cache=True, no_cfunc_wrapper=True)
def _mean_ratio(limit: Floats, x: Floats, y: Floats, heights: Floats, weights: Floats) -> float:
    """Mean force along x of all elements over their mean limit."""
    friction, normal = 0.0, 0.0
    for j in range(heights.size):
        force, mean_limit, _ = steady_spring_period(limit, -heights[j], x, y)
        friction += weights[j] * force
        normal += weights[j] * mean_limit
    return friction / normal


@kernel(cache=True, no_cfunc_wrapper=True)
def planar_bristle_force(
    k: Floats, limit: Floats, along: Floats, across: Floats, steady: Floats, exponent: float
) -> Floats:
    """Mean force along the sliding of a bristle on a rigid holder over its steady period, for each steady slide.

    `k, limit` are stiffness and limit at the samples, `along, across` the slides between them; shape (n,). Result (m,).
    """
    n = k.size
    means = np.empty(steady.size)
    for i in range(steady.size):
        p, q = limit[0], 0.0
        for _ in range(MAXIMUM_PERIODS):
            start_p, start_q, total = p, q, 0.0
            for j in range(n):
                after = j + 1 if j + 1 < n else 0
                stiff, dx, dy = (k[j] + k[after]) / 2, along[j] + steady[i], across[j]
                if exponent == 0.0:
                    p, q = slide_spring(p, q, limit[j], limit[after], stiff * dx, stiff * dy)
                else:
                    p, q = _after_dahl_slide(p, q, (limit[j] + limit[after]) / 2, limit[after], stiff * dx, stiff * dy)
                total += p
            if hypot(p - start_p, q - start_q) <= 1e-12 * limit.max():
                break
        means[i] = total / n
    return means


@kernel(**INNER)
def _after_dahl_slide(p: float, q: float, limit: float, after: float, dx: float, dy: float) -> tuple[float, float]:
    """Force by Dahl's law after a straight slide, given times the stiffness, within the limit at its end."""
    path = hypot(dx, dy)
    if limit > 0.0 and path > 0.0:
        kept = exp(-path / limit)
        p, q = dx / path * limit * (1 - kept) + p * kept, dy / path * limit * (1 - kept) + q * kept
    size = hypot(p, q)
    return (p / size * after, q / size * after) if size > after else (p, q)
