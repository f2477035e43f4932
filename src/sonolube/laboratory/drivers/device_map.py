"""Device maps: which hardware a rig has, how it is wired, and what it stands; TOML with all faults told at once."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from pydantic import ValidationError

from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.laboratory.devices import Devices, DriveSource, Motor
from sonolube.laboratory.drivers.daqmx_acquisition import AnalogueInput, DaqmxAcquisition
from sonolube.laboratory.drivers.daqmx_output import SAMPLES_PER_PERIOD, DaqmxDrive, DaqmxMotor
from sonolube.laboratory.drivers.entries import (
    TERMINATIONS,
    ChannelEntry,
    DaqmxDriveEntry,
    DaqmxMotorEntry,
    ExchangeEntry,
    GeneratorEntry,
    LineMotorEntry,
    MapEntries,
)
from sonolube.laboratory.drivers.function_generator import FunctionGenerator
from sonolube.laboratory.drivers.line_motor import Exchange, LineMotor, LineProtocol
from sonolube.laboratory.drivers.output_limits import DriveLimits
from sonolube.laboratory.drivers.resources import daqmx_resource, visa_resource
from sonolube.laboratory.drivers.sensor_scale import SensorScale, tabulated_scale
from sonolube.laboratory.drivers.visa_connection import VisaConnection
from sonolube.toml_text import text_of, toml_content
from sonolube.units import format_si

_KIND: Final = "a device map"
_MOST_FAULTS: Final = 20
_LONGEST_FAULT: Final = 300  # characters


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
        drivers = (self.entries.acquisition.driver, self.entries.drive.driver, self.entries.motor.driver)
        return tuple(sorted({_EXTRA_OF[driver] for driver in drivers}))

    @property
    def frequency_maximum(self) -> float:
        """Of the drive. [Hz]"""
        return self._drive_limits.frequency_maximum

    def devices(self) -> Devices:
        """Devices of the rig; nothing is connected yet.

        Returns
        -------
        Devices
        """
        return Devices(
            acquisition=self._acquisition(),
            drive=self._drive(),
            motor=self._motor(),
            description=MappingProxyType(self._description()),
            groove_diameter=self.entries.motor.groove_diameter,
            resources=self._resources(),
        )

    def _acquisition(self) -> DaqmxAcquisition:
        """Analogue inputs."""
        entry = self.entries.acquisition
        inputs = [
            AnalogueInput(
                name=each.name,
                terminal=f"{entry.device}/{each.input}",
                voltage_range=each.input_range,
                scale=_scale(each, self.files),
                wiring=each.wiring,
            )
            for each in entry.channels
        ]
        return DaqmxAcquisition(device=entry.device, inputs=inputs, sample_rate_maximum=entry.sample_rate_maximum)

    def _drive(self) -> DriveSource:
        """Source of the drive voltage."""
        entry, limits = self.entries.drive, self._drive_limits
        if isinstance(entry, DaqmxDriveEntry):
            return DaqmxDrive(terminal=entry.output, sample_rate=entry.sample_rate, limits=limits)
        line = VisaConnection(
            name=f"function generator {entry.resource}", resource=entry.resource, library=entry.visa_library
        )
        return FunctionGenerator(line, output=entry.output, limits=limits)

    def _motor(self) -> Motor:
        """Motor of the disc."""
        entry = self.entries.motor
        if isinstance(entry, DaqmxMotorEntry):
            return DaqmxMotor(
                terminal=entry.output,
                rotation_speed_maximum=entry.rotation_speed_maximum,
                voltage_at_maximum=entry.voltage_at_maximum,
            )
        line = VisaConnection(
            name=f"motor {entry.resource}",
            resource=entry.resource,
            library=entry.visa_library,
            termination=TERMINATIONS[entry.termination],
            baud_rate=entry.baud_rate,
        )
        return LineMotor(line, protocol=_line_protocol(entry), rotation_speed_maximum=entry.rotation_speed_maximum)

    @property
    def _drive_limits(self) -> DriveLimits:
        """What amplifier, output and actuator stand."""
        entry = self.entries.drive
        highest = entry.frequency_maximum
        if isinstance(entry, DaqmxDriveEntry):
            highest = min(highest, entry.sample_rate / SAMPLES_PER_PERIOD)
        return DriveLimits(
            amplifier_gain=entry.amplifier_gain,
            actuator_voltage=entry.voltage_maximum,
            output_voltage=entry.output_maximum,
            frequency_maximum=highest,
        )

    def _resources(self) -> tuple[str, ...]:
        """Canonical names of the hardware."""
        drive, motor = self.entries.drive, self.entries.motor
        named = [
            daqmx_resource(self.entries.acquisition.device),
            visa_resource(drive.resource) if isinstance(drive, GeneratorEntry) else daqmx_resource(drive.output),
            visa_resource(motor.resource) if isinstance(motor, LineMotorEntry) else daqmx_resource(motor.output),
        ]
        return tuple(dict.fromkeys(named))

    def _description(self) -> dict[str, str]:
        """Kind, serial number and settings of each device."""
        entries = self.entries
        drive, motor = entries.drive, entries.motor
        place = drive.resource if isinstance(drive, GeneratorEntry) else drive.output
        where = motor.resource if isinstance(motor, LineMotorEntry) else motor.output
        gain, most = f"{drive.amplifier_gain:g}", format_si(drive.voltage_maximum, "V")
        channels = (
            f"{each.name} {each.input} {each.calibration or each.gain} +-{format_si(each.input_range, 'V')}"
            for each in entries.acquisition.channels
        )
        told = {
            "rig": entries.title,
            "acquisition": f"NI-DAQmx {entries.acquisition.device}: {'; '.join(channels)}",
            "acquisition hardware": entries.acquisition.description,
            "drive": f"{drive.driver} {place}, amplifier {gain} V/V, at most {most} at the actuator",
            "drive hardware": drive.description,
            "amplifier": drive.amplifier,
            "motor": f"{motor.driver} {where}, at most {format_si(motor.rotation_speed_maximum, '1/s')}",
            "motor hardware": motor.description,
        }
        return {key: text for key, text in told.items() if text}


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


_EXTRA_OF: Final = {"daqmx": "daqmx", "scpi": "visa", "line": "visa"}


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
    rest = max(len(faults) - _MOST_FAULTS, 0)
    return SeveralFaults(faults[:_MOST_FAULTS], rest=rest, keys=keys[:_MOST_FAULTS])


def _place(parts: Sequence[str | int]) -> str:
    """Key of a fault, such as "acquisition.channels[2].gain: "; channels count from 1."""
    keys = ""
    for number, part in enumerate(parts):
        if isinstance(part, int):
            keys += f"[{part + 1}]"
        elif not (number == 1 and part in _EXTRA_OF):  # the tag by which the driver was found
            keys += f".{part}"
    return f"{keys.removeprefix('.')}: ".removeprefix(": ")


def _reason(kind: str, message: str) -> str:
    """Reason of a fault in plain words."""
    known = {
        "extra_forbidden": "unknown key",
        "missing": "missing",
        "union_tag_not_found": "driver is missing: scpi or daqmx for the drive, line or daqmx for the motor",
        "union_tag_invalid": "driver must be scpi or daqmx for the drive, line or daqmx for the motor",
    }
    return known.get(kind, message.removeprefix("Value error, ").strip())


def _read_calibrations(entries: MapEntries, folder: Path, files: dict[str, str]) -> list[str]:
    """Add the texts of calibrations to the files, and return what is wrong with them."""
    faults = []
    for number, channel in enumerate(entries.acquisition.channels, start=1):
        if channel.calibration is None:
            continue
        try:
            if Path(channel.calibration).name != channel.calibration or channel.calibration in ("..", "."):
                raise InvalidInput("must be the name of a file beside the map")
            files.setdefault(channel.calibration, text_of(folder / channel.calibration, kind="a calibration"))
            _scale(channel, files)
        except InvalidInput as refusal:
            faults.append(f"acquisition.channels[{number}].calibration: {channel.calibration}: {refusal}")
    return faults


def _scale(channel: ChannelEntry, files: Mapping[str, str]) -> SensorScale:
    """Scale of the sensor of a channel."""
    if channel.calibration is None:
        return channel.linear_scale
    return tabulated_scale(files[channel.calibration], quantity=channel.quantity)


def _line_protocol(entry: LineMotorEntry) -> LineProtocol:
    """How the controller of a motor is spoken to."""
    query = None
    if entry.query is not None and entry.query_answer is not None:
        query = Exchange(command=entry.query, answer=entry.query_answer)
    return LineProtocol(
        speed=Exchange(command=entry.speed_command, answer=entry.speed_answer),
        stop=Exchange(command=entry.stop_command, answer=entry.stop_answer),
        speed_unit=entry.speed_unit,
        at_connect=tuple(_exchange(each) for each in entry.at_connect),
        query=query,
        decimals=entry.decimals,
    )


def _exchange(entry: ExchangeEntry) -> Exchange:
    """A command and its answer."""
    return Exchange(command=entry.command, answer=entry.answer)
