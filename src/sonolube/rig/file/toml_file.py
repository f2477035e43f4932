"""Text files of bounded size, TOML, and refusals of its content in one line that names the key."""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from sonolube.errors import InvalidInput, SonolubeError, suggestion
from sonolube.rig.file.json_schema import tables_of
from sonolube.rig.file.section import Section
from sonolube.rig.file.structures import STRUCTURES
from sonolube.targets import record_input

_LARGEST_FILE = 1_000_000  # bytes; a rig is a page of text, hundreds of modes are some 20 kB
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


def text_of(path: Path, *, kind: str) -> str:
    """Return the text of a file.

    Parameters
    ----------
    path : Path
        UTF-8, with or without a byte order mark.
    kind : str
        What the file is, such as "a rig file".

    Returns
    -------
    str

    Raises
    ------
    InvalidInput
        If the file cannot be read, is no UTF-8 text or larger than 1 MB, or the running command is to write to it.
    """
    record_input(path)
    try:
        if path.stat().st_size > _LARGEST_FILE:
            raise InvalidInput(f"larger than {kind} can be (1 MB)")
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InvalidInput("no such file") from None
    except OSError as failure:
        raise InvalidInput(f"cannot be read: {failure.strerror}") from None
    except UnicodeDecodeError as failure:
        raise InvalidInput(f"not UTF-8 text: byte {failure.object[failure.start]:#04x} at {failure.start}") from None


def toml_of(path: Path, *, kind: str) -> dict[str, Any]:
    """Return the content of a TOML file.

    Parameters
    ----------
    path : Path
    kind : str
        What the file is, such as "a rig file".

    Returns
    -------
    dict

    Raises
    ------
    InvalidInput
        If the file cannot be read or is no TOML.
    """
    text = text_of(path, kind=kind)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as failure:
        raise InvalidInput(f"not valid TOML: {failure}") from None
    except RecursionError:
        raise InvalidInput("not valid TOML: nested too deeply") from None


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
