"""Base of the sections of a rig file: quantities are read from text with a unit, unknown keys are refused.

With guidance on the entries that a file requires, from `guidance.toml`, and plausible magnitudes by SI unit.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any, Self, get_args, get_origin

import pydantic
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.text.units import format_si, to_si, unit_description
from sonolube.variants import VariantTable
from sonolube.vocabulary import Quantity, quantities


@dataclass(frozen=True, kw_only=True, slots=True)
class Guidance:
    """Guidance on obtaining a number of a rig file.

    Parameters
    ----------
    obtain : str
        What measures or gives it.
    typical : str
        Range of usual values, with the unit.
    """

    obtain: str
    typical: str

    @property
    def text(self) -> str:
        """Both, as they follow the meaning of the number in a sentence."""
        return f"from {self.obtain}; typically {self.typical}"


@cache
def guidance() -> Mapping[str, Guidance]:
    """Guidance to every number that a rig file requires, by the name of its key."""
    text = files("sonolube.rig.file").joinpath("guidance.toml").read_text(encoding="utf-8")
    return MappingProxyType({name: Guidance(**entry) for name, entry in tomllib.loads(text).items()})


LIMITS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "": (1e-9, 1e2),
        "m": (1e-12, 1e3),
        "m2": (1e-18, 1e4),
        "1/m2": (1.0, 1e20),
        "kg": (1e-12, 1e6),
        "N": (1e-12, 1e9),
        "Pa": (1.0, 1e13),
        "m/s": (1e-12, 1e4),
        "Hz": (1e-3, 1e9),
        "s": (1e-12, 1e8),
        "rad": (1e-12, 1e3),
        "V": (1e-9, 1e6),
        "F": (1e-15, 1.0),
        "m/V": (1e-18, 1e-2),
        "N/m": (1e-6, 1e15),
        "N s/m": (1e-9, 1e12),
        "kg/m3": (1e-3, 1e5),
        "Pa s": (1e-9, 1e6),
        "W": (1e-12, 1e6),
        "W/K": (1e-9, 1e6),
        "J/K": (1e-9, 1e9),
    }
)
"""Least and largest magnitude of what is not zero, by SI unit."""

DECAY_LENGTHS = (1e-10, 1e-3)
"""Shortest and longest decay length of a contact force. [m]"""

_ANY_UNIT = (1e-30, 1e30)


def plausible_si(text: str, *, unit: str, name: str) -> float:
    """Number in SI that a command's option stands for, where a rig can have it."""
    return require_plausible(to_si(text, unit=unit, name=name), unit=unit, text=f"{name} {text}")


def require_plausible(value: float, *, unit: str, text: str) -> float:
    """Value in SI, or refuse it where its magnitude lies beyond any rig."""
    least, largest = LIMITS.get(unit, _ANY_UNIT)
    if value and (abs(value) < least or abs(value) > largest):  # what is no number is for others as well
        bounds = " to ".join(format_si(bound, unit) for bound in (least, largest))
        raise InvalidInput(f"{text} lies beyond any rig: expected {bounds}")
    return float(value)


@dataclass(frozen=True)
class NameIn:
    """Text that must be a name of a table of variants; to annotate a field with.

    Parameters
    ----------
    table : VariantTable
    """

    table: VariantTable[Any]

    def __get_pydantic_core_schema__(self, source: Any, handler: pydantic.GetCoreSchemaHandler) -> CoreSchema:
        """Accept the names of the table only."""
        return core_schema.literal_schema(list(self.table))


class Section(pydantic.BaseModel):
    """A table of a rig file; unknown keys are refused, text with a unit becomes SI."""

    model_config = pydantic.ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True, defer_build=True)

    @pydantic.field_validator("*", mode="before")
    @classmethod
    def _read_quantity(cls, value: object, info: pydantic.ValidationInfo) -> object:
        known = cls.quantity_of(info.field_name or "")
        if known is None or value is None:
            return value
        if isinstance(value, str) and value.rstrip().endswith("HV") and known.name != "hardness":
            raise ValueError(f"{value} is a hardness; expected {unit_description(known.unit)}")
        return quantity_in_si(value, unit=known.unit)

    @pydantic.model_validator(mode="after")
    def _possible(self) -> Self:
        try:
            self.require_possible()
        except SonolubeError as refusal:
            raise ValueError(str(refusal)) from None
        return self

    def require_possible(self) -> None:
        """Refuse values that are read but that nothing can have, each section its own."""

    @classmethod
    def quantity_of(cls, name: str) -> Quantity | None:
        """Quantity that a key holds: the one its field is annotated with, else the vocabulary's.

        Parameters
        ----------
        name : str
            Key of the table.

        Returns
        -------
        Quantity or None
            None for text, tables and lists.
        """
        field = cls.model_fields.get(name)
        if field is None or get_origin(field.annotation) is list:
            return None
        if float not in (field.annotation, *get_args(field.annotation)):
            return None
        return next((each for each in field.metadata if isinstance(each, Quantity)), quantities().get(name))

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: pydantic.GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe physical keys by meaning, unit and an example."""
        schema = handler(core_schema)
        properties: dict[str, Any] = handler.resolve_ref_schema(schema).get("properties", {})
        for name, entry in properties.items():
            if known := cls.quantity_of(name):
                properties[name] = _schema_of(known) | {
                    key: value for key, value in entry.items() if key == "default" and value is None
                }
        return schema


def quantity_in_si(value: object, *, unit: str) -> float:
    """Quantity written as text with its unit, or a pure number, in SI."""
    if isinstance(value, str):
        return require_plausible(to_si(value, unit=unit, name=""), unit=unit, text=value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{value!r} is not {unit_description(unit)}")
    if unit:
        raise ValueError(f"{value!r} has no unit; expected {unit_description(unit)}")
    return require_plausible(value, unit=unit, text=f"{value}")


def _schema_of(known: Quantity) -> dict[str, Any]:
    advice = guidance().get(known.name)
    described = f"{known.meaning}; {unit_description(known.unit)}"
    return {
        "type": "string" if known.unit else ["number", "string"],
        "title": known.meaning,
        "description": described if advice is None else f"{described}; {advice.text}",
        "x-si-unit": known.unit,
    }
