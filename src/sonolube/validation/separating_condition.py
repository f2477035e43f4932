"""Condition that would separate the leading models of own runs most: what to measure next."""

from dataclasses import dataclass
from itertools import combinations
from math import hypot
from typing import Final

import numpy as np

from sonolube.validation.ranked_models import RankedModel
from sonolube.validation.run_conditions import RunConditions

_SMALLEST_RMS: Final = 1e-3  # of a friction ratio, below which no rig measures
_LEADERS: Final = 5  # models between which the next condition decides
_STEPS: Final = 13  # of the candidates along strength and speed
_BEYOND: Final = 2.0  # factor by which candidates may lie beyond the runs
_MUCH_BETTER: Final = 1.5  # of a candidate beyond the runs over the best within them


@dataclass(frozen=True, kw_only=True, slots=True)
class NextCondition:
    """Condition under which two leading models differ most for their errors.

    Parameters
    ----------
    condition : RunConditions
    first, second : str
        Names of the models.
    first_ratio, second_ratio : float
        Friction ratios that they predict.
    contrast : float
        Their difference over the root sum square of their unseen errors.
    is_beyond : bool
        Whether the condition is beyond the strengths and speeds of the runs.
    """

    condition: RunConditions
    first: str
    second: str
    first_ratio: float
    second_ratio: float
    contrast: float
    is_beyond: bool


def next_conditions(
    models: tuple[RankedModel, ...], conditions: tuple[RunConditions, ...]
) -> tuple[NextCondition, ...]:
    """Conditions that separate the leading models most, within the runs and beyond them.

    Beyond the runs, by at most a factor of two, only where that separates much better; empty for one model.
    """
    leaders = models[:1] + tuple(one for one in models[1:] if one.tied)
    leaders = (leaders if len(leaders) > 1 else models)[:_LEADERS]
    found = [_most_separating(leaders, conditions, beyond) for beyond in (1.0, _BEYOND)]
    within, beyond = found
    if beyond is None or (within is not None and beyond.contrast < _MUCH_BETTER * within.contrast):
        return () if within is None else (within,)
    return (beyond,) if within is None else (within, beyond)


def _most_separating(
    models: tuple[RankedModel, ...], conditions: tuple[RunConditions, ...], beyond: float
) -> NextCondition | None:
    """Condition of a grid over strength and speed, widened by a factor, that separates two models most."""
    base = conditions[0]
    strengths, speeds = (
        _grid([getattr(one, name) for one in conditions], beyond) for name in ("strength", "sliding_speed")
    )
    best: NextCondition | None = None
    for strength in strengths:
        for speed in speeds:
            place = base.at(strength=strength, sliding_speed=speed)
            ratios = [(model, ratio) for model in models if (ratio := model.fit.predict(place)) is not None]
            for (first, one), (second, other) in combinations(ratios, 2):
                contrast = abs(one - other) / max(hypot(first.rms_unseen, second.rms_unseen), _SMALLEST_RMS)
                if best is None or contrast > best.contrast:
                    best = NextCondition(
                        condition=place,
                        first=first.name,
                        second=second.name,
                        first_ratio=one,
                        second_ratio=other,
                        contrast=contrast,
                        is_beyond=beyond > 1,
                    )
    return best


def _grid(values: list[float | None], beyond: float) -> list[float | None]:
    """Values from the lowest to the highest of the runs, widened by a factor."""
    known = [value for value in values if value is not None]
    if not known:
        return [None]
    low, high = min(known) / beyond, max(known) * beyond
    return [low] if low == high else np.geomspace(low, high, _STEPS).tolist()
