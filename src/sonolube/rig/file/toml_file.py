"""Refusals of the content of a TOML file: every fault in one line that names the key."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from typing import Any, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from sonolube.errors import InvalidInput, SeveralFaults, SonolubeError, suggestion
from sonolube.rig.file.contact_section import ROUGHNESS_KINDS
from sonolube.rig.file.guidance import guidance
from sonolube.rig.file.json_schema import tables_of
from sonolube.rig.file.section import Section
from sonolube.rig.file.structures import STRUCTURES
from sonolube.vocabulary import quantity

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
    while tables := [each["loc"] for each in complaints if each["type"] == "missing" and _keys(file, each["loc"])]:
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


def _keys(file: type[Section], tables: Sequence[str | int]) -> list[str]:
    """Keys of a table; the kind of a structure, and the place in a list, follow its table's name."""
    schema = _schema(file)
    places = [schema]
    for name in tables:
        if name in STRUCTURES:
            places = [place for place in places if place["properties"]["kind"]["const"] == name]
        elif isinstance(name, str) and name not in ROUGHNESS_KINDS:
            entries = [place.get("properties", {}).get(name, {}) for place in places]
            places = [schema["$defs"][known] for entry in entries for known in tables_of(entry)]
    return [key for place in places for key in place.get("properties", {})]


@cache
def _schema(file: type[Section]) -> dict[str, Any]:
    return file.model_json_schema()
