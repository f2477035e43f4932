"""Device maps: hardware of a rig in TOML, all faults reported at once, and whether it is ready for a protocol.

It is not where packages or drivers are missing, a protocol demands more than the devices give, or one reads no block.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from math import ceil
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, TypeVar

from pydantic import ValidationError

from sonolube.errors import InvalidInput, SeveralFaults, SonolubeError
from sonolube.extras import EXTRAS
from sonolube.facts.protocol import Protocol, SetPoint, flattened
from sonolube.laboratory.devices import DeviceError, Devices
from sonolube.laboratory.drivers.daqmx_library import DRIVER_REMEDY, daqmx_errors, daqmx_library
from sonolube.laboratory.drivers.driver_table import MapEntries
from sonolube.laboratory.drivers.entry import AcquisitionEntry, DriverEntry
from sonolube.laboratory.run_plan import highest_of_steps, impossibilities, reserved
from sonolube.text.toml_text import text_of, toml_content
from sonolube.text.units import format_si

_KIND: Final = "a device map"
_MAX_FAULTS: Final = 20
_LONGEST_FAULT: Final = 300  # characters

_Device = TypeVar("_Device")


@dataclass(frozen=True, kw_only=True)
class DeviceMap:
    """Hardware of a rig.

    Parameters
    ----------
    entries : MapEntries
        Content of the file.
    files : mapping of str to str
        Texts of the map and of its calibrations by the names of their files, for the record of a run.
    """

    entries: MapEntries
    files: Mapping[str, str] = field(repr=False)

    @property
    def extras(self) -> tuple[str, ...]:
        """Optional parts of the installation that it needs, as in `EXTRAS`."""
        return tuple(sorted({extra for part in self.entries.parts for extra in part.extras}))

    def devices(self) -> Devices:
        """Devices of the rig; nothing is connected yet.

        Returns
        -------
        Devices

        Raises
        ------
        InvalidInput
            If a driver, such as one of another package, cannot make its device.
        """
        entries, guard = self.entries, self.entries.guard
        return Devices(
            acquisition=_made(entries.acquisition, partial(entries.acquisition.new_device, self.files)),
            drive=_made(entries.drive, entries.drive.new_device),
            motor=_made(entries.motor, entries.motor.new_device),
            description=MappingProxyType(self._description()),
            groove_diameter=entries.motor.groove_diameter,
            resources=tuple(dict.fromkeys(part.reserved_as for part in entries.parts if part.reserved_as)),
            guard=None if guard is None else _made(guard, partial(guard.new_device, entries.guarded)),
            further=MappingProxyType(
                {name: _made(each, partial(each.new_device, self.files)) for name, each in entries.acquisitions.items()}
            ),
        )

    def _description(self) -> dict[str, str]:
        """Kind, serial number and settings of each device."""
        entries = self.entries
        drive, motor = entries.drive, entries.motor
        gain, most = f"{drive.amplifier_gain:g}", format_si(drive.voltage_maximum, "V")
        told = {
            "rig": entries.title,
            "acquisition": entries.acquisition.described,
            "acquisition hardware": entries.acquisition.description,
            "drive": f"{drive.driver} {drive.where}, amplifier {gain} V/V, at most {most} at the actuator",
            "drive hardware": drive.description,
            "drive not read back": ", ".join(drive.not_read_back).replace("_", " "),
            "amplifier": drive.amplifier,
            "motor": f"{motor.driver} {motor.where}, at most {format_si(motor.rotation_speed_maximum, '1/s')}",
            "motor hardware": motor.description,
            "guard": "" if entries.guard is None else entries.guard.described,
        }
        for name, entry in entries.acquisitions.items():
            told[f"acquisition {name}"] = f"{entry.described}; {format_si(entry.own_rate or 0.0, 'Hz')}, own clock"
            told[f"acquisition {name} hardware"] = entry.description
        return {key: text for key, text in told.items() if text}


def _made(entry: DriverEntry, make: Callable[[], _Device]) -> _Device:
    """Device of a section."""
    try:
        return make()
    except SonolubeError:
        raise
    except Exception as failure:  # whatever a driver of another package raises
        told = (str(failure).strip().splitlines() or [""])[0][:120]
        name = f"{type(entry).__module__}.{type(entry).__name__}"
        raise InvalidInput(
            f"driver {entry.driver} ({name}) cannot make its device ({type(failure).__name__}: {told})"
        ) from None


def read_device_map(path: str | Path) -> DeviceMap:
    """Read a device map from a TOML file, with the calibrations that it names.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    DeviceMap

    Raises
    ------
    InvalidInput
        With the file, and every fault with its key.
    """
    path = Path(path)
    try:
        text = text_of(path, kind=_KIND)
        entries = _entries(toml_content(text))
        files = {path.name: text}
        faults = _read_calibrations(entries, path.parent, files)
    except SeveralFaults as refusal:
        raise refusal.at(str(path)) from None
    except InvalidInput as refusal:
        raise InvalidInput(f"{path}: {refusal}") from None
    if faults:
        raise _told(faults).at(str(path)) if len(faults) > 1 else InvalidInput(f"{path}: {faults[0]}")
    return DeviceMap(entries=entries, files=MappingProxyType(files))


def device_map_of(files: Mapping[str, str]) -> DeviceMap:
    """Device map from texts that were read before: that of the map, then those of its calibrations, by name."""
    return DeviceMap(entries=_entries(toml_content(next(iter(files.values())))), files=MappingProxyType(dict(files)))


def device_map_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) that every device map follows.

    Returns
    -------
    dict
    """
    content = {key: value for key, value in MapEntries.model_json_schema().items() if key != "title"}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "sonolube device map"} | content


def _entries(content: Mapping[str, Any]) -> MapEntries:
    """Sections of a file; refuses with all faults."""
    try:
        return MapEntries.model_validate(content)
    except ValidationError as refusal:
        found = refusal.errors(include_url=False, include_context=False, include_input=False)
        keys = [".".join(map(str, each["loc"])) for each in found]
        faults = [f"{_place(each['loc'])}{_reason(each['type'], each['msg'])}"[:_LONGEST_FAULT] for each in found]
    raise _told(faults, keys) if len(faults) > 1 else InvalidInput(faults[0], key=keys[0])


def _told(faults: Sequence[str], keys: Sequence[str] = ()) -> SeveralFaults:
    """Faults, as many as one can read."""
    rest = max(len(faults) - _MAX_FAULTS, 0)
    return SeveralFaults(faults[:_MAX_FAULTS], rest=rest, keys=keys[:_MAX_FAULTS])


def _place(parts: Sequence[str | int]) -> str:
    """Key of a fault, such as "acquisition.channels[2].gain: "; channels count from 1."""
    keys = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in parts)
    return f"{keys.removeprefix('.')}: ".removeprefix(": ")


def _reason(kind: str, message: str) -> str:
    """Reason of a fault in plain words."""
    known = {"extra_forbidden": "unknown key", "missing": "missing"}
    return known.get(kind, message.removeprefix("Value error, ").strip())


def _read_calibrations(entries: MapEntries, folder: Path, files: dict[str, str]) -> list[str]:
    """Add the texts of calibrations to the files, and return what is wrong with them."""
    faults = []
    for section, entry in entries.all_inputs.items():
        for key, name in entry.files_beside.items():
            try:
                _read_beside(entry, key, folder / name, files)
            except InvalidInput as refusal:
                faults.append(f"{section}.{key}: {name}: {refusal}")
    return faults


def _read_beside(entry: AcquisitionEntry, key: str, path: Path, files: dict[str, str]) -> None:
    """Add the text of a file beside the map to the files, held to what its key needs."""
    name = entry.files_beside[key]
    if Path(name).name != name or name in ("..", "."):
        raise InvalidInput("must be the name of a file beside the map")
    files.setdefault(name, text_of(path, kind="a calibration"))
    entry.check_file(key, files[name])


BLOCK_DURATION = 0.1
"""Of the first look. [s]"""


def missing_parts(device_map: DeviceMap) -> tuple[str, ...]:
    """Packages and drivers that a device map needs and that are not installed, each with its remedy.

    Parameters
    ----------
    device_map : DeviceMap

    Returns
    -------
    tuple of str
    """
    missing = [
        f"{EXTRAS[name].package} is not installed: {EXTRAS[name].command}"
        for name in device_map.extras
        if not EXTRAS[name].is_installed
    ]
    if "daqmx" in device_map.extras and EXTRAS["daqmx"].is_installed and not _has_daqmx_driver():
        missing.append(f"the driver NI-DAQmx is not installed: {DRIVER_REMEDY}")
    return tuple(missing)


def unfulfilled(device_map: DeviceMap, protocol: Protocol) -> tuple[str, ...]:
    """Demands of a protocol that the devices of a map cannot meet.

    Parameters
    ----------
    device_map : DeviceMap
    protocol : Protocol

    Returns
    -------
    tuple of str
        All of them, each with its step.
    """
    beyond = highest_of_steps(_beyond(device_map, flattened(protocol)))
    return (*impossibilities(protocol, device_map.devices()), *beyond)


def _beyond(device_map: DeviceMap, points: Sequence[SetPoint]) -> Iterator[tuple[str, str, float, str]]:
    """Step, kind, value and text of frequencies and sample rates beyond the devices of a map."""
    highest = device_map.entries.drive.highest_frequency
    further = device_map.entries.acquisitions.values()
    beside = {each.name for entry in further for each in entry.channel_entries}
    total = device_map.entries.acquisition.total_rate_maximum
    for point in points:
        place, frequency, rate = f"step {point.step}", point.frequency, point.sample_rate
        if frequency is not None and frequency > highest * (1 + 1e-9) and "drive" in point.sets:
            wanted, most = format_si(frequency, "Hz"), format_si(highest, "Hz")
            yield point.step, "frequency", frequency, f"{place}: drives at {wanted}; the drive gives at most {most}"
        count = sum(name not in beside for name in point.channels)
        if rate is not None and rate * count > total * (1 + 1e-9) and point.begins_recording:
            wanted = f"{count} channels at {format_si(rate, 'Hz')}"
            text = f"{place}: records {wanted}; the device takes {format_si(total, 'Hz')} in all"
            yield point.step, "rate", rate, text


def first_readings(devices: Devices, *, sample_rate: float) -> dict[str, float]:
    """Connect all devices, read one block of all channels with motor and drive off, and release the devices.

    Parameters
    ----------
    devices : Devices
    sample_rate : float
        Of each channel that has no rate of its own. [Hz]

    Returns
    -------
    dict of str to float
        Mean of each channel in SI.

    Raises
    ------
    DeviceError
        If a device is missing, does not answer or is in use by a run; the others are off and released then.
    """
    with reserved(devices.resources), ExitStack() as after:
        guarded = () if devices.guard is None else (devices.guard,)
        inputs = (devices.acquisition, *devices.further.values())
        for device in (*inputs, *guarded, devices.drive, devices.motor):
            after.callback(device.close)
            device.connect()
        devices.drive.off()
        devices.motor.off()
        means: dict[str, float] = {}
        for each in inputs:
            names = list(each.channels)
            rate = each.start(names, sample_rate=each.channels[names[0]].sample_rate or sample_rate)
            values = each.read(max(ceil(BLOCK_DURATION * rate), 1)).values.mean(axis=0)
            means |= {name: float(mean) for name, mean in zip(names, values, strict=True)}
        return means


def _has_daqmx_driver() -> bool:
    """Whether the driver of NI-DAQmx answers."""
    try:
        library = daqmx_library()
        with daqmx_errors("NI-DAQmx"):
            library.system.System.local().driver_version  # noqa: B018
    except (DeviceError, ImportError):
        return False
    return True
