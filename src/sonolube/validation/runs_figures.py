"""Figures of own runs: measured friction ratios with the best models as curves, and the errors of all models."""

from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import COLOURS, LINES, MARKERS, subplots
from sonolube.validation.ranked_models import RankedModel
from sonolube.validation.run_conditions import RunConditions, RunsTable
from sonolube.validation.runs_comparison import RunsPrediction
from sonolube.validation.runs_fit import RunsFit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_CURVES: Final = 3  # models drawn as curves
_SERIES: Final = 4  # of measured points, each at one value of what does not run along the abscissa
_POINTS: Final = 40
_ROWS: Final = 15  # models of a dot chart
_WORST: Final = 0.6  # error beyond which a model is drawn at the edge
_LABELS: Final = {
    "strength": ("Vibration amplitude [µm]", 1e6, "µm"),
    "velocity": ("Peak velocity of the vibration [m/s]", 1.0, "m/s"),
    "sliding_speed": ("Sliding speed [mm/s]", 1e3, "mm/s"),
}
_LOWEST, _HIGHEST = -0.05, 1.3  # ratios drawn
_RATIO: Final = "Friction with over without vibration [-]"


def runs_fit_figure(result: RunsFit) -> "Figure":
    """Draw own runs over amplitude or speed with the best models as curves, and the unseen errors of all models.

    Parameters
    ----------
    result : RunsFit

    Returns
    -------
    Figure
    """
    figure, (measured, errors) = subplots(1, 2, figsize=(8.4, 4.2), width_ratios=(1.25, 1))
    _draw_runs(measured, result.table, result.models[:_CURVES])
    _draw_ranking(errors, result)
    handles, labels = (
        [*first, *second]
        for first, second in zip(measured.get_legend_handles_labels(), errors.get_legend_handles_labels(), strict=True)
    )
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def runs_prediction_figure(predictions: tuple[RunsPrediction, ...], table: RunsTable) -> "Figure":
    """Draw predicted against measured ratios of own runs, by models that published tests fitted.

    Parameters
    ----------
    predictions : tuple of RunsPrediction
        By rank; the first few are drawn.
    table : RunsTable

    Returns
    -------
    Figure
    """
    figure, axes = subplots(figsize=(5.0, 4.6))
    axes.plot([0, _HIGHEST], [0, _HIGHEST], color="0.5", lw=0.8)
    errors = [condition.uncertainty or 0.0 for condition in table.conditions]
    shown = [one for one in predictions if one.rms is not None][: len(MARKERS) - 1]
    for index, one in enumerate(shown):
        pairs = zip(one.ratios, table.conditions, errors, strict=True)
        points = [(condition.friction_ratio, ratio, error) for ratio, condition, error in pairs if ratio is not None]
        x, y, spread = np.array(points).T
        y = np.clip(y, _LOWEST, _HIGHEST)
        name = f"{one.model.name.replace('-', ' ')}, rms {one.rms:.2f}"
        axes.errorbar(
            x, y, xerr=spread, fmt=MARKERS[index], color=COLOURS[index], ms=5, elinewidth=0.8, alpha=0.85, label=name
        )
    axes.set(xlabel=f"Measured: {_RATIO[0].lower()}{_RATIO[1:]}", ylabel="Predicted, at the edge beyond it [-]")
    axes.set(xlim=(_LOWEST, _HIGHEST), ylim=(_LOWEST, _HIGHEST), aspect="equal")
    axes.set_title(f"{table.title}: models as published tests fitted them", fontsize=9)
    axes.legend(loc="upper left")
    return figure


def _draw_runs(axes: "Axes", table: RunsTable, models: tuple[RankedModel, ...]) -> None:
    """Draw measured ratios with their uncertainty, and models as curves, in a colour for each series."""
    name, other = _abscissa(table.conditions)
    label, scale, _ = _label(name, table.conditions)
    _, other_scale, unit = _label(other, table.conditions)
    series = _series(table.conditions, other)
    for index, (value, members) in enumerate(series):
        colour = COLOURS[index % len(COLOURS)]
        x = np.array([scale * (getattr(one, name) or np.nan) for one in members])
        ratio, error = (
            np.array([getattr(one, field) or 0.0 for one in members]) for field in ("friction_ratio", "uncertainty")
        )
        text = "measured" if value is None else f"measured, {other_scale * value:.3g} {unit}"
        axes.errorbar(x, ratio, error, fmt=MARKERS[index], color=colour, capsize=3, zorder=5, label=text)
        places = _places(table.conditions, name)
        for line, model in enumerate(models):
            curve = _curve(model, members[0], name, places)
            axes.plot(scale * places, curve, color=colour, ls=LINES[line], lw=1.2)
    for line, model in enumerate(models):
        axes.plot([], [], color="0.3", ls=LINES[line], label=model.name.replace("-", " "))
    axes.set(xlabel=label, ylabel=_RATIO)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))


def _draw_ranking(axes: "Axes", result: RunsFit) -> None:
    """Draw the unseen error of each model as a dot, that of its fit as a ring, and what needs no model as lines."""
    models = result.models[:_ROWS][::-1]
    for row, model in enumerate(models):
        colour = COLOURS[0] if model.tied or model is result.models[0] else "0.55"
        axes.plot([min(model.rms_fit, _WORST), min(model.rms_unseen, _WORST)], [row, row], color=colour, lw=0.8)
        axes.plot(min(model.rms_fit, _WORST), row, "o", mfc="white", color=colour, ms=5, clip_on=False)
        axes.plot(min(model.rms_unseen, _WORST), row, "o", color=colour, ms=5, clip_on=False)
    axes.plot([], [], "o", color=COLOURS[0], label="unseen error: first and tied")
    axes.plot([], [], "o", color="0.55", label="unseen error: told apart")
    axes.plot([], [], "o", mfc="white", color="0.4", label="error of the fit")
    axes.axvline(min(result.rms_of_mean, _WORST), color="0.3", ls="--", lw=1, label="mean of the other conditions")
    if result.table.scatter is not None:
        axes.axvline(result.table.scatter, color="0.3", ls=":", lw=1, label="scatter of repeats")
    axes.set_yticks(range(len(models)), labels=[model.name.replace("-", " ") for model in models], fontsize=7)
    axes.set(xlabel="rms error of the friction ratio [-]", ylim=(-0.7, len(models) - 0.3))
    axes.set_xlim(left=0)


def _abscissa(conditions: tuple[RunConditions, ...]) -> tuple[str, str]:
    """Return which of strength and speed varies over more values, and the other."""
    counts = {
        name: len({round(float(np.log(value)), 2) for one in conditions if (value := getattr(one, name))})
        for name in ("strength", "sliding_speed")
    }
    if counts["sliding_speed"] > counts["strength"]:
        return "sliding_speed", "strength"
    return "strength", "sliding_speed"


def _label(name: str, conditions: tuple[RunConditions, ...]) -> tuple[str, float, str]:
    """Return label, scale and unit of an axis."""
    in_plane = name == "strength" and conditions[0].vibration_amplitude is None
    return _LABELS["velocity" if in_plane else name]


def _series(conditions: tuple[RunConditions, ...], other: str) -> list[tuple[float | None, list[RunConditions]]]:
    """Return conditions by the value of what does not run along the abscissa, the largest series first."""
    groups: dict[float | None, list[RunConditions]] = {}
    for one in conditions:
        value = getattr(one, other)
        groups.setdefault(None if value is None else float(f"{value:.2g}"), []).append(one)
    return sorted(groups.items(), key=lambda item: -len(item[1]))[:_SERIES]


def _places(conditions: tuple[RunConditions, ...], name: str) -> Floats:
    """Return the abscissae of a curve, over those of the runs."""
    values = [value for one in conditions if (value := getattr(one, name)) is not None]
    if not values:
        return np.array([np.nan])
    low, high = min(values), max(values)
    return np.linspace(0.8 * low, 1.1 * high, _POINTS)


def _curve(model: RankedModel, condition: RunConditions, name: str, places: Floats) -> Floats:
    """Return the ratios of a fitted model over the abscissa; NaN outside its range."""
    others = [condition.at(**{name: float(place)}) for place in places if np.isfinite(place)]
    ratios = [np.nan if (ratio := model.fit.predict(one)) is None else ratio for one in others]
    return np.array(ratios or [np.nan], dtype=np.float64)
