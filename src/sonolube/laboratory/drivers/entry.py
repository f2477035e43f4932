"""Sections of a device map, of which every driver has its own: bases that refuse unknown keys; limits of outputs."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from math import inf, nan
from typing import Annotated, Any, ClassVar, Final, Literal, Self

import numpy as np
from pydantic import Field, ValidationInfo, field_validator, model_validator

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.facts.protocol.quantity_text import SiText, Table
from sonolube.laboratory.block import CHANNEL_QUANTITIES, Channel, Sensor, quantity_of
from sonolube.laboratory.devices import (
    WAVEFORMS,
    Acquisition,
    DeviceError,
    DriveSetting,
    DriveSource,
    Motor,
    OutputGuard,
)
from sonolube.text.units import format_si, require_si_unit, temperature_difference_to_si, to_si
from sonolube.vocabulary import quantities, unit_of

_ROUNDING: Final = 1 + 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveLimits:
    """Amplifier behind an output, and what output and actuator stand.

    Parameters
    ----------
    amplifier_gain : float
        Voltage at the actuator per voltage of the output. []
    actuator_voltage : float
        Greatest magnitude at the actuator, offset included; in V.
    output_voltage : float
        Greatest magnitude that the output gives and the amplifier takes, in V.
    frequency_maximum : float
        In Hz.
    """

    amplifier_gain: float
    actuator_voltage: float
    output_voltage: float
    frequency_maximum: float

    @property
    def voltage_maximum(self) -> float:
        """Magnitude of the voltage at the actuator that can be given. [V]"""
        return min(self.actuator_voltage, self.amplifier_gain * self.output_voltage)

    def output_of(self, setting: DriveSetting, *, device: str) -> tuple[float, float]:
        """Amplitude peak to peak and offset of the output for a setting at the actuator. [V]

        Parameters
        ----------
        setting : DriveSetting
        device : str
            Name in errors.

        Returns
        -------
        tuple of float

        Raises
        ------
        DeviceError
            If the setting lies beyond a limit or its waveform is unknown.
        """
        if setting.waveform not in WAVEFORMS:
            raise DeviceError(f"{device}: no waveform {setting.waveform!r}; it gives {', '.join(WAVEFORMS)}")
        reached = setting.voltage_maximum
        if not 0 <= setting.voltage_peak_to_peak <= 2 * reached <= 2 * self.voltage_maximum * _ROUNDING:
            wanted, most = format_si(reached, "V"), format_si(self.voltage_maximum, "V")
            raise DeviceError(f"{device}: {wanted} at the actuator refused; it gives at most {most}")
        if not 0 < setting.frequency <= self.frequency_maximum * _ROUNDING:
            wanted, most = format_si(setting.frequency, "Hz"), format_si(self.frequency_maximum, "Hz")
            raise DeviceError(f"{device}: {wanted} refused; it gives frequencies up to {most}")
        return setting.voltage_peak_to_peak / self.amplifier_gain, setting.voltage_offset / self.amplifier_gain


def require_speed(*, rotation_speed: float, highest: float, device: str) -> None:
    """Raise where a motor cannot turn at a speed."""
    if not 0 <= rotation_speed <= highest * _ROUNDING:
        wanted, most = format_si(rotation_speed, "1/s"), format_si(highest, "1/s")
        raise DeviceError(f"{device}: {wanted} refused; it turns at 0 to {most}")


_LIBRARY: Final = "@py for pure Python, @ivi for the library of a maker"
_TEXT: Final = 500

Text = Annotated[str, Field(max_length=_TEXT)]
Line = Annotated[str, Field(min_length=1, max_length=200)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,59}$")]
Resource = Annotated[str, Field(min_length=1, max_length=200, pattern=r"^(TCPIP|USB|GPIB|ASRL)[!-~]*::(INSTR|SOCKET)$")]
VisaLibrary = Annotated[Literal["@py", "@ivi"], Field(description=_LIBRARY)]
Range = Annotated[float, SiText("V", 1e-3, 1e3)]
HighVoltage = Annotated[float, SiText("V", 1e-3, 1e5)]
Rate = Annotated[float, SiText("Hz", 1e-3, 1e9)]
Speed = Annotated[float, SiText("1/s", 1e-9, 1e5)]
Diameter = Annotated[float, SiText("m", 1e-4, 1e2)]
Gain = Annotated[float, Field(gt=0, le=1e6)]


class DriverEntry(Table, ABC):
    """Section of a device, whose driver it names.

    Parameters
    ----------
    driver : str
        Name in the table of drivers.
    description : str
        Model and serial number.
    """

    extras: ClassVar[tuple[str, ...]] = ()
    """Optional parts of the installation that the driver needs, as in `sonolube.extras.EXTRAS`."""

    driver: str
    description: Text = ""

    @property
    @abstractmethod
    def where(self) -> str:
        """Address, terminal or port, as people write it."""

    @property
    @abstractmethod
    def reserved_as(self) -> str:
        """Canonical name of the hardware, by which one run at a time has it."""

    @property
    def guarded_output(self) -> str | None:
        """Analogue output that a guard on the same hardware can take off; None without."""
        return None


class ChannelEntry(Table):
    """Channel of an acquisition: its name, and quantity and unit where the name implies none.

    Parameters
    ----------
    name : str
        As protocols call it, such as friction_force; with a quantity any other, such as pin_temperature.
    quantity : str or None
        Of the vocabulary, such as temperature, or a free one, such as acoustic_emission.
    unit : str or None
        SI unit of a free quantity, such as m/s2; empty for pure numbers.
    limit : str or None
        Greatest magnitude that the rig stands, beyond which every run ends, such as 120 degC.
    identifier : str
        Serial number of the sensor, which the recording keeps as the following ones.
    calibrated : str
        Date of its latest calibration, such as 2026-03-01.
    uncertainty : str or None
        Standard uncertainty of a reading, such as 0.05 N, by which a virtual rig deviates in a run.
    """

    quantity: Name | None = None
    name: Name  # behind the quantity, on which it depends
    unit: Annotated[str, Field(max_length=40)] | None = None
    limit: Annotated[str, Field(max_length=80)] | None = None
    identifier: Text = ""
    calibrated: str = ""
    uncertainty: Annotated[str, Field(max_length=80)] | None = None

    @field_validator("name")
    @classmethod
    def _require_known(cls, name: str, info: ValidationInfo) -> str:
        quantity = info.data.get("quantity")
        if quantity is None:
            try:
                quantity_of(name)
            except SonolubeError as unknown:
                raise ValueError(f"{unknown}; any other name needs its quantity") from None
        elif CHANNEL_QUANTITIES.get(name, quantity) != quantity:
            raise ValueError(f"a channel {name} measures {quantity_of(name)}; choose another name")
        elif name not in CHANNEL_QUANTITIES and name in quantities() and name != quantity:
            raise ValueError(f"{name} is another quantity of the vocabulary than {quantity}; choose another name")
        return name

    @field_validator("calibrated", mode="before")
    @classmethod
    def _require_date(cls, calibrated: Any) -> str:
        try:
            return date.fromisoformat(str(calibrated)).isoformat()
        except ValueError:
            raise ValueError(f"calibrated must be a date such as 2026-03-01, got {str(calibrated)[:80]!r}") from None

    @model_validator(mode="after")
    def _require_unit(self) -> Self:
        if self.kind in quantities():
            if self.unit is not None:
                raise ValueError(f"unit belongs to free quantities; that of {self.kind} is {unit_of(self.kind) or '1'}")
        elif self.unit is None:
            raise ValueError(f"quantity {self.quantity} is not in the vocabulary and needs its unit, of SI")
        require_si_unit(self.si_unit, name="unit")
        if self.limit is not None and not self.limit_value > 0:
            raise ValueError("limit must be positive")
        if self.uncertainty is not None and not (self.uncertainty_value or 0.0) > 0:
            raise ValueError(f"uncertainty must be positive, got {self.uncertainty}")
        return self

    @property
    def kind(self) -> str:
        """Quantity that it measures."""
        return self.quantity or quantity_of(self.name)

    @property
    def si_unit(self) -> str:
        """SI unit of its samples."""
        return unit_of(self.kind) if self.unit is None else self.unit

    @property
    def limit_value(self) -> float:
        """Greatest magnitude in SI; infinite without one."""
        return inf if self.limit is None else to_si(self.limit, unit=self.si_unit, name="limit")

    @property
    def uncertainty_value(self) -> float | None:
        """Standard uncertainty of a reading in SI; None without one."""
        if self.uncertainty is None:
            return None
        if self.si_unit == "K":
            return temperature_difference_to_si(self.uncertainty, name="uncertainty")
        return to_si(self.uncertainty, unit=self.si_unit, name="uncertainty")

    def channel(
        self, *, lowest: float = -inf, highest: float = inf, sample_rate: float | None = None, calibration: str = ""
    ) -> Channel:
        """Channel with the range of sensor and input, in SI.

        Parameters
        ----------
        lowest, highest : float
        sample_rate : float or None
            Of an acquisition with a clock of its own. [Hz]
        calibration : str
            Gain and offset, or points.

        Returns
        -------
        Channel
        """
        return Channel(
            name=self.name,
            quantity=self.kind,
            lowest=lowest,
            highest=highest,
            free_unit=self.unit or "",
            limit=self.limit_value,
            sample_rate=sample_rate,
            sensor=Sensor(
                identifier=self.identifier,
                calibration=calibration,
                calibrated=self.calibrated,
                uncertainty=self.uncertainty_value,
            ),
        )


class AcquisitionEntry(DriverEntry):
    """Inputs with one clock.

    Parameters
    ----------
    driver : str
    sample_rate : float or None
        Of each channel where the clock is one of several, thus below `acquisitions`. [Hz]
    description : str
    """

    sample_rate: Rate | None = None

    @property
    @abstractmethod
    def channel_entries(self) -> Sequence[ChannelEntry]:
        """Its channels."""

    @property
    def own_rate(self) -> float | None:
        """Sample rate of an acquisition with a clock of its own; None where protocols state it. [Hz]"""
        return self.sample_rate

    @property
    def total_rate_maximum(self) -> float:
        """Samples of all channels together. [Hz]"""
        return inf

    @property
    def described(self) -> str:
        """Device and channels in words."""
        return f"{self.driver} {self.where}: {'; '.join(each.name for each in self.channel_entries)}"

    @property
    def files_beside(self) -> Mapping[str, str]:
        """Names of files beside the map, by their keys."""
        return {}

    def check_file(self, key: str, text: str) -> None:
        """Raise InvalidInput where the text of a file beside the map is not what its key needs."""

    def chain(self, name: str, files: Mapping[str, str]) -> Callable[[Floats], Floats]:
        """Reading of a channel by its true values, in SI, through sensor and input: here within the range alone."""
        channel = self.new_device(files).channels[name]
        return lambda values: np.clip(values, channel.lowest, channel.highest)

    def open_reading(self, name: str, files: Mapping[str, str]) -> float:
        """Reading of a channel whose sensor is broken, in SI; NaN where the device says so."""
        return nan

    @abstractmethod
    def new_device(self, files: Mapping[str, str]) -> Acquisition:
        """Inputs, not connected; `files` holds the texts of the files beside the map by their names."""


class DriveEntry(DriverEntry):
    """Source of the drive voltage with its amplifier, and what output and actuator stand.

    Parameters
    ----------
    driver : str
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

    @property
    def limits(self) -> DriveLimits:
        """Limits of amplifier, output and actuator."""
        return DriveLimits(
            amplifier_gain=self.amplifier_gain,
            actuator_voltage=self.voltage_maximum,
            output_voltage=self.output_maximum,
            frequency_maximum=self.highest_frequency,
        )

    @property
    def highest_frequency(self) -> float:
        """That output and map allow. [Hz]"""
        return self.frequency_maximum

    @property
    def not_read_back(self) -> Sequence[str]:
        """What the source does not tell of its output: all of it, where a driver says nothing else."""
        return ["anything"]

    @abstractmethod
    def new_device(self) -> DriveSource:
        """Source, not connected."""


class MotorEntry(DriverEntry):
    """Motor of the disc.

    Parameters
    ----------
    driver : str
    description : str
    rotation_speed_maximum : float
        Of the disc, in 1/s.
    groove_diameter : float
        Of the circle under the pin. [m]
    """

    rotation_speed_maximum: Speed
    groove_diameter: Diameter

    @abstractmethod
    def new_device(self) -> Motor:
        """Motor, not connected."""


class GuardEntry(DriverEntry):
    """Hardware that takes the outputs off where the program does not answer.

    Parameters
    ----------
    driver : str
    description : str
    """

    @property
    @abstractmethod
    def described(self) -> str:
        """Description of the guard."""

    def outputs(self, guarded: Sequence[str]) -> tuple[str, ...]:
        """Those of the analogue outputs of drive and motor that it takes off itself."""
        return ()

    def require_use(self, guarded: Sequence[str]) -> None:
        """Raise InvalidInput where it would guard nothing of a rig with these analogue outputs."""

    @abstractmethod
    def new_device(self, guarded: Sequence[str]) -> OutputGuard:
        """Guard, not connected, of a rig with these analogue outputs."""


def si_gain(gain: str, offset: str | None, *, unit: str) -> tuple[float, float]:
    """Gain per volt and offset of a sensor, in SI."""
    per_volt = {"V": "", "": "1/V"}.get(unit, f"({unit})/V" if "/" in unit else f"{unit}/V")
    at_zero = 0.0 if offset is None else to_si(offset, unit=unit, name="offset")
    per = to_si(gain, unit=per_volt, name="gain")
    if per == 0:
        raise InvalidInput("gain must not be 0")
    return per, at_zero
