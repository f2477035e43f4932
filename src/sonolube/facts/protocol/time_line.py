"""Time line of a protocol: set points of motor, drive and recording; and protocol at another load and speed."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.facts.protocol.record import Protocol, Repeat, Step
from sonolube.facts.protocol.step import Change, DriveSetPoint, Lane
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
    sets : tuple of str
        Set points of which parts of the rig the step has set here: motor, drive, and record where a recording begins.
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
    sets: tuple[Lane, ...] = ()
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

    @property
    def begins_recording(self) -> bool:
        """Whether a recording begins here."""
        return "record" in self.sets


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
    for place, step, change in _changes(protocol.steps, ""):
        if change.record is not None:
            if now < until:
                start, end = format_si(now, "s"), format_si(until, "s")
                raise InvalidInput(f"step {place}: starts to record at {start}, while another lasts until {end}")
            until = now + change.record.duration
            state = replace(state, recorded_until=until)
        elif state.channels and now >= until:
            state = replace(state, channels=(), sample_rate=None, recorded_until=None)
        state = replace(_changed(state, change), time=now, step=place, kind=step.kind, sets=change.sets)
        points.append(state)
        now += change.duration
        if abs(now - until) < _ROUNDING * max(1.0, until):
            now = until  # the end of a recording, but for rounding
    return (*points, SetPoint(time=max(now, until), step="", kind="end", sets=("motor", "drive")))


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
    _require_shallow(steps, depth=0)
    count = sum(step.change_count for step in steps)
    if count > MAX_SET_POINTS:
        raise InvalidInput(f"steps: {count:.6g} set points with all repeats; at most {MAX_SET_POINTS}")


def _require_shallow(steps: Sequence[Step], *, depth: int) -> None:
    """Raise where repeats are nested too deep."""
    if depth > _DEEPEST:
        raise InvalidInput(f"steps: repeats are nested more than {_DEEPEST} deep")
    for step in steps:
        if isinstance(step, Repeat):
            _require_shallow(step.steps, depth=depth + 1)


def _changes(steps: Sequence[Step], prefix: str) -> Iterator[tuple[str, Step, Change]]:
    """Changes of set points by steps with their places, repeats written out."""
    for number, step in enumerate(steps, 1):
        place = f"{prefix}{number}"
        if isinstance(step, Repeat):
            for _ in range(step.count):
                yield from _changes(step.steps, f"{place}.")
        else:
            for change in step.changes():
                yield place, step, change


def _changed(state: SetPoint, change: Change) -> SetPoint:
    """Set points after a change."""
    if (motor := change.motor) is not None:
        state = replace(state, sliding_speed=motor.sliding_speed, rotation_speed=motor.rotation_speed)
    if change.drive is not None:
        state = _driven(state, change.drive)
    if (record := change.record) is not None:
        state = replace(state, channels=record.channels, sample_rate=record.sample_rate)
    if change.normal_load is not None:
        state = replace(state, normal_load=change.normal_load)
    return state if change.lubricant is None else replace(state, lubricant=change.lubricant)


def _driven(state: SetPoint, drive: DriveSetPoint) -> SetPoint:
    """Set points with others of the drive."""
    return replace(
        state,
        voltage_peak_to_peak=drive.voltage_peak_to_peak,
        voltage_offset=drive.voltage_offset,
        frequency=drive.frequency if drive.voltage_peak_to_peak > 0 else None,
        waveform=drive.waveform,
    )


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

    Raises
    ------
    InvalidInput
        If a step sets load or speed, and its kind has no other ones.
    """
    conditions = f"{format_si(normal_load, 'N')} and {format_si(sliding_speed, 'm/s')}"
    return protocol.model_copy(
        update={
            "title": f"{protocol.title.split(',')[0]}, {conditions}",
            "metadata": protocol.metadata.model_copy(update={"normal_load": normal_load}),
            "steps": tuple(
                step.at_conditions(normal_load=normal_load, sliding_speed=sliding_speed) for step in protocol.steps
            ),
        }
    )
