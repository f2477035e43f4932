"""Charts of the comparison: predicted against measured ratios, ratios over speed and amplitude, and those of a rig."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.charts import Axis, Chart, Line, Note, Panel, Points, Rule
from sonolube.checks import Floats
from sonolube.validation.comparison import DATA_SETS, ComparedFit
from sonolube.validation.published_tests import FrictionTest, friction_tests
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
