"""Charts of own runs: measured friction ratios with the best models as curves, and the errors of all models."""

from typing import Final

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Part, Points, Rule
from sonolube.checks import Floats
from sonolube.validation.figures import CURVE_POINTS, NOWHERE, RATIO_LABEL
from sonolube.validation.ranked_models import RankedModel
from sonolube.validation.run_conditions import RunConditions, RunsTable
from sonolube.validation.runs_comparison import RunsPrediction
from sonolube.validation.runs_fit import RunsFit

_LEADERS: Final = 3  # models drawn as curves
_SERIES: Final = 4  # of measured points, each at one value of what does not run along the abscissa
_ROWS: Final = 15  # models of a dot chart
_WORST: Final = 0.6  # error beyond which a model is drawn at the edge
_LABELS: Final = {
    "strength": ("Vibration amplitude", 1e6, "µm"),
    "velocity": ("Peak velocity of the vibration", 1.0, "m/s"),
    "sliding_speed": ("Sliding speed", 1e3, "mm/s"),
}
_LOWEST, _HIGHEST = -0.05, 1.3  # ratios drawn
_MAX_PREDICTIONS: Final = 6


def runs_fit_chart(result: RunsFit) -> Chart:
    """Own runs over amplitude or speed with the best models as curves, and the unseen errors of all models."""
    panels = (_runs(result.table, result.models[:_LEADERS]), _ranking(result))
    return Chart(panels=panels, size=(8.4, 4.2), columns=2, widths=(1.25, 1), legend="bottom")


def runs_prediction_chart(predictions: tuple[RunsPrediction, ...], table: RunsTable) -> Chart:
    """Predicted against measured ratios of own runs, by models that published tests fitted."""
    line = np.array([0.0, _HIGHEST])
    parts: list[Part] = [Line(x=line, y=line, colour="0.5", weight=0.6)]
    for index, one in enumerate([one for one in predictions if one.rms is not None][:_MAX_PREDICTIONS]):
        reached = [(each, ratio) for each, ratio in zip(table.conditions, one.ratios, strict=True) if ratio is not None]
        points = Points(
            x=np.array([condition.friction_ratio for condition, _ in reached]),
            y=np.clip(np.array([ratio for _, ratio in reached]), _LOWEST, _HIGHEST),
            x_error=np.array([condition.uncertainty or 0.0 for condition, _ in reached]),
            label=f"{one.model.name.replace('-', ' ')}, rms {one.rms:.2f}",
            colour=index,
            marker=index,
            sources=tuple(condition.label for condition, _ in reached),
        )
        parts.append(points)
    panel = Panel(
        x=Axis(label=f"Measured: {RATIO_LABEL[0].lower()}{RATIO_LABEL[1:]}", lowest=_LOWEST, highest=_HIGHEST),
        y=Axis(label="Predicted, at the edge beyond it", lowest=_LOWEST, highest=_HIGHEST),
        parts=tuple(parts),
        title=f"{table.title}: models as published tests fitted them",
        has_equal_scales=True,
    )
    return Chart(panels=(panel,), size=(5.0, 4.6))


def _runs(table: RunsTable, models: tuple[RankedModel, ...]) -> Panel:
    """Measured ratios with their uncertainty, and models as curves, in a colour for each series."""
    name, other = _abscissa(table.conditions)
    label, scale, unit = _label(name, table.conditions)
    _, other_scale, other_unit = _label(other, table.conditions)
    places = _places(table.conditions, name)
    measured, curves = [], []
    for index, (value, members) in enumerate(_series(table.conditions, other)):
        points = Points(
            x=np.array([scale * (getattr(one, name) or np.nan) for one in members]),
            y=np.array([one.friction_ratio for one in members]),
            y_error=np.array([one.uncertainty or 0.0 for one in members]),
            label="measured" if value is None else f"measured, {other_scale * value:.3g} {other_unit}",
            colour=index,
            marker=index,
            sources=tuple(one.label for one in members),
        )
        measured.append(points)
        curves += [
            Line(x=scale * places, y=_curve(model, members[0], name, places), colour=index, dash=dash, weight=0.85)
            for dash, model in enumerate(models)
        ]
    names = [
        Line(x=NOWHERE, y=NOWHERE, label=model.name.replace("-", " "), colour="0.3", dash=dash)
        for dash, model in enumerate(models)
    ]
    lowest = min((float(np.nanmin(each.y)) for each in curves if np.isfinite(each.y).any()), default=0.0)
    lowest = min(lowest, *(one.friction_ratio - (one.uncertainty or 0.0) for one in table.conditions))
    y = Axis(label=RATIO_LABEL, lowest=None if lowest < 0 else 0.0)
    return Panel(x=Axis(label=label, unit=unit), y=y, parts=(*measured, *curves, *names))


def _ranking(result: RunsFit) -> Panel:
    """Unseen error of each model as a dot, that of its fit as a ring, and what needs no model as lines."""
    models = result.models[:_ROWS][::-1]
    parts: list[Part] = []
    for is_best, colour, text in ((True, 0, "first and tied"), (False, "0.55", "told apart")):
        rows = [(row, one) for row, one in enumerate(models) if (one.tied or one is result.models[0]) == is_best]
        places = np.array([row for row, _ in rows], dtype=np.float64)
        fit, unseen = (np.array([min(getattr(one, of), _WORST) for _, one in rows]) for of in ("rms_fit", "rms_unseen"))
        sources = tuple(one.name for _, one in rows)
        between = np.column_stack([fit, unseen, np.full(len(rows), np.nan)]).ravel()
        ring = "error of the fit" if is_best else ""
        parts += [
            Line(x=between, y=np.repeat(places, 3), colour=colour, weight=0.6),
            Points(x=fit, y=places, colour=colour, label=ring, sources=sources, is_hollow=True),
            Points(x=unseen, y=places, colour=colour, label=f"unseen error: {text}", sources=sources),
        ]
    parts.append(
        Rule(value=min(result.rms_of_mean, _WORST), label="mean of the other conditions", colour="0.3", dash=1)
    )
    if result.table.scatter is not None:
        parts.append(Rule(value=result.table.scatter, label="scatter of repeats", colour="0.3"))
    names = tuple(model.name.replace("-", " ") for model in models)
    return Panel(
        x=Axis(label="rms error of the friction ratio", lowest=0.0),
        y=Axis(lowest=-0.7, highest=len(models) - 0.3, words=names),
        parts=tuple(parts),
    )


def _abscissa(conditions: tuple[RunConditions, ...]) -> tuple[str, str]:
    """Which of strength and speed varies over more values, and the other."""
    counts = {
        name: len({round(float(np.log(value)), 2) for one in conditions if (value := getattr(one, name))})
        for name in ("strength", "sliding_speed")
    }
    if counts["sliding_speed"] > counts["strength"]:
        return "sliding_speed", "strength"
    return "strength", "sliding_speed"


def _label(name: str, conditions: tuple[RunConditions, ...]) -> tuple[str, float, str]:
    """Label, scale and unit of an axis."""
    in_plane = name == "strength" and conditions[0].vibration_amplitude is None
    return _LABELS["velocity" if in_plane else name]


def _series(conditions: tuple[RunConditions, ...], other: str) -> list[tuple[float | None, list[RunConditions]]]:
    """Conditions by the value of what does not run along the abscissa, the largest series first."""
    groups: dict[float | None, list[RunConditions]] = {}
    for one in conditions:
        value = getattr(one, other)
        groups.setdefault(None if value is None else float(f"{value:.2g}"), []).append(one)
    return sorted(groups.items(), key=lambda item: -len(item[1]))[:_SERIES]


def _places(conditions: tuple[RunConditions, ...], name: str) -> Floats:
    """Abscissae of a curve, over those of the runs."""
    values = [value for one in conditions if (value := getattr(one, name)) is not None]
    if not values:
        return np.array([np.nan])
    low, high = min(values), max(values)
    return np.linspace(0.8 * low, 1.1 * high, CURVE_POINTS)


def _curve(model: RankedModel, condition: RunConditions, name: str, places: Floats) -> Floats:
    """Ratios of a fitted model over the abscissa; NaN outside its range."""
    others = [condition.at(**{name: float(place)}) for place in places if np.isfinite(place)]
    ratios = [np.nan if (ratio := model.fit.predict(one)) is None else ratio for one in others]
    return np.array(ratios or [np.nan], dtype=np.float64)
