"""Optimisation of a rig: screening of the design space, local search from the best designs, and the Pareto front."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.design.optimisation.gradient_search import DesignPoint, design_point_at, local_search
from sonolube.design.optimisation.requirements import OBJECTIVES, Aim, deviations, worst_or_quantile
from sonolube.design.optimisation.screening import (
    DesignProblem,
    ScreeningResult,
    enumerate_candidates,
    evaluate_candidate,
    evaluate_with_tolerance,
    sample_ranges,
    screen,
)
from sonolube.design.optimisation.space import Candidate, candidate_rig
from sonolube.design.parameter_sweep import ProgressCallback
from sonolube.errors import OutsideRange, UnknownName

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


_FRONT_POINTS = 9
_REFINEMENTS, _SAMPLES, _FREQUENCIES = 3, 8, 25  # of the search under tolerances; the latter two in each refinement
_FEASIBLE = 0.999  # utilisation up to which a sampled design counts as feasible


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Optimum:
    """Result of an optimisation.

    Parameters
    ----------
    problem : DesignProblem
    minimise : str
        Objective that was minimised.
    second_objective : str or None
        Second objective of the Pareto front, where there is one.
    screening : ScreeningResult
        All screened designs.
    designs : tuple of DesignPoint
        Best design of each actuator and waveform, by increasing objective.
    front : tuple of DesignPoint
        Pareto front of both objectives, by increasing first objective; empty for a single objective.
    """

    problem: DesignProblem
    minimise: str
    second_objective: str | None
    screening: ScreeningResult
    designs: tuple[DesignPoint, ...]
    front: tuple[DesignPoint, ...]

    @property
    def best(self) -> DesignPoint:
        """Design with the smallest first objective."""
        return self.designs[0]


def optimise(
    problem: DesignProblem,
    *,
    minimise: str = "power",
    second_objective: str | None = None,
    samples: int = 16,
    advance: ProgressCallback | None = None,
) -> Optimum:
    """Designs that reach a target friction ratio with the smallest objective, and the Pareto front of two objectives.

    Parameters
    ----------
    problem : DesignProblem
    minimise : str
        Objective to minimise, of `OBJECTIVES`.
    second_objective : str, optional
        A second objective, for a Pareto front.
    samples : int
        Structures sampled for each actuator and waveform, where entries of the structure have ranges.
    advance : callable, optional
        Called with the number of screened candidates and their total.

    Returns
    -------
    Optimum

    Raises
    ------
    OutsideRange
        If no design reaches the target within the limits; the message names the limit that prevents it.
    UnknownName
        If an objective is unknown.

    See Also
    --------
    screen, local_search, epsilon_constraint_front

    Notes
    -----
    The design space is screened first: every actuator and waveform, structures from a Sobol sequence, a frequency grid
    that is finer at resonances. The best feasible design of each actuator and waveform is then refined: the nominal
    design by sequential quadratic programming, a design under tolerances by repeated sampling in shrinking ranges. Each
    point of the front minimises the first objective under a bound on the second (epsilon-constraint method).
    """
    for name in (minimise, *([second_objective] if second_objective else [])):
        if name not in OBJECTIVES:
            raise UnknownName.among(OBJECTIVES, kind="objective", name=name)
    screening = screen(problem, enumerate_candidates(problem.space, samples=samples), advance=advance)
    if not screening.feasible.any():
        raise OutsideRange(_infeasibility(problem, screening))
    starts = _best_of_each_kind(screening, minimise)
    refined = [_refined(problem, screening, row, Aim(minimise=minimise)) for row in starts]
    designs = sorted((design for design in refined if design is not None), key=lambda point: point.objective(minimise))
    if not designs:
        raise OutsideRange(
            "no design of the screening remains feasible when refined: voltage or vibration change too fast between the"
            " screened frequencies; give narrower ranges with --over"
        )
    front = _pareto_front(problem, screening, minimise, second_objective) if second_objective is not None else ()
    return Optimum(
        problem=problem,
        minimise=minimise,
        second_objective=second_objective,
        screening=screening,
        designs=tuple(designs),
        front=tuple(front),
    )


def _best_of_each_kind(screening: ScreeningResult, minimise: str) -> list[int]:
    """Row of the best feasible design of each actuator and waveform."""
    kinds = [(candidate.actuator, candidate.waveform) for candidate in screening.candidates]
    best: dict[tuple[str, str], int] = {}
    objective = screening.objectives[minimise]
    for row in np.flatnonzero(screening.feasible):
        kind = kinds[screening.candidate_index[row]]
        if kind not in best or objective[row] < objective[best[kind]]:
            best[kind] = int(row)
    return list(best.values())


def _refined(problem: DesignProblem, screening: ScreeningResult, row: int, aim: Aim) -> DesignPoint | None:
    """Best design near a screened one; None where none is feasible."""
    candidate, f = screening.candidates[screening.candidate_index[row]], float(screening.frequency[row])
    if problem.tolerance is not None:
        return _refined_with_tolerance(problem, candidate, f, aim)
    start = design_point_at(problem, candidate, frequency=f, near=float(screening.voltage_peak_to_peak[row]))
    if start is None:
        return None
    best = local_search(problem, start, aim)
    return best if best.evaluation.maximum_utilisation[0] <= 1 + 1e-6 else None


def _refined_with_tolerance(
    problem: DesignProblem, candidate: Candidate, frequency: float, aim: Aim
) -> DesignPoint | None:
    """Best design under tolerances near a screened one, by repeated sampling in shrinking ranges."""
    space, best = problem.space, (np.inf, candidate, frequency)
    width = 0.5
    for refinement in range(_REFINEMENTS):
        width /= 3
        ranges = {name: _narrowed(bounds, best[1].entries[name], width) for name, bounds in space.ranges.items()}
        low, high = _narrowed(space.frequencies, best[2], width)
        rows = sample_ranges(ranges, samples=_SAMPLES, seed=refinement) if ranges else np.empty((1, 0))
        for entries in [best[1].entries, *[dict(zip(ranges, map(float, row), strict=True)) for row in rows]]:
            trial = replace(candidate, entries=entries)
            f, evaluation = evaluate_candidate(
                problem, trial, frequency=np.unique([best[2], *np.linspace(low, high, _FREQUENCIES)])
            )
            own, second = evaluation.objectives[aim.minimise], aim.second_objective
            objective = np.where(evaluation.maximum_utilisation <= _FEASIBLE, own, np.inf)
            if second is not None:
                objective = np.where(evaluation.objectives[second] <= aim.bound, objective, np.inf)
            i = int(np.argmin(objective))
            if objective[i] < best[0]:
                best = (float(objective[i]), trial, float(f[i]))
    return _design_point_with_tolerance(problem, best[1], best[2])


def _design_point_with_tolerance(problem: DesignProblem, candidate: Candidate, frequency: float) -> DesignPoint | None:
    """Design point at the voltage that reaches the target under tolerances; None where it is infeasible."""
    rigs = [candidate_rig(problem.space, candidate, deviation) for deviation in deviations(problem.tolerance)]
    swings = np.array([problem.required_swing(rig, frequency=frequency) for rig in rigs])
    volts = float(worst_or_quantile(np.where(np.isnan(swings), np.inf, swings), problem.tolerance))
    if not np.isfinite(volts):
        return None
    evaluation = evaluate_with_tolerance(
        problem, rigs, frequency=np.array([frequency]), voltage_peak_to_peak=np.array([volts])
    )
    if evaluation.maximum_utilisation[0] > 1:
        return None
    return DesignPoint(candidate=candidate, frequency=frequency, voltage_peak_to_peak=volts, evaluation=evaluation)


def _narrowed(bounds: tuple[float, float], value: float, width: float) -> tuple[float, float]:
    """Range about a value within bounds, of a given fraction of their ratio to either side, in the logarithm."""
    low, high = bounds
    factor = (high / low) ** width
    return max(low, value / factor), min(high, value * factor)


def _pareto_front(
    problem: DesignProblem, screening: ScreeningResult, minimise: str, second_objective: str
) -> list[DesignPoint]:
    """Pareto front of two objectives by the epsilon-constraint method, from the non-dominated screened designs."""
    objectives = np.stack([screening.objectives[minimise], screening.objectives[second_objective]], axis=1)
    objectives[~screening.feasible] = np.inf
    kept = non_dominated(objectives)

    def minimise_under(bound: float) -> tuple[DesignPoint, Floats] | None:
        """Best design under a bound on the second objective."""
        within = np.flatnonzero(kept & (objectives[:, 1] <= bound * (1 + 1e-9)))
        if not within.size:
            return None
        row = int(within[np.argmin(objectives[within, 0])])
        aim = Aim(minimise=minimise, second_objective=second_objective, bound=bound)
        point = _refined(problem, screening, row, aim)
        if point is None:
            return None
        return point, np.array([point.objective(minimise), point.objective(second_objective)])

    front = epsilon_constraint_front(minimise_under, epsilon_bounds(objectives[kept], _FRONT_POINTS))
    return [point for point, _ in front]


def _infeasibility(problem: DesignProblem, screening: ScreeningResult) -> str:
    """Message why no screened design is feasible."""
    if not screening.frequency.size:
        return "no actuator makes a rig: " + "; ".join(screening.refused.values())
    reached = np.isfinite(screening.voltage_peak_to_peak)
    target = f"friction ratio of {problem.friction_ratio:.3g}"
    if not reached.any():
        return (
            f"out of reach: no design brings friction down to a {target} within the voltage limits of stack and"
            " amplifier; take in more frequencies, lighter tips or other actuators"
        )
    closest = int(np.argmin(screening.maximum_utilisation[reached]))
    utilisation = {name: float(values[reached][closest]) for name, values in screening.utilisation.items()}
    name = max(utilisation, key=lambda each: utilisation[each])
    is_finite = np.isfinite(utilisation[name])
    how = f"{utilisation[name]:.3g} times what is allowed" if is_finite else "with an infinite utilisation"
    excess = f"violates {name}, {how}"
    return (
        f"no design gives a {target} within the limits: the closest of {int(reached.sum())} {excess};"
        " relax that limit or widen the ranges"
    )
