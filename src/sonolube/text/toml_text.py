"""Text and TOML files of users, read in bounded time: limited size, depth and numbers, and plain text only."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from sonolube.errors import InvalidInput
from sonolube.storage.user_files import input_text, record_input
from sonolube.text.plain_text import active_character

_LARGEST_FILE = 1_000_000  # bytes; a rig is a page of text, hundreds of modes are some 20 kB
_DEEPEST = 32  # tables, arrays and parts of a dotted key, one within the other
_PART = r"""(?:[\w-]+|"[^"\n]*"|'[^'\n]*')"""
_LONG_KEY = re.compile(rf"(?<![\w-]){_PART}(?:[ \t]*\.[ \t]*{_PART}){{{_DEEPEST},}}")


def text_of(path: Path, *, kind: str) -> str:
    """Text of a file."""
    record_input(path)
    try:
        if path.stat().st_size > _LARGEST_FILE:
            raise InvalidInput(f"larger than {kind} can be (1 MB)")
        return input_text(path, most=_LARGEST_FILE)
    except FileNotFoundError:
        raise InvalidInput("no such file") from None
    except OSError as failure:
        raise InvalidInput(f"cannot be read: {failure.strerror}") from None
    except UnicodeDecodeError as failure:
        raise InvalidInput(f"not UTF-8 text: byte {failure.object[failure.start]:#04x} at {failure.start}") from None


def read_toml(path: Path, *, kind: str) -> dict[str, Any]:
    """Content of a TOML file."""
    return toml_content(text_of(path, kind=kind))


def toml_content(text: str) -> dict[str, Any]:
    """Content of a TOML text.

    The standard library's parser takes a time in the square of the parts of a dotted key, and a depth of the stack for
    every array within another; keys of many parts are therefore refused before it reads them.
    """
    if _LONG_KEY.search(text):
        raise InvalidInput(f"not valid TOML: a key of more than {_DEEPEST} parts")
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as failure:
        raise InvalidInput(f"not valid TOML: {failure}") from None
    except RecursionError:
        raise InvalidInput("not valid TOML: nested too deeply") from None
    except ValueError:  # of int(), which has a limit of digits
        raise InvalidInput("not valid TOML: an integer of too many digits") from None
    require_plain_content(content)
    return content


def require_plain_content(content: Mapping[str, Any]) -> None:
    """Refuse content of a file that is nested too deeply or holds what is not plain text."""
    for key, depth, value in _entries(content):
        if depth > _DEEPEST:
            raise InvalidInput(f"{key}: nested too deeply, at most {_DEEPEST} tables and arrays")
        if isinstance(value, str) and (found := active_character(value)):
            raise InvalidInput(f"{key}: holds the control character {found}; leave it out")


def _entries(content: Mapping[str, Any]) -> Iterator[tuple[str, int, Any]]:
    """Dotted key, depth and value of every entry, and every key as an entry of its own."""
    waiting: list[tuple[str, int, Any]] = [("", 0, content)]
    while waiting:
        place, depth, value = waiting.pop()
        yield place, depth, value
        if depth > _DEEPEST:
            continue
        if isinstance(value, Mapping):
            yield from ((f"{place}.{key}".strip("."), depth, key) for key in value)
            waiting += [(f"{place}.{key}".strip("."), depth + 1, inner) for key, inner in reversed([*value.items()])]
        elif isinstance(value, list):
            waiting += [(place, depth + 1, inner) for inner in reversed(value)]
