"""Whole device map as a record: each section by the driver that it names, and what holds between sections."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Self

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from sonolube.facts.protocol.quantity_text import Table
from sonolube.laboratory.drivers.driver_table import DRIVERS
from sonolube.laboratory.drivers.entry import AcquisitionEntry, DriveEntry, DriverEntry, GuardEntry, MotorEntry

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
        if name not in table:
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
    def _require_different_outputs(self) -> Self:
        drive, motor = self.drive, self.motor
        if drive.reserved_as == motor.reserved_as and drive.where == motor.where:
            raise ValueError(f"drive and motor both have the output {drive.where}")
        return self

    @model_validator(mode="after")
    def _require_guarded(self) -> Self:
        if self.guard is not None:
            self.guard.require_use(self.guarded)
        return self

    @model_validator(mode="after")
    def _require_clocks(self) -> Self:
        if self.acquisition.own_rate is not None:
            raise ValueError("acquisition: protocols tell its sample rate; one of its own belongs below acquisitions")
        for name, entry in self.acquisitions.items():
            if entry.own_rate is None:
                raise ValueError(f"acquisitions.{name}: needs sample_rate, which no protocol tells")
        return self

    @model_validator(mode="after")
    def _require_different_channels(self) -> Self:
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
        return self


def _listed(names: Any) -> str:
    """Names as "a, b or c"."""
    *first, last = names
    return f"{', '.join(first)} or {last}" if first else last
