"""Figure and dataset of a decision about the decay length: readings over the distance with the fitted courses."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Points
from sonolube.checks import Floats
from sonolube.identification.decay_length.decision import DecayLengthDecision
from sonolube.identification.decay_length.posterior import HYPOTHESES
from sonolube.identification.decay_length.run_model import zero_free_ratio
from sonolube.identification.decay_length.switch_table import SwitchTable
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_AXES: Final = {
    "friction_ratio": Axis(label="Friction ratio"),
    "force_zero": Axis(label="Zero of the force", unit="N"),
    "stack_current": Axis(label="Stack current", unit="A"),
    "small_drive_shift": Axis(label="Shift at small drive", unit="Hz"),
    "large_drive_shift": Axis(label="Shift at large drive", unit="Hz"),
}
_READINGS: Final = tuple(_AXES)


def decision_dataset(table: SwitchTable, decision: DecayLengthDecision) -> "xr.Dataset":
    """Readings at the switches with their fitted courses, and the probabilities of the hypotheses.

    Parameters
    ----------
    table : SwitchTable
    decision : DecayLengthDecision

    Returns
    -------
    xarray.Dataset
        Readings over `sliding_distance`; `probability` over `hypothesis`; fitted courses, such as
        `friction_ratio_by_long_sliding`, over the distance; the verdict among the attributes.
    """
    import xarray as xr

    axis = "sliding_distance"
    data: dict[str, tuple[str, Floats, dict[str, str]]] = {}
    for name, values in _measured(table).items():
        data[name] = (axis, values, _attributes(name))
    for hypothesis, courses in decision.courses.items():
        for name, values in courses.items():
            long_name = f"{quantity(name).meaning}, fitted: {HYPOTHESES[hypothesis].title}"
            data[f"{name}_by_{hypothesis}"] = (axis, values, _attributes(name) | {"long_name": long_name})
    names = list(decision.probabilities)
    probability = np.array([decision.probabilities[name] for name in names])
    return xr.Dataset(
        {**data, "probability": ("hypothesis", probability, {"units": "1", "long_name": "Posterior probability"})},
        coords={axis: (axis, table.sliding_distance, _attributes(axis)), "hypothesis": names},
        attrs={"title": table.title, "verdict": decision.verdict, "advice": decision.advice},
    )


def decision_chart(table: SwitchTable, decision: DecayLengthDecision) -> Chart:
    """Friction ratio, zero, current and shifts over the sliding distance, each with the courses of the hypotheses.

    Parameters
    ----------
    table : SwitchTable
    decision : DecayLengthDecision

    Returns
    -------
    Chart
    """
    measured = {name: values for name, values in _measured(table).items() if np.isfinite(values).any()}
    x = Axis(label="Sliding distance", unit="m")
    panels = tuple(
        Panel(x=x, y=_axis(name, values), parts=(*_readings(table, name, values), *_courses(table, name, decision)))
        for name, values in measured.items()
    )
    size = (5.4, 1.25 * len(measured) + 1.0)
    return Chart(panels=panels, size=size, legend="bottom", legend_columns=2, shares_x=True)


def _measured(table: SwitchTable) -> dict[str, Floats]:
    """Readings that are drawn, by name."""
    values = {"friction_ratio": zero_free_ratio(table)[0]}
    for name in _READINGS[1:]:
        reading = getattr(table, name)
        if reading is not None:
            values[name] = reading
    return values


def _attributes(name: str) -> dict[str, str]:
    """Attributes of a variable by the vocabulary."""
    known = quantity(name)
    return {"units": known.unit or "1", "long_name": known.meaning}


def _readings(table: SwitchTable, name: str, values: Floats) -> tuple[Points, ...]:
    """Readings at the switches; of the friction ratio also as read."""
    s = table.sliding_distance
    switches = tuple(f"{table.title}, switch {number}" for number in range(1, s.size + 1))
    read = Points(x=s, y=values, label="read, zero subtracted", colour="0.35", size=0.9, sources=switches)
    if name != "friction_ratio":
        return (read,)
    raw = table.friction_force / table.intrinsic_friction_force
    style: dict[str, Any] = {"colour": "0.6", "size": 0.9, "is_hollow": True}
    return Points(x=s, y=raw, label="zero not subtracted", sources=switches, **style), read


def _courses(table: SwitchTable, name: str, decision: DecayLengthDecision) -> list[Line]:
    """Fitted course of each hypothesis, or the smoothed zero."""
    s = table.sliding_distance
    if name == "force_zero":
        return [Line(x=s[decision.zero.rows], y=decision.zero.force_zero, colour=3)]
    return [
        Line(x=s, y=courses[name], label=HYPOTHESES[hypothesis].title, colour=place, dash=place)
        for place, (hypothesis, courses) in enumerate(decision.courses.items())
        if name in courses
    ]


def _axis(name: str, values: Floats) -> Axis:
    """Axis that begins at nothing, or is about it for the zero, lest noise look like a course."""
    if name == "force_zero":
        reach = 1.2 * float(np.nanmax(np.abs(values)))
        return replace(_AXES[name], lowest=-reach, highest=reach)
    begins = name != "friction_ratio" and float(np.nanmin(values)) > 0
    return replace(_AXES[name], lowest=0.0) if begins else _AXES[name]
