"""Devices of a device map on a virtual rig: its acquisitions, drive and motor with their limits, and faults by name."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import UnknownName
from sonolube.facts.protocol import Protocol
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.devices import DeviceError, Devices, DriveSetting
from sonolube.laboratory.drivers.device_map import DeviceMap
from sonolube.laboratory.drivers.entry import DriveEntry, MotorEntry, require_speed
from sonolube.laboratory.drivers.scpi_instruments import CHECKED
from sonolube.laboratory.heating_assumptions import HeatingAssumptions
from sonolube.laboratory.rehearsal.faults import SLOW_SHARE, ActiveFaults, Fault, faults_named
from sonolube.laboratory.rehearsal.sources import SimulatedChannel, generator_of, source_of
from sonolube.laboratory.virtual_tribometer import Disturbances
from sonolube.laboratory.virtual_tribometer.pace import ExpectedTime, expected_time
from sonolube.laboratory.virtual_tribometer.simulation import VirtualRig
from sonolube.laboratory.virtual_tribometer.streams import Source, Stream
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.rig import Rig
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr


def rehearsal(
    device_map: DeviceMap,
    rig: Rig,
    protocol: Protocol,
    *,
    seed: int,
    faults: Sequence[str] = (),
    disturbances: Disturbances | None = None,
    evidence: EvidencePosterior | None = None,
) -> "Rehearsal":
    """Devices of a device map on a virtual rig.

    Parameters
    ----------
    device_map : DeviceMap
        Nothing of it is connected, and no library of an instrument is imported.
    rig : Rig
        With a drive.
    protocol : Protocol
        Whose groove and place of the thermocouple the rig has.
    seed : int
        Of everything that is drawn.
    faults : sequence of str
        Names of `FAULTS`, each with the time from which on it acts, such as overload_trip@2s.
    disturbances : Disturbances, optional
        Of tests with the rig; the usual ones by default.
    evidence : EvidencePosterior, optional
        Posterior that friction is drawn from, in place of the shipped one.

    Returns
    -------
    Rehearsal

    Raises
    ------
    InvalidInput
        If a fault is unknown, or the rig does not slide, does not vibrate or has no drive.
    """
    active = ActiveFaults(faults_named(faults))
    heating = HeatingAssumptions()
    diameter = protocol.metadata.groove_diameter or device_map.entries.motor.groove_diameter
    virtual = VirtualRig(rig, seed, disturbances or Disturbances(), heating, diameter, False, evidence=evidence)
    known, told = device_map.devices(), list[SimulatedChannel]()
    inputs: dict[str, _Inputs] = {}
    entries = {"": device_map.entries.acquisition, **device_map.entries.acquisitions}
    for clock, entry in entries.items():
        device = known.acquisition if not clock else known.further[clock]
        sources: dict[str, Source] = {}
        for each in entry.channel_entries:
            sources[each.name], said = source_of(
                entry,
                each,
                device.channels[each.name],
                clock=clock,
                files=device_map.files,
                thermocouple=protocol.metadata.thermocouple,
                ambient_temperature=heating.ambient_temperature,
                seed=seed,
                active=active,
            )
            told.append(said)
        stream = Stream(sources, partial(generator_of, seed))
        name, most = f"virtual {device.name}", entry.total_rate_maximum
        kind = _Beside if clock else _Inputs
        inputs[clock] = kind(virtual, stream, name=name, channels=device.channels, highest=most, active=active)
    main = inputs.pop("")
    virtual.replace_main(main.stream)
    drive = _Drive(virtual, device_map.entries.drive, name=f"virtual {known.drive.name}", active=active)
    motor = _Motor(virtual, device_map.entries.motor, name=f"virtual {known.motor.name}", active=active)
    for fault in active.faults:
        virtual.at(fault.from_time, partial(_begin, fault.name, active, drive, motor))
    description = {
        **known.description,
        "virtual": f"the map on the virtual rig {rig.title}, seed {seed}",
        "not simulated": "; ".join(each.name for each in told if not each.is_simulated),
        "faults": "; ".join(fault.described for fault in active.faults),
    }
    devices = Devices(
        acquisition=main,
        drive=drive,
        motor=motor,
        description=MappingProxyType({key: text for key, text in description.items() if text}),
        groove_diameter=device_map.entries.motor.groove_diameter,
        simulated=True,
        rehearsed=True,
        prepare=virtual.prepare,
        attend=virtual.attend,
        clock=virtual.clock,
        further=MappingProxyType(inputs),
    )
    return Rehearsal(devices, tuple(told), active.faults, virtual, diameter)


class Rehearsal:
    """Devices of a device map on a virtual rig; made by `rehearsal`.

    Parameters
    ----------
    devices : Devices
    channels : tuple of SimulatedChannel
        What each channel reads.
    faults : tuple of Fault
    virtual : VirtualRig
    groove_diameter : float
        Of the circle under the pin. [m]
    """

    def __init__(
        self,
        devices: Devices,
        channels: tuple[SimulatedChannel, ...],
        faults: tuple[Fault, ...],
        virtual: VirtualRig,
        groove_diameter: float,
    ) -> None:
        self.devices, self.channels, self.faults = devices, channels, faults
        self._virtual, self._diameter = virtual, groove_diameter

    def expected_time(self, protocol: Protocol) -> ExpectedTime:
        """Time that a protocol is expected to take, by a few blocks of all acquisitions and a few set points.

        Parameters
        ----------
        protocol : Protocol

        Returns
        -------
        ExpectedTime
        """
        channels = tuple(self.devices.acquisition.channels)
        known = [each for each in self.devices.further.values() if isinstance(each, _Beside)]
        beside = [(each.stream, next(iter(each.channels.values())).sample_rate or 0.0) for each in known]
        return expected_time(self._virtual, protocol, channels=channels, groove_diameter=self._diameter, beside=beside)

    def truth(self) -> "xr.Dataset":
        """Truth of the recording, as that of a virtual tribometer, with deviations of calibrations and faults.

        Returns
        -------
        xarray.Dataset
            With a number `CHANNEL_deviation` for each channel of stated uncertainty, in its unit.
        """
        found = self._virtual.truth()
        channels = self.devices.channels
        for each in self.channels:
            if each.error:
                found[f"{each.name}_deviation"] = ((), each.error, {"units": channels[each.name].unit or "1"})
        return found.assign_attrs(faults="; ".join(fault.described for fault in self.faults))

    @property
    def caveats(self) -> tuple[str, ...]:
        """Faults, and channels that read their value at rest."""
        resting = (each.described for each in self.channels if not each.is_simulated)
        return (*(f"fault {fault.described}" for fault in self.faults), *(f"not simulated, {each}" for each in resting))


def _begin(name: str, active: ActiveFaults, drive: "_Drive", motor: "_Motor") -> None:
    """Let a fault act from now on."""
    active.begin(name)
    drive.apply()
    motor.apply()


class _Device:
    """A device of a rehearsal, which does nothing before it is connected."""

    def __init__(self, virtual: VirtualRig, *, name: str, active: ActiveFaults) -> None:
        self.name, self._virtual, self._active = name, virtual, active
        self._is_connected = False

    def connect(self) -> None:
        """Connect with everything off."""
        self._is_connected = True
        self.off()

    def off(self) -> None:
        """Switch off."""

    def close(self) -> None:
        """Switch off and disconnect."""
        self.off()
        self._is_connected = False

    def _require_connected(self) -> None:
        """Raise DeviceError before `connect`."""
        if not self._is_connected:
            raise DeviceError(f"{self.name}: is not connected; call connect first")


class _Inputs(_Device):
    """Acquisition whose clock is that of protocols."""

    def __init__(
        self,
        virtual: VirtualRig,
        stream: Stream,
        *,
        name: str,
        channels: Mapping[str, Channel],
        highest: float,
        active: ActiveFaults,
    ) -> None:
        super().__init__(virtual, name=name, active=active)
        self.channels, self.stream, self._highest = channels, stream, highest
        self._former: Block | None = None

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        """Start to sample from sample 0 on, and return the sample rate. [Hz]"""
        self._require_connected()
        for name in channels:
            if name not in self.channels:
                raise DeviceError(f"{self.name}: {UnknownName.among(self.channels, kind='channel', name=name)}")
        if not channels or len(set(channels)) < len(channels):
            told = ", ".join(channels) or "none"
            raise DeviceError(f"{self.name}: needs at least one channel, each once, got {told}")
        if not 0 < sample_rate * len(channels) <= self._highest * (1 + 1e-9):
            wanted, most = format_si(sample_rate, "Hz"), format_si(self._highest / len(channels), "Hz")
            raise DeviceError(f"{self.name}: {wanted} refused; it samples {len(channels)} channels at up to {most}")
        given = sample_rate * (SLOW_SHARE if self._active.acts("slow_sampling") else 1.0)
        self._former = None
        self._begin(channels, given)
        return given

    def read(self, samples: int) -> Block:
        """Next samples."""
        former = self._former
        if former is not None and self._active.takes_stale():
            return former
        self._former = self._next(samples)
        return self._former

    def stop(self) -> None:
        """Stop to sample."""
        self._virtual.stop()

    def off(self) -> None:
        """Stop to sample."""
        self.stop()

    def _begin(self, channels: Sequence[str], rate: float) -> None:
        """Begin to sample at a rate, in Hz."""
        self._virtual.start(channels, rate)

    def _next(self, samples: int) -> Block:
        """Samples that follow."""
        return self._virtual.read(samples)


class _Beside(_Inputs):
    """Acquisition with a clock of its own, whose samples come as the time of the virtual rig goes on."""

    def _begin(self, channels: Sequence[str], rate: float) -> None:
        """Begin to sample at a rate, in Hz."""
        self._taken: list[Floats] = []
        self._read, self._rate = 0, rate
        self._follower: Callable[[], None] = lambda: None
        self._virtual.start_beside(self.stream, channels, rate, self._take)

    def follow(self, take: Callable[[], None]) -> None:
        """Call a function whenever samples were taken."""
        self._follower = take

    @property
    def waiting(self) -> int:
        """Samples that were taken and not read."""
        return sum(len(each) for each in self._taken)

    def stop(self) -> None:
        """Stop to sample."""
        self._virtual.stop_beside(self.stream)

    def _take(self, values: Floats) -> None:
        """Keep samples until they are read."""
        self._taken.append(values)
        self._follower()

    def _next(self, samples: int) -> Block:
        """Samples that follow."""
        if self.waiting < samples:
            raise DeviceError(f"{self.name}: has not taken {samples} samples yet; they come with those of the run")
        together = np.concatenate(self._taken)
        self._taken = [together[samples:]]
        first, self._read = self._read, self._read + samples
        return Block(first_sample=first, sample_rate=self._rate, values=together[:samples])


class _Drive(_Device):
    """Source of the drive voltage with the limits of its section."""

    def __init__(self, virtual: VirtualRig, entry: DriveEntry, *, name: str, active: ActiveFaults) -> None:
        super().__init__(virtual, name=name, active=active)
        self._limits = entry.limits
        self.voltage_maximum = self._limits.voltage_maximum
        untold = entry.not_read_back
        self._reads_back = () if "anything" in untold else tuple(each for each in CHECKED if each not in untold)
        self._setting: DriveSetting | None = None

    def drive(self, setting: DriveSetting) -> None:
        """Set the output; where a read-back tells a fault, it ends off."""
        amplitude, _ = self._limits.output_of(setting, device=self.name)
        self._require_connected()
        if amplitude == 0:
            self.off()
            return
        try:
            self.read_back()
        except DeviceError:
            self.off()
            raise
        self._setting = setting
        self.apply()

    def read_back(self) -> str:
        """Nothing, or a DeviceError where what the map reads back tells a fault."""
        told = self._active.told_by(self._reads_back)
        if told:
            raise DeviceError(f"{self.name}: tells another {told[0].told_by} than was set up ({told[0].effect})")
        return ""

    def off(self) -> None:
        """Switch the output off."""
        if not self._active.acts("off_ignored"):
            self._setting = None
            self.apply()

    def apply(self) -> None:
        """Set the rig as setting and faults say."""
        distortion = self._active.distortion(self._setting)
        if distortion != self._virtual.distortion:
            self._virtual.distort(distortion)
        self._virtual.drive(self._setting)


class _Motor(_Device):
    """Motor with the limits of its section."""

    def __init__(self, virtual: VirtualRig, entry: MotorEntry, *, name: str, active: ActiveFaults) -> None:
        super().__init__(virtual, name=name, active=active)
        self.rotation_speed_maximum = entry.rotation_speed_maximum
        self._speed = 0.0

    def turn(self, rotation_speed: float) -> None:
        """Set the speed of the disc, 0 to stop. [1/s]"""
        require_speed(rotation_speed=rotation_speed, highest=self.rotation_speed_maximum, device=self.name)
        self._require_connected()
        self._speed = rotation_speed
        self.apply()

    def off(self) -> None:
        """Stop."""
        self._speed = 0.0
        self.apply()

    def apply(self) -> None:
        """Set the rig as speed and faults say."""
        self._virtual.turn(0.0 if self._active.acts("motor_stalls") else self._speed)
