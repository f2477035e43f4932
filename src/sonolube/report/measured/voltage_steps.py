"""Sheet of the steps of a voltage: friction, its reduction and stick-slip at each, and the rotation found in them."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sonolube.measurement.friction.voltage_steps import VoltageStep
from sonolube.measurement.friction_analysis import analyse_rotation_speed, analyse_voltage_steps, channel_values
from sonolube.measurement.recorded_sliding import speed_changes, speed_channel
from sonolube.report.measured import friction_figures as figures, sheet
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_STEP_LABELS = {
    "voltage_peak_to_peak": "Voltage",
    "sliding_speed": "Speed",
    "start_time": "From",
    "end_time": "To",
    "friction_force": "Friction",
    "friction_force_deviation": "Deviation",
    "friction_force_uncertainty": "Standard error",
    "friction_reduction": "Reduction",
    "friction_reduction_uncertainty": "Uncertainty",
}
_VOLTAGE = {"voltage_peak_to_peak": "Voltage"}
_SPEEDS = ("relative_velocity", "sliding_speed", "sliding_speed_set")  # in m/s
_SLIP_COLUMNS = (
    *sheet.quantity_columns(_VOLTAGE),
    sheet.Column("detected", "Stick-slip"),
    sheet.Column("force_drops", "Slips"),
    *sheet.quantity_columns({"stick_slip_amplitude": "Fall"}),
    sheet.Column("stick_slip_amplitude_lower", "95 % from", "N"),
    sheet.Column("stick_slip_amplitude_upper", "to", "N"),
    *sheet.quantity_columns({"stick_slip_frequency": "Frequency"}),
    sheet.Column("stick_slip_period", "Period", "s"),
    *sheet.quantity_columns({"stick_slip_fraction": "Share of the time"}),
)
_BURST_COLUMNS = (
    *sheet.quantity_columns({**_VOLTAGE, "start_time": "From", "end_time": "To"}),
    sheet.Column("force_drops", "Slips"),
)


def step_sheet(recording: "xr.Dataset", *, rotation_speed: float | None) -> sheet.Sheet:
    """Friction, its reduction and stick-slip at each step of the voltage of a recording."""
    found = analyse_rotation_speed(recording) if rotation_speed is None else None
    speed = found if rotation_speed is None else rotation_speed
    steps = analyse_voltage_steps(recording, rotation_speed=speed)
    has_speed = speed_channel(recording) in _SPEEDS and speed_changes(recording)
    labels = {name: label for name, label in _STEP_LABELS.items() if has_speed or name != "sliding_speed"}
    table = sheet.Table(
        name="steps",
        title="Friction at each step of the voltage",
        columns=sheet.quantity_columns(labels),
        rows=tuple(tuple(getattr(step, name) for name in labels) for step in steps),
    )
    rotation: tuple[sheet.Value, ...] = ()
    if found is not None:
        rotation = (sheet.quantity_value("rotation_speed", found, label="Rotational speed, found by the wobble"),)
    force = channel_values(recording, "time"), channel_values(recording, "friction_force")
    sticking = [step for step in steps if step.stick_slip.detected]
    values = (*rotation, sheet.Value("stick_slip_steps", "Steps with stick-slip", float(len(sticking)), ""))
    pictures = [figures.voltage_steps_figure(steps)]
    if sticking:
        pictures.append(figures.stick_slip_figure(*force, steps))
    tables = [table, _slips(steps), *([_bursts(sticking)] if sticking else [])]
    first = next((step for step in steps if not step.stick_slip.resolved), steps[0])
    at = "the first" if first is steps[0] else format_si(first.voltage_peak_to_peak, "V")
    reason = f"stick-slip: at none of {len(steps)} steps; at {at}, {first.stick_slip.reason}"
    return sheet.Sheet(
        values=values,
        tables=tuple(tables),
        figures=tuple(pictures),
        caveats=(*_zero_taken_off(steps[0]), *(() if speed is not None else (_unknown_rotation(steps),))),
        not_found=() if sticking else (reason,),
    )


def _zero_taken_off(step: VoltageStep) -> tuple[str, ...]:
    """Caveat that the force at rest was taken for its zero."""
    if not step.force_zero:
        return ()
    return (f"{format_si(step.force_zero, 'N')}, the mean force at rest before sliding, is taken off as its zero",)


def _unknown_rotation(steps: Sequence[VoltageStep]) -> str:
    """Caveat that no wobble was taken off."""
    duration = format_si(steps[-1].end_time - steps[0].start_time, "s")
    return (
        f"no rotation was found in the friction over {duration}, and no wobble taken off: give the rotational speed "
        "if the disc turns fewer than twice in that time"
    )


def _slips(steps: Sequence[VoltageStep]) -> sheet.Table:
    """Stick-slip at each step: whether, slips, fall with its interval, frequency, period, and share of the time."""
    rows: list[tuple[sheet.Cell, ...]] = []
    for step in steps:
        found = step.stick_slip
        if not found.detected:
            seen = "no" if found.resolved else "cannot be seen"
            rows.append((step.voltage_peak_to_peak, seen, *[None] * (len(_SLIP_COLUMNS) - 2)))
            continue
        fall = found.stick_slip_amplitude, *found.stick_slip_amplitude_interval
        recurrence = found.stick_slip_frequency, 1 / found.stick_slip_frequency, found.stick_slip_fraction
        rows.append((step.voltage_peak_to_peak, "yes", float(found.force_drops), *fall, *recurrence))
    title = "Stick-slip at each step of the voltage"
    return sheet.Table(name="stick_slip", title=title, columns=_SLIP_COLUMNS, rows=tuple(rows))


def _bursts(steps: Sequence[VoltageStep]) -> sheet.Table:
    """When slips recur, one row a burst."""
    rows = tuple(
        (step.voltage_peak_to_peak, burst.start_time, burst.end_time, float(burst.force_drops))
        for step in steps
        for burst in step.stick_slip.bursts
    )
    return sheet.Table(name="stick_slip_bursts", title="Bursts of stick-slip", columns=_BURST_COLUMNS, rows=rows)
