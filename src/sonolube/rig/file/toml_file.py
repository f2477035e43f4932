"""Refusals of the content of a TOML file in one line that names the key."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, TypeVar

from pydantic import ValidationError

from sonolube.errors import InvalidInput, SonolubeError, suggestion
from sonolube.rig.file.json_schema import tables_of
from sonolube.rig.file.section import Section
from sonolube.rig.file.structures import STRUCTURES

_Content = TypeVar("_Content", bound=Section)


@contextmanager
def prefixed(place: str) -> Iterator[None]:
    """Put a place before the message of every refusal within.

    Parameters
    ----------
    place : str
        File or key.

    Yields
    ------
    None

    Raises
    ------
    InvalidInput
        In place of any error of sonolube.
    """
    try:
        yield
    except SonolubeError as refusal:
        raise InvalidInput(f"{place}: {refusal}") from None


def validated(file: type[_Content], content: Mapping[str, Any]) -> _Content:
    """Return the content of a file as its sections.

    Parameters
    ----------
    file : type
        Section of the whole file.
    content : mapping
        The file as TOML gives it.

    Returns
    -------
    Section

    Raises
    ------
    InvalidInput
        In one line that names the key and the value.
    """
    try:
        return file.model_validate(content)
    except ValidationError as refusal:
        complaints = refusal.errors(include_url=False, include_context=False)
    # a misspelt key explains the one that is missing
    first = min(complaints, key=lambda complaint: complaint["type"] != "extra_forbidden")
    rest = f" (and {len(complaints) - 1} more)" if len(complaints) > 1 else ""
    reason = _reason(file, first["type"], first["loc"], first["msg"])
    raise InvalidInput(f"{_dotted(first['loc'])}: {reason}{rest}".removeprefix(": "))


def _dotted(place: Sequence[str | int]) -> str:
    """Return the dotted key of a place in the file, without the kind that chose among tables."""
    parts = [str(part) for part in place]
    if parts[:1] == ["structure"] and len(parts) > 1 and parts[1] in STRUCTURES:
        del parts[1]
    return ".".join(parts)


def _reason(file: type[Section], kind: str, place: Sequence[str | int], message: str) -> str:
    if kind == "extra_forbidden":
        *tables, key = place
        close = suggestion(str(key), _known_keys(file, tables))
        return f"unknown key; {close}".removesuffix("; ")
    return "missing" if kind == "missing" else message.removeprefix("Value error, ").strip()


def _known_keys(file: type[Section], tables: Sequence[str | int]) -> list[str]:
    """Return the keys of a table; the kind of a structure, and the place in a list, follow its table's name."""
    schema = file.model_json_schema()
    places = [schema]
    for name in tables:
        if name in STRUCTURES:
            places = [place for place in places if place["properties"]["kind"]["const"] == name]
        elif isinstance(name, str):
            entries = [place.get("properties", {}).get(name, {}) for place in places]
            places = [schema["$defs"][known] for entry in entries for known in tables_of(entry)]
    return [key for place in places for key in place.get("properties", {})]
