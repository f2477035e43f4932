"""Drivers by the role of their device and their name, and the whole device map, whose sections they read.

Another package adds a driver by a section of a device map, in one file, and one line in its pyproject.toml::

    [project.entry-points."sonolube.drivers"]
    "drive.acme" = "acme_drive:AcmeDrive"

The name has the role first: acquisition, drive, motor or guard. Packages are looked up where a map names a driver that
sonolube does not have, and imported where a map names theirs.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from inspect import isabstract
from types import MappingProxyType
from typing import Annotated, Any, Final, Self, cast

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from sonolube.errors import InvalidInput
from sonolube.extras import EXTRAS
from sonolube.facts.protocol.quantity_text import Table
from sonolube.laboratory.drivers.entry import AcquisitionEntry, DriveEntry, DriverEntry, GuardEntry, MotorEntry
from sonolube.variants import VariantTable

GROUP: Final = "sonolube.drivers"
"""Group of entry points by which other packages add drivers."""


_OWN: Final = {  # drivers of sonolube, named as those of other packages
    "acquisition.daqmx": "sonolube.laboratory.drivers.daqmx_acquisition:DaqmxAcquisitionEntry",
    "acquisition.scpi_query": "sonolube.laboratory.drivers.scpi_instruments:ScpiQueryEntry",
    "drive.scpi": "sonolube.laboratory.drivers.function_generator:GeneratorEntry",
    "drive.daqmx": "sonolube.laboratory.drivers.daqmx_output:DaqmxDriveEntry",
    "drive.scpi_commands": "sonolube.laboratory.drivers.scpi_source:ScpiSourceEntry",
    "motor.line": "sonolube.laboratory.drivers.line_motor:LineMotorEntry",
    "motor.daqmx": "sonolube.laboratory.drivers.daqmx_output:DaqmxMotorEntry",
    "guard.daqmx": "sonolube.laboratory.drivers.daqmx_library:DaqmxGuardEntry",
}


class DriverTable(VariantTable[type[DriverEntry]]):
    """Drivers of one role by name.

    Parameters
    ----------
    role : str
        Of the devices, such as drive.
    base : type
        From which their sections of a device map derive.
    """

    def __init__(self, role: str, base: type) -> None:
        own = ((*name.split("."), place) for name, place in _OWN.items())
        super().__init__(f"driver of the {role}", {name: place for of, name, place in own if of == role})
        self.role, self._base = role, base

    def __getitem__(self, name: str) -> type[DriverEntry]:
        return super().__getitem__(name) if name in self._places else self._added(name)

    def __contains__(self, name: object) -> bool:
        return name in self._places or name in self.added

    def __iter__(self) -> Iterator[str]:
        return iter((*self._places, *(name for name in self.added if name not in self._places)))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    @property
    def own(self) -> tuple[str, ...]:
        """Names of those of sonolube."""
        return tuple(self._places)

    @property
    def added(self) -> dict[str, list[EntryPoint]]:
        """Entry points of other packages by the names of their drivers; nothing is imported."""
        found: dict[str, list[EntryPoint]] = {}
        for point in entry_points(group=GROUP):
            role, _, name = point.name.partition(".")
            if role == self.role and name:
                found.setdefault(name, []).append(point)
        return found

    def _added(self, name: str) -> type[DriverEntry]:
        """Driver of another package."""
        points = self.added[name]
        packages = sorted({package_of(point) for point in points})
        place = f"driver {self.role}.{name} of the package {' and '.join(packages)}"
        if len(packages) > 1:
            raise InvalidInput(f"{place}: several packages add it; remove all but one")
        try:
            found = points[0].load()
        except Exception as failure:  # whatever the module of another package raises
            told = (str(failure).strip().splitlines() or [""])[0][:120]
            raise InvalidInput(
                f"{place} cannot be loaded ({type(failure).__name__}: {told}); mend or remove the package"
            ) from None
        if not (isinstance(found, type) and issubclass(found, self._base)) or isabstract(found):
            raise InvalidInput(f"{place} is no complete {self._base.__name__}; mend or remove the package")
        driver = cast(type[DriverEntry], found)
        unknown = [name for name in driver.extras if name not in EXTRAS]
        if unknown:
            raise InvalidInput(f"{place} needs {unknown[0]!r}, which is no optional part of sonolube; mend the package")
        return driver


_BASES: Final = {"acquisition": AcquisitionEntry, "drive": DriveEntry, "motor": MotorEntry, "guard": GuardEntry}
DRIVERS: Final[Mapping[str, DriverTable]] = MappingProxyType(
    {role: DriverTable(role, base) for role, base in _BASES.items()}
)
"""Tables of drivers by the role of their devices."""


def package_of(point: EntryPoint) -> str:
    """Name of the package that adds an entry point."""
    return point.dist.name if point.dist is not None else point.module.partition(".")[0]


def known_drivers() -> dict[str, tuple[str, ...]]:
    """Names of all drivers by the role of their devices, with the package of those that others add.

    Returns
    -------
    dict of str to tuple of str
        Such as {"drive": ("scpi", "daqmx", "acme (acme-drive)")}; nothing is imported.
    """
    return {
        role: (
            *table.own,
            *(f"{name} ({', '.join(map(package_of, points))})" for name, points in sorted(table.added.items())),
        )
        for role, table in DRIVERS.items()
    }


_TEXT = 500


@dataclass(frozen=True)
class OfDriver:
    """Section that the driver of its key `driver` reads; to annotate an entry with.

    Parameters
    ----------
    role : str
        Key of `DRIVERS`.
    """

    role: str

    def entry(self, value: object) -> DriverEntry:
        """Section of a table."""
        table = DRIVERS[self.role]
        if isinstance(value, DriverEntry):
            return value
        if not isinstance(value, dict):
            raise ValueError("must be a table of keys")
        if "driver" not in value:
            raise ValueError(f"driver is missing: {_listed(table)}")
        name = value["driver"]
        if not isinstance(name, str) or name not in table:
            raise ValueError(f"driver must be {_listed(table)}, got {str(name)[:40]!r}")
        return table[name].model_validate(value)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Read by the driver."""
        return core_schema.no_info_plain_validator_function(self.entry)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """One of the sections of sonolube's own drivers; those that packages add are not described."""
        table = DRIVERS[self.role]
        own = [handler(table[name].__pydantic_core_schema__) for name in table.own]
        return own[0] if len(own) == 1 else {"oneOf": own}


class MapEntries(Table):
    """Whole device map.

    Parameters
    ----------
    title : str
    acquisition : AcquisitionEntry
        Whose clock is that of protocols.
    acquisitions : dict of str to AcquisitionEntry
        Further ones by name, each with a clock and a sample rate of its own.
    drive : DriveEntry
    motor : MotorEntry
    guard : GuardEntry or None
    """

    title: Annotated[str, Field(min_length=1, max_length=_TEXT)]
    acquisition: Annotated[AcquisitionEntry, OfDriver("acquisition")]
    acquisitions: Annotated[
        dict[
            Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,29}$")],
            Annotated[AcquisitionEntry, OfDriver("acquisition")],
        ],
        Field(default_factory=dict, max_length=16),
    ]
    drive: Annotated[DriveEntry, OfDriver("drive")]
    motor: Annotated[MotorEntry, OfDriver("motor")]
    guard: Annotated[GuardEntry, OfDriver("guard")] | None = None

    @property
    def parts(self) -> Iterator[DriverEntry]:
        """Sections of all devices."""
        yield from (self.acquisition, *self.acquisitions.values(), self.drive, self.motor)
        if self.guard is not None:
            yield self.guard

    @property
    def all_inputs(self) -> dict[str, AcquisitionEntry]:
        """Acquisitions by their keys."""
        return {"acquisition": self.acquisition} | {f"acquisitions.{key}": e for key, e in self.acquisitions.items()}

    @property
    def guarded(self) -> tuple[str, ...]:
        """Analogue outputs of drive and motor."""
        return tuple(each.guarded_output for each in (self.drive, self.motor) if each.guarded_output is not None)

    @model_validator(mode="after")
    def _require_consistent(self) -> Self:
        drive, motor = self.drive, self.motor
        if drive.reserved_as == motor.reserved_as and drive.where == motor.where:
            raise ValueError(f"drive and motor both have the output {drive.where}")
        if self.guard is not None:
            self.guard.require_use(self.guarded)
        self._require_clocks()
        self._require_different_channels()
        return self

    def _require_clocks(self) -> None:
        """Raise where an acquisition has no clock, or one too many."""
        if self.acquisition.own_rate is not None:
            raise ValueError("acquisition: protocols tell its sample rate; one of its own belongs below acquisitions")
        for name, entry in self.acquisitions.items():
            if entry.own_rate is None:
                raise ValueError(f"acquisitions.{name}: needs sample_rate, which no protocol tells")

    def _require_different_channels(self) -> None:
        """Raise where two acquisitions are one device, or two channels have one name."""
        places, devices = dict[str, str](), dict[str, str]()
        for place, entry in self.all_inputs.items():
            other = devices.setdefault(entry.reserved_as, place)
            if other != place:
                raise ValueError(f"{place}: {entry.where} is that of {other} too; one device has one clock")
            for channel in entry.channel_entries:
                if channel.name in places:
                    first = places[channel.name]
                    among = "stands twice among the channels" if first == place else f"is one of {first} too"
                    raise ValueError(f"{place}: name {channel.name} {among}")
                places[channel.name] = place


def _listed(names: Any) -> str:
    """Names as "a, b or c"."""
    *first, last = names
    return f"{', '.join(first)} or {last}" if first else last
