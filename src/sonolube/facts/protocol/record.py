"""Test protocol: its steps, one class a kind and one table of all, the limits of the rig, and the specimens."""

import re
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Final, Literal, Self, final, get_args

from pydantic import Field, field_validator, model_validator

from sonolube.facts.protocol.quantity_text import (
    MAX_STEPS,
    Amperes,
    Hertz,
    Kelvins,
    Metres,
    MetresPerSecond,
    Newtons,
    NoOrMoreNewtons,
    Seconds,
    SignedVolts,
    Table,
    TurnsPerSecond,
    Volts,
    written_out,
)
from sonolube.facts.protocol.step import Change, DriveSetPoint, MotorSetPoint, Recording, StepTable, Waveform
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import unit_of

CheckedQuantity = Literal[
    "friction_force", "normal_load", "temperature", "sliding_speed", "rotation_speed", "vibration_amplitude"
]

_CHANNEL: Final = re.compile(r"[A-Za-z]\w{0,63}")
_LONGEST_TEXT: Final = 2000
_LONGEST_NAME: Final = 500


@final
class Wait(StepTable):
    """Keep all set points for a time.

    Parameters
    ----------
    duration : float
        [s]
    reason : str
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType({"duration": "1 s"})

    kind: Literal["wait"] = "wait"
    duration: Seconds
    reason: str = Field(default="", max_length=_LONGEST_TEXT)

    def changes(self) -> Iterator[Change]:
        """None, for its duration."""
        yield Change(duration=self.duration)

    @property
    def content(self) -> str:
        """Reason."""
        return self.reason


@final
class MotorSpeed(StepTable):
    """Set the speed of the motor, 0 to stop it: of the contact or of the disc.

    Parameters
    ----------
    sliding_speed : float or None
        [m/s]
    rotation_speed : float or None
        [1/s]
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType({"sliding_speed": "20 mm/s"})

    kind: Literal["motor_speed"] = "motor_speed"
    sliding_speed: MetresPerSecond | None = None
    rotation_speed: TurnsPerSecond | None = None

    @model_validator(mode="after")
    def _require_one_speed(self) -> Self:
        if (self.sliding_speed is None) == (self.rotation_speed is None):
            raise ValueError("needs either sliding_speed or rotation_speed")
        return self

    def changes(self) -> Iterator[Change]:
        """Speed of the motor, of which the one that is not given is None."""
        yield Change(motor=MotorSetPoint(sliding_speed=self.sliding_speed, rotation_speed=self.rotation_speed))

    def at_conditions(self, *, normal_load: float, sliding_speed: float) -> Self:
        """Same step at another speed; one that stops the motor as it is."""
        del normal_load
        if not (self.sliding_speed or self.rotation_speed):
            return self
        return self.model_copy(update={"sliding_speed": sliding_speed, "rotation_speed": None})


@final
class Drive(StepTable):
    """Set the voltage of the actuator, 0 V to switch it off.

    Parameters
    ----------
    voltage_peak_to_peak : float
        [V]
    frequency : float or None
        Needed for a voltage above 0. [Hz]
    waveform : str
    voltage_offset : float
        [V]
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType({"voltage_peak_to_peak": "0 V"})

    kind: Literal["drive"] = "drive"
    voltage_peak_to_peak: Volts
    frequency: Hertz | None = None
    waveform: Waveform = "sine"
    voltage_offset: SignedVolts = 0.0

    @model_validator(mode="after")
    def _require_frequency(self) -> Self:
        if self.voltage_peak_to_peak > 0 and self.frequency is None:
            raise ValueError("needs a frequency for a voltage above 0 V")
        return self

    def changes(self) -> Iterator[Change]:
        """Voltage of the actuator."""
        drive = DriveSetPoint(
            voltage_peak_to_peak=self.voltage_peak_to_peak,
            voltage_offset=self.voltage_offset,
            frequency=self.frequency,
            waveform=self.waveform,
        )
        yield Change(drive=drive)


@final
class Acquire(StepTable):
    """Start to record channels; the steps that follow run meanwhile.

    Parameters
    ----------
    channels : tuple of str
        Names, such as friction_force, voltage, current, temperature, gaussmeter.
    sample_rate : float
        Samples per second and channel. [Hz]
    duration : float
        [s]
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType(
        {"channels": ["friction_force"], "sample_rate": "400 Hz", "duration": "1 s"}
    )

    kind: Literal["acquire"] = "acquire"
    channels: Annotated[tuple[str, ...], Field(strict=False, min_length=1, max_length=64)]
    sample_rate: Hertz
    duration: Seconds

    @field_validator("channels")
    @classmethod
    def _require_names(cls, channels: tuple[str, ...]) -> tuple[str, ...]:
        for channel in channels:
            if not _CHANNEL.fullmatch(channel):
                raise ValueError(
                    f"{channel[:40]!r} is no name of a channel; letters, digits and _, such as friction_force"
                )
        if len(set(channels)) < len(channels):
            raise ValueError("names a channel twice")
        return channels

    def changes(self) -> Iterator[Change]:
        """Recording that begins."""
        yield Change(record=Recording(channels=self.channels, sample_rate=self.sample_rate, duration=self.duration))


@final
class VoltageSteps(StepTable):
    """Drive the actuator by several voltages in turn.

    Parameters
    ----------
    voltages : tuple of float
        Peak to peak, in V.
    step_duration : float
        Of each voltage, in s.
    frequency : float
        [Hz]
    waveform : str
    unipolar : bool
        Whether the offset of each voltage is half of it, so that the actuator is never under tension; else 0 V.
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType(
        {"voltages": ["0 V"], "step_duration": "1 s", "frequency": "20 kHz"}
    )

    kind: Literal["voltage_steps"] = "voltage_steps"
    voltages: Annotated[tuple[Volts, ...], Field(strict=False, min_length=1, max_length=1000)]
    step_duration: Seconds
    frequency: Hertz
    waveform: Waveform = "sine"
    unipolar: bool = False

    def changes(self) -> Iterator[Change]:
        """Voltages in turn."""
        for voltage in self.voltages:
            drive = DriveSetPoint(
                voltage_peak_to_peak=voltage,
                voltage_offset=voltage / 2 if self.unipolar else 0.0,
                frequency=self.frequency,
                waveform=self.waveform,
            )
            yield Change(duration=self.step_duration, drive=drive)

    @property
    def change_count(self) -> int:
        """Number of voltages."""
        return len(self.voltages)


@final
class Sweep(StepTable):
    """Drive the actuator by frequencies that rise or fall from the first to the last in equal steps or ratios.

    Parameters
    ----------
    first_frequency, last_frequency : float
        In Hz.
    points : int
        Number of frequencies, each of the same duration.
    duration : float
        Of all together. [s]
    scale : str
        Whether steps or ratios are equal.
    voltage_peak_to_peak : float
        [V]
    voltage_offset : float
        [V]
    waveform : str
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType(
        {
            "first_frequency": "20 kHz",
            "last_frequency": "21 kHz",
            "points": 2,
            "duration": "2 s",
            "voltage_peak_to_peak": "0 V",
        }
    )

    kind: Literal["sweep"] = "sweep"
    first_frequency: Hertz
    last_frequency: Hertz
    points: int = Field(ge=2, le=10_000)
    duration: Seconds
    scale: Literal["linear", "log"] = "linear"
    voltage_peak_to_peak: Volts
    voltage_offset: SignedVolts = 0.0
    waveform: Waveform = "sine"

    def changes(self) -> Iterator[Change]:
        """Frequencies in turn."""
        first, last = self.first_frequency, self.last_frequency
        for index in range(self.points):
            share = index / (self.points - 1)
            drive = DriveSetPoint(
                voltage_peak_to_peak=self.voltage_peak_to_peak,
                voltage_offset=self.voltage_offset,
                frequency=first * (last / first) ** share if self.scale == "log" else first + (last - first) * share,
                waveform=self.waveform,
            )
            yield Change(duration=self.duration / self.points, drive=drive)

    @property
    def change_count(self) -> int:
        """Number of frequencies."""
        return self.points


@final
class Check(StepTable):
    """Check that a quantity lies within bounds, each text with its unit; the run ends where it does not.

    Parameters
    ----------
    quantity : str
        Of the vocabulary.
    lowest, highest : str or None
        At least one of them.
    otherwise : str
        What to do where it does not: stop the test, wait until it does, or note it and go on.
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType({"quantity": "temperature", "highest": "60 degC"})

    kind: Literal["check"] = "check"
    quantity: CheckedQuantity
    lowest: str | None = None
    highest: str | None = None
    otherwise: Literal["stop", "wait", "note"] = "stop"

    @model_validator(mode="after")
    def _require_bounds(self) -> Self:
        if self.lowest is None and self.highest is None:
            raise ValueError("needs lowest or highest")
        low, high = self.bounds
        if not low < high:
            raise ValueError(f"lowest {self.lowest!r} must be below highest {self.highest!r}")
        return self

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest value in SI, infinite where absent."""
        unit = unit_of(self.quantity)
        low = float("-inf") if self.lowest is None else to_si(self.lowest, unit=unit, name="lowest")
        high = float("inf") if self.highest is None else to_si(self.highest, unit=unit, name="highest")
        return low, high

    def changes(self) -> Iterator[Change]:
        """None."""
        yield Change()

    @property
    def content(self) -> str:
        """Quantity with its bounds, and what is done otherwise."""
        return f"{self.quantity} from {self.lowest or 'any'} to {self.highest or 'any'}, else {self.otherwise}"


@final
class Prompt(StepTable):
    """Ask the operator to do something and to confirm it; the clock of the protocol stands still meanwhile.

    Parameters
    ----------
    task : str
        Kind of work.
    text : str
        What to do.
    normal_load : float or None
        That the operator sets, 0 for a lifted pin; None where it stays as it is. [N]
    lubricant : str or None
        That the operator applies, empty for a cleaned contact; None where it stays as it is.
    applied_force : float or None
        Greatest force with which the operator pulls at the pin along the sliding during the next recording, in loops
        of 30 s of which each goes further. [N]
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType({"text": "Say here what the operator is to do."})

    kind: Literal["prompt"] = "prompt"
    task: Literal["cleaning", "mounting", "load", "profilometry", "other"] = "other"
    text: str = Field(min_length=1, max_length=_LONGEST_TEXT)
    normal_load: NoOrMoreNewtons | None = None
    lubricant: str | None = Field(default=None, max_length=_LONGEST_NAME)
    applied_force: Newtons | None = None

    def changes(self) -> Iterator[Change]:
        """Load and lubricant that the operator changes."""
        yield Change(normal_load=self.normal_load, lubricant=self.lubricant)

    @property
    def content(self) -> str:
        """Task and text."""
        return f"{self.task}: {self.text}"

    def at_conditions(self, *, normal_load: float, sliding_speed: float) -> Self:
        """Same step with another load and its text, where it has a load."""
        del sliding_speed
        if self.normal_load is None:
            return self
        text = f"Set a normal load of {format_si(normal_load, 'N')}; bring the pin into contact."
        return self.model_copy(update={"normal_load": normal_load, "text": text})


@final
class Repeat(StepTable):
    """Make steps several times, or once for each value of variables.

    Parameters
    ----------
    count : int
    steps : tuple of step
        Written out for all values where there are variables.
    over : mapping of str to tuple of str
        Values of variables, which stand as {name} in the texts of the steps: all combinations, those of the last
        variable in turn for each of the one before. Empty in a record that was read, whose steps are written out.
    """

    example: ClassVar[Mapping[str, Any]] = MappingProxyType(
        {"count": 2, "steps": [{"kind": "wait", "duration": "1 s"}]}
    )

    kind: Literal["repeat"] = "repeat"
    count: int = Field(default=1, ge=1, le=10_000)
    steps: "Annotated[tuple[Step, ...], Field(strict=False, min_length=1, max_length=MAX_STEPS)]"
    over: dict[str, Annotated[tuple[str, ...], Field(strict=False, min_length=1, max_length=1000)]] = Field(
        default_factory=dict
    )

    @model_validator(mode="before")
    @classmethod
    def _write_out(cls, content: Any) -> Any:
        if not isinstance(content, dict):
            return content
        if "count" not in content and not content.get("over"):
            raise ValueError("needs count, or over with the values of variables")
        return written_out(content)

    def changes(self) -> Iterator[Change]:
        """Changes by its steps, as often as it makes them."""
        for _ in range(self.count):
            for step in self.steps:
                yield from step.changes()

    @property
    def change_count(self) -> int:
        """Number of changes by its steps, as often as it makes them."""
        return self.count * sum(step.change_count for step in self.steps)

    def at_conditions(self, *, normal_load: float, sliding_speed: float) -> Self:
        """Same steps at another load and speed."""
        steps = (step.at_conditions(normal_load=normal_load, sliding_speed=sliding_speed) for step in self.steps)
        return self.model_copy(update={"steps": tuple(steps)})


Step = Annotated[
    Wait | MotorSpeed | Drive | Acquire | VoltageSteps | Sweep | Repeat | Check | Prompt, Field(discriminator="kind")
]
"""Step of any kind, by its key `kind`: the table of the kinds, from which all other lists of them follow."""

Repeat.model_rebuild()

STEP_CLASSES: Final[Mapping[str, type[StepTable]]] = MappingProxyType(
    {each.model_fields["kind"].default: each for each in get_args(get_args(Step)[0])}
)
"""Classes of the steps by their `kind`."""

STEP_KINDS: Final = tuple(STEP_CLASSES)
"""Values of `kind`."""


_TEXT = 500


class Limits(Table):
    """Limits beyond which the test is ended.

    Parameters
    ----------
    voltage_maximum : float
        Magnitude of the drive voltage, its offset included. [V]
    duration_maximum : float
        Time of the whole test without prompts, in s.
    current_maximum : float or None
        Magnitude of the drive current. [A]
    temperature_maximum : float or None
        Of the actuator, in K.
    friction_force_maximum : float or None
        In N.
    """

    voltage_maximum: Volts
    duration_maximum: Seconds
    current_maximum: Amperes | None = None
    temperature_maximum: Kelvins | None = None
    friction_force_maximum: Newtons | None = None


class Metadata(Table):
    """Specimens and pair of materials of a test.

    Parameters
    ----------
    pin_material, disc_material : str
    normal_load : float or None
        [N]
    groove_diameter : float or None
        Of the middle of the wear track. [m]
    specimen : str
        Name of the pair of bodies.
    operator : str
        Who makes the test.
    humidity : str
        Relative humidity of the air, such as 45 %.
    calibrated : str
        Date of the latest calibration of the sensors, such as 2026-03-01.
    run : int or None
        Row of the table of runs.
    block : int or None
        Runs made together, such as on one day.
    """

    pin_material: str = Field(default="", max_length=_TEXT)
    disc_material: str = Field(default="", max_length=_TEXT)
    normal_load: Newtons | None = None
    groove_diameter: Metres | None = None
    specimen: str = Field(default="", max_length=_TEXT)
    operator: str = Field(default="", max_length=_TEXT)
    humidity: str = Field(default="", max_length=_TEXT)
    calibrated: str = Field(default="", max_length=_TEXT)
    run: int | None = Field(default=None, ge=1)
    block: int | None = Field(default=None, ge=1)


class Protocol(Table):
    """A test as a sequence of steps.

    Parameters
    ----------
    title : str
    source : str
        Where the procedure comes from.
    limits : Limits
    metadata : Metadata
    steps : tuple of step
        One after the other; `sonolube.facts.protocol.record` has their kinds.
    """

    title: str = Field(min_length=1, max_length=_TEXT)
    source: str = Field(min_length=1, max_length=_TEXT)
    limits: Limits
    metadata: Metadata = Metadata()
    steps: Annotated[tuple[Step, ...], Field(strict=False, min_length=1, max_length=1000)]
