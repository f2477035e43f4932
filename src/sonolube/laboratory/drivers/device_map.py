"""Device maps: hardware of a rig, its wiring and its limits, in TOML; all faults are reported at once."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, TypeVar

from pydantic import ValidationError

from sonolube.errors import InvalidInput, SeveralFaults, SonolubeError
from sonolube.laboratory.devices import Devices
from sonolube.laboratory.drivers.entry import AcquisitionEntry, DriverEntry
from sonolube.laboratory.drivers.map_entries import MapEntries
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

    @property
    def frequency_maximum(self) -> float:
        """Of the drive. [Hz]"""
        return self.entries.drive.highest_frequency

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
