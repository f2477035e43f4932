"""Sections of a device map, as records that refuse what they do not know."""

import re
from typing import Annotated, Final, Literal, Self

from pydantic import AfterValidator, Field, field_validator, model_validator

from sonolube.errors import SonolubeError
from sonolube.facts.protocol.quantity_text import SiText, Table
from sonolube.laboratory.block import quantity_of
from sonolube.laboratory.drivers.line_motor import PLACEHOLDER
from sonolube.laboratory.drivers.sensor_scale import LinearScale
from sonolube.units import to_si
from sonolube.vocabulary import unit_of

TERMINATIONS: Final = {"CR": "\r", "LF": "\n", "CRLF": "\r\n"}
"""Ends of a line, by name."""

_LIBRARY: Final = "@py for pure Python, @ivi for the library of a maker"
_TEXT: Final = 500

Text = Annotated[str, Field(max_length=_TEXT)]
Line = Annotated[str, Field(min_length=1, max_length=80)]
Resource = Annotated[str, Field(min_length=1, max_length=200, pattern=r"^(TCPIP|USB|GPIB|ASRL)[!-~]*::(INSTR|SOCKET)$")]
Output = Annotated[str, Field(pattern=r"^[\w-]+/ao\d+$")]
Range = Annotated[float, SiText("V", 1e-3, 1e3)]
HighVoltage = Annotated[float, SiText("V", 1e-3, 1e5)]
Rate = Annotated[float, SiText("Hz", 1e-3, 1e9)]
Speed = Annotated[float, SiText("1/s", 1e-9, 1e5)]
Diameter = Annotated[float, SiText("m", 1e-4, 1e2)]
Gain = Annotated[float, Field(gt=0, le=1e6)]


class ChannelEntry(Table):
    """Channel of the acquisition: an input, and its sensor by gain and offset or by a table.

    Parameters
    ----------
    name : str
        As protocols call it, such as friction_force.
    input : str
        Such as ai0.
    input_range : float
        Magnitude of the voltage, in V.
    wiring : str
    gain : str or None
        Quantity per voltage, such as 20 N/V.
    offset : str or None
        Value at 0 V.
    calibration : str or None
        File beside the map.
    """

    name: str
    input: Annotated[str, Field(pattern=r"^ai\d+$")]
    input_range: Range = 10.0
    wiring: Literal["default", "differential", "referenced", "non_referenced"] = "default"
    gain: str | None = None
    offset: str | None = None
    calibration: Annotated[str, Field(min_length=1, max_length=200)] | None = None

    @field_validator("name")
    @classmethod
    def _require_known(cls, name: str) -> str:
        try:
            quantity_of(name)
        except SonolubeError as unknown:
            raise ValueError(str(unknown)) from None
        return name

    @model_validator(mode="after")
    def _require_scale(self) -> Self:
        if (self.gain is None) == (self.calibration is None):
            raise ValueError("needs either gain or calibration")
        if self.calibration is not None and self.offset is not None:
            raise ValueError("offset belongs to gain; a calibration has its own")
        if self.gain is not None and self.linear_scale.gain == 0:
            raise ValueError("gain must not be 0")
        return self

    @property
    def quantity(self) -> str:
        """Quantity of the vocabulary."""
        return quantity_of(self.name)

    @property
    def linear_scale(self) -> LinearScale:
        """Scale by gain and offset."""
        unit = unit_of(self.quantity)
        per_volt = "" if unit == "V" else f"{unit}/V"
        offset = 0.0 if self.offset is None else to_si(self.offset, unit=unit, name="offset")
        return LinearScale(gain=to_si(self.gain or "", unit=per_volt, name="gain"), offset=offset)


class AcquisitionEntry(Table):
    """Analogue inputs.

    Parameters
    ----------
    driver : str
    device : str
        As NI-DAQmx calls it, such as Dev1.
    description : str
        Model and serial number.
    sample_rate_maximum : float
        Of all channels together, in Hz.
    channels : tuple of ChannelEntry
    """

    driver: Literal["daqmx"]
    device: Annotated[str, Field(pattern=r"^[\w-]+$")]
    description: Text = ""
    sample_rate_maximum: Rate
    channels: Annotated[tuple[ChannelEntry, ...], Field(strict=False, min_length=1, max_length=64)]

    @model_validator(mode="after")
    def _require_different(self) -> Self:
        for key in ("name", "input"):
            told = [getattr(channel, key) for channel in self.channels]
            twice = sorted({each for each in told if told.count(each) > 1})
            if twice:
                raise ValueError(f"{key} {twice[0]} stands twice among the channels")
        return self


class _DriveEntry(Table):
    """What every source of the drive has."""

    description: Text = ""
    amplifier: Text = ""
    amplifier_gain: Gain = 1.0
    voltage_maximum: HighVoltage
    frequency_maximum: Rate
    output_maximum: Range = 10.0

    @field_validator("output_maximum")
    @classmethod
    def _require_small(cls, output_maximum: float) -> float:
        if output_maximum > 10.0:
            raise ValueError("output_maximum is at most 10 V, which these outputs give")
        return output_maximum


class GeneratorEntry(_DriveEntry):
    """Function generator of the Agilent and Keysight 33500 family.

    Parameters
    ----------
    driver : str
    resource : str
        As VISA calls it.
    visa_library : str
    output : int
    description, amplifier : str
        Model and serial number.
    amplifier_gain : float
        []
    voltage_maximum : float
        Magnitude at the actuator, offset included. [V]
    frequency_maximum : float
        In Hz.
    output_maximum : float
        Magnitude that the amplifier takes, in V.
    """

    driver: Literal["scpi"]
    resource: Resource
    visa_library: Literal["@py", "@ivi"] = Field(default="@py", description=_LIBRARY)
    output: Literal[1, 2] = 1


class DaqmxDriveEntry(_DriveEntry):
    """Analogue output of NI-DAQmx as source of the drive; keys as those of a generator.

    Parameters
    ----------
    driver : str
    output : str
        Such as Dev1/ao0.
    sample_rate : float
        Of the output. [Hz]
    """

    driver: Literal["daqmx"]
    output: Output
    sample_rate: Rate


class ExchangeEntry(Table):
    """A command and its answer.

    Parameters
    ----------
    command, answer : str
    """

    command: Line
    answer: Line


def _with_speed(text: str) -> str:
    """Text with one place for the speed."""
    if text.count(PLACEHOLDER) != 1 or re.search(r"[{}]", text.replace(PLACEHOLDER, "")):
        raise ValueError(f"must hold {PLACEHOLDER} once, and no other braces")
    return text


class _MotorEntry(Table):
    """What every motor has."""

    description: Text = ""
    rotation_speed_maximum: Speed
    groove_diameter: Diameter


class LineMotorEntry(_MotorEntry):
    """Motor controller that takes lines of text.

    Parameters
    ----------
    driver : str
    resource : str
        As VISA calls it, such as ASRL/dev/ttyUSB0::INSTR or ASRL3::INSTR.
    visa_library : str
    baud_rate : int or None
        Of a serial port, 8 data bits without parity.
    termination : str
    speed_unit : float
        Speed of the disc for which 1 stands in commands, such as 1 rpm; in 1/s.
    decimals : int
    speed_command, speed_answer : str
        `{speed}` stands for the number.
    stop_command, stop_answer : str
    query, query_answer : str or None
        Asks for the set speed.
    at_connect : tuple of ExchangeEntry
    description : str
    rotation_speed_maximum : float
        Of the disc, in 1/s.
    groove_diameter : float
        Of the circle under the pin. [m]
    """

    driver: Literal["line"]
    resource: Resource
    visa_library: Literal["@py", "@ivi"] = Field(default="@py", description=_LIBRARY)
    baud_rate: Annotated[int, Field(ge=50, le=4_000_000)] | None = None
    termination: Literal["CR", "LF", "CRLF"] = "CR"
    speed_unit: Speed
    decimals: Annotated[int, Field(ge=0, le=6)] = 0
    speed_command: Annotated[Line, AfterValidator(_with_speed)]
    speed_answer: Line
    stop_command: Line
    stop_answer: Line
    query: Line | None = None
    query_answer: Annotated[Line, AfterValidator(_with_speed)] | None = None
    at_connect: Annotated[tuple[ExchangeEntry, ...], Field(strict=False, max_length=20)] = ()

    @model_validator(mode="after")
    def _require_pair(self) -> Self:
        if (self.query is None) != (self.query_answer is None):
            raise ValueError("query and query_answer belong together")
        return self


class DaqmxMotorEntry(_MotorEntry):
    """Motor whose controller takes its speed as a voltage.

    Parameters
    ----------
    driver : str
    output : str
        Such as Dev1/ao1.
    voltage_at_maximum : float
        At which it turns at rotation_speed_maximum; 0 V is rest; in V.
    description : str
    rotation_speed_maximum : float
        Of the disc, in 1/s.
    groove_diameter : float
        Of the circle under the pin. [m]
    """

    driver: Literal["daqmx"]
    output: Output
    voltage_at_maximum: Annotated[float, SiText("V", -10.0, 10.0)]

    @field_validator("voltage_at_maximum")
    @classmethod
    def _require_voltage(cls, voltage_at_maximum: float) -> float:
        if abs(voltage_at_maximum) < 0.1:
            raise ValueError("voltage_at_maximum must be at least 0.1 V, of either sign")
        return voltage_at_maximum


class GuardEntry(Table):
    """Hardware that takes the outputs off where the program does not answer: a watchdog, an enable line, or both.

    Parameters
    ----------
    driver : str
    watchdog_timeout : float or None
        Time without a block, in s, after which the device sets its analogue outputs to 0 V and the line low; None
        without a watchdog.
    enable_line : str or None
        Digital line that is high while outputs are enabled, such as Dev1/port0/line0.
    """

    driver: Literal["daqmx"]
    watchdog_timeout: Annotated[float, SiText("s", 0.2, 60.0)] | None = None
    enable_line: Annotated[str, Field(pattern=r"^[\w-]+/port\d+/line\d+$")] | None = None

    @model_validator(mode="after")
    def _require_one(self) -> Self:
        if self.watchdog_timeout is None and self.enable_line is None:
            raise ValueError("needs watchdog_timeout, enable_line or both")
        return self


class MapEntries(Table):
    """Whole device map.

    Parameters
    ----------
    title : str
    acquisition : AcquisitionEntry
    drive : GeneratorEntry or DaqmxDriveEntry
    motor : LineMotorEntry or DaqmxMotorEntry
    guard : GuardEntry or None
    """

    title: Annotated[str, Field(min_length=1, max_length=_TEXT)]
    acquisition: AcquisitionEntry
    drive: Annotated[GeneratorEntry | DaqmxDriveEntry, Field(discriminator="driver")]
    motor: Annotated[LineMotorEntry | DaqmxMotorEntry, Field(discriminator="driver")]
    guard: GuardEntry | None = None

    @model_validator(mode="after")
    def _require_different_outputs(self) -> Self:
        drive, motor = self.drive, self.motor
        if isinstance(drive, DaqmxDriveEntry) and isinstance(motor, DaqmxMotorEntry) and drive.output == motor.output:
            raise ValueError(f"drive and motor both have the output {drive.output}")
        return self

    @property
    def guarded_outputs(self) -> tuple[str, ...]:
        """Analogue outputs of drive and motor that are on the device of the guard."""
        if self.guard is None:
            return ()
        outputs = [
            each.output for each in (self.drive, self.motor) if isinstance(each, DaqmxDriveEntry | DaqmxMotorEntry)
        ]
        line = self.guard.enable_line or (outputs[0] if outputs else "")
        return tuple(each for each in outputs if each.partition("/")[0].lower() == line.partition("/")[0].lower())

    @model_validator(mode="after")
    def _require_guarded(self) -> Self:
        if self.guard is not None and self.guard.enable_line is None and not self.guarded_outputs:
            raise ValueError("guard: a watchdog alone guards analogue outputs of drive or motor; give enable_line")
        return self
