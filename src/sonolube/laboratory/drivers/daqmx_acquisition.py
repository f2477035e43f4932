"""Analogue inputs by NI-DAQmx: sampled by the clock of the device, read block by block, scaled to quantities in SI."""

import csv
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from math import ceil
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from sonolube.errors import InvalidInput, UnknownName
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.devices import Acquisition, DeviceError
from sonolube.laboratory.drivers.daqmx_library import daqmx_errors, daqmx_resource, library_of
from sonolube.laboratory.drivers.entry import AcquisitionEntry, ChannelEntry, Range, Rate, si_gain
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import unit_of

Floats = NDArray[np.float64]

_MAX_POINTS = 10_000
_MAX_SHOWN_POINTS = 100


SensorScale = Callable[[Floats], Floats]
"""Monotonic relation of the voltage of an input to a quantity: values in SI of voltages in V."""


def tabulated_scale(text: str, *, quantity: str, unit: str | None = None) -> SensorScale:
    """Scale of the text of a calibration file, linear between its points and saturated beyond them."""
    voltages, readings = calibration_points(text, quantity=quantity, unit=unit)
    return lambda given: np.interp(given, voltages, readings)


def calibration_points(text: str, *, quantity: str, unit: str | None = None) -> tuple[Floats, Floats]:
    """Rising voltages, in V, and readings, in SI, of the text of a calibration file."""
    rows = [[cell.strip() for cell in row] for row in csv.reader(text.splitlines()) if row]
    if not rows or rows[0] != ["voltage", quantity]:
        raise InvalidInput(f"line 1: expected voltage,{quantity}")
    if not 3 <= len(rows) <= _MAX_POINTS:
        raise InvalidInput(f"{len(rows) - 1} points; expected 2 to {_MAX_POINTS - 1}")
    si_unit = unit_of(quantity) if unit is None else unit
    points = np.array([_point(row, si_unit, line) for line, row in enumerate(rows[1:], start=2)])
    voltages, readings = points[:, 0], points[:, 1]
    if not (np.diff(voltages) > 0).all():
        raise InvalidInput("the voltages must increase from line to line")
    if abs(np.sign(np.diff(readings)).sum()) != len(readings) - 1:
        raise InvalidInput("the readings must rise or fall from line to line: one reading has one voltage")
    return voltages, readings


def _point(row: list[str], unit: str, line: int) -> tuple[float, float]:
    """Voltage and reading of a line."""
    if len(row) != 2:
        raise InvalidInput(f"line {line}: expected a voltage and a reading, got {len(row)} cells")
    place = f"line {line}:"
    return to_si(row[0], unit="V", name=place), to_si(row[1], unit=unit, name=place)


BUFFER_DURATION: Final = 4.0
"""Time for which the driver keeps samples that nobody has read. [s]"""

RESOLUTION: Final = 16
"""Bits of the converter that a virtual rig takes, over the range of the input."""

WIRINGS: Final = MappingProxyType(
    {"default": "DEFAULT", "differential": "DIFF", "referenced": "RSE", "non_referenced": "NRSE"}
)
"""Ways to wire an input, and what NI-DAQmx calls them."""

_MIN_BUFFER: Final = 1000  # samples
_GRACE: Final = 1.0  # s, beyond twice the time of the samples


class AnalogueInputEntry(ChannelEntry):
    """Input and its sensor, by gain and offset or by a table.

    Parameters
    ----------
    name : str
    quantity, unit, limit, identifier, calibrated, uncertainty : str or None
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
            return lambda voltages: gain * voltages + offset
        return tabulated_scale(files[self.calibration], quantity=self.kind, unit=self.si_unit)

    def calibration_text(self, files: Mapping[str, str]) -> str:
        """Gain and offset, or the points of the calibration, of which long ones are kept as their number."""
        if self.calibration is None:
            return f"gain {self.gain}" + ("" if self.offset is None else f", offset {self.offset}")
        _, *points = filter(str.strip, files[self.calibration].splitlines())
        shown = "; ".join(points) if len(points) <= _MAX_SHOWN_POINTS else f"{len(points)} points"
        return f"{self.calibration}, voltage and reading: {shown}"

    def voltage(self, values: Floats, files: Mapping[str, str]) -> Floats:
        """Voltage of the sensor at values in SI; beyond the points of a calibration that of the nearest. [V]"""
        if self.calibration is None:
            gain, offset = si_gain(self.gain or "", self.offset, unit=self.si_unit)
            return (values - offset) / gain
        voltages, readings = calibration_points(files[self.calibration], quantity=self.kind, unit=self.si_unit)
        order = np.argsort(readings)
        return np.interp(values, readings[order], voltages[order])

    def ranged(self, scale: SensorScale, *, sample_rate: float | None, calibration: str = "") -> Channel:
        """Channel with the range of sensor and input, and its calibration in words."""
        lowest, highest = sorted(scale(np.array([-self.input_range, self.input_range])).tolist())
        return self.channel(lowest=lowest, highest=highest, sample_rate=sample_rate, calibration=calibration)


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

    def chain(self, name: str, files: Mapping[str, str]) -> SensorScale:
        """Reading of a channel by its true values: sensor, range and resolution of the input, and its scale."""
        channel = next(each for each in self.channels if each.name == name)
        scale, most = channel.scale(files), channel.input_range
        step = 2 * most / 2**RESOLUTION

        def read(values: Floats) -> Floats:
            volts = step * np.round(channel.voltage(values, files) / step)
            return scale(np.clip(volts, -most, most))

        return read

    def open_reading(self, name: str, files: Mapping[str, str]) -> float:
        """Reading of a channel whose sensor is broken: the upper end of its range, to which amplifiers go then."""
        return self.new_device(files).channels[name].highest

    def new_device(self, files: Mapping[str, str]) -> Acquisition:
        """Inputs, not connected."""
        return DaqmxAcquisition(self, files)


class DaqmxAcquisition:
    """Analogue inputs of one device of NI-DAQmx.

    Parameters
    ----------
    entry : DaqmxAcquisitionEntry
    files : mapping of str to str
        Texts of calibrations, by the names of their files.
    """

    def __init__(self, entry: DaqmxAcquisitionEntry, files: Mapping[str, str]) -> None:
        self.name = f"NI-DAQmx {entry.device}"
        self._entry = entry
        self._inputs = {each.name: each for each in entry.channels}
        self._scale_of = {each.name: each.scale(files) for each in entry.channels}
        self.channels: Mapping[str, Channel] = {
            each.name: each.ranged(
                self._scale_of[each.name], sample_rate=entry.sample_rate, calibration=each.calibration_text(files)
            )
            for each in entry.channels
        }
        self._library: Any = None
        self._task: Any = None
        self._scales: tuple[SensorScale, ...] = ()
        self._sample_rate = 0.0
        self._most = 0  # samples of one call of the driver

    def connect(self) -> None:
        """Find driver and device."""
        if self._library is None:
            self._library = library_of(self._entry.device, name=self.name)

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        """Start to sample from sample 0 on, and return the sample rate of the device. [Hz]"""
        if self._library is None:
            raise DeviceError(f"{self.name}: connect it before sampling")
        inputs = self._chosen(channels, sample_rate)
        self.stop()
        with daqmx_errors(self.name):
            self._task = self._library.Task()
        try:
            with daqmx_errors(self.name):
                self._sample_rate = self._configured(inputs, sample_rate)
                self._task.start()
        except BaseException:
            self.stop()
            raise
        self._scales = tuple(self._scale_of[each.name] for each in inputs)
        return self._sample_rate

    def read(self, samples: int) -> Block:
        """Wait for the next samples of all channels, and return them in SI."""
        if self._task is None:
            raise DeviceError(f"{self.name}: start it before reading")
        if samples < 1:
            raise DeviceError(f"{self.name}: {samples} samples cannot be read; at least 1")
        values = np.empty((samples, len(self._scales)))
        with daqmx_errors(self.name):
            first = int(self._task.in_stream.curr_read_pos)
            for start in range(0, samples, self._most):
                part = values[start : start + self._most]
                part[:] = self._voltages(len(part)).T
        for column, scale in zip(values.T, self._scales, strict=True):
            column[:] = scale(column)
        return Block(first_sample=first, sample_rate=self._sample_rate, values=values)

    def stop(self) -> None:
        """Stop to sample and release the task; a lost device has none to release."""
        task, self._task = self._task, None
        if task is not None:
            with suppress(DeviceError), daqmx_errors(self.name):
                task.close()

    def close(self) -> None:
        """Release the device."""
        self.stop()
        self._library = None

    def _chosen(self, channels: Sequence[str], sample_rate: float) -> list[AnalogueInputEntry]:
        """Inputs of channels, which the converter can sample at a rate."""
        if not channels or len(set(channels)) < len(channels):
            raise DeviceError(
                f"{self.name}: needs at least one channel, each once, got {', '.join(channels) or 'none'}"
            )
        for name in channels:
            if name not in self._inputs:
                unknown = UnknownName.among(self._inputs, kind="channel", name=name)
                raise DeviceError(f"{self.name}: {unknown}")
        in_all = self._entry.sample_rate_maximum
        if not 0 < sample_rate * len(channels) <= in_all * (1 + 1e-9):
            most = format_si(in_all / len(channels), "Hz")
            wanted = format_si(sample_rate, "Hz")
            raise DeviceError(f"{self.name}: {wanted} refused; it samples {len(channels)} channels at up to {most}")
        return [self._inputs[name] for name in channels]

    def _configured(self, inputs: Sequence[AnalogueInputEntry], sample_rate: float) -> float:
        """Rate of the device after the task was given its channels, clock and buffer. [Hz]"""
        constants, task = self._library.constants, self._task
        for each in inputs:
            task.ai_channels.add_ai_voltage_chan(
                f"{self._entry.device}/{each.input}",
                terminal_config=constants.TerminalConfiguration[WIRINGS[each.wiring]],
                min_val=-each.input_range,
                max_val=each.input_range,
            )
        buffer = max(ceil(BUFFER_DURATION * sample_rate), _MIN_BUFFER)
        continuous = constants.AcquisitionType.CONTINUOUS
        task.timing.cfg_samp_clk_timing(sample_rate, sample_mode=continuous, samps_per_chan=buffer)
        task.in_stream.input_buf_size = buffer
        task.in_stream.overwrite = constants.OverwriteMode.DO_NOT_OVERWRITE_UNREAD_SAMPLES
        self._most = buffer // 2
        return float(task.timing.samp_clk_rate)

    def _voltages(self, samples: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        """Next voltages, one row a channel."""
        volts = np.empty((len(self._scales), samples))
        reader = self._library.stream_readers.AnalogMultiChannelReader(self._task.in_stream)
        count = reader.read_many_sample(
            volts, number_of_samples_per_channel=samples, timeout=2 * samples / self._sample_rate + _GRACE
        )
        if count != samples:
            raise DeviceError(f"{self.name}: gave {count} of {samples} samples")
        return volts
