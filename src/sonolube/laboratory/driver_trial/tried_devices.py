"""Sections and devices of a rig that is tried: calls go to the device of a driver, or to one that is pretended.

Every call is logged before it is made and has its fault there. An output counts as on from the call that sets it, and
as off once `connect`, `off`, `halt` or `close` has returned.
"""

import json
import time
from collections.abc import Mapping, Sequence
from functools import cached_property
from importlib import import_module
from typing import Any, Literal

import numpy as np

from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.driver_trial.faults import Injector
from sonolube.laboratory.drivers import AcquisitionEntry, ChannelEntry, DriveEntry, DriverEntry, MotorEntry

_READING = 0.5  # of every channel that is pretended
_BY_DEVICE = ("halt", "read_back")  # methods that devices may have


class _Tried:
    """A device whose calls are logged.

    Parameters
    ----------
    role : str
    device : object
        Of the driver; None where it is pretended.
    injector : Injector
    """

    def __init__(self, role: str, device: Any, injector: Injector) -> None:
        self.role, self.device, self.injector = role, device, injector
        self.name: str = getattr(device, "name", role)

    def connect(self) -> None:
        """Connect the device."""
        self._off_by("connect")

    def close(self) -> None:
        """Release the device."""
        self._off_by("close")

    def _call(self, method: str, *arguments: Any) -> Any:
        """Call the device, where there is one."""
        return None if self.device is None else getattr(self.device, method)(*arguments)

    def _off_by(self, method: str) -> None:
        """Call a method after which the output is off."""
        acts = self.injector.meet(f"{self.role}.{method}")
        if acts != "lies":
            self._call(method)
            self.injector.write(self.role, 0.0)


class _TriedOutput(_Tried):
    """A drive or a motor."""

    def __getattr__(self, name: str) -> Any:
        if name not in _BY_DEVICE or not hasattr(self.__dict__.get("device"), name):
            raise AttributeError(name)
        return self._halt if name == "halt" else getattr(self.device, name)

    def off(self) -> None:
        """Switch the output off."""
        self._off_by("off")

    def close(self) -> None:
        """Release the device, which a device that lies does not switch off either."""
        if self.injector.fault.is_lie and self.injector.fault.role == self.role:
            self.injector.meet(f"{self.role}.close")
        else:
            super().close()

    def _halt(self) -> None:
        """Switch the output off whatever it is at work on."""
        self._call("halt")
        self.injector.write(self.role, 0.0)

    def _set(self, method: str, value: float, argument: Any) -> None:
        """Set the output."""
        self.injector.meet(f"{self.role}.{method}")
        self.injector.write(self.role, value)
        self._call(method, argument)


class _TriedDrive(_TriedOutput):
    """A source of the drive voltage."""

    voltage_maximum: float

    def drive(self, setting: DriveSetting) -> None:
        """Set the output."""
        self._set("drive", setting.voltage_peak_to_peak, setting)


class _TriedMotor(_TriedOutput):
    """A motor of the disc."""

    rotation_speed_maximum: float

    def turn(self, rotation_speed: float) -> None:
        """Set the speed."""
        self._set("turn", rotation_speed, rotation_speed)


class _TriedInputs(_Tried):
    """Inputs; those that are pretended read one value at the rate asked for."""

    channels: Mapping[str, Channel]

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        """Start to sample."""
        acts = self.injector.meet("acquisition.start")
        asked = sample_rate / (10 if acts == "slowly" else 1)
        self._count, self._next, self._began, self._rate = len(channels), 0, time.monotonic(), asked
        if self.device is None:
            return asked
        return float(self.device.start(channels, sample_rate=asked))

    def read(self, samples: int) -> Block:
        """Next samples, which the fault may have made wrong."""
        acts = self.injector.meet("acquisition.read")
        block = self._pretended(samples) if self.device is None else self.device.read(samples)
        values = block.values
        if acts == "doubled":
            values = np.concatenate([values, values], axis=1)
        elif acts == "longer":
            values = np.concatenate([values, values])
        elif acts in ("whole numbers", "infinity"):
            values = np.full_like(values, -32768 if acts == "whole numbers" else np.inf)
            values = values.astype(np.int16) if acts == "whole numbers" else values
        return Block(
            first_sample=block.first_sample - (samples if acts == "stale" else 0),
            sample_rate=block.sample_rate / (10 if acts == "slowly" else 1),
            values=values,
        )

    def stop(self) -> None:
        """Stop to sample."""
        self.injector.meet("acquisition.stop")
        self._call("stop")

    def _pretended(self, samples: int) -> Block:
        first, self._next = self._next, self._next + samples
        time.sleep(max(0.0, self._next / self._rate - (time.monotonic() - self._began)))
        return Block(first_sample=first, sample_rate=self._rate, values=np.full((samples, self._count), _READING))


class _TriedEntry(DriverEntry):
    """Section of a device that is tried.

    Parameters
    ----------
    driver : str
    trial : str
        JSON: log and fault, and module, class and section of the driver where it is not pretended.
    """

    driver: Literal["tried"]
    trial: str

    @cached_property
    def content(self) -> Mapping[str, Any]:
        """What the trial says."""
        found: dict[str, Any] = json.loads(self.trial)
        return found

    @cached_property
    def injector(self) -> Injector:
        """Log and fault."""
        return Injector.of(self.content)

    @cached_property
    def entry(self) -> Any:
        """Section of the driver; None where the device is pretended."""
        if "class" not in self.content:
            return None
        driver: type[DriverEntry] = getattr(import_module(self.content["module"]), self.content["class"])
        return driver.model_validate(self.content["section"])

    @property
    def is_answered(self) -> bool:
        """Whether the device of the driver takes the calls."""
        return self.entry is not None and not self.content["pretended"]

    @property
    def where(self) -> str:
        """Address of the device."""
        return "log" if self.entry is None else str(self.entry.where)

    @property
    def reserved_as(self) -> str:
        """Name of the device by which it is reserved."""
        return self.content["role"] if self.entry is None else str(self.entry.reserved_as)


class TriedAcquisitionEntry(_TriedEntry, AcquisitionEntry):
    """Section of inputs."""

    @property
    def channel_entries(self) -> Sequence[ChannelEntry]:
        """Channels of the driver; one of the friction force where it is pretended."""
        found: Sequence[ChannelEntry] = (
            (ChannelEntry(name="friction_force"),) if self.entry is None else self.entry.channel_entries
        )
        return found

    @property
    def total_rate_maximum(self) -> float:
        """Of the driver. [Hz]"""
        return super().total_rate_maximum if self.entry is None else float(self.entry.total_rate_maximum)

    def new_device(self, files: Mapping[str, str]) -> _TriedInputs:
        """Inputs, not connected."""
        device = None if self.entry is None else self.entry.new_device(files)
        tried = _TriedInputs("acquisition", device if self.is_answered else None, self.injector)
        known = [each.channel(lowest=-10.0, highest=10.0) for each in self.channel_entries]
        tried.channels = {each.name: each for each in known} if device is None else device.channels
        return tried


class TriedDriveEntry(_TriedEntry, DriveEntry):
    """Section of a source of the drive voltage."""

    @property
    def highest_frequency(self) -> float:
        """Of the driver. [Hz]"""
        return super().highest_frequency if self.entry is None else float(self.entry.highest_frequency)

    def new_device(self) -> _TriedDrive:
        """Source, not connected."""
        device = None if self.entry is None else self.entry.new_device()
        tried = _TriedDrive("drive", device if self.is_answered else None, self.injector)
        tried.voltage_maximum = self.limits.voltage_maximum if device is None else device.voltage_maximum
        return tried


class TriedMotorEntry(_TriedEntry, MotorEntry):
    """Section of a motor of the disc."""

    def new_device(self) -> _TriedMotor:
        """Motor, not connected."""
        device = None if self.entry is None else self.entry.new_device()
        tried = _TriedMotor("motor", device if self.is_answered else None, self.injector)
        tried.rotation_speed_maximum = self.rotation_speed_maximum if device is None else device.rotation_speed_maximum
        return tried
