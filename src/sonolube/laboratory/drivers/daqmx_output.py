"""Analogue outputs by NI-DAQmx: a drive source from a repeated buffer, and a motor set by a steady voltage."""

from contextlib import suppress
from fractions import Fraction
from math import ceil
from typing import Annotated, Any, ClassVar, Final, Literal

import numpy as np
from pydantic import Field, field_validator

from sonolube.facts.protocol.quantity_text import SiText, Table
from sonolube.laboratory.devices import DeviceError, DriveSetting, DriveSource, Motor
from sonolube.laboratory.drivers.daqmx_library import daqmx_errors, daqmx_resource, library_of
from sonolube.laboratory.drivers.entry import DriveEntry, DriveLimits, MotorEntry, Rate, require_speed
from sonolube.text.units import format_si

SAMPLES_PER_PERIOD: Final = 20
"""Least number of samples of one period of the drive."""

_LONGEST_BUFFER: Final = 100_000  # samples
_SHORTEST_BUFFER: Final = 1000  # samples, so that the driver refills it seldom
_FREQUENCY_ERROR: Final = 1e-5  # a fifth of that of the clocks of such devices


class DaqmxOutput:
    """One analogue output, at 0 V while it is off.

    Parameters
    ----------
    terminal : str
        Such as Dev1/ao0.
    voltage_range : float
        Magnitude that it can give, in V.
    """

    def __init__(self, *, terminal: str, voltage_range: float) -> None:
        self.name = f"NI-DAQmx {terminal}"
        self._terminal, self._range = terminal, voltage_range
        self._library: Any = None
        self._task: Any = None
        self._is_halted = False

    def connect(self) -> None:
        """Find driver and device, and set the output to 0 V."""
        if self._library is not None:
            return
        self._library = library_of(self._terminal.partition("/")[0], name=self.name)
        try:
            self.off()
        except BaseException:
            self._forget()
            raise

    def off(self) -> None:
        """Set the output to 0 V."""
        if self._library is not None:
            self._hold(0.0)

    def _require_connected(self, *, before: str) -> None:
        """Raise DeviceError where the device is not connected, before something such as driving."""
        if self._library is None:
            raise DeviceError(f"{self.name}: connect it before {before}")

    def _hold(self, voltage: float) -> None:
        """Set a steady voltage. [V]"""
        self._release()
        with daqmx_errors(self.name), self._library.Task() as task:
            self._task = task
            try:
                self._add_channel(task)
                task.write(voltage, auto_start=True)
            finally:
                if self._task is task:
                    self._task = None

    def halt(self) -> None:
        """Set 0 V from another thread: a call that hangs is aborted first, and starts nothing where it goes on."""
        task, self._task, self._is_halted = self._task, None, True
        if self._library is None:
            return
        if task is not None:
            with suppress(DeviceError), daqmx_errors(self.name):
                task.control(self._library.constants.TaskMode.TASK_ABORT)
                task.close()
        self._hold(0.0)

    def _repeat(self, setting: DriveSetting, *, amplitude: float, offset: float, sample_rate: float) -> None:
        """Generate a waveform continuously; amplitude peak to peak and offset in V, rate of the output in Hz."""
        self._release()
        continuous = self._library.constants.AcquisitionType.CONTINUOUS
        with daqmx_errors(self.name):
            self._task = task = self._library.Task()
            self._add_channel(task)
            task.timing.cfg_samp_clk_timing(sample_rate, sample_mode=continuous, samps_per_chan=_SHORTEST_BUFFER)
            rate = float(task.timing.samp_clk_rate)
            periods, samples = whole_periods(frequency=setting.frequency, sample_rate=rate, device=self.name)
            volts = offset + amplitude / 2 * setting.wave(np.arange(samples) * periods % samples / samples)
            task.timing.cfg_samp_clk_timing(sample_rate, sample_mode=continuous, samps_per_chan=samples)
            task.write(volts, auto_start=False)
            if self._is_halted:
                raise DeviceError(f"{self.name}: was switched off while a call hung")
            task.start()

    def close(self) -> None:
        """Set the output to 0 V and release the device."""
        with suppress(DeviceError):
            self.off()
        self._forget()

    def _forget(self) -> None:
        """Release task and device."""
        self._release()
        self._library = None

    def _add_channel(self, task: Any) -> None:
        """Add the output to a task."""
        task.ao_channels.add_ao_voltage_chan(self._terminal, min_val=-self._range, max_val=self._range)

    def _release(self) -> None:
        """End the waveform; the output stays at its last voltage until it is given another."""
        task, self._task = self._task, None
        if task is not None:
            with suppress(DeviceError), daqmx_errors(self.name):  # what follows fails too where that matters
                task.close()


class DaqmxDrive(DaqmxOutput):
    """Source of the drive voltage: an analogue output with an amplifier behind it.

    Parameters
    ----------
    terminal : str
        Such as Dev1/ao0.
    sample_rate : float
        Of the output. [Hz]
    limits : DriveLimits
    """

    def __init__(self, *, terminal: str, sample_rate: float, limits: DriveLimits) -> None:
        super().__init__(terminal=terminal, voltage_range=limits.output_voltage)
        self.voltage_maximum = limits.voltage_maximum
        self._limits, self._sample_rate = limits, sample_rate

    def drive(self, setting: DriveSetting) -> None:
        """Set the output, which rests for some ms between two settings."""
        amplitude, offset = self._limits.output_of(setting, device=self.name)
        self._require_connected(before="driving")
        if setting.voltage_peak_to_peak == 0:
            self.off()
        else:
            try:
                self._repeat(setting, amplitude=amplitude, offset=offset, sample_rate=self._sample_rate)
            except DeviceError:
                with suppress(DeviceError):
                    self.off()
                raise


class DaqmxMotor(DaqmxOutput):
    """Motor whose controller takes its speed as a voltage.

    Parameters
    ----------
    terminal : str
        Such as Dev1/ao1.
    rotation_speed_maximum : float
        Of the disc, in 1/s.
    voltage_at_maximum : float
        At which the disc turns at that speed; 0 V is rest; in V.
    """

    def __init__(self, *, terminal: str, rotation_speed_maximum: float, voltage_at_maximum: float) -> None:
        super().__init__(terminal=terminal, voltage_range=abs(voltage_at_maximum))
        self.rotation_speed_maximum = rotation_speed_maximum
        self._voltage_at_maximum = voltage_at_maximum

    def turn(self, rotation_speed: float) -> None:
        """Set the speed of the disc, 0 to stop. [1/s]"""
        require_speed(rotation_speed=rotation_speed, highest=self.rotation_speed_maximum, device=self.name)
        self._require_connected(before="turning")
        share = min(rotation_speed / self.rotation_speed_maximum, 1.0)
        self._hold(share * self._voltage_at_maximum)


def whole_periods(*, frequency: float, sample_rate: float, device: str) -> tuple[int, int]:
    """Numbers of periods and of samples of a buffer that can be repeated without a step."""
    if frequency * SAMPLES_PER_PERIOD > sample_rate * (1 + 1e-9):
        most = format_si(sample_rate / SAMPLES_PER_PERIOD, "Hz")
        raise DeviceError(f"{device}: {format_si(frequency, 'Hz')} refused; its sample rate allows up to {most}")
    share = Fraction(frequency / sample_rate).limit_denominator(_LONGEST_BUFFER)
    if abs(share * Fraction(sample_rate / frequency) - 1) > _FREQUENCY_ERROR:
        least = format_si(sample_rate / _LONGEST_BUFFER, "Hz")
        raise DeviceError(f"{device}: {format_si(frequency, 'Hz')} refused; its buffer takes frequencies from {least}")
    times = ceil(_SHORTEST_BUFFER / share.denominator)
    return share.numerator * times, share.denominator * times


class DaqmxOutputEntry(Table):
    """Keys of every output."""

    extras: ClassVar[tuple[str, ...]] = ("daqmx",)

    output: Annotated[str, Field(pattern=r"^[\w-]+/ao\d+$")]

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


class DaqmxDriveEntry(DaqmxOutputEntry, DriveEntry):
    """Analogue output as source of the drive; keys as those of a generator.

    Parameters
    ----------
    driver : str
    output : str
        Such as Dev1/ao0.
    sample_rate : float
        Of the output. [Hz]
    """

    driver: Literal["daqmx"]
    sample_rate: Rate

    @property
    def highest_frequency(self) -> float:
        """That the sample rate of the output allows. [Hz]"""
        return min(self.frequency_maximum, self.sample_rate / SAMPLES_PER_PERIOD)

    def new_device(self) -> DriveSource:
        """Source, not connected."""
        return DaqmxDrive(terminal=self.output, sample_rate=self.sample_rate, limits=self.limits)


class DaqmxMotorEntry(DaqmxOutputEntry, MotorEntry):
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
    voltage_at_maximum: Annotated[float, SiText("V", -10.0, 10.0)]

    @field_validator("voltage_at_maximum")
    @classmethod
    def _require_voltage(cls, voltage_at_maximum: float) -> float:
        if abs(voltage_at_maximum) < 0.1:
            raise ValueError("voltage_at_maximum must be at least 0.1 V, of either sign")
        return voltage_at_maximum

    def new_device(self) -> Motor:
        """Motor, not connected."""
        return DaqmxMotor(
            terminal=self.output,
            rotation_speed_maximum=self.rotation_speed_maximum,
            voltage_at_maximum=self.voltage_at_maximum,
        )
