"""Analogue inputs by NI-DAQmx: sampled by the clock of the device into a buffer, and read block by block."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import ceil
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from sonolube.errors import UnknownName
from sonolube.laboratory.block import Block, Channel, quantity_of
from sonolube.laboratory.devices import DeviceError
from sonolube.laboratory.drivers.daqmx_library import daqmx_errors, daqmx_library, require_device
from sonolube.laboratory.drivers.sensor_scale import SensorScale
from sonolube.text.units import format_si

BUFFER_DURATION: Final = 4.0
"""Time for which the driver keeps samples that nobody has read. [s]"""

WIRINGS: Final = MappingProxyType(
    {"default": "DEFAULT", "differential": "DIFF", "referenced": "RSE", "non_referenced": "NRSE"}
)
"""Ways to wire an input, and what NI-DAQmx calls them."""

_MIN_BUFFER: Final = 1000  # samples
_GRACE: Final = 1.0  # s, beyond twice the time of the samples


@dataclass(frozen=True, kw_only=True, slots=True)
class AnalogueInput:
    """Input with its sensor.

    Parameters
    ----------
    name : str
        Of the channel, as protocols call it.
    terminal : str
        Such as Dev1/ai0.
    voltage_range : float
        Magnitude of the voltage that the input takes, in V.
    scale : SensorScale
        Voltage to quantity.
    wiring : str
        Key of `WIRINGS`.
    quantity : str
        That of the name by default.
    free_unit : str
        SI unit of a quantity that is not in the vocabulary.
    limit : float
        Greatest magnitude that the rig stands, in SI.
    sample_rate : float or None
        Of inputs with a clock of their own. [Hz]
    """

    name: str
    terminal: str
    voltage_range: float
    scale: SensorScale
    wiring: str = "default"
    quantity: str = ""
    free_unit: str = ""
    limit: float = np.inf
    sample_rate: float | None = None

    @property
    def channel(self) -> Channel:
        """Channel with the range of sensor and input."""
        lowest, highest = self.scale.reach(self.voltage_range)
        return Channel(
            name=self.name,
            quantity=self.quantity or quantity_of(self.name),
            lowest=lowest,
            highest=highest,
            free_unit=self.free_unit,
            limit=self.limit,
            sample_rate=self.sample_rate,
        )


class DaqmxAcquisition:
    """Analogue inputs of one device of NI-DAQmx.

    Parameters
    ----------
    device : str
        As NI-DAQmx calls it, such as Dev1.
    inputs : sequence of AnalogueInput
    sample_rate_maximum : float
        Of all channels together, since most devices have one converter for all; in Hz.
    """

    def __init__(self, *, device: str, inputs: Sequence[AnalogueInput], sample_rate_maximum: float) -> None:
        self.name = f"NI-DAQmx {device}"
        self.sample_rate_maximum = sample_rate_maximum
        self._device = device
        self._inputs = {each.name: each for each in inputs}
        self._library: Any = None
        self._task: Any = None
        self._scales: tuple[SensorScale, ...] = ()
        self._sample_rate = 0.0
        self._most = 0  # samples of one call of the driver

    @property
    def channels(self) -> Mapping[str, Channel]:
        """Channels that can be recorded, by name."""
        return {name: each.channel for name, each in self._inputs.items()}

    def connect(self) -> None:
        """Find driver and device."""
        if self._library is None:
            library = daqmx_library()
            require_device(library, self._device, name=self.name)
            self._library = library

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
        self._scales = tuple(each.scale for each in inputs)
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
            column[:] = scale.values(column)
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

    def _chosen(self, channels: Sequence[str], sample_rate: float) -> list[AnalogueInput]:
        """Inputs of channels, which the converter can sample at a rate."""
        if not channels or len(set(channels)) < len(channels):
            raise DeviceError(
                f"{self.name}: needs at least one channel, each once, got {', '.join(channels) or 'none'}"
            )
        for name in channels:
            if name not in self._inputs:
                unknown = UnknownName.among(self._inputs, kind="channel", name=name)
                raise DeviceError(f"{self.name}: {unknown}")
        if not 0 < sample_rate * len(channels) <= self.sample_rate_maximum * (1 + 1e-9):
            most = format_si(self.sample_rate_maximum / len(channels), "Hz")
            wanted = format_si(sample_rate, "Hz")
            raise DeviceError(f"{self.name}: {wanted} refused; it samples {len(channels)} channels at up to {most}")
        return [self._inputs[name] for name in channels]

    def _configured(self, inputs: Sequence[AnalogueInput], sample_rate: float) -> float:
        """Rate of the device after the task was given its channels, clock and buffer. [Hz]"""
        constants, task = self._library.constants, self._task
        for each in inputs:
            task.ai_channels.add_ai_voltage_chan(
                each.terminal,
                terminal_config=constants.TerminalConfiguration[WIRINGS[each.wiring]],
                min_val=-each.voltage_range,
                max_val=each.voltage_range,
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
