"""Figures of the closures' errors: point by point, Table 2.3 against Table 4.2, and on motions of the dynamics."""

from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.reproduce.closures.dynamics import MODELS, MOTIONS, predictions
from sonolube.reproduce.closures.tables_in_conflict import mechanisms
from sonolube.validation.closure_comparison import ALL_FITTED, DEFAULT, FITTED_ON, Judgement, judged
from sonolube.validation.closures import VARIANTS
from sonolube.validation.fit import fitted, measured_in, profile_interval

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WORST: Final = 0.5  # error at which the colours end
_DRAWN: Final = ("normal-mindlin", "normal", "in-plane", "in-plane-unbounded", "slack-string", "zero-error-unbounded")
_MICRO: Final = 1e6


def figures() -> tuple[ReportFigure, ...]:
    """Return the figures of the errors."""
    return (
        ReportFigure(
            name="closures-point-by-point",
            chapter=3,
            title="Error of every closure in every test",
            caption="Cells: predicted less measured friction ratio in hundredths, the measured ratio above its column; "
            "empty where a closure does not reach. All closures are fitted to all seven sets. Right: the number of "
            "fitted parameters k, rms, median of the relative error, the same with each set predicted by a fit to the "
            "others, and the criteria of Akaike (corrected) and Schwarz, the lower the better, where every test is "
            f"reached. {_default_said()}",
            draw=_point_by_point,
        ),
        ReportFigure(
            name="closures-table-2-3-against-4-2",
            chapter=4,
            title="What could explain both Table 2.3 and Table 4.2",
            caption="Points and scatter: measured. Lines: mechanisms fitted to both tables at once, with the number k "
            "of fitted parameters and Akaike's corrected criterion, the lower the better. Normal vibration cannot; "
            "in-plane motion can, if it is nearly as large as the normal one and absent in Table 2.3; a zero error of "
            "the string can only if it is as large as the friction itself.",
            draw=_dispute,
        ),
        ReportFigure(
            name="closures-on-dynamics",
            chapter=3,
            title="Friction on motions of the dynamics beside that on a prescribed sine",
            caption="Left: measured ratios of Tables 2.3 (A) and 4.2 (B) and both closures with nothing fitted on the "
            "steady motion of the identified tribometer. Right: by how much the ratio changes against that on a "
            "prescribed sine: "
            + "; ".join(f"{name.replace('-', ' ')}, {said}" for name, said in MOTIONS.items())
            + ".",
            draw=_on_dynamics,
        ),
    )


def _default_said() -> str:
    """Return what is known of the default closure's one parameter."""
    variant = next(one for one in VARIANTS if one.name == DEFAULT)
    fit = fitted(variant, FITTED_ON)
    low, high = profile_interval(fit, 0)
    return (
        f"The default is {DEFAULT}: fitted to the sets without Table 4.2 its memory length is "
        f"{_MICRO * fit.values[0]:.2f} um, {_MICRO * low:.2f} to {_MICRO * high:.2f} um with 95 %."
    )


def _point_by_point() -> "Figure":
    from matplotlib import pyplot as plt

    tests = measured_in(ALL_FITTED)
    judgements = [judged(variant, ALL_FITTED) for variant in VARIANTS]
    off = np.full((len(VARIANTS), len(tests)), np.nan)
    for row, judgement in enumerate(judgements):
        for column, test in enumerate(tests):
            ratio = judgement.fit.predict(test)
            if ratio is not None:
                off[row, column] = ratio - test.friction_ratio
    figure, (axes, beside) = plt.subplots(1, 2, figsize=(11.0, 5.4), sharey=True, width_ratios=(15, 7.5))
    image = axes.imshow(off, cmap="RdBu_r", vmin=-_WORST, vmax=_WORST, aspect="auto")
    for (row, column), error in np.ndenumerate(off):
        if np.isfinite(error):
            shade = "white" if abs(error) > 0.7 * _WORST else "black"
            axes.text(
                column,
                row,
                f"{100 * error:+.0f}" if error < 1 else "> 99",
                ha="center",
                va="center",
                fontsize=7,
                color=shade,
            )
    axes.set_yticks(range(len(VARIANTS)), labels=[variant.name.replace("-", " ") for variant in VARIANTS])
    axes.set_xticks(range(len(tests)), labels=[f"{test.label}\n{test.friction_ratio:.2f}" for test in tests])
    axes.xaxis.tick_top()
    axes.tick_params(length=0, labelsize=8)
    axes.grid(visible=False)
    axes.set_xlabel("Test and its measured friction ratio [-]")
    axes.xaxis.set_label_position("top")
    _measures_beside(beside, judgements)
    label = "Predicted less measured friction ratio [-]"
    figure.colorbar(image, ax=axes, label=label, location="bottom", fraction=0.03, pad=0.02, extend="both")
    return figure


def _measures_beside(axes: "Axes", judgements: list[Judgement]) -> None:
    heads = ("k", "rms", "median", "rms\nunseen", "median\nunseen", "AICc", "BIC")
    columns = range(len(heads))
    for row, judgement in enumerate(judgements):
        seen, unseen, known = judgement.seen, judgement.unseen, judgement.information
        texts = (
            str(len(judgement.fit.values)),
            f"{seen.rms:.3f}",
            f"{100 * seen.median_relative:.0f} %",
            f"{unseen.rms:.3f}",
            f"{100 * unseen.median_relative:.0f} %",
            "" if known is None else f"{known.akaike:.0f}",
            "" if known is None else f"{known.schwarz:.0f}",
        )
        for column, text in zip(columns, texts, strict=True):
            axes.text(column, row, text, ha="center", va="center", fontsize=8)
    axes.set_xlim(-0.5, len(heads) - 0.5)
    axes.set_xticks(columns, labels=heads)
    axes.xaxis.tick_top()
    axes.tick_params(length=0, labelsize=8, labelleft=False)
    axes.spines[:].set_visible(False)
    axes.grid(visible=False)


def _dispute() -> "Figure":
    from matplotlib import pyplot as plt

    figure, (speeds, amplitudes) = plt.subplots(1, 2, figsize=(8.6, 4.6), sharey=True)
    for index, mechanism in enumerate(one for one in mechanisms() if one.fit.variant.name in _DRAWN):
        known = mechanism.information
        assert known is not None
        style = {"color": COLOURS[index], "ls": LINES[index], "marker": MARKERS[index], "ms": 4, "mfc": "white"}
        told = f"{mechanism.fit.variant.meaning}: k = {known.free}, AICc = {known.akaike:.0f}"
        for axes, letter in ((speeds, "A"), (amplitudes, "B")):
            tests = measured_in(letter)
            axes.plot(
                [_abscissa(letter, test.sliding_speed, test.vibration_amplitude) for test in tests],
                [mechanism.fit.predict(test) for test in tests],
                **style,
                label=told if letter == "A" else None,
            )
    for axes, letter in ((speeds, "A"), (amplitudes, "B")):
        tests = measured_in(letter)
        axes.errorbar(
            [_abscissa(letter, test.sliding_speed, test.vibration_amplitude) for test in tests],
            [test.friction_ratio for test in tests],
            yerr=[test.uncertainty for test in tests],
            fmt="o",
            color="black",
            capsize=3,
            zorder=5,
            label="measured" if letter == "A" else None,
        )
    speeds.set(xlabel="Sliding speed [mm/s]", ylabel="Friction with over without vibration [-]", ylim=(-0.12, 1.08))
    speeds.set_title("Table 2.3: 2.5 µm, 3 N", fontsize=9)
    amplitudes.set(xlabel="Vibration amplitude [µm]")
    amplitudes.set_title("Table 4.2: 65.5 mm/s, 5 N", fontsize=9)
    figure.legend(loc="outside lower center", ncols=1, title="k parameters fitted to both tables")
    return figure


def _abscissa(letter: str, speed: float, amplitude: float) -> float:
    return 1e3 * speed if letter == "A" else _MICRO * amplitude


def _on_dynamics() -> "Figure":
    from matplotlib import pyplot as plt

    figure, (ratios, changes) = plt.subplots(1, 2, figsize=(8.6, 4.4))
    found = predictions()
    places = np.arange(len(found))
    ratios.errorbar(
        places,
        [one.test.friction_ratio for one in found],
        yerr=[one.test.uncertainty for one in found],
        fmt="o",
        color="black",
        capsize=3,
        label="measured",
    )
    for index, closure in enumerate(MODELS):
        label = closure.replace("_", "-")
        ratios.plot(
            places,
            [one.ratios[closure, "harmonic-balance"] for one in found],
            linestyle="none",
            marker=MARKERS[index + 1],
            color=COLOURS[index],
            label=label,
        )
        for motion, fill in (("harmonic-balance", "none"), ("slow-arm", COLOURS[index]), ("marched", "0.85")):
            changes.plot(
                places,
                [max(abs(one.ratios[closure, motion] - one.ratios[closure, "sine"]), 1e-6) for one in found],
                linestyle="none",
                marker=MARKERS[index + 1],
                color=COLOURS[index],
                mfc=fill,
                label=f"{label}, {motion.replace('-', ' ')}",
            )
    for axes in (ratios, changes):
        axes.set_xticks(places, labels=[one.test.label for one in found])
        axes.set_xlabel("Test")
    ratios.set(ylabel="Friction with over without vibration [-]", ylim=(-0.03, 1.08))
    changes.set(yscale="log", ylim=(5e-7, 1), ylabel="Change against the prescribed sine [-]")
    changes.axhspan(0.04, 0.06, color="0.9", zorder=0, label="scatter of the measured ratios")
    for axes, columns in ((ratios, 1), (changes, 2)):
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=columns)
    return figure
