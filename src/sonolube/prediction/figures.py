"""Figures: a prediction over amplitude and speed, calibration, and the width of intervals over own runs."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.charts import Axis, Band, Chart, Line, Panel, Part, Points, Rule
from sonolube.checks import Floats
from sonolube.figure import COLOURS, MARKERS, subplots
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.scores import PROBABILITIES
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from sonolube.prediction.calibration import Calibration
    from sonolube.rig.datasets import LabelledArrays

_OPACITIES: Final = (0.15, 0.25, 0.4)  # of the bands, the widest first
_HIGHEST: Final = 1.15  # ratio on the axis, where no own run lies above
_MATCH: Final = 0.05  # relative difference of a condition below which a run is drawn as measured
_MOVED_LABEL: Final = "own runs, moved to the operating point by the prediction"
_AXES: Final = (
    ("amplitude", "vibration_amplitude", 1e6, "Vibration amplitude", "µm", "sliding_speed"),
    ("speed", "sliding_speed", 1e3, "Sliding speed", "mm/s", "vibration_amplitude"),
)
_UNITS: Final = {"vibration_amplitude": "m", "sliding_speed": "m/s"}


def prediction_chart(prediction: "xr.Dataset | LabelledArrays") -> Chart:
    """Friction ratio of a rig over amplitude and over speed with its intervals, and measured ratios.

    Parameters
    ----------
    prediction : xarray.Dataset or LabelledArrays
        By `predict`.

    Returns
    -------
    Chart
        Published tests lie at conditions of their own. Own runs whose other condition is not that of the operating
        point are moved there by the difference of the predicted medians, and are hollow.
    """
    highest = _highest(prediction)
    panels = []
    for name, condition, scale, label, unit, other in _AXES:
        places = scale * prediction[f"curve_{name}"].to_numpy()
        own = _own_runs(prediction, name, condition, scale, other)
        parts = (
            *ratio_bands(places, prediction[f"friction_ratio_over_{name}"].to_numpy()),
            _published(condition, scale, (places[0], places[-1])),
            *own,
            Rule(value=scale * float(prediction.attrs[condition]), label="operating point"),
        )
        reach = np.concatenate([places, *(each.x for each in own)])
        x = Axis(label=label, unit=unit, logarithmic=True, lowest=float(reach.min()), highest=float(reach.max()))
        y = Axis(label="Friction ratio", lowest=-0.05, highest=highest)
        panels.append(Panel(x=x, y=y, parts=parts))
    return Chart(panels=tuple(panels), size=(6.85, 3.3), columns=2, legend="top", shares_y=True)


def _highest(prediction: "xr.Dataset | LabelledArrays") -> float:
    """Upper end of the axis of ratios, above every own run."""
    if "run" not in prediction.sizes:
        return _HIGHEST
    uncertainty = prediction["measured_uncertainty"].to_numpy()
    names = ("measured_friction_ratio", "measured_ratio_moved_over_amplitude", "measured_ratio_moved_over_speed")
    return max(_HIGHEST, *(0.05 + float((prediction[name].to_numpy() + uncertainty).max()) for name in names))


def ratio_bands(places: Floats, quantiles: Floats) -> tuple[Part, ...]:
    """Central intervals and median along one axis; `quantiles` has shape (7, n)."""
    bands = [
        Band(
            x=places, low=quantiles[row], high=quantiles[-1 - row], label=f"{100 * chance:.0f} % interval", opacity=dark
        )
        for row, (chance, dark) in enumerate(zip(PROBABILITIES[::-1], _OPACITIES, strict=True))
    ]
    return (*bands, Line(x=places, y=quantiles[len(PROBABILITIES)], label="median"))


def _published(condition: str, scale: float, ends: tuple[float, float]) -> Points:
    """Published tests between the ends of the axis, each at conditions of its own."""
    rows = []
    for rig in published_rigs():
        at = {name: getattr(rig.at.conditions, name) for name in _UNITS}
        places = scale * at[condition]
        for test, (place, ratio) in enumerate(zip(places, rig.friction_ratio, strict=True)):
            if ends[0] <= place <= ends[1]:
                rows.append((place, ratio, f"{rig.name}-{test + 1}: {_conditions(at, test)}"))
    x, y, sources = zip(*rows, strict=True) if rows else ((), (), ())
    return Points(
        x=np.array(x),
        y=np.array(y),
        label="published tests, each on its own rig",
        colour="0.45",
        size=0.8,
        sources=tuple(sources),
        is_hollow=True,
    )


def _conditions(at: Mapping[str, Floats], test: int) -> str:
    """Amplitude and speed of a test as text."""
    return ", ".join(format_si(float(values[test]), _UNITS[name]) for name, values in at.items())


def _own_runs(
    prediction: "xr.Dataset | LabelledArrays", name: str, condition: str, scale: float, other: str
) -> tuple[Points, ...]:
    """Own runs: those at the other condition of the operating point, and those moved there."""
    if "run" not in prediction.sizes:
        return ()
    point = float(prediction.attrs[other])
    values = prediction[f"measured_{other}"].to_numpy()
    matching = np.abs(values / point - 1) < _MATCH
    measured = prediction["measured_friction_ratio"].to_numpy()
    moved = prediction[f"measured_ratio_moved_over_{name}"].to_numpy()
    at = {each: prediction[f"measured_{each}"].to_numpy() for each in _UNITS}
    found = []
    for runs, ratio, label in (
        (np.flatnonzero(matching), measured, "own runs"),
        (np.flatnonzero(~matching), moved, _MOVED_LABEL),
    ):
        points = Points(
            x=scale * at[condition][runs],
            y=ratio[runs],
            y_error=prediction["measured_uncertainty"].to_numpy()[runs],
            label=label,
            colour=1,
            marker=1,
            sources=tuple(f"run {run + 1}: {measured[run]:.3g} at {_conditions(at, int(run))}" for run in runs),
            is_hollow=label == _MOVED_LABEL,
        )
        found += [points] if runs.size else []
    return tuple(found)


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
    coverage.set(xlabel="Probability of the interval", ylabel="Share of tests within", xlim=(0.4, 1.02), ylim=(0, 1.05))
    heights = np.arange(len(calibrations))[::-1]
    for offset, field, text in ((0.18, "crps", "CRPS"), (-0.18, "interval_score", "interval score, 80 %")):
        values = [getattr(one, field) for one in calibrations]
        colour = COLOURS[0] if field == "crps" else COLOURS[4]
        scores.barh(heights + offset, values, height=0.34, color=colour, label=text)
        for height, value in zip(heights + offset, values, strict=True):
            scores.annotate(
                f"{value:.3f}", (value, height), (3, 0), textcoords="offset points", va="center", fontsize=7
            )
    scores.set(yticks=heights, xlabel="Score (lower is better)", xlim=(0, 1.6))
    scores.set_yticklabels(
        [
            one.name.replace(" with ", "\nwith ").replace(" by ", "\nby ").replace(", its", ",\nits")
            for one in calibrations
        ]
    )
    scores.legend(loc="lower right")
    figure.legend(*coverage.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure
