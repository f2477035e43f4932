"""Entries of a rig file behind the rig read from it: replaced one by one, and written as a file again."""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sonolube.errors import InvalidInput
from sonolube.rig.file.derived import ALTERNATIVES, DERIVED_SUMMITS, REPLACED, ROUGHNESS, TYPICAL
from sonolube.rig.file.toml_file import prefixed
from sonolube.rig.record import Rig
from sonolube.storage.files import write_atomically


@dataclass(frozen=True, slots=True)
class FileEntries:
    """Content of the file of a rig.

    Parameters
    ----------
    content : mapping
        Entries as they are written; a file of modes is read in its place.
    rig_from : callable
        Reader of such a content.
    text : str
        File with its comments, where it is kept; empty otherwise.
    path : str
        Of the file; empty where there is none.
    changes : tuple of str
        Entries that were replaced when it was read.
    """

    content: Mapping[str, Any]
    rig_from: Callable[[Mapping[str, Any]], Rig]
    text: str = ""
    path: str = ""
    changes: tuple[str, ...] = ()

    def replaced(self, key: str, value: str | float) -> Rig:
        """Rig of the file with one entry replaced."""
        content = deepcopy(dict(self.content))
        set_entry(content, key, value)
        with prefixed(f"replace({key!r}, {value!r})"):
            return from_file(self.rig_from(content), path=self.path, changes=self.changes)

    def write(self, path: str | Path) -> Path:
        """Write the file with its entries."""
        import tomli_w

        return write_atomically(Path(path), self.text or tomli_w.dumps(self.content))


def with_entries(rig: Rig, entries: FileEntries) -> Rig:
    """Rig that was just read, with the entries of its file."""
    object.__setattr__(rig, "_entries", entries)
    return rig


def from_file(rig: Rig, *, path: str, changes: tuple[str, ...]) -> Rig:
    """Rig that was just read, with the path of its file and the entries that were replaced."""
    entries: FileEntries = object.__getattribute__(rig, "_entries")
    return with_entries(rig, replace(entries, path=path, changes=changes))


def set_entry(content: dict[str, Any], key: str, value: str | float) -> None:
    """Set an entry of the content of a file, its tables made where they are missing."""
    *tables, name = key.strip().split(".")
    if tables and tables[0] == "uncertainty":
        tables, name = tables[:1], key.strip().partition(".")[2]  # the keys of this table are whole
    if not name or not all(tables):
        raise InvalidInput(f"{key!r} is no key of a rig file, such as drive.frequency")
    place = content
    for table in tables:
        place = place.setdefault(table, {})
        if not isinstance(place, dict):
            raise InvalidInput(f"{key}: {table} is not a table")
    if key.strip() in REPLACED:
        _forget(content, place, REPLACED[key.strip()])
    if key.strip() in ALTERNATIVES:
        for other in ALTERNATIVES[key.strip()]:
            _remove(content, place, other)
        content.get("assumptions", {}).pop(key.strip(), None)
    place[name] = value


def _forget(content: dict[str, Any], place: dict[str, Any], number: str) -> None:
    """Remove from a file a number, the entries that it could be derived from, and those derived with it."""
    table = number.rpartition(".")[0]
    assumptions = content.get("assumptions", {})
    derived = [key for key in DERIVED_SUMMITS if str(assumptions.get(key, "")).startswith(TYPICAL)]
    siblings = [each for each in REPLACED if REPLACED[each] == number]
    for each in (number, *siblings, *(derived if table == ROUGHNESS else ())):
        _remove(content, place, each)


def _remove(content: dict[str, Any], place: dict[str, Any], key: str) -> None:
    """Remove an entry of a table of a file, with its assumption and its distribution."""
    place.pop(key.rpartition(".")[2], None)
    content.get("assumptions", {}).pop(key, None)
    content.get("uncertainty", {}).pop(key, None)
