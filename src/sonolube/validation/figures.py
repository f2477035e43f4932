"""Figures of the comparison: predicted against measured, friction over speed and amplitude, and a rig's predictions."""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.validation.compare import DATA_SETS, ComparedFit, RigPrediction, published_comparison
from sonolube.validation.fit import measured_in
from sonolube.validation.friction_tests import FrictionTest

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PANELS: Final = 12  # models of which predicted is drawn against measured
_CURVES: Final = 6  # models drawn over speed and amplitude
_POINTS: Final = 40
_MICRO, _MILLI = 1e6, 1e3
_STYLES: Final = {
    letter: (COLOURS[index % len(COLOURS)], (*MARKERS, "<", ">")[index]) for index, letter in enumerate(DATA_SETS)
}
_LOW, _TOP = -0.1, 1.15  # of the ratios drawn


def figures() -> tuple[ReportFigure, ...]:
    """Return the figures of the comparison of all models with all published tests."""
    return comparison_figures(published_comparison)


def comparison_figures(compared: Callable[[], tuple[ComparedFit, ...]]) -> tuple[ReportFigure, ...]:
    """Return the figures of a comparison, which is only asked for when one is drawn."""

    def judged() -> list[ComparedFit]:
        return [one for one in compared() if one.judgement is not None]

    return (
        ReportFigure(
            name="models-predicted-against-measured",
            chapter=3,
            title="Models of friction under vibration: predicted against measured",
            caption="Filled: by the fit to all sets A to G. Open: each set by a fit to the others, where "
            "that differs; set H by the fit to all. On the line both "
            "would agree; ratios outside the frame stand at its edge. k fitted parameters, rms errors of the fit and "
            f"unseen. The {_PANELS} models of the least corrected criterion of Akaike.",
            draw=lambda: _against_measured(judged()[:_PANELS]),
        ),
        ReportFigure(
            name="models-over-speed-and-amplitude",
            chapter=3,
            title="Models of friction under vibration over speed and amplitude",
            caption="Points and scatter: Tables 2.3 and 4.2. Lines: models fitted to all sets, of each kind the one of "
            "the least corrected criterion of Akaike.",
            draw=lambda: _over_speed_and_amplitude(_one_of_each_kind(judged())[:_CURVES]),
        ),
    )


def rig_figure(predictions: tuple[RigPrediction, ...], title: str) -> "Figure":
    """Draw what every applicable model says of a rig, each with its unseen error."""
    from matplotlib import pyplot as plt

    said = [one for one in predictions if one.friction_ratio is not None][::-1]
    figure, axes = plt.subplots(figsize=(5.6, 1.3 + 0.22 * len(said)))
    ratios = np.array([min(one.friction_ratio or 0.0, 1.5) for one in said])
    spread = np.array([one.uncertainty or 0.0 for one in said])
    axes.errorbar(ratios, range(len(said)), xerr=spread, fmt="o", color=COLOURS[0], ecolor="0.6", capsize=2.5)
    for row, one in enumerate(said):
        if (one.friction_ratio or 0.0) > 1.5:
            axes.annotate(f"{one.friction_ratio:.1f} →", (1.5, row), ha="right", va="bottom", fontsize=7)
    axes.axvline(1.0, color="0.5", lw=0.8, ls="--")
    axes.set_yticks(range(len(said)), labels=[one.model.name.replace("-", " ") for one in said])
    axes.set(xlabel="Friction with over without vibration [-]", xlim=(-0.1, 1.6), ylim=(-0.7, len(said) - 0.3))
    axes.set_title(f"{title}\nbars: rms error in sets of tests that no fit had seen", fontsize=9)
    return figure


def _against_measured(fits: list[ComparedFit]) -> "Figure":
    from matplotlib import pyplot as plt
    from matplotlib.lines import Line2D

    columns = min(4, len(fits))
    rows = -(-len(fits) // columns)
    legend_columns = 1 if columns < 3 else 2
    width = max(2.15 * columns + 0.6, 4.9)
    height = rows * (min(width / columns, 2.6) + 0.25) + 0.4 + 1.8 / legend_columns
    figure, grid = plt.subplots(rows, columns, figsize=(width, height), sharex=True, sharey=True, squeeze=False)
    for axes, one in zip(grid.flat, fits, strict=False):
        _panel(axes, one)
    for axes in grid.flat[len(fits) :]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_ylabel("Predicted friction ratio [-]")
    for column in range(columns):
        lowest = max(row for row in range(rows) if row * columns + column < len(fits))
        grid[lowest, column].set_xlabel("Measured friction ratio [-]")
        grid[lowest, column].tick_params(labelbottom=True)
    shown = sorted({p.test.set_name for one in fits for p in one.predictions if p.fitted is not None})
    handles = [
        Line2D(
            [], [], ls="", color=_STYLES[letter][0], marker=_STYLES[letter][1], label=f"{letter}: {DATA_SETS[letter]}"
        )
        for letter in shown
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=legend_columns)
    return figure


def _panel(axes: "Axes", one: ComparedFit) -> None:
    assert one.judgement is not None
    axes.plot([0, _TOP], [0, _TOP], color="0.5", lw=0.8)
    for prediction in one.predictions:
        colour, marker = _STYLES[prediction.test.set_name]
        for ratio, face in ((prediction.unseen, "none"), (prediction.fitted, colour)):
            if ratio is not None:
                axes.plot(
                    prediction.test.friction_ratio,
                    min(max(ratio, _LOW), _TOP),
                    ls="",
                    marker=marker,
                    color=colour,
                    mfc=face,
                    ms=4.5,
                    clip_on=False,
                )
    seen, unseen = one.judgement.seen.rms, one.judgement.unseen.rms
    axes.set_title(
        f"{one.model.name.replace('-', ' ')}\nk = {len(one.parameters)}, rms {seen:.2f}, unseen {unseen:.2f}",
        fontsize=8,
    )
    axes.set(xlim=(0, _TOP), ylim=(_LOW, _TOP), aspect="equal", xticks=(0, 0.5, 1), yticks=(0, 0.5, 1))


def _over_speed_and_amplitude(fits: list[ComparedFit]) -> "Figure":
    from matplotlib import pyplot as plt

    figure, (speeds, amplitudes) = plt.subplots(1, 2, figsize=(8.2, 4.4), sharey=True)
    slow, loud = measured_in("A"), measured_in("B")
    over_speed = np.geomspace(5e-3, 0.2, _POINTS)
    over_amplitude = np.linspace(0.05e-6, 2.6e-6, _POINTS)
    for index, one in enumerate(fits):
        style = {"color": COLOURS[index % len(COLOURS)], "ls": LINES[index % len(LINES)]}
        speeds.plot(
            _MILLI * over_speed,
            _curve(one, over_speed, lambda speed: replace(slow[0], sliding_speed=speed)),
            **style,
            label=f"{one.model.name.replace('-', ' ')}, k = {len(one.parameters)}",
        )
        amplitudes.plot(
            _MICRO * over_amplitude,
            _curve(one, over_amplitude, lambda amplitude: replace(loud[0], vibration_amplitude=amplitude)),
            **style,
        )
    for axes, tests, places in (
        (speeds, slow, [_MILLI * test.sliding_speed for test in slow]),
        (amplitudes, loud, [_MICRO * test.vibration_amplitude for test in loud]),
    ):
        axes.errorbar(
            places,
            [test.friction_ratio for test in tests],
            yerr=[test.uncertainty for test in tests],
            fmt="o",
            color="black",
            capsize=3,
            zorder=5,
            label="measured, Tables 2.3 and 4.2" if axes is speeds else None,
        )
    speeds.set(
        xscale="log",
        xlabel="Sliding speed [mm/s]",
        ylabel="Friction with over without vibration [-]",
        ylim=(-0.05, 1.1),
        xticks=(5, 10, 20, 50, 100, 200),
    )
    speeds.xaxis.set_major_formatter("{x:g}")
    speeds.minorticks_off()
    speeds.set_title("Table 2.3: 2.5 µm, 3 N", fontsize=9)
    amplitudes.set(xlabel="Vibration amplitude [µm]")
    amplitudes.set_title("Table 4.2: 65.5 mm/s, 5 N", fontsize=9)
    figure.legend(loc="outside lower center", ncols=3)
    return figure


def _curve(one: ComparedFit, values: np.ndarray, at: Callable[[float], FrictionTest]) -> np.ndarray:
    ratios = (one.fit.predict(at(float(value))) for value in values)
    return np.array([np.nan if ratio is None else ratio for ratio in ratios])


def _one_of_each_kind(fits: list[ComparedFit]) -> list[ComparedFit]:
    """Return the first model of each kind that knows normal vibration; a kind is the first word of the name."""
    kinds: dict[str, ComparedFit] = {}
    for one in fits:
        if "A" in one.sets:
            kinds.setdefault(one.model.name.split("-")[0], one)
    return list(kinds.values())
