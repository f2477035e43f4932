"""Figure of a plan: information of all candidates over speed and amplitude, and the prediction at the points."""

import numpy as np

from sonolube.charts import Axis, Chart, Panel, Part, Points, Rule
from sonolube.checks import Floats
from sonolube.design.test_plan.plan import TestPlan
from sonolube.text.units import format_si

_MAX_DESCRIBED = 4  # points whose conditions are written below the axis


def plan_chart(plan: TestPlan) -> Chart:
    """Candidates over speed and amplitude, coloured by information, and the prediction at the points of a plan."""
    panels = (_candidates(plan), _ratios(plan))
    return Chart(panels=panels, size=(7.4, 3.7), columns=2, widths=(1.25, 1.0), legend="top", legend_columns=3)


def _candidates(plan: TestPlan) -> Panel:
    """Candidates, coloured by information, the greatest over the loads; those of the plan with their numbers."""
    at = plan.candidates
    speed, amplitude = 1e3 * at.sliding_speed, 1e6 * at.vibration_amplitude
    refused = np.array([bool(reason) for reason in at.refused])
    order = np.argsort(plan.information)
    order = order[~refused[order]]
    greatest = float(plan.information[order].max(initial=0.0))
    parts: list[Part] = [
        Points(
            x=speed[order],
            y=amplitude[order],
            size=1.7,
            shades=plan.information[order],
            scale_text="Expected information [bit]",
            scale_ends=(0.0, greatest),
        )
    ]
    if refused.any():
        parts.append(Points(x=speed[refused], y=amplitude[refused], label="exceeds a limit", colour="0.5", marker=6))
    points = list(plan.batch.points)
    places = dict.fromkeys(zip(speed[points], amplitude[points], strict=True))
    numbers = [
        ", ".join(str(n) for n, p in enumerate(points, 1) if (speed[p], amplitude[p]) == place) for place in places
    ]
    x, y = np.array(list(places)).T
    parts.append(Points(x=x, y=y, texts=tuple(numbers), label="point of the plan", colour=1, size=2.3, is_hollow=True))
    ticks = _ticks(np.unique(speed))
    words = tuple(f"{tick:.3g}" for tick in ticks)
    return Panel(
        x=Axis("Sliding speed", "mm/s", logarithmic=True, ticks=ticks, words=words),
        y=Axis("Vibration amplitude", "µm"),
        parts=tuple(parts),
    )


def _ticks(values: Floats) -> tuple[float, ...]:
    """At most seven of the values."""
    chosen = np.unique(np.linspace(0, values.size - 1, min(values.size, 7)).round().astype(int))
    return tuple(float(each) for each in values[chosen])


def _ratios(plan: TestPlan) -> Panel:
    """Predicted friction ratio at each point with its interval, the closures apart, and the difference to be shown."""
    points = list(plan.batch.points)
    numbers = np.arange(1.0, len(points) + 1)
    low, high = plan.interval[:, points]
    middle = plan.median[points]
    error = np.array([middle - low, high - middle])
    parts: list[Part] = [Points(x=numbers, y=middle, y_error=error, label="prediction, 80 %", colour="0.25", size=0.8)]
    for place, (name, medians) in enumerate(plan.closure_medians.items()):
        shifted = numbers + 0.14 * (2 * place - len(plan.closure_medians) + 1)
        label = name.replace("_", " ")
        parts.append(Points(x=shifted, y=medians[points], label=label, colour=place, marker=place, size=1.2))
    parts.append(Rule(value=1 - plan.question.difference, along="y", label="difference to be shown"))
    words = [str(number) for number in range(1, len(points) + 1)]
    if len(points) <= _MAX_DESCRIBED:
        words = [f"{word}\n{_condition(plan, point)}" for word, point in zip(words, points, strict=True)]
    x = Axis(
        "Point of the plan", ticks=tuple(numbers.tolist()), words=tuple(words), lowest=0.5, highest=len(points) + 0.5
    )
    return Panel(x=x, y=Axis("Friction ratio", lowest=-0.03, highest=1.08), parts=tuple(parts))


def _condition(plan: TestPlan, point: int) -> str:
    """Speed and amplitude of a point, and its load where it varies."""
    at = plan.candidates
    load = f"\n{format_si(at.normal_load[point], 'N')}" if np.unique(at.normal_load).size > 1 else ""
    return f"{1e3 * at.sliding_speed[point]:.3g} mm/s\n{1e6 * at.vibration_amplitude[point]:.3g} µm{load}"
