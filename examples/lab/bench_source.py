"""A driver of one's own for a source of the drive voltage, in one file: a section of the device map, and its device.

`sonolube lab try-driver bench_source.py` tries it against faults. A package adds it by one line of its pyproject.toml,
under [project.entry-points."sonolube.drivers"]: "drive.bench_source" = "bench_source:BenchSourceEntry".
"""

from typing import Literal

from sonolube.laboratory import DriveSetting
from sonolube.laboratory.drivers import DriveEntry, DriveLimits


class BenchSource:
    """A source whose output is a number in memory; a real one would send it to an instrument."""

    name = "bench source"

    def __init__(self, limits: DriveLimits) -> None:
        self._limits = limits
        self.voltage_maximum = limits.voltage_maximum
        self.output = 0.0

    def connect(self) -> None:
        """Open the connection, output off."""
        self.off()

    def drive(self, setting: DriveSetting) -> None:
        """Set the output, which a limit of the map may refuse."""
        self.output, _ = self._limits.output_of(setting, device=self.name)

    def off(self) -> None:
        """Switch the output off."""
        self.output = 0.0

    def close(self) -> None:
        """Release the source, output off."""
        self.off()


class BenchSourceEntry(DriveEntry):
    """Section `drive` of a device map with driver = "bench_source"."""

    driver: Literal["bench_source"]

    @property
    def where(self) -> str:
        """Address, as people write it."""
        return "memory"

    @property
    def reserved_as(self) -> str:
        """Name by which one run at a time has it."""
        return "bench source"

    def new_device(self) -> BenchSource:
        """Source, not connected."""
        return BenchSource(self.limits)
