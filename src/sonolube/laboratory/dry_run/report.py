"""Report of a dry run: set points beyond an amplifier or a limit and other findings, its lines in words, and its chart.

The chart has speed, drive voltage and temperatures over the time line.
"""

from collections.abc import Callable, Iterator
from math import inf
from typing import Final

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Part, Rule, Zone
from sonolube.checks import Floats
from sonolube.design.control import Amplifier
from sonolube.facts.protocol import Check, step_at
from sonolube.laboratory.dry_run.record import DryRun, PlannedPoint
from sonolube.laboratory.interlocks import drive_sampling, recorded_channels
from sonolube.laboratory.run_plan import SPEED_CHANNEL, speed_checks
from sonolube.text.units import format_si

STATIC_FRICTION_FACTOR = 1.35
"""Static over intrinsic sliding friction: 1.2 N before 0.89 N, D 4.1.2. []"""

SAFETY = "software is no safety function: a rig needs an emergency stop of its own, in reach of who runs it"
"""Caveat of every run on devices."""

_TOLERANCE = 1 + 1e-9
_LARGE = 1e9  # bytes, of which the operator is told


def refusals_of(found: DryRun, amplifier: Amplifier | None) -> tuple[str, ...]:
    """Reasons why a test is impossible or would be ended by a limit, each in one line with its step."""
    lines = [] if amplifier is None else list(_beyond_amplifier(found, amplifier))
    return (*lines, *_beyond_limits(found))


def _beyond_amplifier(found: DryRun, amplifier: Amplifier) -> Iterator[str]:
    """Steps whose drive is beyond the amplifier."""

    def lacking(needed: str, given: str) -> str:
        return f"needs {needed}; the amplifier gives {given}"

    most = amplifier.voltage_maximum
    for place, value in _beyond(found, lambda point: point.setting.voltage_peak_to_peak, most):
        yield place + lacking(f"{format_si(value, 'V')} peak to peak", format_si(most, "V"))
    most = amplifier.current_maximum
    for place, value in _beyond(found, lambda point: point.load.peak_current if point.load else 0.0, most):
        yield place + lacking(f"{format_si(value, 'A')} peak", format_si(most, "A"))
    most = amplifier.slew_rate_maximum
    for place, value in _beyond(found, lambda point: point.load.slew_rate if point.load else 0.0, most):
        yield place + lacking(f"{value / 1e6:.3g} V/us", f"{most / 1e6:.3g} V/us")


def _beyond_limits(found: DryRun) -> Iterator[str]:
    """Steps at which a limit of the protocol would end the test."""

    def ending(reached: str, limit: str, allowed: str) -> str:
        return f"reaches {reached}; limits.{limit} of {allowed} ends the test"

    limits = found.protocol.limits
    most = limits.current_maximum or inf
    for place, value in _beyond(found, lambda point: point.load.peak_current if point.load else 0.0, most):
        yield place + ending(format_si(value, "A"), "current_maximum", format_si(most, "A"))
    most = limits.friction_force_maximum or inf
    for place, value in _beyond(found, lambda point: point.friction_force or 0.0, most):
        yield place + ending(f"{format_si(value, 'N')} of friction", "friction_force_maximum", format_si(most, "N"))
    if limits.temperature_maximum is not None and found.heating is not None:
        reached = found.heating.ambient_temperature + found.heating.actuator_rise
        beyond = np.flatnonzero(reached > limits.temperature_maximum)
        if beyond.size:
            around = slice(max(beyond[0] - 1, 0), beyond[0] + 1)
            time = float(np.interp(limits.temperature_maximum, reached[around], found.heating.time[around]))
            lasting = [each for each in found.points if each.duration > 0]
            point = ([each for each in lasting if each.setting.time < time] or lasting[:1])[-1]
            hottest = f"{_celsius(float(reached.max()))} at the actuator, too hot after {format_si(time, 's')}"
            allowed = _celsius(limits.temperature_maximum)
            yield f"step {point.setting.step}: " + ending(hottest, "temperature_maximum", allowed)


def _celsius(temperature: float) -> str:
    """Temperature in degrees Celsius."""
    return f"{temperature - 273.15:.4g} degC"


def _beyond(found: DryRun, quantity: Callable[[PlannedPoint], float], most: float) -> Iterator[tuple[str, float]]:
    """Steps at which a quantity rises beyond its limit, with its highest value; those of equal value together."""
    highest: dict[str, float] = {}
    before = 0.0
    for point in found.points:
        value, step = quantity(point), point.setting.step
        if value > most * _TOLERANCE and value != before:
            highest[step] = max(value, highest.get(step, 0.0))
        before = value
    for value in dict.fromkeys(highest.values()):
        steps = [step for step, each in highest.items() if each == value]
        yield f"step {', '.join(steps)}: ", value


def caveats_of(found: DryRun) -> Iterator[str]:
    """Findings before a test, each in one line."""
    yield SAFETY
    limits = found.protocol.limits
    if limits.friction_force_maximum is not None:
        force = max((point.friction_force or 0.0 for point in found.points), default=0.0)
        if force <= limits.friction_force_maximum < STATIC_FRICTION_FACTOR * force:
            yield (
                f"static friction may reach {format_si(STATIC_FRICTION_FACTOR * force, 'N')} at the start, 1.35 times"
                f" that of sliding (D 4.1.2), and trip limits.friction_force_maximum"
            )
    if any(point.load and point.load.peak_current for point in found.points):
        highest = max((point.peak_current or 0.0 for point in found.points), default=0.0)
        motion = (
            f"with that of the computed motion they reach {format_si(highest, 'A')}"
            if highest
            else "near resonance that of the motion adds to them"
        )
        yield f"currents are those of the capacitance; {motion}"
    if found.heating is not None and found.heating.contact_rise is not None:
        yield (
            "the rise of the contact is the mean over its nominal area by heat of friction alone; asperities flash"
            " hotter, and a thermocouple in the contact has read 53 degC (D 4.3.5), far more"
        )
    sampling = drive_sampling(found.protocol)
    unresolved = "" if sampling is None else sampling.caveat(recorded_channels(found.protocol))
    if unresolved:
        yield unresolved
    speeds = speed_checks(found.protocol)
    if speeds:
        yield f"step {', '.join(speeds)}: checks the speed that is set, unless a channel {SPEED_CHANNEL} measures it"
    waiting = [
        point.setting.step
        for point in found.points
        if point.setting.kind == "check" and _waits(found, point.setting.step)
    ]
    if waiting:
        steps = ", ".join(dict.fromkeys(waiting))
        yield f"checks that wait until they hold may take longer: step {steps}"
    if found.bytes > _LARGE:
        yield f"the recordings need {found.bytes / 1e9:.3g} GB of disk"


def _waits(found: DryRun, place: str) -> bool:
    """Whether a step is a check that waits."""
    step = step_at(found.protocol, place)
    return isinstance(step, Check) and step.otherwise == "wait"


def dry_run_lines(found: DryRun) -> list[str]:
    """Lines of a dry run: one a set point, then time, data, drive and temperatures.

    Parameters
    ----------
    found : DryRun

    Returns
    -------
    list of str
        Refusals, caveats and assumptions are not among them.
    """
    cells = (dry_run_cells(point, found) for point in found.points)
    lines = [f"{time}  {step:<6}{kind:<14}{content}".rstrip() for time, step, kind, content in cells]
    return [*lines, "", *(f"{name:<13}{text}" for name, text in dry_run_sums(found))]


def dry_run_cells(point: PlannedPoint, found: DryRun) -> tuple[str, str, str, str]:
    """Time, step, kind and content of a set point of a dry run.

    Parameters
    ----------
    point : PlannedPoint
    found : DryRun

    Returns
    -------
    tuple of str
        The times of all points are equally long.
    """
    at, width = point.setting, len(clock(found.duration))
    content = point.content if at.kind == "prompt" else "  ".join(_facts(point))
    return f"{clock(at.time):>{width}}", at.step, at.kind.replace("_", " "), content


def clock(seconds: float) -> str:
    """Time as hours, minutes and seconds, such as 4:00:00 or 0:32.5."""
    tenths = round(10 * seconds)
    minutes, rest = divmod(tenths, 600)
    hours, minutes = divmod(minutes, 60)
    text = f"{rest / 10:04.1f}".removesuffix(".0")
    return f"{hours}:{minutes:02d}:{text}" if hours else f"{minutes}:{text}"


def _facts(point: PlannedPoint) -> Iterator[str]:
    """Set point in words, with the amplitude, current and heat that follow from it."""
    at = point.setting
    if at.rotation_speed:
        yield f"{60 * at.rotation_speed:.3g} rpm"
    if point.sliding_speed:
        yield format_si(point.sliding_speed, "m/s", digits=3)
    if at.frequency is not None:
        yield f"{at.voltage_peak_to_peak:.3g} V pp {at.frequency / 1e3:.4g} kHz"
        if point.vibration_amplitude is not None:
            yield format_si(point.vibration_amplitude, "m", digits=3)
        if point.load is not None:
            yield f"{format_si(point.load.peak_current, 'A', digits=3)} peak"
    if point.friction_force:
        yield format_si(point.friction_force, "N", digits=3)
    if at.begins_recording and at.sample_rate is not None:
        yield f"{', '.join(at.channels)} at {format_si(at.sample_rate, 'Hz')} for {clock(point.recorded)}"
    if point.content:
        yield point.content


def dry_run_sums(found: DryRun) -> Iterator[tuple[str, str]]:
    """Time, data, drive and temperatures of a whole dry run, each as its name and its text.

    Parameters
    ----------
    found : DryRun

    Yields
    ------
    tuple of str
    """
    prompts = sum(point.setting.kind == "prompt" for point in found.points)
    whole = clock(found.duration + found.prompt_time)
    beside = f", about {whole} with {_counted(prompts, 'prompt')}" if prompts else ""
    yield "duration", f"{clock(found.duration)}{beside}"
    recordings = _counted(len(found.recordings), "recording")
    yield "data", f"{recordings}, {found.samples:,} samples, {found.bytes / 1e6:.3g} MB"
    loads = [point.load for point in found.points if point.load is not None]
    if loads and any(load.peak_current for load in loads):
        current = format_si(max(load.peak_current for load in loads), "A", digits=3)
        power = max((load.power for load in loads), key=lambda each: each.power_to_supply).text
        energy = found.amplifier_energy
        in_all = "" if energy is None else f", {format_si(energy, 'J', digits=3)} in all"
        yield "drive", f"at most {current} peak, {power} to supply{in_all}"
    heating = found.heating
    if heating is not None:
        yield "friction", f"{format_si(heating.frictional_heat, 'J', digits=3)} of work"
        if heating.contact_rise is not None:
            yield "contact", f"warms by {float(heating.contact_rise.max()):.3g} K at most"
        yield "actuator", f"warms by {float(heating.actuator_rise.max()):.3g} K at most"


def _counted(number: int, thing: str) -> str:
    """Number of things, in the plural where it is not 1."""
    return f"{number} {thing}{'' if number == 1 else 's'}"


_UNITS: Final = ((2 * 3600.0, "h", 3600.0), (180.0, "min", 60.0), (0.0, "s", 1.0))
_WIDTH: Final = 6.85  # inches: 174 mm
_MAX_PROMPTS: Final = 40  # that are marked


def dry_run_chart(found: DryRun) -> Chart:
    """Speed of the sliding, drive and temperature rises of a protocol over time.

    Parameters
    ----------
    found : DryRun

    Returns
    -------
    Chart
        A panel each for speed, voltage, the frequency where it is swept, and the temperatures with a rig; recordings
        are shaded, prompts dotted lines.
    """
    unit, scale = next((unit, scale) for least, unit, scale in _UNITS if found.duration >= least)
    time = np.array([point.setting.time for point in found.points]) / scale
    x = Axis(label="Time without prompts", unit=unit, lowest=float(-0.01 * time[-1]), highest=float(1.01 * time[-1]))
    curves = [_speed(time, found), _voltage(time, found), *_frequency(time, found), *_temperatures(found, scale)]
    prompts = sorted({point.setting.time / scale for point in found.points if point.setting.kind == "prompt"})
    panels: list[Panel] = []
    for axis, lines in curves:
        is_first = not panels
        marks: list[Part] = []
        if is_first and found.recordings:
            start, lasts = np.array([(each.setting.time, each.recorded) for each in found.recordings]).T
            marks.append(
                Zone(first=start / scale, last=(start + lasts) / scale, label="recorded", colour=2, opacity=0.25)
            )
        marks += [
            Rule(value=place, label="prompt" if is_first and not number else "", colour="0.35")
            for number, place in enumerate(prompts[:_MAX_PROMPTS])
        ]
        panels.append(Panel(x=x, y=axis, parts=(*marks, *lines)))
    size = (_WIDTH, 1.2 + 1.45 * len(panels))
    return Chart(panels=tuple(panels), size=size, legend="top", legend_columns=5, shares_x=True)


def _speed(time: Floats, found: DryRun) -> tuple[Axis, tuple[Line, ...]]:
    """Sliding speed, or speed of the disc where the groove is unknown."""
    is_known = all(point.sliding_speed is not None for point in found.points)
    speeds = [
        1e3 * (point.sliding_speed or 0.0) if is_known else 60 * (point.setting.rotation_speed or 0.0)
        for point in found.points
    ]
    label, unit = ("Sliding speed", "mm/s") if is_known else ("Speed of the disc", "rpm")
    return _from_zero(label, unit, speeds), (Line(x=time, y=np.array(speeds), is_stepped=True),)


def _voltage(time: Floats, found: DryRun) -> tuple[Axis, tuple[Line, ...]]:
    """Peak-to-peak voltage."""
    volts = [point.setting.voltage_peak_to_peak for point in found.points]
    line = Line(x=time, y=np.array(volts), colour=1, is_stepped=True)
    return _from_zero("Drive, peak to peak", "V", volts), (line,)


def _frequency(time: Floats, found: DryRun) -> list[tuple[Axis, tuple[Line, ...]]]:
    """Frequency of the drive, where it is swept."""
    frequency = np.array([np.nan if f is None else f for f in (point.setting.frequency for point in found.points)])
    driven = frequency[np.isfinite(frequency)]
    if not driven.size or np.ptp(driven) == 0:
        return []
    return [(Axis(label="Frequency", unit="kHz"), (Line(x=time, y=1e-3 * frequency, colour=6, is_stepped=True),))]


def _temperatures(found: DryRun, scale: float) -> list[tuple[Axis, tuple[Line, ...]]]:
    """Temperature rises of contact, pin and actuator."""
    heating = found.heating
    if heating is None:
        return []
    curves = (
        ("contact, mean", heating.contact_rise, 1, 0),
        ("pin", heating.pin_rise, 0, 1),
        ("actuator", heating.actuator_rise, 6, 2),
    )
    lines = tuple(
        Line(x=heating.time / scale, y=rise, label=label, colour=colour, dash=dash)
        for label, rise, colour, dash in curves
        if rise is not None
    )
    return [(Axis(label="Computed rise", unit="K", lowest=0.0), lines)]


def _from_zero(label: str, unit: str, values: list[float]) -> Axis:
    """Axis from zero to a little over the greatest of some values."""
    return Axis(label=label, unit=unit, lowest=0.0, highest=1.15 * max(values) or 1.0)
