"""Devices of a test rig: an acquisition, a source of the drive voltage and a motor, as protocols of a few methods.

A device answers in SI and raises `DeviceError` alone. What it measures comes in blocks that its own clock has timed;
the program never polls single samples.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Final, Protocol

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import SonolubeError, words_of
from sonolube.facts.protocol import Prompt
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.verdict import Verdict
from sonolube.text.units import format_si

SILENT: Final = "clock silent"
"""Kind of the note that an acquisition with a clock of its own gave no sample while it was to be recorded."""

RATE_ERROR: Final = 0.05
"""Share by which the sample rate of hardware may differ from the one asked for."""


WAVEFORMS: Final[Mapping[str, Callable[[Floats], Floats]]] = MappingProxyType(
    {
        "sine": lambda phase: np.sin(2 * np.pi * phase),
        "square": lambda phase: np.where(phase < 0.5, 1.0, -1.0),
        "triangle": lambda phase: 1 - 4 * np.abs((phase + 0.25) % 1.0 - 0.5),
        "sawtooth": lambda phase: 2 * ((phase + 0.5) % 1.0) - 1,
    }
)
"""Waveforms of drive sources by name: values between -1 and 1 over the phase in periods, from 0 to 1."""


class DeviceError(SonolubeError):
    """Device that did not follow a command; the text names the device and the remedy."""


class DeviceLost(DeviceError):
    """A device that answers no more."""


def fault_of(name: str, failure: BaseException) -> str:
    """What a device or a call to it has raised, behind its name; of any exception."""
    words = words_of(failure)
    if not isinstance(failure, SonolubeError):
        words = f"{type(failure).__name__}: {words}".removesuffix(": ")
    return words if words.startswith(name) else f"{name}: {words}"


class SamplesLost(DeviceError):
    """Samples that the hardware has taken and nobody has read in time, or whose counter is not the expected one."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveSetting:
    """Output of the source of the drive voltage; the voltage is that at the actuator.

    Parameters
    ----------
    voltage_peak_to_peak : float
        0 switches the output off. [V]
    voltage_offset : float
        [V]
    frequency : float
        [Hz]
    waveform : str
        sine, square, triangle or sawtooth.
    """

    voltage_peak_to_peak: float
    frequency: float
    voltage_offset: float = 0.0
    waveform: str = "sine"

    @property
    def voltage_maximum(self) -> float:
        """Greatest magnitude of the voltage, its offset included. [V]"""
        return abs(self.voltage_offset) + self.voltage_peak_to_peak / 2

    def wave(self, periods: Floats) -> Floats:
        """Waveform between -1 and 1 over the time in periods."""
        return np.asarray(WAVEFORMS[self.waveform](periods % 1.0))


def require_gapless(block: Block, sample: int, *, device: str) -> None:
    """Raise SamplesLost where a block does not begin with the sample that follows."""
    if block.first_sample < sample:
        raise SamplesLost(f"{device}: gives sample {block.first_sample} once more, where {sample} follows")
    if block.first_sample != sample:
        raise SamplesLost(f"{device}: {block.first_sample - sample} samples are missing after sample {sample}")


def require_rate(given: float, wanted: float, *, device: str) -> float:
    """Sample rate that hardware has chosen, within five per cent of the one asked for; raises DeviceError beyond.

    Limits are held to channels that resolve the drive at the rate asked for, and levels to their number of samples.
    """
    if not abs(given - wanted) <= RATE_ERROR * wanted:
        told = f"samples at {format_si(given, 'Hz')} where {format_si(wanted, 'Hz')} was asked for"
        raise DeviceError(f"{device}: {told}; choose a rate that it has")
    return given


def require_whole(block: Block, *, samples: int, channels: int, sample_rate: float, device: str) -> None:
    """Raise DeviceError where a block has other samples, channels or rate than asked for, or an infinite value."""
    shape = block.values.shape
    if shape != (samples, channels):
        told = f"values of shape {shape} where {samples} samples of {channels} channels were asked for"
        raise DeviceError(f"{device}: gives {told}")
    if not abs(block.sample_rate - sample_rate) <= RATE_ERROR * sample_rate:
        told = f"from {format_si(sample_rate, 'Hz')} to {format_si(block.sample_rate, 'Hz')}"
        raise DeviceError(f"{device}: has changed its sample rate {told}")
    if np.isinf(block.values).any():
        raise DeviceError(f"{device}: gives an infinite value; look at the range of its inputs")


class Device(Protocol):
    """Hardware that is connected for a run and released after it; outputs are off after both."""

    name: str

    def connect(self) -> None:
        """Open the connection and reserve the hardware, outputs off; harmless where that was done before."""

    def close(self) -> None:
        """Release the hardware, outputs off; harmless where that was done before."""


class Acquisition(Device, Protocol):
    """Analogue inputs with one hardware clock."""

    @property
    def channels(self) -> Mapping[str, Channel]:
        """Channels that can be recorded, by name."""

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        """Start to sample from sample 0 on, and return the sample rate that the hardware has chosen. [Hz]"""

    def read(self, samples: int) -> Block:
        """Wait for the next samples of all channels, and return them.

        Raises
        ------
        DeviceLost
            If they do not come within twice their time and a second.
        SamplesLost
            If the hardware has dropped samples.
        """

    def stop(self) -> None:
        """Stop to sample; harmless where nothing runs."""


class DriveSource(Device, Protocol):
    """Function generator with amplifier, or an amplifier with an input of its own.

    Notes
    -----
    Drive sources and motors may have a method `halt`, which switches the output off from another thread while a call
    to them hangs. Without it `off` is called there. A drive source may have a method `read_back`, which asks the
    instrument what its output is, raises DeviceError where that is not what was set, and returns the answers in a line.
    """

    voltage_maximum: float
    """Magnitude of the voltage at the actuator, offset included, that it can give. [V]"""

    def drive(self, setting: DriveSetting) -> None:
        """Set the output, which follows within a few periods."""

    def off(self) -> None:
        """Switch the output off; safe to call at any time after `connect`."""


class Motor(Device, Protocol):
    """Motor of the disc."""

    rotation_speed_maximum: float
    """Speed that it can give. [1/s]"""

    def turn(self, rotation_speed: float) -> None:
        """Set the speed of the disc, 0 to stop. [1/s]"""

    def off(self) -> None:
        """Stop; safe to call at any time after `connect`."""


class OutputGuard(Device, Protocol):
    """Watchdog or enable line: hardware that takes the outputs off where the program does not answer.

    Notes
    -----
    A run enables the outputs before the first is set, renews the permission with every block, and disables them after
    the last was switched off, or where it is late.
    """

    def enable(self) -> None:
        """Allow the outputs, and begin to wait for renewals."""

    def renew(self) -> None:
        """Begin to wait anew."""

    def disable(self) -> None:
        """Switch the outputs off; safe to call at any time, from any thread."""


class SwitchOff(Protocol):
    """What has the outputs of a run apart from the run's program, and switches them off where that cannot."""

    folder: Path | None
    """Record of the run, which it closes then."""

    def begin(self) -> None:
        """Begin to wait for the outputs, before any device is connected; raises DeviceLost where it cannot."""

    def tell(self, verdict: Verdict) -> None:
        """Keep the verdict of the run, whose record is not closed yet."""

    def end(self) -> None:
        """End after the record was closed; harmless where that was done before."""

    def watch(self) -> None:
        """Raise DeviceLost where it is gone; called with every block."""


class Recorder(Protocol):
    """Record of a run, as `sonolube.laboratory.records` keeps it."""

    def begin(self, channels: Sequence[Channel], *, sample_rate: float) -> None:
        """Begin a recording without gaps."""

    def append(self, block: Block, *, clock: str = "") -> None:
        """Keep a block, of the clock of the run where no other is named."""

    def end(self, *, clock: str = "") -> None:
        """End the recording of the run, or of another clock."""

    def begin_beside(
        self,
        clock: str,
        channels: Sequence[Channel],
        *,
        sample_rate: float,
        first: int,
        ago: float,
        uncertainty: float,
        offset: float | None = None,
    ) -> None:
        """Begin a recording of another clock, whose first sample was taken some time ago, beside that of the run.

        Of virtual devices the offset tells when: after the first sample of the recording of the run, in s.
        """

    def note(self, kind: str, *, sample: int | None = None, **facts: str | float) -> None:
        """Keep what happened."""

    def finish(self, outcome: str, *, reason: str = "") -> object:
        """Close the record."""


@dataclass(frozen=True, kw_only=True)
class Devices:
    """Devices of one rig.

    Parameters
    ----------
    acquisition : Acquisition
    drive : DriveSource
    motor : Motor
    description : mapping of str to str
        Kind, serial number and settings of each, for the record of a run.
    simulated : bool
        Whether no hardware moves.
    rehearsed : bool
        Whether simulated devices stand for those of a device map, and set and measured voltages are compared as theirs.
    groove_diameter : float
        Of the circle under the pin, which turns sliding speeds into those of the disc. [m]
    prepare : callable or None
        Works out what the devices need for a drive setting (None for off) at a speed of the disc, in 1/s. It is called
        for every set point before anything is connected; None where no set point takes the devices time.
    resources : tuple of str
        Canonical names of the hardware (device, address, port), which one run of a user has at a time.
    guard : OutputGuard or None
        Watchdog or enable line of the rig.
    attend : callable or None
        Takes a prompt after it was confirmed: of simulated devices the time passes, and load and lubricant change.
    further : mapping of str to Acquisition
        Acquisitions with a clock and a sample rate of their own, by name; their channels state the rate.
    clock : callable or None
        Time of virtual devices, in s, which goes on while they are read; None where that of the computer counts.
    switch_off : SwitchOff or None
        What has drive, motor and guard, where it is not this program.
    """

    acquisition: Acquisition
    drive: DriveSource
    motor: Motor
    description: Mapping[str, str]
    groove_diameter: float
    simulated: bool = False
    rehearsed: bool = False
    prepare: Callable[[DriveSetting | None, float], None] | None = None
    resources: tuple[str, ...] = ()
    guard: OutputGuard | None = None
    attend: Callable[[Prompt], None] | None = None
    clock: Callable[[], float] | None = None
    further: Mapping[str, Acquisition] = field(default_factory=dict)
    switch_off: SwitchOff | None = None

    @property
    def channels(self) -> Mapping[str, Channel]:
        """Channels of all acquisitions, by name."""
        further = (each.channels for each in self.further.values())
        return {name: channel for known in (self.acquisition.channels, *further) for name, channel in known.items()}


def connect_devices(devices: Devices) -> None:
    """Connect all devices, outputs off: the acquisition first, which touches no output where another program has it.

    Parameters
    ----------
    devices : Devices

    Raises
    ------
    DeviceError
        If a device does not answer.
    """
    for device in (devices.acquisition, devices.drive, devices.motor):
        device.connect()


def switch_outputs_off(devices: Devices) -> list[str]:
    """Switch drive and motor off, each whatever becomes of the other; never raises.

    Parameters
    ----------
    devices : Devices

    Returns
    -------
    list of str
        Outputs that did not confirm to be off, with the reason.
    """
    failures = []
    for device in (devices.drive, devices.motor):
        try:
            device.off()
        except BaseException as failure:  # whatever a driver raises, the next device must be switched off
            failures.append(fault_of(device.name, failure))
    return failures
