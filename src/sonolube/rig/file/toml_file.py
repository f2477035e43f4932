"""Content of a rig file held against its sections: JSON schema, every fault in one line, and distributions.

Distributions of the table `uncertainty` are such as "normal 0.5 um", about the values of the rig.
"""

import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from types import MappingProxyType
from typing import Any, TypeVar, get_args, get_origin

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from sonolube.errors import InvalidInput, SeveralFaults, SonolubeError, suggestion
from sonolube.rig.distribution import Distribution, Law, LogNormal, Normal, Uniform
from sonolube.rig.file.contact_section import ROUGHNESS_KINDS
from sonolube.rig.file.section import Section, guidance
from sonolube.rig.file.sections import RigFile
from sonolube.rig.file.structures import STRUCTURES
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import Quantity, quantity


def rig_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) that every rig file follows.

    Returns
    -------
    dict
    """
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "sonolube rig"} | {
        key: value for key, value in RigFile.model_json_schema().items() if key != "title"
    }


def tables_of(entry: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names, among the definitions of the schema, of the tables that a key may hold, alone or in a list."""
    if "$ref" in entry:
        yield entry["$ref"].rpartition("/")[2]
    if "items" in entry:
        yield from tables_of(entry["items"])
    for option in (*entry.get("anyOf", ()), *entry.get("oneOf", ())):
        yield from tables_of(option)


TABLE_KINDS = {"structure": STRUCTURES, "roughness": ROUGHNESS_KINDS}
"""Kinds of tables by key: of those keys that hold one of several kinds."""

_MOST = 20  # faults that are listed
_Content = TypeVar("_Content", bound=Section)


@contextmanager
def prefixed(place: str) -> Iterator[None]:
    """Put a place before the message of every refusal within."""
    try:
        yield
    except SeveralFaults as refusal:
        raise refusal.at(place) from None
    except SonolubeError as refusal:
        raise InvalidInput(f"{place}: {refusal}", key=getattr(refusal, "key", "")) from None


def validated(file: type[_Content], content: Mapping[str, Any]) -> _Content:
    """Content of a file as its sections."""
    try:
        return file.model_validate(content)
    except ValidationError as refusal:
        found = _complaints(file, refusal, content)
    faults = [_fault(file, each) for each in found[:_MOST]]
    keys = [_entry_of(file, each) for each in found[:_MOST]]
    if len(found) == 1:
        raise InvalidInput(faults[0], key=keys[0])
    raise SeveralFaults(faults, rest=len(found) - len(faults), keys=keys)


def _complaints(file: type[Section], refusal: ValidationError, content: Mapping[str, Any]) -> list[ErrorDetails]:
    """Faults of a file, misspelt keys first; the keys of a missing table stand in its place.

    A key that an unknown one of its table is like is misspelt and not missing.
    """
    complaints = _details(refusal)
    while tables := [each["loc"] for each in complaints if each["type"] == "missing" and _is_table(file, each["loc"])]:
        for place in tables:
            content = _with_table(content, _without_tags(place))
        try:
            file.model_validate(content)
            break  # of these tables no key is required
        except ValidationError as deeper:
            complaints = _details(deeper)
    unknown = [each for each in complaints if each["type"] == "extra_forbidden"]
    meant = {(*each["loc"][:-1], _meant(file, each["loc"])) for each in unknown[:_MOST]}
    return unknown + [each for each in complaints if _is_other(each, meant)]


def _details(refusal: ValidationError) -> list[ErrorDetails]:
    return refusal.errors(include_url=False, include_context=False)


def _is_other(complaint: ErrorDetails, meant: Collection[tuple[str | int, ...]]) -> bool:
    """Whether a complaint is neither of an unknown key nor of a missing one that was misspelt."""
    kind = complaint["type"]
    return kind != "extra_forbidden" and not (kind == "missing" and complaint["loc"] in meant)


def _with_table(content: Mapping[str, Any], place: Sequence[str | int]) -> dict[str, Any]:
    """Content with an empty table at a place that has none."""
    key, *rest = place
    inner = content.get(str(key), {})
    return {**content, str(key): _with_table(inner, rest) if rest else inner}


def _without_tags(place: Sequence[str | int]) -> list[str | int]:
    """Place in the file without the kinds that chose among tables."""
    return [part for at, part in enumerate(place) if not (at and part in TABLE_KINDS.get(str(place[at - 1]), ()))]


def _fault(file: type[Section], complaint: ErrorDetails) -> str:
    """Complaint in one line: the dotted key and what is wrong with it."""
    place = complaint["loc"]
    reason = _reason_of(complaint)
    if complaint["type"] == "extra_forbidden":
        reason = f"unknown key; {suggestion(str(place[-1]), _keys(file, place[:-1]))}".removesuffix("; ")
    elif complaint["type"] == "missing":
        reason = _missing(str(place[-1]))
    return f"{_key_of(complaint)}: {reason}".removeprefix(": ")


def _key_of(complaint: ErrorDetails) -> str:
    """Dotted key of a complaint."""
    return ".".join(map(str, _without_tags(complaint["loc"])))


def _entry_of(file: type[Section], complaint: ErrorDetails) -> str:
    """Dotted key of the entry that a complaint is about, also where its table makes it."""
    key, first = _key_of(complaint), _reason_of(complaint).partition(" ")[0]
    return f"{key}.{first}" if key and first in _keys(file, complaint["loc"]) else key


def _reason_of(complaint: ErrorDetails) -> str:
    """Text of a complaint of pydantic."""
    return str(complaint["msg"]).removeprefix("Value error, ").strip()


def _missing(key: str) -> str:
    """Meaning of a missing key and the way to obtain it, where known."""
    if key not in guidance():
        return "missing"
    meaning = quantity(key).meaning
    is_named = "'" in meaning.split()[0]  # such as Young's modulus
    return f"missing: {meaning if is_named else meaning[0].lower() + meaning[1:]}; {guidance()[key].text}"


def _meant(file: type[Section], place: Sequence[str | int]) -> str:
    """Known key of a table that an unknown one is like; empty where none is."""
    return suggestion(str(place[-1]), _keys(file, place[:-1])).removeprefix("did you mean ").removesuffix("?")


def _is_table(file: type[Section], place: Sequence[str | int]) -> bool:
    """Whether a key holds one table, with keys of its own, and not a list of tables."""
    entries = [each.get("properties", {}).get(place[-1], {}) for each in _places(file, place[:-1])]
    return bool(_keys(file, place)) and not any("items" in entry for entry in entries)


def _keys(file: type[Section], tables: Sequence[str | int]) -> list[str]:
    """Keys of a table."""
    return [key for place in _places(file, tables) for key in place.get("properties", {})]


def _places(file: type[Section], tables: Sequence[str | int]) -> list[dict[str, Any]]:
    """Schemas of a table; the kind of a structure, and the place in a list, follow its table's name."""
    schema = _schema(file)
    places = [schema]
    for name in tables:
        if name in STRUCTURES:
            places = [place for place in places if place["properties"]["kind"]["const"] == name]
        elif isinstance(name, str) and name not in ROUGHNESS_KINDS:
            entries = [place.get("properties", {}).get(name, {}) for place in places]
            places = [schema["$defs"][known] for entry in entries for known in tables_of(entry)]
    return places


@cache
def _schema(file: type[Section]) -> dict[str, Any]:
    return file.model_json_schema()


EXAMPLES = (
    "normal 0.5 um",
    "normal 3 %",
    "uniform 10 %",
    "uniform 1 um to 2 um",
    "lognormal 20 %",
    "lognormal factor 2",
)
"""Notation of distributions in a rig file."""

_ENTRY = re.compile(r"(normal|lognormal|uniform)\s+(\S.*)")
_ENDS = re.compile(r"(.+?)\s+to\s+(.+)")
_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_SHARE = re.compile(_NUMBER + r"\s*%")
_FACTOR = re.compile(r"factor\s+" + _NUMBER)
_EITHER_SIGN = (
    *("voltage_offset", "lowest_voltage", "highest_voltage", "position"),
    *("in_plane_phase", "second_phase", "vibration_direction"),
)
_POSSIBLE = {"poisson_ratio": (0.0, 0.5), "coupling_factor": (0.0, 1.0)} | dict.fromkeys(
    _EITHER_SIGN, (-math.inf, math.inf)
)


def distributions_of(file: RigFile) -> Mapping[str, Distribution]:
    """Distributions of a rig file's uncertain entries, by dotted key.

    Cut off where the quantity can have no value: below zero for most.
    """
    found = {}
    for key, text in file.uncertainty.items():
        with prefixed(f"uncertainty.{key}"):
            found[key] = _distribution(_quantity(key), text, _value(file, key))
    return MappingProxyType(found)


@cache
def number_keys() -> Mapping[str, Quantity]:
    """Quantity of every single number of a rig file, by dotted key."""
    return MappingProxyType(dict(_number_keys(RigFile, "")))


def _number_keys(section: type[Section], place: str) -> Iterator[tuple[str, Quantity]]:
    for name, field in section.model_fields.items():
        for table in _sections(field.annotation):
            yield from _number_keys(table, f"{place}{name}.")
        if known := section.quantity_of(name):
            yield f"{place}{name}", known


def _sections(annotation: Any) -> Iterator[type[Section]]:
    """Yield the tables that a key may hold, those of a list left out."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        yield annotation
    elif get_origin(annotation) is not list:
        for part in get_args(annotation):
            yield from _sections(part)


def _quantity(key: str) -> Quantity:
    if key not in number_keys():
        last = [known for known in number_keys() if known.rpartition(".")[2] == key.rpartition(".")[2]]
        close = f"did you mean {last[0]}?" if last else suggestion(key, number_keys())
        raise InvalidInput(f"no number of a rig file; {close}".removesuffix("; "))
    return number_keys()[key]


def _value(file: RigFile, key: str) -> float | None:
    place: Any = file
    for part in key.split("."):
        place = getattr(place, part, None)
    return None if place is None else float(place)


def _distribution(known: Quantity, text: str, value: float | None) -> Distribution:
    name, unit = known.name, known.unit
    match = _ENTRY.fullmatch(" ".join(text.split()))
    if match is None:
        raise InvalidInput(f"{text!r} is no distribution; write it like {', '.join(EXAMPLES[:4])} or {EXAMPLES[-1]}")
    kind, rest = match[1], match[2].strip()
    ends = _ENDS.fullmatch(rest)
    if kind == "uniform" and ends is not None:
        low, high = (to_si(end, unit=unit, name=kind) for end in ends.groups())
        law: Law = Uniform(low=low, high=high)
    elif value is None:
        raise InvalidInput(f"the file has no value that {text!r} could be about; give one, or write {EXAMPLES[3]!r}")
    elif kind == "lognormal":
        law = LogNormal(median=value, factor=_factor(rest))
    elif kind == "normal":
        law = Normal(middle=value, deviation=_width(kind, rest, unit, value))
    else:
        width = _width(kind, rest, unit, value)
        law = Uniform(low=value - width, high=value + width)
    lowest, highest = _POSSIBLE.get(name, (0.0, math.inf))
    return Distribution(law=law, lowest=lowest, highest=highest, text=_text(law, unit))


def _factor(rest: str) -> float:
    share, factor = _SHARE.fullmatch(rest), _FACTOR.fullmatch(rest)
    if share is not None:
        return 1 + float(share[1]) / 100
    if factor is not None:
        return float(factor[1])
    raise InvalidInput(f"lognormal {rest}: write {EXAMPLES[4]!r} or {EXAMPLES[5]!r}")


def _width(kind: str, rest: str, unit: str, value: float) -> float:
    share = _SHARE.fullmatch(rest)
    width = to_si(rest, unit=unit, name=kind) if share is None else abs(value) * float(share[1]) / 100
    if not width > 0:
        raise InvalidInput(f"{kind} {rest} is no width" + " about the file's zero" * (value == 0))
    return width


def _text(law: Law, unit: str) -> str:
    match law:
        case Normal():
            return f"normal, {format_si(law.middle, unit)} +- {format_si(law.deviation, unit)}"
        case LogNormal():
            return f"lognormal, {format_si(law.median, unit)} within a factor of {law.factor:.3g}"
        case Uniform():
            return f"uniform, {format_si(law.low, unit)} to {format_si(law.high, unit)}"
