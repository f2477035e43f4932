"""Charts of model variants: predicted against measured ratios, ratios over speed and amplitude, a rig's, own runs."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.charts import Axis, Chart, Line, Note, Panel, Part, Points, Rule
from sonolube.checks import Floats
from sonolube.validation.comparison import DATA_SETS, ComparedFit, RunsPrediction
from sonolube.validation.published_tests import FrictionTest, friction_tests
from sonolube.validation.run_conditions import RunConditions, RunsTable
from sonolube.validation.runs_fit import RankedModel, RunsFit
from sonolube.validation.tables import comparison_dataset

if TYPE_CHECKING:
    import xarray as xr

_PANELS: Final = 12  # variants with a panel of predicted against measured ratios
_CURVES: Final = 6  # variants drawn over speed and amplitude
CURVE_POINTS: Final = 40
_LOW, _HIGH = -0.1, 1.15  # limits of the ratios drawn
_HIGHEST_OF_RIG: Final = 1.5
RATIO_LABEL: Final = "Friction with over without vibration"
_PAGE: Final = 6.85  # inches
NOWHERE: Final = np.array([])


@dataclass(frozen=True, kw_only=True, slots=True)
class ComparisonFigure:
    """Figure of a comparison.

    Parameters
    ----------
    name : str
        Of its file, without ending.
    title : str
    caption : str
    chart : callable
        Returns the figure as data.
    """

    name: str
    title: str
    caption: str
    chart: Callable[[], Chart]


def comparison_figures(compared: Callable[[], tuple[ComparedFit, ...]]) -> Iterator[ComparisonFigure]:
    """Figures of a comparison."""
    yield ComparisonFigure(
        name="models-predicted-against-measured",
        title="Models of friction under vibration: predicted against measured",
        caption="Filled: by the fit to all sets A to G. Open: each set by a fit to the others, where "
        "that differs; set H by the fit to all. On the line both would agree; ratios outside the frame are drawn "
        "at its edge. k fitted parameters, rms errors of the fit and of the cross-validation (CV). The "
        f"{_PANELS} models of the least error of the cross-validation.",
        chart=lambda: predicted_against_measured_chart(comparison_dataset(compared())),
    )
    yield ComparisonFigure(
        name="models-over-speed-and-amplitude",
        title="Models of friction under vibration over speed and amplitude",
        caption="Points and scatter: Tables 2.3 and 4.2. Lines: models fitted to all sets, of each family the one "
        "of the least error of the cross-validation.",
        chart=lambda: _over_speed_and_amplitude(_best_of_each_family(compared())[:_CURVES]),
    )


def comparison_chart(result: "xr.Dataset") -> Chart:
    """Friction ratio of the rig of a comparison by every model; without a rig the predicted ratios of tests."""
    return rig_chart(result) if "rig_friction_ratio" in result else predicted_against_measured_chart(result)


def rig_chart(result: "xr.Dataset") -> Chart:
    """Friction ratio of a rig by every applicable model, with its cross-validation error."""
    known = result.isel(model=slice(None, None, -1)).dropna("model", subset=["rig_friction_ratio"])
    names, ratios = known["model"].to_numpy(), known["rig_friction_ratio"].to_numpy()
    rows = np.arange(float(names.size))
    points = Points(
        x=np.minimum(ratios, _HIGHEST_OF_RIG),
        y=rows,
        x_error=np.nan_to_num(known["rig_uncertainty"].to_numpy()),
        sources=tuple(f"{name}: {ratio:.3g}" for name, ratio in zip(names, ratios, strict=True)),
    )
    beyond = [
        Note(x=_HIGHEST_OF_RIG, y=row, text=f"{ratio:.1f} →", side="left")
        for row, ratio in zip(rows, ratios, strict=True)
        if ratio > _HIGHEST_OF_RIG
    ]
    panel = Panel(
        x=Axis(label=RATIO_LABEL, lowest=-0.1, highest=1.6),
        y=Axis(lowest=-0.7, highest=names.size - 0.3, words=tuple(name.replace("-", " ") for name in names)),
        parts=(points, Rule(value=1.0, colour="0.5", dash=1), *beyond),
        title=f"{result.attrs.get('rig', '')}\nbars: rms error of the cross-validation",
    )
    return Chart(panels=(panel,), size=(5.6, 1.3 + 0.22 * names.size))


def speed_and_amplitude_panels(
    over_speed: tuple[Line, ...], over_amplitude: tuple[Line, ...], *, logarithmic: bool = False
) -> tuple[Panel, Panel]:
    """Measured ratios of Table 2.3 over sliding speed and of Table 4.2 over amplitude, with curves."""
    speeds = _measured("A", lambda test: 1e3 * test.sliding_speed)
    amplitudes = _measured("B", lambda test: 1e6 * test.vibration_amplitude)
    ticks = (5, 10, 20, 50, 100, 200) if logarithmic else ()
    ratio = Axis(label=RATIO_LABEL, lowest=-0.12, highest=1.1)
    return (
        Panel(
            x=Axis(label="Sliding speed", unit="mm/s", logarithmic=logarithmic, ticks=ticks),
            y=ratio,
            parts=(speeds, *over_speed),
            title="Table 2.3: 2.5 µm, 3 N",
        ),
        Panel(
            x=Axis(label="Vibration amplitude", unit="µm"),
            y=ratio,
            parts=(amplitudes, *over_amplitude),
            title="Table 4.2: 65.5 mm/s, 5 N",
        ),
    )


def _measured(set_name: str, abscissa: Callable[[FrictionTest], float]) -> Points:
    """Measured friction ratios of a set with their uncertainties."""
    tests = friction_tests(set_name)
    return Points(
        x=np.array([abscissa(test) for test in tests]),
        y=np.array([test.friction_ratio for test in tests]),
        y_error=np.array([test.uncertainty or 0.0 for test in tests]),
        label="measured, Tables 2.3 and 4.2",
        colour="0",
        sources=tuple(map(_source, tests)),
    )


def _source(test: FrictionTest) -> str:
    """Label of a test, with what its set is."""
    return f"{test.label}: {DATA_SETS[test.set_name]}"


def predicted_against_measured_chart(result: "xr.Dataset") -> Chart:
    """Predicted against measured ratios, one panel for each of the first models that could be assessed."""
    assessed = result.dropna("model", subset=["rms"]).isel(model=slice(_PANELS))
    count = assessed.sizes["model"]
    columns = min(4, count)
    legend_columns = 1 if columns < 3 else 2
    width = min(max(2.15 * columns + 0.6, 4.9), _PAGE)
    height = -(-count // columns) * (min(width / columns, 2.6) + 0.6) + 1.1 + 1.8 / legend_columns
    fitted = assessed["test"].to_numpy()[assessed["fitted_ratio"].notnull().any("model").to_numpy()]
    letters = sorted({test[0] for test in fitted})
    return Chart(
        panels=tuple(_panel(assessed.isel(model=index), letters) for index in range(count)),
        size=(width, height),
        columns=columns,
        legend="bottom",
        legend_columns=legend_columns,
        shares_x=True,
        shares_y=True,
    )


def _panel(one: "xr.Dataset", letters: list[str]) -> Panel:
    """Predictions of one model against the measured ratios, with a label for each set of tests."""
    sets = np.array([test[0] for test in one["test"].to_numpy()])
    filled = [_ratios_of_set(one, letter, sets == letter, "fitted_ratio") for letter in letters]
    every = sorted(set(sets))
    hollow = [_ratios_of_set(one, letter, sets == letter, "cross_validated_ratio") for letter in every]
    line = np.array([0.0, _HIGH])
    meaning = (
        Points(x=NOWHERE, y=NOWHERE, label="filled: fitted, k free parameters, rms error", colour="0.3"),
        Points(x=NOWHERE, y=NOWHERE, label="open: its set left out, rms error CV", colour="0.3", is_hollow=True),
        Line(x=line, y=line, label="predicted as measured", colour="0.5", weight=0.6),
    )
    errors = f"rms {float(one['rms']):.2f}, CV {float(one['rms_cross_validated']):.2f}"
    return Panel(
        x=Axis(label="Measured friction ratio", lowest=0.0, highest=_HIGH, ticks=(0, 0.5, 1)),
        y=Axis(label="Predicted friction ratio", lowest=_LOW, highest=_HIGH, ticks=(0, 0.5, 1)),
        parts=(*hollow, *filled, *meaning),
        title=f"{one['model'].item().replace('-', ' ')}\nk {int(one['fitted_parameters'])}, {errors}",
        has_equal_scales=True,
    )


def _ratios_of_set(one: "xr.Dataset", letter: str, members: "np.ndarray", name: str) -> Points:
    """Ratios of the tests of a set by one model, those outside the frame at its edge."""
    own = one.isel(test=np.flatnonzero(members)).dropna("test", subset=[name])
    is_fitted = name == "fitted_ratio"
    number = list(DATA_SETS).index(letter)
    return Points(
        x=own["friction_ratio"].to_numpy(),
        y=np.clip(own[name].to_numpy(), _LOW, _HIGH),
        label=f"{letter}: {DATA_SETS[letter]}" if is_fitted else "",
        colour=number,
        marker=number,
        sources=tuple(map(str, own["test"].to_numpy())),
        is_hollow=not is_fitted,
    )


def _over_speed_and_amplitude(fits: list[ComparedFit]) -> Chart:
    """Fitted models over sliding speed and amplitude with the measured ratios of Tables 2.3 and 4.2."""
    tribometer, power_map = friction_tests("A")[0], friction_tests("B")[0]
    speed, amplitude = np.geomspace(5e-3, 0.2, CURVE_POINTS), np.linspace(0.05e-6, 2.6e-6, CURVE_POINTS)
    over_speed, over_amplitude = [], []
    for index, one in enumerate(fits):
        by_speed = _ratios(one, [replace(tribometer, sliding_speed=float(v)) for v in speed])
        by_amplitude = _ratios(one, [replace(power_map, vibration_amplitude=float(a)) for a in amplitude])
        label = f"{one.model.name.replace('-', ' ')}, k = {len(one.parameters)}"
        over_speed.append(Line(x=1e3 * speed, y=by_speed, label=label, colour=index, dash=index))
        over_amplitude.append(Line(x=1e6 * amplitude, y=by_amplitude, label=label, colour=index, dash=index))
    panels = speed_and_amplitude_panels(tuple(over_speed), tuple(over_amplitude), logarithmic=True)
    return Chart(panels=panels, size=(8.2, 4.4), columns=2, legend="bottom", shares_y=True)


def _ratios(one: ComparedFit, tests: list[FrictionTest]) -> Floats:
    """Friction ratios of tests by a fitted model; NaN outside its range. []"""
    ratios: list[ArrayLike] = [np.nan if ratio is None else ratio for ratio in map(one.fit.predict, tests)]
    return np.array(ratios, dtype=np.float64)


def _best_of_each_family(fits: tuple[ComparedFit, ...]) -> list[ComparedFit]:
    """First assessed fit to set A of each family of models, named by the first word of their names."""
    families: dict[str, ComparedFit] = {}
    for one in fits:
        if one.assessment is not None and "A" in one.sets:
            families.setdefault(one.model.name.split("-")[0], one)
    return list(families.values())


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
