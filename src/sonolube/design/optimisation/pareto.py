"""Several objectives: which designs no other beats in all of them, and the front between their best."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats

Chosen = TypeVar("Chosen")


def non_dominated(values: Floats) -> NDArray[np.bool_]:
    """Return which rows no other row beats in one column without losing in another; less is better.

    Parameters
    ----------
    values : ndarray, shape (n, m)

    Returns
    -------
    ndarray of bool, shape (n,)
        Of rows that are alike, the first; never one with a value that is not finite.
    """
    keep: NDArray[np.bool_] = np.asarray(np.isfinite(values).all(axis=1), dtype=np.bool_)
    order = np.lexsort(values.T[::-1])
    kept: list[int] = []
    for row in order:
        if not keep[row]:
            continue
        beaten = kept and np.any(np.all(values[kept] <= values[row], axis=1))
        keep[row] = not beaten
        if keep[row]:
            kept.append(int(row))
    return keep


def bounds_between(values: Floats, points: int) -> Floats:
    """Return bounds on the second column that walk along a front, from its least to that of the first column's best.

    Parameters
    ----------
    values : ndarray, shape (n, 2)
        Objectives of designs that no other beats.
    points : int
        How many bounds.

    Returns
    -------
    ndarray, shape (points,)
        Even in ratio, falling; the first is no bound to the first column's best.
    """
    best = values[np.argmin(values[:, 0]), 1]
    return np.geomspace(best, values[:, 1].min(), points)


def epsilon_front(
    least_under: Callable[[float], tuple[Chosen, Floats] | None], bounds: Floats
) -> list[tuple[Chosen, Floats]]:
    """Return the front of two objectives: the least of the first under each bound on the second.

    Parameters
    ----------
    least_under : callable
        Returns for a bound what was chosen and both objectives, or None where nothing keeps to it.
    bounds : ndarray
        Bounds on the second objective.

    Returns
    -------
    list of pair
        What was chosen and its objectives, none beaten by another, by rising first objective.

    References
    ----------
    .. [1] Y. Y. Haimes, L. S. Lasdon, D. A. Wismer, IEEE Trans. Syst. Man Cybern. 1, 296 (1971).
    """
    found = [point for bound in bounds if (point := least_under(float(bound))) is not None]
    if not found:
        return []
    kept = non_dominated(np.array([objectives for _, objectives in found]))
    front = [point for point, keep in zip(found, kept, strict=True) if keep]
    return sorted(front, key=lambda point: float(point[1][0]))
