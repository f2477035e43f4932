"""Figure of a plan: information of all candidates over speed and amplitude, and the prediction at the points."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.design.test_plan.plan import TestPlan
from sonolube.figure import COLOURS, MARKERS, subplots
from sonolube.units import format_si

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def plan_figure(plan: TestPlan) -> "Figure":
    """Draw candidates over speed and amplitude, coloured by information, and the prediction at the points of the plan.

    Parameters
    ----------
    plan : TestPlan

    Returns
    -------
    Figure
    """
    figure, (places, ratios) = subplots(1, 2, figsize=(7.4, 3.7), width_ratios=(1.25, 1))
    _draw_candidates(figure, places, plan)
    _draw_ratios(ratios, plan)
    return figure


def _draw_candidates(figure: "Figure", axes: "Axes", plan: TestPlan) -> None:
    """Candidates, coloured by information, the greatest over the loads; those of the plan with their numbers."""
    at = plan.candidates
    speed, amplitude = 1e3 * at.sliding_speed, 1e6 * at.vibration_amplitude
    refused = np.array([bool(reason) for reason in at.refused])
    order = np.argsort(plan.information)
    order = order[~refused[order]]
    drawn = axes.scatter(
        speed[order], amplitude[order], c=plan.information[order], s=70, cmap="viridis", vmin=0, zorder=2
    )
    if refused.any():
        axes.plot(speed[refused], amplitude[refused], "x", color="0.5", ms=6, label="exceeds a limit", zorder=1)
    points = list(plan.batch.points)
    axes.plot(
        speed[points], amplitude[points], "o", mfc="none", mec=COLOURS[1], mew=1.6, ms=12, label="point of the plan"
    )
    for place in sorted(set(zip(speed[points], amplitude[points], strict=True))):
        numbers = [str(n) for n, p in enumerate(points, 1) if (speed[p], amplitude[p]) == place]
        axes.annotate(", ".join(numbers), place, (8, 6), textcoords="offset points", fontweight="bold", zorder=4)
    ticks = _ticks(np.unique(speed))
    axes.set(xscale="log", xlabel="sliding speed (mm/s)", ylabel="vibration amplitude (µm)")
    axes.set_xticks(ticks, [f"{tick:.3g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.margins(0.1, 0.12)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    figure.colorbar(drawn, ax=axes, label="expected information (bit)")


def _ticks(values: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> list[float]:
    """At most seven of the values."""
    chosen = np.unique(np.linspace(0, values.size - 1, min(values.size, 7)).round().astype(int))
    return [float(each) for each in values[chosen]]


def _draw_ratios(axes: "Axes", plan: TestPlan) -> None:
    """Predicted friction ratio at each point with its interval, the closures apart, and the difference to be shown."""
    points = list(plan.batch.points)
    numbers = np.arange(1, len(points) + 1)
    low, high = plan.interval[:, points]
    middle = plan.median[points]
    axes.errorbar(numbers, middle, [middle - low, high - middle], fmt="_", color="0.25", ms=9, label="prediction, 80 %")
    for index, (name, medians) in enumerate(plan.closure_medians.items()):
        offset = 0.14 * (2 * index - len(plan.closure_medians) + 1)
        label = name.replace("_", " ")
        axes.plot(numbers + offset, medians[points], MARKERS[index], color=COLOURS[index], ms=4, label=label)
    axes.axhline(1 - plan.question.difference, color="0.4", lw=0.8, ls=":", label="difference to be shown")
    axes.set(xlabel="point of the plan", ylabel="friction ratio", ylim=(-0.03, 1.08), xlim=(0.5, len(points) + 0.5))
    labels = [f"{number}\n{_condition(plan, point)}" for number, point in enumerate(points, 1)]
    axes.set_xticks(numbers, labels if len(points) <= 4 else [str(number) for number in numbers], fontsize=7)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, fontsize=7)


def _condition(plan: TestPlan, point: int) -> str:
    """Speed and amplitude of a point, and its load where it varies."""
    at = plan.candidates
    load = f"\n{format_si(at.normal_load[point], 'N')}" if np.unique(at.normal_load).size > 1 else ""
    return f"{1e3 * at.sliding_speed[point]:.3g} mm/s\n{1e6 * at.vibration_amplitude[point]:.3g} µm{load}"
