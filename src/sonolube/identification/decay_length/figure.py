"""Figure and dataset of a decision about the decay length: readings over the distance with the fitted courses."""

from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import COLOURS, LINES, MARKERS
from sonolube.identification.decay_length.decision import DecayLengthDecision
from sonolube.identification.decay_length.run_model import zero_free_ratio
from sonolube.identification.decay_length.switch_table import SwitchTable
from sonolube.identification.decay_length.verdict import HYPOTHESES
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LABELS: Final = {
    "friction_ratio": "Friction ratio",
    "force_zero": "Zero of the force [N]",
    "stack_current": "Stack current [A]",
    "small_drive_shift": "Shift at\nsmall drive [Hz]",
    "large_drive_shift": "Shift at\nlarge drive [Hz]",
}
_READINGS: Final = tuple(_LABELS)


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
            long_name = f"{quantity(name).meaning}, fitted: {HYPOTHESES[hypothesis].partition(':')[0]}"
            data[f"{name}_by_{hypothesis}"] = (axis, values, _attributes(name) | {"long_name": long_name})
    names = list(decision.probabilities)
    probability = np.array([decision.probabilities[name] for name in names])
    return xr.Dataset(
        {**data, "probability": ("hypothesis", probability, {"units": "1", "long_name": "Posterior probability"})},
        coords={axis: (axis, table.sliding_distance, _attributes(axis)), "hypothesis": names},
        attrs={"title": table.title, "verdict": decision.verdict, "advice": decision.advice},
    )


def decision_figure(table: SwitchTable, decision: DecayLengthDecision) -> "Figure":
    """Friction ratio, zero, current and shifts over the sliding distance, each with the courses of the hypotheses.

    Parameters
    ----------
    table : SwitchTable
    decision : DecayLengthDecision

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    measured = {name: values for name, values in _measured(table).items() if np.isfinite(values).any()}
    figure = Figure(figsize=(5.4, 1.25 * len(measured) + 1.0))
    panels = figure.subplots(len(measured), 1, sharex=True, squeeze=False)[:, 0]
    s = table.sliding_distance
    for axes, (name, values) in zip(panels, measured.items(), strict=True):
        axes.plot(
            s,
            values,
            MARKERS[0],
            color="0.35",
            markersize=3,
            label="read, zero subtracted" if axes is panels[0] else None,
        )
        if name == "friction_ratio":
            raw = table.friction_force / table.intrinsic_friction_force
            axes.plot(s, raw, "x", color="0.6", markersize=3, label="zero not subtracted")
        _draw_courses(axes, s, name, decision)
        axes.set_ylabel(_LABELS[name])
        if name != "friction_ratio":
            _limits_with_zero(axes, name)
    panels[-1].set_xlabel("Sliding distance [m]")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure


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


def _draw_courses(axes: "Axes", s: Floats, name: str, decision: DecayLengthDecision) -> None:
    """Draw the fitted course of each hypothesis, or the smoothed zero."""
    if name == "force_zero":
        axes.plot(s[decision.zero.rows], decision.zero.force_zero, color=COLOURS[3])
        return
    for index, (hypothesis, courses) in enumerate(decision.courses.items()):
        if name in courses:
            label = HYPOTHESES[hypothesis].partition(":")[0]
            axes.plot(s, courses[name], linestyle=LINES[index], color=COLOURS[index], label=label)


def _limits_with_zero(axes: "Axes", name: str) -> None:
    """Have an axis begin at nothing, or about it for the zero, lest noise look like a course."""
    low, high = axes.get_ylim()
    if name == "force_zero":
        reach = 1.1 * max(abs(low), abs(high))
        axes.set_ylim(-reach, reach)
    elif low > 0:
        axes.set_ylim(0, 1.05 * high)
