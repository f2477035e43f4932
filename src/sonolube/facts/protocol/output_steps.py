"""Steps that set motor and drive, or keep them."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Literal, Self, final

from pydantic import Field, model_validator

from sonolube.facts.protocol.quantity_text import Hertz, MetresPerSecond, Seconds, SignedVolts, TurnsPerSecond, Volts
from sonolube.facts.protocol.step import LONGEST_TEXT, Change, DriveSetPoint, MotorSetPoint, StepTable, Waveform


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
    reason: str = Field(default="", max_length=LONGEST_TEXT)

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
