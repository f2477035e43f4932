"""Plan of a run: set points held to limits, its rig and devices, and the reservation of these for one user."""

import hashlib
import json
import os
import platform
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from itertools import chain, pairwise
from math import pi
from pathlib import Path
from typing import Any, Final

from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.facts.protocol import Check, Metadata, Protocol, SetPoint, flattened, protocol_text, step_at
from sonolube.laboratory.devices import DeviceError, Devices, DriveSetting
from sonolube.laboratory.interlocks import RunLimits, drive_sampling, idle_rate, recorded_channels, run_limits
from sonolube.laboratory.records import UNRESOLVED, RunRecorder, new_run
from sonolube.laboratory.supervision import LATE
from sonolube.operating_system import home_folder, process_start, remove_file
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.rig import Rig
from sonolube.rig.file.rig_folder import rig_file
from sonolube.storage.files import is_locked, locked_folder, write_atomically
from sonolube.storage.user_files import input_text
from sonolube.text.units import format_si
from sonolube.vocabulary import unit_of

SPEED_CHANNEL: Final = "rotation_speed"
"""Channel that measures the speed of the disc."""

SETTLING: Final = 5.0
"""Time that a measured speed has to come within its bounds. [s]"""

SPEEDS: Final = ("rotation_speed", "sliding_speed")
"""Quantities that follow from the speed of the disc."""

_AS_SET: Final = f"as it is set: no channel {SPEED_CHANNEL} measures it"


@dataclass(frozen=True, kw_only=True, slots=True)
class CheckedValue:
    """Value of a checked quantity.

    Parameters
    ----------
    check : Check
    value : float or None
        In SI; None where nothing tells it.
    is_set : bool
        Whether it is the set point, which nothing measures.
    """

    check: Check
    value: float | None
    is_set: bool = False

    @property
    def holds(self) -> bool:
        """Whether it lies within the bounds."""
        low, high = self.check.bounds
        return self.value is not None and low <= self.value <= high

    @property
    def facts(self) -> dict[str, str | float]:
        """Facts that a record keeps of a check that holds."""
        assert self.value is not None
        return {"quantity": self.check.quantity, "value": self.value, **({"basis": _AS_SET} if self.is_set else {})}

    @property
    def reason(self) -> str:
        """Why it does not hold."""
        check = self.check
        bounds = f"{check.lowest or 'any'} to {check.highest or 'any'}"
        if self.value is None:
            return f"check of {check.quantity}: no channel measures it; wanted {bounds}"
        basis = f" ({_AS_SET})" if self.is_set else ""
        return f"check of {check.quantity}: {format_si(self.value, unit_of(check.quantity))}{basis}, wanted {bounds}"


def speed_checks(protocol: Protocol) -> tuple[str, ...]:
    """Steps that check a speed; each place once."""
    checks = {point.step: step_at(protocol, point.step) for point in flattened(protocol) if point.kind == "check"}
    return tuple(place for place, step in checks.items() if isinstance(step, Check) and step.quantity in SPEEDS)


_ROUNDING: Final = 1 + 1e-9


@dataclass(frozen=True, kw_only=True)
class RunPlan:
    """A protocol on devices: what every part of a run asks of it, worked out once.

    Parameters
    ----------
    protocol : Protocol
    points : tuple of SetPoint
        In the order of time.
    limits : RunLimits
    groove_diameter : float
        Diameter of the circle under the pin. [m]
    """

    protocol: Protocol
    points: tuple[SetPoint, ...]
    limits: RunLimits
    groove_diameter: float

    @property
    def idle_rate(self) -> float:
        """Sample rate where nothing is recorded. [Hz]"""
        return idle_rate(self.points)

    @property
    def first_setting(self) -> DriveSetting | None:
        """First output of the drive source; None without one."""
        return next(filter(None, map(drive_setting, self.points)), None)


def planned_run(protocol: Protocol, devices: Devices) -> RunPlan:
    """Plan of a protocol on devices, before anything is connected.

    Parameters
    ----------
    protocol : Protocol
    devices : Devices

    Returns
    -------
    RunPlan

    Raises
    ------
    InvalidInput
        With all that `impossibilities` finds.
    """
    faults = impossibilities(protocol, devices)
    if faults:
        raise InvalidInput(faults[0]) if len(faults) == 1 else SeveralFaults(faults)
    return RunPlan(
        protocol=protocol,
        points=tuple(flattened(protocol)),
        limits=run_limits(protocol.limits, devices, drive_sampling(protocol)),
        groove_diameter=groove_diameter(protocol, devices),
    )


def impossibilities(protocol: Protocol, devices: Devices) -> tuple[str, ...]:
    """Everything that a protocol asks for and devices cannot give.

    Parameters
    ----------
    protocol : Protocol
    devices : Devices

    Returns
    -------
    tuple of str
        Limits that no channel can watch; then of each step the highest voltage and speed beyond the devices, and the
        channels that are missing.
    """
    unwatched: tuple[str, ...] = ()
    try:
        run_limits(protocol.limits, devices, drive_sampling(protocol))
    except InvalidInput as refusal:
        unwatched = refusal.faults if isinstance(refusal, SeveralFaults) else (str(refusal),)
    diameter, points = groove_diameter(protocol, devices), flattened(protocol)
    found = (_faults(point, before, devices, diameter) for before, point in pairwise((None, *points)) if point)
    return (*dict.fromkeys(unwatched), *highest_of_steps(chain.from_iterable(found)))


def highest_of_steps(found: Iterable[tuple[str, str, float, str]]) -> tuple[str, ...]:
    """Texts of faults by step, kind and value, of each step and kind the one with the highest value."""
    highest: dict[tuple[str, str], tuple[float, str]] = {}
    for step, kind, value, text in found:
        known = highest.get((step, kind))
        if known is None or value > known[0]:
            highest[step, kind] = (value, text)
    return tuple(text for _, text in highest.values())


def groove_diameter(protocol: Protocol, devices: Devices) -> float:
    """Diameter of the circle under the pin, of the protocol or else of the rig. [m]"""
    return protocol.metadata.groove_diameter or devices.groove_diameter


def rotation_speed(point: SetPoint, diameter: float) -> float:
    """Speed of the disc that a set point asks for. [1/s]"""
    if point.rotation_speed is not None:
        return point.rotation_speed
    return (point.sliding_speed or 0.0) / (pi * diameter)


def drive_setting(point: SetPoint) -> DriveSetting | None:
    """Output of the drive source that a set point asks for; none for off."""
    if point.frequency is None or point.voltage_peak_to_peak == 0:
        return None
    return DriveSetting(
        voltage_peak_to_peak=point.voltage_peak_to_peak,
        voltage_offset=point.voltage_offset,
        frequency=point.frequency,
        waveform=point.waveform,
    )


def _faults(
    point: SetPoint, before: SetPoint | None, devices: Devices, diameter: float
) -> Iterator[tuple[str, str, float, str]]:
    """Step, kind, value and text of what a set point changes to and devices cannot give."""
    place, drive, motor = f"step {point.step}", devices.drive, devices.motor
    volts = point.voltage_maximum
    if volts > drive.voltage_maximum * _ROUNDING and (before is None or volts != before.voltage_maximum):
        reached, most = format_si(volts, "V"), format_si(drive.voltage_maximum, "V")
        yield point.step, "voltage", volts, f"{place}: the drive reaches {reached}; {drive.name} gives at most {most}"
    turns, fastest = rotation_speed(point, diameter), motor.rotation_speed_maximum
    if turns > fastest * _ROUNDING and (before is None or turns != rotation_speed(before, diameter)):
        wanted, most = format_si(turns, "1/s"), format_si(fastest, "1/s")
        yield point.step, "speed", turns, f"{place}: needs {wanted}; {motor.name} turns at most at {most}"
    channels, acquisition = devices.channels, devices.acquisition
    missing = [name for name in point.channels if name not in channels]
    if missing and point.begins_recording:
        names = f"channel {missing[0]}" if len(missing) == 1 else f"channels {', '.join(missing)}"
        text = f"{place}: {acquisition.name} has no {names}; it has {', '.join(channels)}"
        yield point.step, "channels", 0.0, text
    elif point.begins_recording and all(name not in acquisition.channels for name in point.channels):
        yield point.step, "channels", 0.0, f"{place}: records no channel of {acquisition.name}; add one"


_ELSEWHERE: Final = ("pin_material", "disc_material", "normal_load", "groove_diameter")  # that a rig has too
_STATED: Final = tuple(name for name in Metadata.model_fields if name not in _ELSEWHERE)


@dataclass(frozen=True, kw_only=True)
class RunRequest:
    """A run that is wanted, and what its record says of it.

    Parameters
    ----------
    protocol : Protocol
    name : str
        Of the protocol.
    rig : Rig or None
    device_file : Path or None
        None for the virtual tribometer.
    seed : int
    tags : sequence of str
    facts : mapping of str to str or float
        What is known besides, such as operator, humidity or the date of a calibration; before those of the protocol.
    evidence : EvidencePosterior or None
        That a virtual rig draws its friction from, in place of the shipped posterior.
    """

    protocol: Protocol
    name: str
    rig: Rig | None
    device_file: Path | None = None
    seed: int = 0
    tags: Sequence[str] = ()
    facts: Mapping[str, str | float] = field(default_factory=dict)
    evidence: EvidencePosterior | None = None

    @property
    def evidence_caveats(self) -> tuple[str, ...]:
        """Own published tests that the friction of a virtual rig was learned from too."""
        return () if self.evidence is None or self.rig is None else self.evidence.caveats(self.rig.direction)


def begin_record(
    request: RunRequest,
    devices: Devices,
    limits: RunLimits,
    *,
    out: Path,
    facts: Mapping[str, str | float] | None = None,
) -> RunRecorder:
    """Begin the record of a run below a folder, with its files and what is known of it."""
    recorder = new_run(
        out,
        title=request.protocol.title,
        protocol=protocol_text(request.protocol),
        files=_files(request),
        facts=_facts(request, devices, limits) | dict(facts or {}),
    )
    if devices.switch_off is not None:
        devices.switch_off.folder = recorder.folder
    return recorder


def _files(request: RunRequest) -> dict[str, str]:
    """Texts of the files that the run was given, by the name under which they are kept."""
    rig = None if request.rig is None else request.rig.file
    given = {"rig.toml": None if rig is None else rig_file(rig), "devices.toml": request.device_file}
    return {name: input_text(path) for name, path in given.items() if path is not None}


def _facts(request: RunRequest, devices: Devices, limits: RunLimits) -> dict[str, str | float | int | bool]:
    """Facts of the run, for its record and the catalogue."""
    rig, metadata = request.rig, request.protocol.metadata
    facts: dict[str, str | float | int | bool] = {
        "protocol": request.name,
        "simulated": devices.simulated,
        **{f"device_{name.replace(' ', '_')}": text for name, text in devices.description.items()},
    }
    facts["late_maximum"] = LATE
    if unresolved := limits.unresolved(recorded_channels(request.protocol), devices.channels):
        facts[UNRESOLVED] = unresolved
    facts["groove_diameter"] = groove_diameter(request.protocol, devices)
    facts |= {name: text for name in _STATED if (text := getattr(metadata, name))} | dict(request.facts)
    if metadata.normal_load is not None:
        facts["normal_load"] = metadata.normal_load
    if request.tags:
        facts["tags"] = ", ".join(request.tags)
    if devices.simulated:
        facts["seed"] = request.seed
    if request.evidence_caveats:
        facts["evidence"] = "; ".join(request.evidence_caveats)
    if rig is not None:
        facts |= {
            "normal_load": facts.get("normal_load", rig.normal_load),
            "rig_title": rig.title,
            "nominal_area": rig.contact.nominal_area,
        }
        facts |= {name: value for name in ("pin_material", "disc_material") if (value := getattr(rig, name))}
        if rig.direction.word is not None:
            facts["vibration_direction"] = rig.direction.word
        if rig.changes:
            facts["changed_entries"] = "; ".join(rig.changes)
    if request.device_file is not None:
        facts["rig"] = request.device_file.stem
    return facts


LOCKS: Final = "SONOLUBE_DEVICE_LOCKS"
"""Variable of the environment that names another folder for the locks of devices."""

_HOLDER: Final = "holder.json"  # process that has a device
_LARGEST: Final = 10_000  # bytes of it


class DeviceInUse(DeviceError):
    """A device that another run has."""


@contextmanager
def reserved(resources: Sequence[str]) -> Iterator[None]:
    """Keep other runs of this user from devices inside a `with` block; a dead process keeps nobody out."""
    with ExitStack() as held:
        for resource in sorted(set(resources)):
            held.enter_context(_reserved(resource))
        yield


def require_free(resources: Sequence[str]) -> None:
    """Raise where a run has one of these devices."""
    with reserved(resources):
        pass


@contextmanager
def _reserved(resource: str) -> Iterator[None]:
    """Keep other runs from one device."""
    folder = _folder(resource)
    with ExitStack() as held:
        try:
            held.enter_context(locked_folder(folder, purpose="run"))
        except InvalidInput:
            if is_locked(folder):
                raise _in_use(resource, folder) from None
            raise
        if _is_alive(_holder(folder)):  # of a file system without locks
            raise _in_use(resource, folder)
        own = {"process": os.getpid(), "started": process_start(os.getpid()), "folder": str(Path.cwd())}
        write_atomically(folder / _HOLDER, json.dumps(own))
        held.callback(remove_file, folder / _HOLDER)
        yield


def _folder(resource: str) -> Path:
    """Folder of the lock of a device, which is one of this computer unless it is on the network."""
    place = "network" if resource.startswith("tcpip ") else platform.node() or "computer"
    words = re.sub(r"[^a-z0-9]+", "-", f"{place} {resource}".lower()).strip("-")[:80]
    digest = hashlib.sha256(f"{place} {resource}".encode()).hexdigest()[:8]  # of names with the same letters
    return _locks() / "devices" / f"{words}-{digest}"


def _locks() -> Path:
    """Folder of the locks of devices: one a user, wherever XDG_STATE_HOME of a shell or service has other states."""
    own = os.environ.get(LOCKS)
    return Path(own) if own else home_folder() / ".local" / "state" / "sonolube"


def _in_use(resource: str, folder: Path) -> DeviceInUse:
    """Refusal with the process that has a device."""
    holder = _holder(folder)
    process = holder.get("process")
    if not process:
        return DeviceInUse(f"{resource} is in use by another run; wait for its end")
    if not _is_alive(holder):
        return DeviceInUse(
            f"{resource} is in use by a program that process {process}, now dead, had started; see that motor and drive"
            " are off, and end it"
        )
    return DeviceInUse(f"{resource} is in use by another run: process {process}, started in {holder.get('folder')}")


def _holder(folder: Path) -> dict[str, Any]:
    """Process that has, or had, a device; empty where none is known."""
    with suppress(OSError, ValueError, RecursionError):
        found = json.loads((folder / _HOLDER).read_bytes()[:_LARGEST])
        if isinstance(found, dict) and isinstance(found.get("process"), int):
            return found
    return {}


def _is_alive(holder: dict[str, Any]) -> bool:
    """Whether the very process lives, and not a later one of the same number."""
    started = process_start(holder["process"]) if holder else ""
    return bool(started) and started == holder.get("started")
