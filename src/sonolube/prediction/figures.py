"""Figures: a prediction over amplitude and speed, published tests predicted unseen, calibration, worth of own runs."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.charts import Axis, Band, Chart, Line, Panel, Part, Points, Rule, draw_chart
from sonolube.checks import Floats
from sonolube.figure import COLOURS, MARKERS, ReportFigure, subplots
from sonolube.prediction.calibration import (
    Calibration,
    blind_calibration,
    calibrations,
    mean_ratio_calibration,
    plane_calibration,
)
from sonolube.prediction.evidence import Conditions, TestedRig, published_rigs
from sonolube.prediction.hierarchy import LEVELS, PROBABILITIES, central_interval
from sonolube.prediction.posterior import Posterior, published_population
from sonolube.prediction.predictive import ratio_draws
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

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
    within_plane = "tested" in prediction.attrs  # where no published test states amplitude and speed
    panels = []
    for name, condition, scale, label, unit, other in _AXES:
        places = scale * prediction[f"curve_{name}"].to_numpy()
        own = _own_runs(prediction, name, condition, scale, other)
        parts = (
            *ratio_bands(places, prediction[f"friction_ratio_over_{name}"].to_numpy()),
            *(() if within_plane else (_published(condition, scale, (places[0], places[-1])),)),
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


def calibration_figure(calibrations: tuple[Calibration, ...]) -> "Figure":
    """Draw coverage against probability, and the scores of each way to predict.

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
        coverage.plot(places, shares, ls="", marker=MARKERS[index], color=COLOURS[index], ms=5, label=one.name)
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


_PANELS: Final = (
    ("A", "sliding_speed", 1e3, "Sliding speed", "mm/s", "Table 2.3: steel on aluminium, 2.5 µm"),
    ("B", "vibration_amplitude", 1e6, "Vibration amplitude", "µm", "Table 4.2: steel on steel, 65.5 mm/s"),
)
_POINTS: Final = 40
_DRAWS: Final = 2000
_MAX_SUBSETS: Final = 6  # of own runs for each predicted test


def published_prediction_figures() -> Iterator[ReportFigure]:
    """Figures of the prediction of published tests."""
    yield ReportFigure(
        name="prediction-blind",
        title="Every published test predicted from the other rigs, with nothing that a user would not have",
        caption=blind_caption(),
        draw=blind_figure,
    )
    yield ReportFigure(
        name="prediction-of-published-tests",
        title="Friction ratio predicted before any test on the rig",
        caption="Bands: 50, 80 and 95 % predictive intervals, learned from the tests on all other rigs. Points: Tables"
        " 2.3 and 4.2 with their printed scatter.",
        draw=lambda: draw_chart(unseen_chart()),
    )
    yield ReportFigure(
        name="prediction-calibration",
        title="Calibration of predictions on rigs left out",
        caption="Left: share of the published tests, 20 or the 17 with records, within the predictive intervals; tests"
        " of one rig are not independent. Right: mean scores; lower is better. Ways by records use a roughness that no"
        " user has before a test.",
        draw=lambda: calibration_figure(calibrations()),
    )
    yield ReportFigure(
        name="prediction-width-over-runs",
        title="What own runs are worth",
        caption="Median width of the 80 % interval of a published test when other tests of its rig are known, and"
        " the share of tests within; subsets of one rig's tests are not independent of each other.",
        draw=runs_figure,
    )


def blind_caption() -> str:
    """Headline of the blind protocol: coverage, score and width beside those of the mean ratio."""
    blind, mean = blind_calibration(), mean_ratio_calibration()
    inside = [blind.covered(probability) for probability in PROBABILITIES]
    gain, low, high = blind.gain_over(mean)
    verdict = "" if low > 0 else ": not shown to be better than the mean of published tests"
    by_rig = blind.covered_by_rig(0.8)
    open_rigs = [f"{name} ({within} of {count})" for name, (within, count) in by_rig.items() if within < count]
    others = (
        f", of all {len(by_rig)} rigs"
        if not open_rigs
        else f"; all of each rig within 80 % but of {', '.join(open_rigs)}"
    )
    return (
        f"{inside[0]}, {inside[1]} and {inside[2]} of {len(blind.predictions)} tests lie within the 50, 80 and 95 %"
        f" intervals{others}. Tests of one rig are not independent. CRPS {blind.crps:.3f}, that of the mean ratio"
        f" {mean.crps:.3f}; difference {gain:.3f}, {low:.3f} to {high:.3f} (95 %, bootstrap over sets){verdict}. Median"
        f" width of the 80 % interval {blind.median_width:.2f} (mean ratio {mean.median_width:.2f}). The form of the"
        " model was chosen after the errors were known."
    )


def plane_caption() -> str:
    """Headline of the blind protocol within the plane of contact: how far it was tested, and what the points say."""
    found = plane_calibration()
    count, inside = len(found.predictions), [found.covered(probability) for probability in PROBABILITIES]
    return (
        f"Within the plane of contact it was tested with {count} published points along the sliding, and across, at an"
        f" angle, of a ring and of an ellipse with none. {inside[0]}, {inside[1]} and {inside[2]} of {count} lie within"
        f" the 50, 80 and 95 % intervals of what the other rigs predict, which judges no coverage. Mean CRPS of the"
        f" {found.rigs} rigs {found.crps_by_rig:.3f}, median width of the 80 % interval {found.median_width:.2f}. The"
        " form of the law was chosen after the points were known."
    )


def blind_figure() -> "Figure":
    """Draw every published test with its prediction from the other rigs, the decay length unknown."""
    predictions, mean = blind_calibration().predictions, mean_ratio_calibration().predictions
    places = np.arange(len(predictions))
    quantiles = np.quantile(np.stack([one.draws for one in predictions], axis=1), LEVELS, axis=0)
    figure, axes = subplots(figsize=(6.85, 3.2))
    for row, opacity in enumerate((0.15, 0.25, 0.4)):
        low, high, probability = quantiles[row], quantiles[-1 - row], PROBABILITIES[::-1][row]
        label = f"{100 * probability:.0f} % interval"
        axes.bar(places, high - low, bottom=low, width=0.62, color=COLOURS[0], alpha=opacity, lw=0, label=label)
    axes.hlines(quantiles[len(PROBABILITIES)], places - 0.31, places + 0.31, color=COLOURS[0], label="median")
    ends = np.array([central_interval(one.draws, 0.8) for one in mean]).T
    axes.vlines(places + 0.4, *ends, color="0.45", lw=1.2, label="mean ratio of other tests, 80 %")
    ratios, errors = np.array([(one.friction_ratio, one.uncertainty) for one in predictions]).T
    axes.errorbar(places, ratios, errors, fmt="o", color=COLOURS[1], ms=5, capsize=2, label="measured")
    names = [one.rig for one in predictions]
    labels = [f"{name}-{names[: place + 1].count(name)}" for place, name in enumerate(names)]
    axes.set(xticks=places, xticklabels=labels, ylabel="Friction ratio", xlabel="Published test", ylim=(-0.1, 1.45))
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def unseen_chart() -> Chart:
    """Tables 2.3 and 4.2 with the prediction from the other rigs."""
    panels = []
    for name, condition, scale, label, unit, title in _PANELS:
        rig, posterior = _rig_with_others(name)
        places = getattr(rig.at.conditions, condition)
        curve = np.geomspace(0.6 * places.min(), 1.5 * places.max(), _POINTS)
        at = replace(rig.at, conditions=_along(rig.at.conditions, condition, curve))
        bands = ratio_bands(scale * curve, np.quantile(ratio_draws(posterior, at, count=_DRAWS), LEVELS, axis=0))
        measured = Points(x=scale * places, y=rig.friction_ratio, y_error=rig.uncertainty, label="measured", colour=1)
        x = Axis(label=label, unit=unit, lowest=scale * float(curve[0]), highest=scale * float(curve[-1]))
        y = Axis(label="Friction ratio", lowest=-0.05, highest=1.1)
        panels.append(Panel(x=x, y=y, parts=(*bands, measured), title=title))
    return Chart(panels=tuple(panels), size=(6.85, 3.3), columns=2, legend="top", legend_columns=5, shares_y=True)


def runs_figure() -> "Figure":
    """Figure of the width of the interval of a test, and of the coverage, over the number of other tests of its rig."""
    counts, widths, shares = zip(*_widths_by_runs(), strict=True)
    figure, (left, right) = subplots(1, 2, figsize=(6.85, 2.9))
    left.plot(counts, widths, MARKERS[0] + "-", color=COLOURS[0])
    left.set(xlabel="Own runs known", ylabel="Median width of the 80 % interval", ylim=(0, None), xticks=counts)
    right.plot(counts, shares, MARKERS[1] + "-", color=COLOURS[1])
    right.axhline(0.8, color="0.4", lw=0.8, ls=":")
    right.set(xlabel="Own runs known", ylabel="Share of tests within", ylim=(0, 1.05), xticks=counts)
    return figure


def _widths_by_runs() -> list[tuple[int, float, float]]:
    """Number of own runs, median width and coverage of the 80 % interval, over rigs with so many tests."""
    found: dict[int, list[tuple[float, bool]]] = {}
    for rig in published_rigs():
        _, posterior = _rig_with_others(rig.name)
        tests = range(rig.friction_ratio.size)
        for test in tests:
            others = [each for each in tests if each != test]
            for count in range(len(others) + 1):
                for known in list(combinations(others, count))[:_MAX_SUBSETS]:
                    found.setdefault(count, []).append(_width(rig, posterior, test, known))
    return [
        (count, float(np.median([width for width, _ in rows])), float(np.mean([inside for _, inside in rows])))
        for count, rows in sorted(found.items())
    ]


def _width(rig: TestedRig, posterior: Posterior, test: int, known: tuple[int, ...]) -> tuple[float, bool]:
    """Width of the 80 % interval of one test by some others of its rig, and whether the measured ratio is within."""
    own = _some(rig, known) if known else None
    ratios = ratio_draws(posterior, _some(rig, (test,)).at, count=_DRAWS, own=own)[:, 0]
    noise = rig.uncertainty[test] * np.random.default_rng(4).standard_normal(ratios.size)
    low, high = central_interval(ratios + noise, 0.8)
    return float(high - low), bool(low <= rig.friction_ratio[test] <= high)


def _some(rig: TestedRig, tests: tuple[int, ...]) -> TestedRig:
    """Rig with some of its tests."""
    rows = np.array(tests)
    return replace(
        rig,
        at=replace(rig.at, conditions=rig.at.conditions.taken(rows)),
        friction_ratio=rig.friction_ratio[rows],
        uncertainty=rig.uncertainty[rows],
    )


def _rig_with_others(name: str) -> tuple[TestedRig, Posterior]:
    """A published rig, and the posterior by all others."""
    rigs = published_rigs()
    place = [rig.name for rig in rigs].index(name)
    return rigs[place], published_population().posterior(without=(place,))


def _along(at: Conditions, condition: str, values: Floats) -> Conditions:
    """First of some conditions, with one of its quantities varied."""
    return replace(at.taken(np.zeros(values.size, dtype=np.int64)), **{condition: values})
