"""Texts of a protocol: quantities with units, SI numbers in the record, and variables of a repeat, written out."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Annotated, Any, Final

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from sonolube.text.units import format_si, to_si, unit_description


class Table(BaseModel):
    """A table of a protocol: unknown keys are refused, and it cannot be changed."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)


@dataclass(frozen=True)
class SiText:
    """Quantity written as text with its unit; to annotate a float with.

    Parameters
    ----------
    unit : str
        SI unit of the number in the record.
    lowest, highest : float
        Range of the number; beyond it no test lies.
    """

    unit: str
    lowest: float
    highest: float

    def number(self, value: object) -> float:
        """Number in SI of a text with a unit."""
        if not isinstance(value, str):
            raise ValueError(f"{value!r} has no unit; expected {unit_description(self.unit)}")
        number = to_si(value, unit=self.unit, name="")
        if not self.lowest <= number <= self.highest:
            low, high = (format_si(each, self.unit) for each in (self.lowest, self.highest))
            raise ValueError(f"{value!r} lies beyond any test; expected {low} to {high}")
        return number

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Read text, take a number of the record as it is, and write text to JSON."""
        return core_schema.no_info_plain_validator_function(
            self.number,
            serialization=core_schema.plain_serializer_function_ser_schema(
                partial(exact_text, unit=self.unit), when_used="json"
            ),
        )

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Text, with the SI unit."""
        return {"type": "string", "description": unit_description(self.unit), "x-si-unit": self.unit}


def exact_text(number: float, *, unit: str) -> str:
    """Text that reads back as the same number in SI, with a prefixed unit where that is exact.

    Parameters
    ----------
    number : float
        In SI.
    unit : str
        SI unit.

    Returns
    -------
    str
    """
    short = format_si(number, unit, digits=6)
    return short if to_si(short, unit=unit, name="") == number else f"{number!r} {unit}"


Seconds = Annotated[float, SiText("s", 1e-6, 1e7)]
Hertz = Annotated[float, SiText("Hz", 1e-3, 1e9)]
Volts = Annotated[float, SiText("V", 0.0, 1e5)]
SignedVolts = Annotated[float, SiText("V", -1e5, 1e5)]
Amperes = Annotated[float, SiText("A", 1e-9, 1e4)]
Newtons = Annotated[float, SiText("N", 1e-9, 1e7)]
NoOrMoreNewtons = Annotated[float, SiText("N", 0.0, 1e7)]
Kelvins = Annotated[float, SiText("K", 1.0, 5000.0)]
MetresPerSecond = Annotated[float, SiText("m/s", 0.0, 1e3)]
TurnsPerSecond = Annotated[float, SiText("1/s", 0.0, 1e5)]
Metres = Annotated[float, SiText("m", 1e-9, 1e3)]


MAX_STEPS: Final = 10_000
"""Number of steps of a repeat, written out for all values of its variables."""

_NAME: Final = re.compile(r"[A-Za-z]\w{0,63}")


def written_out(content: Mapping[str, Any]) -> dict[str, Any]:
    """Content of a repeat with its steps written out for the values of its variables, which it then has no more."""
    over, steps = content.get("over"), content.get("steps")
    if not over or not isinstance(over, Mapping) or not isinstance(steps, Sequence) or isinstance(steps, str):
        return dict(content)
    for name, values in over.items():
        if not _is_list_of_texts(values):
            raise ValueError(f'over.{name}: must be a list of texts, such as ["3 N", "6 N"]')
        if not _NAME.fullmatch(name):
            raise ValueError(f"over: {name[:40]!r} is no name of a variable; letters, digits and _, such as speed")
        if f"{{{name}}}" not in "".join(_texts(steps)):
            raise ValueError(f"over: no step uses {{{name}}}")
    count = len(steps)
    for values in over.values():
        count *= len(values)
    if count > MAX_STEPS:
        raise ValueError(f"over: {count} steps with all values; at most {MAX_STEPS}")
    repeated = [
        _substituted(step, dict(zip(over, values, strict=True))) for values in product(*over.values()) for step in steps
    ]
    return {key: value for key, value in content.items() if key != "over"} | {"steps": repeated}


def _is_list_of_texts(values: object) -> bool:
    """Whether values of a variable are a list of texts that is not empty."""
    return isinstance(values, list | tuple) and bool(values) and all(isinstance(each, str) for each in values)


def _texts(content: object) -> Iterator[str]:
    """All texts within lists and tables."""
    if isinstance(content, str):
        yield content
    elif isinstance(content, Mapping):
        for value in content.values():
            yield from _texts(value)
    elif isinstance(content, list | tuple):
        for value in content:
            yield from _texts(value)


def _substituted(content: Any, values: Mapping[str, str]) -> Any:
    """Content with the values of variables in its texts."""
    if isinstance(content, str):
        for name, value in values.items():
            content = content.replace(f"{{{name}}}", value)
        return content
    if isinstance(content, Mapping):
        return {key: _substituted(value, values) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_substituted(value, values) for value in content]
    return content
