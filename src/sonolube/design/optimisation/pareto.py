"""Pareto front of several objectives: non-dominated points, and the front of two by the epsilon-constraint method."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats

Solution = TypeVar("Solution")


def non_dominated(values: Floats) -> NDArray[np.bool_]:
    """Which points no other point dominates: is no worse in every objective and better in one; smaller is better.

    Parameters
    ----------
    values : ndarray, shape (n, m)
        Objectives of each point.

    Returns
    -------
    ndarray of bool, shape (n,)
        Of equal points the first; never a point with a value that is not finite.

    See Also
    --------
    epsilon_constraint_front
    """
    keep: NDArray[np.bool_] = np.asarray(np.isfinite(values).all(axis=1), dtype=np.bool_)
    order = np.lexsort(values.T[::-1])
    kept: list[int] = []
    for row in order:
        if not keep[row]:
            continue
        dominated = kept and np.any(np.all(values[kept] <= values[row], axis=1))
        keep[row] = not dominated
        if keep[row]:
            kept.append(int(row))
    return keep


def epsilon_bounds(values: Floats, points: int) -> Floats:
    """Bounds on the second objective between the two ends of a Pareto front, in geometric sequence.

    Parameters
    ----------
    values : ndarray, shape (n, 2)
        Objectives of non-dominated points.
    points : int
        Number of bounds.

    Returns
    -------
    ndarray, shape (points,)
        Decreasing, from the second objective of the point with the smallest first one.

    See Also
    --------
    epsilon_constraint_front
    """
    largest = values[np.argmin(values[:, 0]), 1]
    return np.geomspace(largest, values[:, 1].min(), points)


def epsilon_constraint_front(
    minimise_under: Callable[[float], tuple[Solution, Floats] | None], bounds: Floats
) -> list[tuple[Solution, Floats]]:
    r"""Pareto front of two objectives by the epsilon-constraint method.

    Parameters
    ----------
    minimise_under : callable
        From a bound on the second objective to the solution with the smallest first objective, and both objectives; or
        None where the bound is infeasible.
    bounds : ndarray, shape (n,)
        Bounds on the second objective.

    Returns
    -------
    list of pair
        Non-dominated solutions and their objectives, by increasing first objective.

    See Also
    --------
    epsilon_bounds, non_dominated

    Notes
    -----
    Each point solves

    .. math:: \min_x f_1(x) \quad \text{subject to} \quad f_2(x) \le \varepsilon

    References
    ----------
    .. [1] Y. Y. Haimes, L. S. Lasdon, D. A. Wismer, IEEE Trans. Syst. Man Cybern. 1, 296 (1971).
    """
    solutions = [solution for bound in bounds if (solution := minimise_under(float(bound))) is not None]
    if not solutions:
        return []
    kept = non_dominated(np.array([objectives for _, objectives in solutions]))
    front = [solution for solution, keep in zip(solutions, kept, strict=True) if keep]
    return sorted(front, key=lambda solution: float(solution[1][0]))
