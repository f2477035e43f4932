"""Figures of the comparison: predicted against measured ratios, ratios over speed and amplitude, and those of a rig."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from textwrap import wrap
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure, subplots
from sonolube.validation.comparison import DATA_SETS, ComparedFit
from sonolube.validation.published_tests import FrictionTest, friction_tests
from sonolube.validation.tables import comparison_dataset

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PANELS: Final = 12  # variants with a panel of predicted against measured ratios
_CURVES: Final = 6  # variants drawn over speed and amplitude
_POINTS: Final = 40
_TITLE_WIDTH: Final = 22  # characters of a line above a panel
_STYLES: Final = {
    letter: (COLOURS[index % len(COLOURS)], (*MARKERS, "<", ">")[index]) for index, letter in enumerate(DATA_SETS)
}
_LOW, _HIGH = -0.1, 1.15  # limits of the ratios drawn
_HIGHEST_OF_RIG: Final = 1.5


def comparison_figures(compared: Callable[[], tuple[ComparedFit, ...]]) -> Iterator[ReportFigure]:
    """Return the figures of a comparison.

    Parameters
    ----------
    compared : callable
        Function that returns the comparison; called when a figure is drawn.

    Returns
    -------
    iterator of ReportFigure
    """

    def assessed() -> list[ComparedFit]:
        return [one for one in compared() if one.assessment is not None]

    yield ReportFigure(
        name="models-predicted-against-measured",
        title="Models of friction under vibration: predicted against measured",
        caption="Filled: by the fit to all sets A to G. Open: each set by a fit to the others, where "
        "that differs; set H by the fit to all. On the line both would agree; ratios outside the frame are drawn "
        "at its edge. k fitted parameters, rms errors of the fit and of the cross-validation (CV). The "
        f"{_PANELS} models of the least error of the cross-validation.",
        draw=lambda: predicted_against_measured_figure(comparison_dataset(compared())),
    )
    yield ReportFigure(
        name="models-over-speed-and-amplitude",
        title="Models of friction under vibration over speed and amplitude",
        caption="Points and scatter: Tables 2.3 and 4.2. Lines: models fitted to all sets, of each family the one "
        "of the least error of the cross-validation.",
        draw=lambda: _over_speed_and_amplitude(_best_of_each_family(assessed())[:_CURVES]),
    )


def comparison_figure(result: "xr.Dataset") -> "Figure":
    """Draw the friction ratio of the rig of a comparison by every model; without a rig the predicted ratios of tests.

    Parameters
    ----------
    result : xarray.Dataset
        As `comparison_dataset` returns it.

    Returns
    -------
    Figure
    """
    return rig_figure(result) if "rig_friction_ratio" in result else predicted_against_measured_figure(result)


def rig_figure(result: "xr.Dataset") -> "Figure":
    """Draw the friction ratio of a rig by every applicable model, with its cross-validation error.

    Parameters
    ----------
    result : xarray.Dataset
        As `comparison_dataset` returns it with predictions of a rig; the attribute `rig` names it.

    Returns
    -------
    Figure
    """
    known = result.isel(model=slice(None, None, -1)).dropna("model", subset=["rig_friction_ratio"])
    names, ratios = known["model"].to_numpy(), known["rig_friction_ratio"].to_numpy()
    errors = np.nan_to_num(known["rig_uncertainty"].to_numpy())
    figure, axes = subplots(figsize=(5.6, 1.3 + 0.22 * names.size))
    places = np.minimum(ratios, _HIGHEST_OF_RIG)
    axes.errorbar(places, range(names.size), xerr=errors, fmt="o", color=COLOURS[0], ecolor="0.6", capsize=2.5)
    for row, ratio in enumerate(ratios):
        if ratio > _HIGHEST_OF_RIG:
            axes.annotate(f"{ratio:.1f} →", (_HIGHEST_OF_RIG, row), ha="right", va="bottom", fontsize=7)
    axes.axvline(1.0, color="0.5", lw=0.8, ls="--")
    axes.set_yticks(range(names.size), labels=[name.replace("-", " ") for name in names])
    axes.set(xlabel="Friction with over without vibration [-]", xlim=(-0.1, 1.6), ylim=(-0.7, names.size - 0.3))
    axes.set_title(f"{result.attrs.get('rig', '')}\nbars: rms error of the cross-validation", fontsize=9)
    return figure


def speed_and_amplitude_panels() -> "tuple[Figure, Axes, Axes]":
    """Return a figure with the measured ratios of Table 2.3 over sliding speed and of Table 4.2 over amplitude.

    Returns
    -------
    Figure, Axes, Axes
    """
    figure, (speeds, amplitudes) = subplots(1, 2, figsize=(8.2, 4.4), sharey=True)
    draw_measured(speeds, friction_tests("A"), lambda test: 1e3 * test.sliding_speed, "measured, Tables 2.3 and 4.2")
    draw_measured(amplitudes, friction_tests("B"), lambda test: 1e6 * test.vibration_amplitude)
    speeds.set(xlabel="Sliding speed [mm/s]", ylabel="Friction with over without vibration [-]", ylim=(-0.12, 1.1))
    amplitudes.set(xlabel="Vibration amplitude [µm]")
    speeds.set_title("Table 2.3: 2.5 µm, 3 N", fontsize=9)
    amplitudes.set_title("Table 4.2: 65.5 mm/s, 5 N", fontsize=9)
    return figure, speeds, amplitudes


def draw_measured(
    axes: "Axes",
    tests: tuple[FrictionTest, ...],
    abscissa: Callable[[FrictionTest], float],
    label: str | None = None,
    *,
    fmt: str = "o",
    color: str = "black",
) -> None:
    """Draw measured friction ratios with their uncertainties as points on axes.

    Parameters
    ----------
    axes : Axes
    tests : tuple of FrictionTest
    abscissa : callable
        Function of a test that returns its abscissa.
    label : str or None
        Label in the legend.
    fmt, color : str
        Marker and colour.
    """
    x, ratios = [abscissa(test) for test in tests], [test.friction_ratio for test in tests]
    errors = [test.uncertainty or 0.0 for test in tests]
    axes.errorbar(x, ratios, yerr=errors, fmt=fmt, color=color, capsize=3, zorder=5, label=label)


def predicted_against_measured_figure(result: "xr.Dataset") -> "Figure":
    """Draw predicted against measured ratios, one panel for each of the first models that could be assessed.

    Parameters
    ----------
    result : xarray.Dataset
        As `comparison_dataset` returns it.

    Returns
    -------
    Figure
    """
    from matplotlib.lines import Line2D

    assessed = result.dropna("model", subset=["rms"]).isel(model=slice(_PANELS))
    count = assessed.sizes["model"]
    columns = min(4, count)
    rows = -(-count // columns)
    legend_columns = 1 if columns < 3 else 2
    width = max(2.15 * columns + 0.6, 4.9)
    height = rows * (min(width / columns, 2.6) + 0.25) + 0.4 + 1.8 / legend_columns
    figure, grid = subplots(rows, columns, figsize=(width, height), sharex=True, sharey=True, squeeze=False)
    for index, axes in enumerate(grid.flat[:count]):
        _panel(axes, assessed.isel(model=index))
    for axes in grid.flat[count:]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_ylabel("Predicted friction ratio [-]")
    for column in range(columns):
        lowest = max(row for row in range(rows) if row * columns + column < count)
        grid[lowest, column].set_xlabel("Measured friction ratio [-]")
        grid[lowest, column].tick_params(labelbottom=True)
    fitted = assessed["test"].to_numpy()[assessed["fitted_ratio"].notnull().any("model").to_numpy()]
    handles = [
        Line2D([], [], ls="", color=colour, marker=marker, label=f"{letter}: {DATA_SETS[letter]}")
        for letter, (colour, marker) in ((letter, _STYLES[letter]) for letter in sorted({test[0] for test in fitted}))
    ]
    handles += [
        Line2D([], [], ls="", color="0.3", marker="o", label="filled: fitted, k free parameters, rms error"),
        Line2D([], [], ls="", color="0.3", marker="o", mfc="none", label="open: its set left out, rms error CV"),
        Line2D([], [], color="0.5", lw=0.8, label="predicted as measured"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=legend_columns)
    return figure


def _panel(axes: "Axes", one: "xr.Dataset") -> None:
    """Draw the predictions of one model against the measured ratios."""
    axes.plot([0, _HIGH], [0, _HIGH], color="0.5", lw=0.8)
    for test in one["test"].to_numpy():
        colour, marker = _STYLES[test[0]]  # by the letter of its set
        row = one.sel(test=test)
        for name, face in (("cross_validated_ratio", "none"), ("fitted_ratio", colour)):
            if row[name].notnull():
                place = float(row["friction_ratio"]), min(max(float(row[name]), _LOW), _HIGH)
                axes.plot(*place, ls="", marker=marker, color=colour, mfc=face, ms=4.5, clip_on=False)
    errors = f"rms {float(one['rms']):.2f}, CV {float(one['rms_cross_validated']):.2f}"
    name = "\n".join(wrap(one["model"].item().replace("-", " "), _TITLE_WIDTH))
    axes.set_title(f"{name}\nk = {int(one['fitted_parameters'])}, {errors}", fontsize=7.5)
    axes.set(xlim=(0, _HIGH), ylim=(_LOW, _HIGH), aspect="equal", xticks=(0, 0.5, 1), yticks=(0, 0.5, 1))


def _over_speed_and_amplitude(fits: list[ComparedFit]) -> "Figure":
    """Draw fitted models over sliding speed and amplitude with the measured ratios of Tables 2.3 and 4.2."""
    figure, speeds, amplitudes = speed_and_amplitude_panels()
    tribometer, power_map = friction_tests("A")[0], friction_tests("B")[0]
    speed, amplitude = np.geomspace(5e-3, 0.2, _POINTS), np.linspace(0.05e-6, 2.6e-6, _POINTS)
    for index, one in enumerate(fits):
        colour, line = COLOURS[index % len(COLOURS)], LINES[index % len(LINES)]
        over_speed = _ratios(one, [replace(tribometer, sliding_speed=float(v)) for v in speed])
        over_amplitude = _ratios(one, [replace(power_map, vibration_amplitude=float(a)) for a in amplitude])
        label = f"{one.model.name.replace('-', ' ')}, k = {len(one.parameters)}"
        speeds.plot(1e3 * speed, over_speed, color=colour, ls=line, label=label)
        amplitudes.plot(1e6 * amplitude, over_amplitude, color=colour, ls=line)
    speeds.set(xscale="log", xticks=(5, 10, 20, 50, 100, 200))
    speeds.xaxis.set_major_formatter("{x:g}")
    speeds.minorticks_off()
    figure.legend(loc="outside lower center", ncols=3)
    return figure


def _ratios(one: ComparedFit, tests: list[FrictionTest]) -> Floats:
    """Return the friction ratios of tests by a fitted model; NaN outside its range. []"""
    ratios: list[ArrayLike] = [np.nan if ratio is None else ratio for ratio in map(one.fit.predict, tests)]
    return np.array(ratios, dtype=np.float64)


def _best_of_each_family(fits: list[ComparedFit]) -> list[ComparedFit]:
    """Return the first fit to set A of each family of models, named by the first word of their names."""
    families: dict[str, ComparedFit] = {}
    for one in fits:
        if "A" in one.sets:
            families.setdefault(one.model.name.split("-")[0], one)
    return list(families.values())
