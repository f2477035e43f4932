"""Drivers by the role of their device and their name: those of sonolube, and those that other packages add.

Another package adds a driver by a section of a device map, in one file, and one line in its pyproject.toml::

    [project.entry-points."sonolube.drivers"]
    "drive.acme" = "acme_drive:AcmeDrive"

The name has the role first: acquisition, drive, motor or guard. Packages are looked up where a map names a driver that
sonolube does not have, and imported where a map names theirs.
"""

from collections.abc import Iterator, Mapping
from importlib.metadata import EntryPoint, entry_points
from inspect import isabstract
from types import MappingProxyType
from typing import Final, cast

from sonolube.errors import InvalidInput
from sonolube.extras import EXTRAS
from sonolube.laboratory.drivers.entry import AcquisitionEntry, DriveEntry, DriverEntry, GuardEntry, MotorEntry
from sonolube.variants import VariantTable

GROUP: Final = "sonolube.drivers"
"""Group of entry points by which other packages add drivers."""


_OWN: Final = {  # drivers of sonolube, named as those of other packages
    "acquisition.daqmx": "sonolube.laboratory.drivers.daqmx_acquisition:DaqmxAcquisitionEntry",
    "acquisition.scpi_query": "sonolube.laboratory.drivers.scpi_query:ScpiQueryEntry",
    "drive.scpi": "sonolube.laboratory.drivers.function_generator:GeneratorEntry",
    "drive.daqmx": "sonolube.laboratory.drivers.daqmx_output:DaqmxDriveEntry",
    "drive.scpi_commands": "sonolube.laboratory.drivers.scpi_source:ScpiSourceEntry",
    "motor.line": "sonolube.laboratory.drivers.line_motor:LineMotorEntry",
    "motor.daqmx": "sonolube.laboratory.drivers.daqmx_output:DaqmxMotorEntry",
    "guard.daqmx": "sonolube.laboratory.drivers.daqmx_guard:DaqmxGuardEntry",
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


DRIVERS: Final[Mapping[str, DriverTable]] = MappingProxyType(
    {
        "acquisition": DriverTable("acquisition", AcquisitionEntry),
        "drive": DriverTable("drive", DriveEntry),
        "motor": DriverTable("motor", MotorEntry),
        "guard": DriverTable("guard", GuardEntry),
    }
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
