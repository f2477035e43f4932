"""Time line of a protocol: set points of motor, drive and recording; and protocol at another load and speed."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final

from sonolube.errors import InvalidInput
from sonolube.facts.protocol.record import (
    Acquire,
    Drive,
    MotorSpeed,
    Prompt,
    Protocol,
    Repeat,
    Step,
    Sweep,
    VoltageSteps,
    Wait,
)
from sonolube.text.units import format_si

MAX_SET_POINTS: Final = 10_000
"""Number of set points of a protocol, repeats included."""

PROMPT_DURATIONS: Final[Mapping[str, float]] = MappingProxyType(
    {"cleaning": 300.0, "mounting": 600.0, "load": 60.0, "profilometry": 900.0, "other": 60.0}
)
"""Time that an operator is taken to need, by the task of a prompt. [s]"""

_ROUNDING: Final = 1e-9  # relative
_DEEPEST: Final = 8  # repeats within each other


@dataclass(frozen=True, kw_only=True, slots=True)
class SetPoint:
    """State of the rig from a time on.

    Parameters
    ----------
    time : float
        Since the start, without prompts. [s]
    step : str
        Place of the step, such as "4" or "4.2" for the second step of a repeat.
    kind : str
        Kind of the step; "end" for the last set point, which switches everything off.
    sliding_speed : float or None
        None where the speed of the disc is set. [m/s]
    rotation_speed : float or None
        None where the speed of the contact is set. [1/s]
    voltage_peak_to_peak : float
        0 while the actuator is off. [V]
    voltage_offset : float
        [V]
    frequency : float or None
        None while the actuator is off. [Hz]
    waveform : str
    channels : tuple of str
        Channels that are recorded.
    sample_rate : float or None
        Of the recording. [Hz]
    recorded_until : float or None
        Time at which the recording ends, in s.
    normal_load : float or None
        None where the protocol does not tell it. [N]
    lubricant : str
        Empty where none was applied.
    """

    time: float
    step: str
    kind: str
    sliding_speed: float | None = 0.0
    rotation_speed: float | None = None
    voltage_peak_to_peak: float = 0.0
    voltage_offset: float = 0.0
    frequency: float | None = None
    waveform: str = "sine"
    channels: tuple[str, ...] = ()
    sample_rate: float | None = None
    recorded_until: float | None = None
    normal_load: float | None = None
    lubricant: str = ""

    @property
    def voltage_maximum(self) -> float:
        """Greatest magnitude of the voltage, its offset included. [V]"""
        return abs(self.voltage_offset) + self.voltage_peak_to_peak / 2


@dataclass(frozen=True, slots=True)
class _Move:
    """Change of set points by a step, and how long it lasts."""

    step: str
    kind: str
    lasts: float
    changes: dict[str, Any]
    records: Acquire | None = None


def flattened(protocol: Protocol) -> tuple[SetPoint, ...]:
    """Set points of a protocol in the order of time, repeats written out.

    Parameters
    ----------
    protocol : Protocol

    Returns
    -------
    tuple of SetPoint
        One a step, one a voltage of voltage steps, one a frequency of a sweep, and "end" at the duration. Checks and
        prompts take no time.

    Raises
    ------
    InvalidInput
        If there are more than `MAX_SET_POINTS`, or a recording starts while another lasts.
    """
    _require_bounded(protocol.steps)
    now, until = 0.0, 0.0
    state = SetPoint(time=0.0, step="", kind="", normal_load=protocol.metadata.normal_load)
    points = []
    for move in _moves(protocol.steps, ""):
        if move.records is not None:
            if now < until:
                start, end = format_si(now, "s"), format_si(until, "s")
                raise InvalidInput(f"step {move.step}: starts to record at {start}, while another lasts until {end}")
            until = now + move.records.duration
            state = replace(state, sample_rate=move.records.sample_rate, recorded_until=until)
        elif state.channels and now >= until:
            state = replace(state, channels=(), sample_rate=None, recorded_until=None)
        state = replace(state, time=now, step=move.step, kind=move.kind, **move.changes)
        points.append(state)
        now += move.lasts
        if abs(now - until) < _ROUNDING * max(1.0, until):
            now = until  # the end of a recording, but for rounding
    return (*points, SetPoint(time=max(now, until), step="", kind="end"))


def step_at(protocol: Protocol, place: str) -> Step:
    """Step of a protocol by its place.

    Parameters
    ----------
    protocol : Protocol
    place : str
        As in `SetPoint.step`, such as "4.2" for the second step of a repeat.

    Returns
    -------
    step
    """
    first, *rest = (int(number) - 1 for number in place.split("."))
    step = protocol.steps[first]
    for number in rest:
        assert isinstance(step, Repeat)
        step = step.steps[number]
    return step


def duration(protocol: Protocol) -> float:
    """Time of a protocol without prompts, until steps and recordings have ended. [s]

    Parameters
    ----------
    protocol : Protocol

    Returns
    -------
    float
    """
    return flattened(protocol)[-1].time


def _require_bounded(steps: Sequence[Step]) -> None:
    """Raise where steps, written out, are too many or too deep; without writing them out."""
    count = _set_points(steps, depth=0)
    if count > MAX_SET_POINTS:
        raise InvalidInput(f"steps: {count:.6g} set points with all repeats; at most {MAX_SET_POINTS}")


def _set_points(steps: Sequence[Step], *, depth: int) -> int:
    """Number of set points of steps."""
    if depth > _DEEPEST:
        raise InvalidInput(f"steps: repeats are nested more than {_DEEPEST} deep")
    total = 0
    for step in steps:
        match step:
            case Repeat():
                total += step.count * _set_points(step.steps, depth=depth + 1)
            case VoltageSteps():
                total += len(step.voltages)
            case Sweep():
                total += step.points
            case _:
                total += 1
    return total


def _moves(steps: Sequence[Step], prefix: str) -> Iterator[_Move]:
    """Changes of set points by steps, repeats written out."""
    for number, step in enumerate(steps, 1):
        place = f"{prefix}{number}"
        match step:
            case Repeat():
                for _ in range(step.count):
                    yield from _moves(step.steps, f"{place}.")
            case VoltageSteps():
                yield from _voltages(step, place)
            case Sweep():
                yield from _frequencies(step, place)
            case _:
                yield _single(step, place)


def _single(step: Step, place: str) -> _Move:
    """Change of set points by a step that makes one."""
    match step:
        case Wait():
            return _Move(place, step.kind, step.duration, {})
        case MotorSpeed():
            speeds = {"sliding_speed": step.sliding_speed, "rotation_speed": step.rotation_speed}
            return _Move(place, step.kind, 0.0, speeds)
        case Drive():
            voltage, frequency = step.voltage_peak_to_peak, step.frequency
            changes = _driven(step, voltage, step.voltage_offset, frequency if voltage > 0 else None)
            return _Move(place, step.kind, 0.0, changes)
        case Acquire():
            return _Move(place, step.kind, 0.0, {"channels": step.channels}, step)
        case Prompt():
            told = {"normal_load": step.normal_load, "lubricant": step.lubricant}
            return _Move(place, step.kind, 0.0, {name: value for name, value in told.items() if value is not None})
    return _Move(place, step.kind, 0.0, {})


def _driven(
    step: Drive | VoltageSteps | Sweep, voltage: float, offset: float, frequency: float | None
) -> dict[str, Any]:
    """Changes of the set points of the drive."""
    return {
        "voltage_peak_to_peak": voltage,
        "voltage_offset": offset,
        "frequency": frequency,
        "waveform": step.waveform,
    }


def _voltages(step: VoltageSteps, place: str) -> Iterator[_Move]:
    """Changes of set points by voltages in turn."""
    for voltage in step.voltages:
        offset = voltage / 2 if step.unipolar else 0.0
        changes = _driven(step, voltage, offset, step.frequency if voltage > 0 else None)
        yield _Move(place, step.kind, step.step_duration, changes)


def _frequencies(step: Sweep, place: str) -> Iterator[_Move]:
    """Changes of set points by frequencies in turn."""
    first, last = step.first_frequency, step.last_frequency
    for index in range(step.points):
        share = index / (step.points - 1)
        frequency = first * (last / first) ** share if step.scale == "log" else first + (last - first) * share
        changes = _driven(step, step.voltage_peak_to_peak, step.voltage_offset, frequency)
        yield _Move(place, step.kind, step.duration / step.points, changes)


def protocol_at(protocol: Protocol, *, normal_load: float, sliding_speed: float) -> Protocol:
    """Protocol whose test is at another load and speed, each where it has one.

    Parameters
    ----------
    protocol : Protocol
    normal_load : float
        [N]
    sliding_speed : float
        Of every step that turns the motor. [m/s]

    Returns
    -------
    Protocol
        Its title has load and speed behind a comma.
    """
    conditions = f"{format_si(normal_load, 'N')} and {format_si(sliding_speed, 'm/s')}"
    return protocol.model_copy(
        update={
            "title": f"{protocol.title.split(',')[0]}, {conditions}",
            "metadata": protocol.metadata.model_copy(update={"normal_load": normal_load}),
            "steps": tuple(_step_at(step, normal_load, sliding_speed) for step in protocol.steps),
        }
    )


def _step_at(step: Step, load: float, speed: float) -> Step:
    """Step at another load and speed."""
    match step:
        case Repeat():
            return step.model_copy(update={"steps": tuple(_step_at(each, load, speed) for each in step.steps)})
        case MotorSpeed() if step.sliding_speed or step.rotation_speed:
            return step.model_copy(update={"sliding_speed": speed, "rotation_speed": None})
        case Prompt() if step.normal_load is not None:
            text = f"Set a normal load of {format_si(load, 'N')}; bring the pin into contact."
            return step.model_copy(update={"normal_load": load, "text": text})
    return step
