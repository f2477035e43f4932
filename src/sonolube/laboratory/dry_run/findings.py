"""Findings of a dry run: set points beyond an amplifier or a limit of the protocol, and remarks."""

from collections.abc import Callable, Iterator
from math import inf

import numpy as np

from sonolube.design.control import Amplifier
from sonolube.facts.protocol import Check, step_at
from sonolube.laboratory.checked_quantity import SPEED_CHANNEL, speed_checks
from sonolube.laboratory.drive_sampling import drive_sampling, recorded_channels
from sonolube.laboratory.dry_run.record import DryRun, PlannedPoint
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


def caveats_of(found: DryRun) -> tuple[str, ...]:
    """Findings before a test, each in one line."""
    return tuple(_caveats(found))


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
            point = [each for each in found.points if each.setting.time < time and each.duration > 0][-1]
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


def _caveats(found: DryRun) -> Iterator[str]:
    """Findings without those of the rig."""
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
        yield "currents are those of the capacitance; near resonance that of the motion adds to them"
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
