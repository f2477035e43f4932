"""Figures: a prediction over amplitude and speed, calibration, and the width of intervals over own runs."""

from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import COLOURS, MARKERS, subplots
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.scores import PROBABILITIES

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from sonolube.prediction.calibration import Calibration
    from sonolube.rig.labelled_arrays import LabelledArrays

_OPACITIES: Final = (0.15, 0.25, 0.4)  # of the bands, the widest first
_HIGHEST: Final = 1.15  # ratio on the axis, where no own run lies above
_AXES: Final = (
    ("amplitude", "vibration_amplitude", 1e6, "vibration amplitude (µm)"),
    ("speed", "sliding_speed", 1e3, "sliding speed (mm/s)"),
)


def prediction_figure(prediction: "xr.Dataset | LabelledArrays") -> "Figure":
    """Draw the friction ratio of a rig over amplitude and over speed with its intervals, and measured ratios.

    Parameters
    ----------
    prediction : xarray.Dataset or LabelledArrays
        By `predict`.

    Returns
    -------
    Figure
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator

    figure = Figure(figsize=(6.85, 3.3))
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (name, condition, scale, label) in zip(panels, _AXES, strict=True):
        places = scale * prediction[f"curve_{name}"].to_numpy()
        curves = prediction[f"friction_ratio_over_{name}"]
        draw_bands(axes, places, curves.to_numpy())
        _points(axes, condition, scale, prediction)
        axes.axvline(scale * prediction.attrs[condition], color="0.4", lw=0.8, ls=":", label="operating point")
        axes.set(xlabel=label, xscale="log", xlim=(places[0], places[-1]), ylim=(-0.05, _highest(prediction)))
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.xaxis.set_major_formatter("{x:g}")  # not as formulas, which take ten times as long to draw
        axes.xaxis.set_minor_formatter("")
    panels[0].set_ylabel("friction ratio")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure


def _highest(prediction: "xr.Dataset | LabelledArrays") -> float:
    """Upper end of the axis of ratios, above every own run."""
    if "run" not in prediction.sizes:
        return _HIGHEST
    runs = prediction["measured_friction_ratio"].to_numpy() + prediction["measured_uncertainty"].to_numpy()
    return max(_HIGHEST, 0.05 + float(runs.max()))


def draw_bands(axes: "Axes", places: Floats, quantiles: Floats) -> None:
    """Draw median and central intervals along one axis.

    Parameters
    ----------
    axes : Axes
    places : ndarray, shape (n,)
        In the unit of the axis.
    quantiles : ndarray, shape (7, n)
        Of the probabilities `LEVELS`.
    """
    for row, (probability, opacity) in enumerate(zip(PROBABILITIES[::-1], _OPACITIES, strict=True)):
        label = f"{100 * probability:.0f} % interval"
        axes.fill_between(
            places, quantiles[row], quantiles[-1 - row], color=COLOURS[0], alpha=opacity, lw=0, label=label
        )
    axes.plot(places, quantiles[len(PROBABILITIES)], color=COLOURS[0], label="median")


def _points(axes: "Axes", condition: str, scale: float, prediction: "xr.Dataset | LabelledArrays") -> None:
    """Draw the published tests, each at conditions of its own, and the rig's runs."""
    for index, rig in enumerate(published_rigs()):
        places = scale * getattr(rig.at.conditions, condition)
        label = "published tests, each on its own rig" if index == 0 else None
        axes.plot(places, rig.friction_ratio, "o", mfc="none", color="0.45", ms=4, label=label)
    if "run" in prediction.sizes:
        ratio, uncertainty = (prediction[f"measured_{name}"].to_numpy() for name in ("friction_ratio", "uncertainty"))
        places = scale * prediction[f"measured_{condition}"].to_numpy()
        axes.errorbar(places, ratio, uncertainty, fmt="s", color=COLOURS[1], ms=5, label="own runs")


def calibration_figure(calibrations: "tuple[Calibration, ...]") -> "Figure":
    """Draw coverage against probability with its binomial interval, and the scores of each way to predict.

    Parameters
    ----------
    calibrations : tuple of Calibration

    Returns
    -------
    Figure
    """
    figure, (coverage, scores) = subplots(1, 2, figsize=(6.85, 3.6))
    coverage.plot([0, 1], [0, 1], color="0.4", lw=0.8, ls=":")
    for index, one in enumerate(calibrations):
        places = np.array(PROBABILITIES) + 0.012 * (index - 2)
        shares = np.array([one.covered(each) for each in PROBABILITIES]) / len(one.predictions)
        ends = np.array([one.coverage_interval(each) for each in PROBABILITIES]).T
        coverage.errorbar(
            places,
            shares,
            np.abs(ends - shares),
            fmt=MARKERS[index],
            color=COLOURS[index],
            ms=5,
            capsize=2,
            label=one.name,
        )
    coverage.set(xlabel="probability of the interval", ylabel="share of tests within", xlim=(0.4, 1.02), ylim=(0, 1.05))
    heights = np.arange(len(calibrations))[::-1]
    for offset, field, text in ((0.18, "crps", "CRPS"), (-0.18, "interval_score", "interval score, 80 %")):
        values = [getattr(one, field) for one in calibrations]
        colour = COLOURS[0] if field == "crps" else COLOURS[4]
        scores.barh(heights + offset, values, height=0.34, color=colour, label=text)
        for height, value in zip(heights + offset, values, strict=True):
            scores.annotate(
                f"{value:.3f}", (value, height), (3, 0), textcoords="offset points", va="center", fontsize=7
            )
    scores.set(yticks=heights, xlabel="score (lower is better)", xlim=(0, 1.6))
    scores.set_yticklabels(
        [
            one.name.replace(" with ", "\nwith ").replace(" by ", "\nby ").replace(", its", ",\nits")
            for one in calibrations
        ]
    )
    scores.legend(loc="lower right")
    figure.legend(*coverage.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure
