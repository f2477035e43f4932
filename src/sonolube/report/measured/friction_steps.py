"""Charts of friction recordings, and sheets of the steps of a voltage and of tests with and without vibration."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.charts import Axis, Band, Chart, Line, Panel, Part, Points, Rule, Zone, envelope, one_panel
from sonolube.checks import Floats
from sonolube.measurement.friction.rotation import MotorFrictionTrace
from sonolube.measurement.friction.stated_load import StatedLoad
from sonolube.measurement.friction.voltage_steps import VoltageStep
from sonolube.measurement.friction.windows import SteadyStateOnset, WindowStatistics
from sonolube.measurement.friction_analysis import (
    analyse_rotation_speed,
    analyse_rotation_speed_uncertainty,
    analyse_voltage_steps,
    channel_values,
)
from sonolube.measurement.recorded_conditions import speed_changes, speed_channel
from sonolube.measurement.statistics.repeated_tests import compare_means, ratio_interval
from sonolube.report.measured import sheet
from sonolube.report.measured.sheet import captioned
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities, unit_of

if TYPE_CHECKING:
    import xarray as xr

_WIDE = (7.0, 3.2)
_MOST: Final = 20_000  # values of a loop
_FORCE: Final = Axis("Friction force", "N")
_TIME: Final = Axis("Time", "s")
_AXES: Final = {"friction_force": _FORCE, "friction_coefficient": Axis("Coefficient of friction")}


def trace_chart(
    t: Floats | None, signal: Floats | None, *, windows: WindowStatistics, steady: SteadyStateOnset | None
) -> Chart:
    """Samples over time with the means and fluctuations of windows and the begin of the steady state."""
    parts: list[Part] = []
    if t is not None and signal is not None:
        time, samples = envelope(t, signal)
        parts.append(Line(x=time, y=samples, label="samples, lowest to highest", colour="0.8", weight=0.5))
    mean, rms = windows.mean, windows.fluctuation
    parts += [
        Band(x=windows.time, low=mean - rms, high=mean + rms, label="RMS fluctuation", colour=5, opacity=0.6),
        Line(x=windows.time, y=mean, label=f"mean of {windows.window_duration:g} s"),
    ]
    if steady is not None and steady.steady:
        start = windows.time[0] + steady.start_time
        label = f"steady after {steady.sliding_distance:.3g} m"
        parts.append(Rule(value=start, label=label, colour=1, dash=1))
    return one_panel(_TIME, _axis(windows.channel), parts, size=_WIDE, legend="top", legend_columns=4)


@captioned("Trace by cycle", "One value a cycle, as the instrument gives it.")
def by_cycle_figure(cycles: Floats, signal: Floats, name: str) -> Chart:
    """Signal with one value a cycle over the number of the cycle."""
    parts = (Line(x=cycles, y=signal, weight=0.6), Points(x=cycles, y=signal, is_faint=True))
    return one_panel(Axis("Cycle"), _axis(name), parts, size=_WIDE)


@captioned(
    "Friction over voltage",
    "Mean and its standard error at each step, and the reduction of the friction without voltage.",
)
def voltage_steps_figure(steps: Sequence[VoltageStep], channel: str = "friction_force") -> Chart:
    """Friction and its reduction over the voltage."""
    driven = [step for step in steps if step.friction_reduction is not None]
    force = Points(
        x=_voltages(steps),
        y=np.array([step.friction_force for step in steps]),
        y_error=np.array([step.friction_force_uncertainty for step in steps]),
        sources=tuple(map(_source, steps)),
    )
    reduction = Points(
        x=_voltages(driven),
        y=np.array([100 * (step.friction_reduction or 0.0) for step in driven]),
        y_error=np.array([100 * (step.friction_reduction_uncertainty or 0.0) for step in driven]),
        sources=tuple(map(_source, driven)),
        colour=1,
        marker=1,
    )
    axes = ((_AXES[channel].label, _AXES[channel].unit, force), ("Friction reduction", "%", reduction))
    panels = [
        Panel(
            x=Axis("Voltage, peak to peak", "V", lowest=0.0),
            y=Axis(label, unit, lowest=None if (points.y < 0).any() else 0.0),
            parts=(points,),
        )
        for label, unit, points in axes
    ]
    return Chart(panels=tuple(panels), size=_WIDE, columns=2)


@captioned(
    "Stick-slip at the steps of the voltage",
    "Samples in grey with the bursts of stick-slip shaded; mean fall of the force in a slip with its 95 % interval.",
)
def stick_slip_figure(t: Floats, force: Floats, steps: Sequence[VoltageStep]) -> Chart:
    """Friction over time with the bursts of stick-slip, and the fall in a slip over the voltage."""
    found = [step for step in steps if step.stick_slip.detected]
    bursts = [burst for step in found for burst in step.stick_slip.bursts]
    first, last = (np.array([getattr(burst, end) for burst in bursts]) for end in ("start_time", "end_time"))
    time, samples = envelope(t, force)
    left = (Zone(first=first, last=last, colour=1, opacity=0.35), Line(x=time, y=samples, colour="0.6", weight=0.5))
    falls = np.array([1e3 * step.stick_slip.stick_slip_amplitude for step in found])
    ends = np.array([step.stick_slip.stick_slip_amplitude_interval for step in found]).T * 1e3
    points = Points(
        x=_voltages(found),
        y=falls,
        y_error=np.abs(ends - falls),
        sources=tuple(map(_source, found)),
        colour=1,
        marker=1,
    )
    voltage = Axis("Voltage, peak to peak", "V", lowest=0.0, highest=1.05 * float(_voltages(steps).max()))
    fall = Axis("Fall in a slip", "mN", lowest=0.0, highest=1.15 * float(ends.max()))
    panels = (Panel(x=_TIME, y=_FORCE, parts=left), Panel(x=voltage, y=fall, parts=(points,)))
    return Chart(panels=panels, size=_WIDE, columns=2, widths=(2, 1))


@captioned(
    "Friction over velocity", "Every cycle of the recording; the work is the area of the loop over displacement."
)
def loops_figure(velocity: Floats, force: Floats) -> Chart:
    """Friction over velocity."""
    stride = max(1, velocity.size // _MOST)
    zero = (Rule(value=0.0, along="y", colour="0.5", dash=0), Rule(value=0.0, colour="0.5", dash=0))
    parts = (Line(x=velocity[::stride], y=force[::stride], weight=0.6), *zero)
    return one_panel(Axis("Velocity", "m/s"), _FORCE, parts, size=(4.2, 3.4))


@captioned("Friction by the motor current", "Mean in each window with its standard uncertainty.")
def motor_trace_figure(motor: MotorFrictionTrace) -> Chart:
    """Friction by the motor current over time with its uncertainty."""
    force = motor.friction_force
    points = Points(x=motor.time, y=force, y_error=motor.friction_force_uncertainty)
    return one_panel(_TIME, _FORCE, (Line(x=motor.time, y=force), points), size=_WIDE)


@captioned("Tests with and without vibration", "Each test, and the mean of its kind.")
def comparison_figure(
    without: Sequence[tuple[str, float]], with_vibration: Sequence[tuple[str, float]], level: str
) -> Chart:
    """Friction of single tests, by name, without and with vibration, and the mean of each kind."""
    parts: list[Part] = []
    for place, (tests, name) in enumerate([(without, "without"), (with_vibration, "with")]):
        values = np.array([value for _, value in tests])
        spread = np.array([0.04 * (index - (values.size - 1) / 2) for index in range(values.size)])
        parts += [
            Points(
                x=place + spread,
                y=values,
                label=f"{name}: {values.size} tests",
                colour=place,
                marker=place,
                sources=tuple(source for source, _ in tests),
            ),
            Line(x=place + np.array([-0.25, 0.25]), y=np.full(2, values.mean()), colour=place),
        ]
    kind = Axis(lowest=-0.5, highest=1.5, words=("without", "with vibration"))
    highest = max(value for _, value in (*without, *with_vibration))
    known = level in _AXES or level in quantities()
    axis = _axis(level) if known else Axis("Steady friction", "N")
    y = Axis(axis.label, axis.unit, lowest=0.0, highest=1.12 * highest)
    return one_panel(kind, y, parts, size=(3.8, 3.2))


def _axis(name: str) -> Axis:
    """Axis of a channel."""
    if name in _AXES:
        return _AXES[name]
    known = quantities().get(name)
    return Axis(name) if known is None else Axis(known.meaning, known.unit)


def _voltages(steps: Sequence[VoltageStep]) -> Floats:
    """Voltage of each step. [V]"""
    return np.array([step.voltage_peak_to_peak for step in steps])


def _source(step: VoltageStep) -> str:
    """Part of the recording that a step is."""
    return f"{step.start_time:.4g} to {step.end_time:.4g} s"


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


def step_sheet(
    recording: "xr.Dataset",
    *,
    rotation_speed: float | None,
    channel: str = "friction_force",
    load: StatedLoad | None = None,
) -> sheet.Sheet:
    """Friction, its reduction and stick-slip at each step of the voltage of a recording.

    With the coefficient, where the load is stated; of a coefficient as `channel`, which stands in place of the force,
    without stick-slip.
    """
    found = analyse_rotation_speed(recording) if rotation_speed is None else None
    speed = found if rotation_speed is None else rotation_speed
    steps = analyse_voltage_steps(recording, rotation_speed=speed)
    has_speed = speed_channel(recording) in _SPEEDS and speed_changes(recording)
    table = _step_table(steps, channel, load, has_speed=has_speed)
    rotation: tuple[sheet.Value, ...] = ()
    if found is not None:
        error = analyse_rotation_speed_uncertainty(recording, rotation_speed=found)
        label = "Rotational speed, found by the wobble"
        rotation = (sheet.quantity_value("rotation_speed", found, label=label, uncertainty=error),)
    caveats = () if speed is not None else (_unknown_rotation(steps),)
    if channel != "friction_force":
        zero = _zero_taken_off(steps[0], "")
        figure = voltage_steps_figure(steps, channel)
        return sheet.Sheet(values=rotation, tables=(table,), figures=(figure,), caveats=(*zero, *caveats))
    force = channel_values(recording, "time"), channel_values(recording, "friction_force")
    sticking = [step for step in steps if step.stick_slip.detected]
    values = (*rotation, sheet.Value("stick_slip_steps", "Steps with stick-slip", float(len(sticking)), ""))
    pictures = [voltage_steps_figure(steps)]
    if sticking:
        pictures.append(stick_slip_figure(*force, steps))
    tables = [table, _slips(steps), *([_bursts(sticking)] if sticking else [])]
    first = next((step for step in steps if not step.stick_slip.resolved), steps[0])
    at = "the first" if first is steps[0] else format_si(first.voltage_peak_to_peak, "V")
    reason = f"stick-slip: at none of {len(steps)} steps; at {at}, {first.stick_slip.reason}"
    return sheet.Sheet(
        values=values,
        tables=tuple(tables),
        figures=tuple(pictures),
        caveats=(*_zero_taken_off(steps[0], "N"), *caveats),
        not_found=() if sticking else (reason,),
    )


def _step_table(steps: Sequence[VoltageStep], channel: str, load: StatedLoad | None, *, has_speed: bool) -> sheet.Table:
    """Friction and its reduction at each step, with the coefficient where the load is stated."""
    labels = {name: label for name, label in _STEP_LABELS.items() if has_speed or name != "sliding_speed"}
    columns = {name: [getattr(step, name) for step in steps] for name in labels}
    if load is not None:
        both = [load.coefficient(step.friction_force, uncertainty=step.friction_force_uncertainty) for step in steps]
        labels |= {"friction_coefficient": "Coefficient", "friction_coefficient_uncertainty": "Uncertainty"}
        columns["friction_coefficient"] = [coefficient for coefficient, _ in both]
        columns["friction_coefficient_uncertainty"] = [error for _, error in both]
        columns["friction_reduction_uncertainty"] = [load.reduction_uncertainty(step) for step in steps]
    named = {name: name.replace("friction_force", channel) for name in labels}
    return sheet.Table(
        name="steps",
        title="Friction at each step of the voltage",
        columns=tuple(sheet.Column(named[name], label, unit_of(named[name])) for name, label in labels.items()),
        rows=tuple(zip(*(columns[name] for name in labels), strict=True)),
    )


def _zero_taken_off(step: VoltageStep, unit: str) -> tuple[str, ...]:
    """Caveat that the friction at rest was taken for its zero."""
    if not step.force_zero:
        return ()
    return (f"{format_si(step.force_zero, unit)}, the mean force at rest before sliding, is taken off as its zero",)


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


_LEVELS = (
    *("steady_friction_force", "friction_force", "mean_force"),
    *("steady_friction_coefficient", "friction_coefficient", "mean_coefficient"),
)


def comparison_sheet(with_vibration: Sequence[sheet.Sheet], without_vibration: Sequence[sheet.Sheet]) -> sheet.Sheet:
    """Friction reduction from tests with and without vibration, with its interval and its significance.

    With what is not known, where there are fewer than two tests of a kind.
    """
    every = [*with_vibration, *without_vibration]
    level = next((name for name in _LEVELS if all(_value(test, name) for test in every)), None)
    title = f"{len(with_vibration)} with vibration against {len(without_vibration)} without"
    if level is None:
        reason = "comparison: the tests have no level of friction in common"
        return sheet.joined([sheet.Sheet(not_found=(reason,))], title=title, source={})
    vibrated, still = (
        [value.value for test in sheets if (value := _value(test, level))]
        for sheets in (with_vibration, without_vibration)
    )
    figure = comparison_figure(_named(without_vibration, still), _named(with_vibration, vibrated), level)
    sections = [
        sheet.attempted(partial(_reduction, vibrated, still), what="interval of the reduction"),
        sheet.attempted(partial(_significance, vibrated, still), what="significance"),
        sheet.Sheet(figures=(figure,)),
    ]
    if min(len(vibrated), len(still)) < 2:
        mean = 1 - (sum(vibrated) / len(vibrated)) / (sum(still) / len(still))
        sections.insert(0, sheet.Sheet(values=(sheet.quantity_value("friction_reduction", mean),)))
    return sheet.joined(sections, title=title, source={"compared": level.replace("_", " ")})


def _value(test: sheet.Sheet, name: str) -> sheet.Value | None:
    """Value of this name on a sheet; None where it has none."""
    return next((value for value in test.values if value.name == name), None)


def _named(tests: Sequence[sheet.Sheet], values: Sequence[float]) -> list[tuple[str, float]]:
    """Values with the titles of their tests."""
    return [(test.title, value) for test, value in zip(tests, values, strict=True)]


def _reduction(vibrated: Sequence[float], still: Sequence[float]) -> sheet.Sheet:
    """Friction reduction with its 95 % interval, by the ratio of means."""
    ratio = ratio_interval(vibrated, still)
    interval = (1 - ratio.upper, 1 - ratio.lower) if ratio.bounded else None
    value = sheet.quantity_value("friction_reduction", 1 - ratio.ratio, interval=interval)
    return sheet.Sheet(values=(value,), caveats=(ratio.reason,) if ratio.reason else ())


def _significance(vibrated: Sequence[float], still: Sequence[float]) -> sheet.Sheet:
    """Significance of the difference by Welch and by permutation tests."""
    test = compare_means(still, vibrated)
    values = (
        sheet.Value("welch_p", "p value of the difference, Welch test", test.welch_p, ""),
        sheet.Value("permutation_p", "p value of the difference, permutation test", test.permutation_p, ""),
    )
    caveats: tuple[str, ...] = ()
    if test.smallest_permutation_p > 1 - test.confidence_level:
        caveats = (
            f"{len(vibrated)} and {len(still)} tests are too few for significance at {test.confidence_level:.0%}"
            f" without assuming normal scatter: the least possible p value is {test.smallest_permutation_p:.2g}",
        )
    return sheet.Sheet(values=values, caveats=caveats)
