"""Sections of a rig file: every physical key is a word of the vocabulary and carries its unit in the text."""

from typing import Any

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, ValidationInfo, field_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from sonolube.rig.file.plausible import require_plausible
from sonolube.units import kind_of, to_si
from sonolube.vocabulary import quantities


class Section(BaseModel):
    """A table of a rig file; unknown keys are refused, text with a unit becomes SI."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)

    @field_validator("*", mode="before")
    @classmethod
    def _read_quantity(cls, value: object, info: ValidationInfo) -> object:
        known = quantities().get(info.field_name or "")
        if known is None or value is None:
            return value
        return _quantity_in_si(value, unit=known.unit)

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Describe physical keys by meaning, unit and an example."""
        schema = handler(core_schema)
        properties: dict[str, Any] = handler.resolve_ref_schema(schema).get("properties", {})
        for name in properties.keys() & quantities().keys():
            properties[name] = _schema_of(name) | {
                key: value for key, value in properties[name].items() if key == "default" and value is None
            }
        return schema


def _quantity_in_si(value: object, *, unit: str) -> float:
    if isinstance(value, str):
        return require_plausible(to_si(value, unit=unit, name=""), unit=unit, text=value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{value!r} is not {kind_of(unit)}")
    if unit:
        raise ValueError(f"{value!r} has no unit; wanted {kind_of(unit)}")
    return require_plausible(value, unit=unit, text=f"{value}")


def _schema_of(name: str) -> dict[str, Any]:
    known = quantities()[name]
    return {
        "type": "string" if known.unit else ["number", "string"],
        "title": known.meaning,
        "description": f"{known.meaning}; {kind_of(known.unit)}",
        "x-si-unit": known.unit,
    }
