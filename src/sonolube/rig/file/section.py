"""Base of the sections of a rig file: quantities are read from text with a unit, unknown keys are refused."""

from dataclasses import dataclass
from typing import Any, Self, get_args, get_origin

import pydantic
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from sonolube.errors import SonolubeError
from sonolube.rig.file.guidance import guidance
from sonolube.rig.file.plausible import require_plausible
from sonolube.text.units import to_si, unit_description
from sonolube.variants import VariantTable
from sonolube.vocabulary import Quantity, quantities


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
