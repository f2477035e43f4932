"""Sections of a device map for NI-DAQmx: inputs, outputs for drive and motor, watchdog and enable line."""

from collections.abc import Mapping, Sequence
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, field_validator, model_validator

from sonolube.errors import InvalidInput
from sonolube.facts.protocol.quantity_text import SiText
from sonolube.laboratory.devices import Acquisition, DriveSource, Motor
from sonolube.laboratory.drivers.daqmx_acquisition import AnalogueInput, DaqmxAcquisition
from sonolube.laboratory.drivers.daqmx_guard import DaqmxGuard
from sonolube.laboratory.drivers.daqmx_output import SAMPLES_PER_PERIOD, DaqmxDrive, DaqmxMotor
from sonolube.laboratory.drivers.entry import (
    AcquisitionEntry,
    ChannelEntry,
    DriveEntry,
    GuardEntry,
    MotorEntry,
    Range,
    Rate,
    si_gain,
)
from sonolube.laboratory.drivers.resources import daqmx_resource
from sonolube.laboratory.drivers.sensor_scale import LinearScale, SensorScale, tabulated_scale
from sonolube.text.units import format_si

Output = Annotated[str, Field(pattern=r"^[\w-]+/ao\d+$")]


class AnalogueInputEntry(ChannelEntry):
    """Input and its sensor, by gain and offset or by a table.

    Parameters
    ----------
    name : str
    quantity, unit, limit : str or None
        As those of every channel.
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

    input: Annotated[str, Field(pattern=r"^ai\d+$")]
    input_range: Range = 10.0
    wiring: Literal["default", "differential", "referenced", "non_referenced"] = "default"
    gain: str | None = None
    offset: str | None = None
    calibration: Annotated[str, Field(min_length=1, max_length=200)] | None = None

    @model_validator(mode="after")
    def _require_scale(self) -> Self:
        if (self.gain is None) == (self.calibration is None):
            raise ValueError("needs either gain or calibration")
        if self.calibration is not None and self.offset is not None:
            raise ValueError("offset belongs to gain; a calibration has its own")
        if self.gain is not None:
            si_gain(self.gain, self.offset, unit=self.si_unit)
        return self

    def scale(self, files: Mapping[str, str]) -> SensorScale:
        """Scale of the sensor, by the texts of calibrations."""
        if self.calibration is None:
            gain, offset = si_gain(self.gain or "", self.offset, unit=self.si_unit)
            return LinearScale(gain=gain, offset=offset)
        return tabulated_scale(files[self.calibration], quantity=self.kind, unit=self.si_unit)


class DaqmxAcquisitionEntry(AcquisitionEntry):
    """Analogue inputs of a device.

    Parameters
    ----------
    driver : str
    device : str
        As NI-DAQmx calls it, such as Dev1.
    description : str
        Model and serial number.
    sample_rate_maximum : float
        Of all channels together, in Hz.
    sample_rate : float or None
        Of each channel, below `acquisitions`. [Hz]
    channels : tuple of AnalogueInputEntry
    """

    extras: ClassVar[tuple[str, ...]] = ("daqmx",)

    driver: Literal["daqmx"]
    device: Annotated[str, Field(pattern=r"^[\w-]+$")]
    sample_rate_maximum: Rate
    channels: Annotated[tuple[AnalogueInputEntry, ...], Field(strict=False, min_length=1, max_length=64)]

    @model_validator(mode="after")
    def _require_different(self) -> Self:
        told = [channel.input for channel in self.channels]
        twice = sorted({each for each in told if told.count(each) > 1})
        if twice:
            raise ValueError(f"input {twice[0]} stands twice among the channels")
        if self.sample_rate is not None and self.sample_rate * len(self.channels) > self.sample_rate_maximum:
            most = format_si(self.sample_rate_maximum / len(self.channels), "Hz")
            raise ValueError(f"sample_rate is at most {most} with {len(self.channels)} channels")
        return self

    @property
    def where(self) -> str:
        """Device."""
        return self.device

    @property
    def reserved_as(self) -> str:
        """Canonical name of the device."""
        return daqmx_resource(self.device)

    @property
    def channel_entries(self) -> Sequence[ChannelEntry]:
        """Inputs."""
        return self.channels

    @property
    def total_rate_maximum(self) -> float:
        """Samples of all channels together: one converter serves them in turn. [Hz]"""
        return self.sample_rate_maximum

    @property
    def described(self) -> str:
        """Device, and inputs with their scales."""
        channels = (
            f"{each.name} {each.input} {each.calibration or each.gain} +-{format_si(each.input_range, 'V')}"
            for each in self.channels
        )
        return f"NI-DAQmx {self.device}: {'; '.join(channels)}"

    @property
    def files_beside(self) -> Mapping[str, str]:
        """Calibrations by their keys; channels count from 1."""
        return {
            f"channels[{number}].calibration": each.calibration
            for number, each in enumerate(self.channels, start=1)
            if each.calibration is not None
        }

    def check_file(self, key: str, text: str) -> None:
        """Raise InvalidInput where the text of a calibration is no table of its channel."""
        number = int(key.partition("[")[2].partition("]")[0])
        channel = self.channels[number - 1]
        channel.scale({channel.calibration or "": text})

    def new_device(self, files: Mapping[str, str]) -> Acquisition:
        """Inputs, not connected."""
        inputs = [
            AnalogueInput(
                name=each.name,
                terminal=f"{self.device}/{each.input}",
                voltage_range=each.input_range,
                scale=each.scale(files),
                wiring=each.wiring,
                quantity=each.kind,
                free_unit=each.unit or "",
                limit=each.limit_value,
                sample_rate=self.sample_rate,
            )
            for each in self.channels
        ]
        return DaqmxAcquisition(device=self.device, inputs=inputs, sample_rate_maximum=self.sample_rate_maximum)


class DaqmxDriveEntry(DriveEntry):
    """Analogue output as source of the drive; keys as those of a generator.

    Parameters
    ----------
    driver : str
    output : str
        Such as Dev1/ao0.
    sample_rate : float
        Of the output. [Hz]
    """

    extras: ClassVar[tuple[str, ...]] = ("daqmx",)

    driver: Literal["daqmx"]
    output: Output
    sample_rate: Rate

    @property
    def where(self) -> str:
        """Terminal."""
        return self.output

    @property
    def reserved_as(self) -> str:
        """Canonical name of the device."""
        return daqmx_resource(self.output)

    @property
    def guarded_output(self) -> str:
        """Terminal."""
        return self.output

    @property
    def highest_frequency(self) -> float:
        """That the sample rate of the output allows. [Hz]"""
        return min(self.frequency_maximum, self.sample_rate / SAMPLES_PER_PERIOD)

    def new_device(self) -> DriveSource:
        """Source, not connected."""
        return DaqmxDrive(terminal=self.output, sample_rate=self.sample_rate, limits=self.limits)


class DaqmxMotorEntry(MotorEntry):
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

    extras: ClassVar[tuple[str, ...]] = ("daqmx",)

    driver: Literal["daqmx"]
    output: Output
    voltage_at_maximum: Annotated[float, SiText("V", -10.0, 10.0)]

    @field_validator("voltage_at_maximum")
    @classmethod
    def _require_voltage(cls, voltage_at_maximum: float) -> float:
        if abs(voltage_at_maximum) < 0.1:
            raise ValueError("voltage_at_maximum must be at least 0.1 V, of either sign")
        return voltage_at_maximum

    @property
    def where(self) -> str:
        """Terminal."""
        return self.output

    @property
    def reserved_as(self) -> str:
        """Canonical name of the device."""
        return daqmx_resource(self.output)

    @property
    def guarded_output(self) -> str:
        """Terminal."""
        return self.output

    def new_device(self) -> Motor:
        """Motor, not connected."""
        return DaqmxMotor(
            terminal=self.output,
            rotation_speed_maximum=self.rotation_speed_maximum,
            voltage_at_maximum=self.voltage_at_maximum,
        )


class DaqmxGuardEntry(GuardEntry):
    """Watchdog, enable line, or both.

    Parameters
    ----------
    driver : str
    watchdog_timeout : float or None
        Time without a block, in s, after which the device sets its analogue outputs to 0 V and the line low; None
        without a watchdog.
    enable_line : str or None
        Digital line that is high while outputs are enabled, such as Dev1/port0/line0.
    """

    extras: ClassVar[tuple[str, ...]] = ("daqmx",)

    driver: Literal["daqmx"]
    watchdog_timeout: Annotated[float, SiText("s", 0.2, 60.0)] | None = None
    enable_line: Annotated[str, Field(pattern=r"^[\w-]+/port\d+/line\d+$")] | None = None

    @model_validator(mode="after")
    def _require_one(self) -> Self:
        if self.watchdog_timeout is None and self.enable_line is None:
            raise ValueError("needs watchdog_timeout, enable_line or both")
        return self

    @property
    def where(self) -> str:
        """Line; empty where it is a watchdog on the device of the outputs."""
        return self.enable_line or ""

    @property
    def reserved_as(self) -> str:
        """Canonical name of the device; empty where it is that of the outputs."""
        return "" if self.enable_line is None else daqmx_resource(self.enable_line)

    @property
    def described(self) -> str:
        """Watchdog and enable line in words."""
        timeout = self.watchdog_timeout
        watchdog = "" if timeout is None else f"watchdog of {format_si(timeout, 's')}"
        return "; ".join(filter(None, (watchdog, self.enable_line and f"enable line {self.enable_line}")))

    def outputs(self, guarded: Sequence[str]) -> tuple[str, ...]:
        """Analogue outputs of drive and motor on the device of the line, else on that of the first."""
        line = self.enable_line or (guarded[0] if guarded else "")
        return tuple(each for each in guarded if daqmx_resource(each) == daqmx_resource(line))

    def require_use(self, guarded: Sequence[str]) -> None:
        """Raise where a watchdog alone has no analogue output to guard."""
        if self.enable_line is None and not self.outputs(guarded):
            raise InvalidInput("guard: a watchdog alone guards analogue outputs of drive or motor; give enable_line")

    def new_device(self, guarded: Sequence[str]) -> DaqmxGuard:
        """Guard, not connected."""
        return DaqmxGuard(outputs=self.outputs(guarded), timeout=self.watchdog_timeout, line=self.enable_line)
