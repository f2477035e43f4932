"""The optimisation of a rig: its space looked over, the best designs refined, and the front of two objectives."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sonolube.checks import Floats
from sonolube.design.optimisation.local_search import Point, descended, point_at
from sonolube.design.optimisation.pareto import bounds_between, epsilon_front, non_dominated
from sonolube.design.optimisation.requirements import OBJECTIVES
from sonolube.design.optimisation.screening import (
    Advance,
    Landscape,
    Task,
    choices_of,
    drawn,
    looked_over,
    of_choice,
    worst_of,
)
from sonolube.design.optimisation.space import Choice, rig_of
from sonolube.design.optimisation.target import exact_swing, highest_swing
from sonolube.design.optimisation.tolerance import deviations, over_deviations
from sonolube.errors import OutsideRange, UnknownName

_FRONT = 9  # points of a front
_ZOOMS, _DRAWN, _BETWEEN = 3, 8, 25  # rounds of closing in, choices and frequencies in each


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Optimum:
    """What an optimisation found.

    Parameters
    ----------
    task : Task
    minimise : str
        What was made least.
    other : str or None
        The second objective, where there is one.
    landscape : Landscape
        All designs looked at.
    designs : tuple of Point
        The best design of each actuator and waveform, the best of all first.
    front : tuple of Point
        Designs that no other beats in both objectives, by rising first objective; empty for one objective.
    """

    task: Task
    minimise: str
    other: str | None
    landscape: Landscape
    designs: tuple[Point, ...]
    front: tuple[Point, ...]

    @property
    def best(self) -> Point:
        """The design with the least of the first objective."""
        return self.designs[0]


def optimise(
    task: Task,
    *,
    minimise: str = "power",
    other: str | None = None,
    samples: int = 16,
    advance: Advance | None = None,
) -> Optimum:
    """Return the designs of a space that bring friction down as wanted for the least of an objective.

    Parameters
    ----------
    task : Task
    minimise : str
        What to make least, of `OBJECTIVES`.
    other : str, optional
        A second objective, for which the front is drawn.
    samples : int
        Entries of the structure to draw for each actuator and waveform, where they have ranges.
    advance : callable, optional
        Told how much is done, and of how much.

    Returns
    -------
    Optimum

    Raises
    ------
    OutsideRange
        If no design brings friction down so far within the limits; it says what stands in the way.
    UnknownName
        If an objective is unknown.

    Notes
    -----
    The space is looked over first: every actuator and waveform, entries drawn evenly, frequencies crowded at
    resonances. Then the best of each is refined: along the engine's gradients where it is built as drawn, by closing in
    with more samples where it must stand deviations. A point of the front is the least of the first objective under a
    bound on the second.
    """
    for name in (minimise, *([other] if other else [])):
        if name not in OBJECTIVES:
            raise UnknownName.among(OBJECTIVES, kind="objective", name=name)
    land = looked_over(task, choices_of(task.space, samples=samples), advance=advance)
    if not land.feasible.any():
        raise OutsideRange(_in_the_way(task, land))
    starts = _best_of_each(land, minimise)
    designs = [_refined(task, land, row, minimise) for row in starts]
    found = sorted((design for design in designs if design is not None), key=lambda point: point.objective(minimise))
    if not found:
        raise OutsideRange("designs found in the survey do not hold when worked out: give closer ranges with --over")
    front = _front(task, land, minimise, other) if other is not None else ()
    return Optimum(task=task, minimise=minimise, other=other, landscape=land, designs=tuple(found), front=tuple(front))


def _best_of_each(land: Landscape, minimise: str) -> list[int]:
    """Return the best feasible design of each actuator and waveform."""
    kinds = [(choice.actuator, choice.waveform) for choice in land.choices]
    best: dict[tuple[str, str], int] = {}
    cost = land.objectives[minimise]
    for row in np.flatnonzero(land.feasible):
        kind = kinds[land.which[row]]
        if kind not in best or cost[row] < cost[best[kind]]:
            best[kind] = int(row)
    return list(best.values())


def _refined(
    task: Task, land: Landscape, row: int, minimise: str, other: str | None = None, bound: float = np.inf
) -> Point | None:
    choice, f = land.choices[land.which[row]], float(land.frequency[row])
    if task.tolerance is not None:
        return _closed_in(task, choice, f, minimise, other, bound)
    start = point_at(task, choice, frequency=f, near=float(land.voltage_peak_to_peak[row]))
    if start is None:
        return None
    best = descended(task, start, minimise=minimise, other=other, bound=bound)
    return best if best.assessment.most_used[0] <= 1 + 1e-6 else None


def _closed_in(
    task: Task, choice: Choice, frequency: float, minimise: str, other: str | None, bound: float
) -> Point | None:
    """Return the best design near one that must stand deviations, by ever closer samples."""
    space, best = task.space, (np.inf, choice, frequency)
    width = 0.5
    for zoom in range(_ZOOMS):
        width /= 3
        near = {name: _narrowed(bounds, best[1].entries[name], width) for name, bounds in space.ranges.items()}
        low, high = _narrowed(space.frequencies, best[2], width)
        rows = drawn(near, samples=_DRAWN, seed=zoom) if near else np.empty((1, 0))
        for entries in [best[1].entries, *[dict(zip(near, map(float, row), strict=True)) for row in rows]]:
            tried = replace(choice, entries=entries)
            f, found = of_choice(task, tried, frequency=np.unique([best[2], *np.linspace(low, high, _BETWEEN)]))
            cost = np.where(found.most_used <= 0.999, found.objectives[minimise], np.inf)
            if other is not None:
                cost = np.where(found.objectives[other] <= bound, cost, np.inf)
            place = int(np.argmin(cost))
            if cost[place] < best[0]:
                best = (float(cost[place]), tried, float(f[place]))
    return _under_deviations(task, best[1], best[2])


def _under_deviations(task: Task, choice: Choice, frequency: float) -> Point | None:
    rigs = [rig_of(task.space, choice, deviation) for deviation in deviations(task.tolerance)]
    f = np.array([frequency])
    needed = np.array(
        [
            exact_swing(
                rig,
                frequency=frequency,
                friction_ratio=task.friction_ratio,
                near=0.3 * highest_swing(rig, task.limits),
                highest=highest_swing(rig, task.limits),
            )
            for rig in rigs
        ]
    )
    volts = float(over_deviations(np.where(np.isnan(needed), np.inf, needed), task.tolerance))
    if not np.isfinite(volts):
        return None
    found = worst_of(task, rigs, frequency=f, voltage_peak_to_peak=np.array([volts]))
    if found.most_used[0] > 1:
        return None
    return Point(choice=choice, frequency=frequency, voltage_peak_to_peak=volts, assessment=found)


def _narrowed(bounds: tuple[float, float], value: float, width: float) -> tuple[float, float]:
    """Return a range about a value, a share of the whole one wide to each side in ratio."""
    low, high = bounds
    reach = (high / low) ** width
    return max(low, value / reach), min(high, value * reach)


def _front(task: Task, land: Landscape, minimise: str, other: str) -> list[Point]:
    both = np.stack([land.objectives[minimise], land.objectives[other]], axis=1)
    both[~land.feasible] = np.inf
    kept = non_dominated(both)

    def least_under(bound: float) -> tuple[Point, Floats] | None:
        within = np.flatnonzero(kept & (both[:, 1] <= bound * (1 + 1e-9)))
        if not within.size:
            return None
        row = int(within[np.argmin(both[within, 0])])
        found = _refined(task, land, row, minimise, other, bound)
        return None if found is None else (found, np.array([found.objective(minimise), found.objective(other)]))

    return [point for point, _ in epsilon_front(least_under, bounds_between(both[kept], _FRONT))]


def _in_the_way(task: Task, land: Landscape) -> str:
    """Return why no design does."""
    if not land.frequency.size:
        return "no actuator makes a rig: " + "; ".join(land.refused.values())
    reaching = np.isfinite(land.voltage_peak_to_peak)
    wanted = f"friction ratio of {task.friction_ratio:.3g}"
    if not reaching.any():
        return (
            f"out of reach: no design brings friction down to a {wanted} with the voltage that stack and amplifier"
            " bear; take in more frequencies, lighter tips or other actuators"
        )
    shares = {name: values[reaching] for name, values in land.usage.items()}
    closest = int(np.argmin(land.most_used[reaching]))
    worst: Callable[[str], float] = lambda name: float(shares[name][closest])  # noqa: E731
    name = max(shares, key=worst)
    over = f"{worst(name):.3g} times what is allowed" if np.isfinite(worst(name)) else "which no design keeps"
    return (
        f"no design gives a {wanted} within the limits: the closest of {int(reaching.sum())} breaks {name}, {over};"
        " ease that limit or widen the ranges"
    )
