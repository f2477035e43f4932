"""Queries of the catalogue, such as material=brass,load=3N..6N,since=2026-01-01,tag=map, and their index.

The index is a database beside the folders of runs; the folders are the truth, and it is rebuilt from them.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from sonolube.errors import InvalidInput, UnknownName
from sonolube.laboratory.catalogue.entry import CatalogueEntry, catalogue_entry
from sonolube.laboratory.records import RunSummary, run_folders
from sonolube.laboratory.records.run_folder import DOCUMENTS, PROTOCOL, RUN
from sonolube.storage.files import is_locked
from sonolube.storage.growing_files import database, set_database_aside
from sonolube.text.units import to_si

if TYPE_CHECKING:
    from sonolube.storage.growing_files import Connection

Range = tuple[float, float]

RunQuery = tuple[tuple[str, tuple[Any, ...]], ...]
"""Conditions that a run must meet, all of them: each in SQL, with its values."""

_TOLERANCE: Final = 0.01  # of a load or speed that is no range
_WITHIN: Final = "folder IN (SELECT folder FROM settings WHERE quantity = ? AND value BETWEEN ? AND ?)"
_CONDITIONS: Final[Mapping[str, tuple[str, Callable[[str], tuple[Any, ...]]]]] = MappingProxyType(
    {
        "material": ("(instr(pin, ?) OR instr(disc, ?))", lambda text: (text.casefold(), text.casefold())),
        "load": (_WITHIN, lambda text: ("load", *_range(text, unit="N", name="load"))),
        "speed": (_WITHIN, lambda text: ("speed", *_range(text, unit="m/s", name="speed"))),
        "since": ("begun >= ?", lambda text: (_time(text, name="since"),)),
        "until": ("begun < ?", lambda text: (_time(text, name="until"),)),
        "tag": ("instr(tags, ?)", lambda text: (f",{text.strip().casefold()},",)),
        "text": ("instr(text, ?)", lambda text: (text.casefold(),)),
        "outcome": ("? IN ('', outcome)", lambda text: (text,)),
    }
)
QUERY_KEYS: Final = tuple(_CONDITIONS)
"""Conditions by which runs are searched."""


def query_from(values: Mapping[str, Sequence[str]]) -> RunQuery:
    """Query by the texts of its conditions.

    Parameters
    ----------
    values : mapping of str to sequence of str
        By the names in `QUERY_KEYS`; material, tag and text may have several.

    Returns
    -------
    RunQuery

    Raises
    ------
    UnknownName
        If there is no such condition.
    InvalidInput
        If a value cannot be read, or a condition that may be given once is given again.
    """
    for key, texts in values.items():
        if key not in QUERY_KEYS:
            raise UnknownName.among(QUERY_KEYS, kind="condition of runs", name=key)
        if len(texts) > 1 and key not in ("material", "tag", "text"):
            raise InvalidInput(f"{key} is given {len(texts)} times; give it once")
    return tuple((term, read(text)) for key, (term, read) in _CONDITIONS.items() for text in values.get(key, ()))


def _range(text: str, *, unit: str, name: str) -> Range:
    """Range of a text such as 3N..6N, 3N.., or 5N, which allows one percent."""
    low, dots, high = (part.strip() for part in text.partition(".."))
    if not dots:
        value = to_si(text, unit=unit, name=name)
        return value * (1 - _TOLERANCE), value * (1 + _TOLERANCE)
    found = (
        to_si(low, unit=unit, name=name) if low else float("-inf"),
        to_si(high, unit=unit, name=name) if high else float("inf"),
    )
    if not found[0] <= found[1]:
        raise InvalidInput(f"{name} {text} must lead from the lower to the higher value")
    return found


def _time(text: str, *, name: str) -> float:
    """Time of a date, in UTC where it names no zone. [s]"""
    try:
        found = datetime.fromisoformat(text.strip())
        return (found if found.tzinfo else found.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError):
        raise InvalidInput(f"{name} {text[:40]!r} must be a date, such as 2026-01-31 or 2026-01-31T14:00") from None


CATALOGUE: Final = "catalogue.sqlite"
"""Name of the index beside the folders of runs."""

_FORMAT: Final = 2
_OWN: Final = 0x534C4C42  # application number of the database
_SCHEMA: Final = """
CREATE TABLE runs (
    folder TEXT PRIMARY KEY, stamp TEXT, begun REAL, outcome TEXT, pin TEXT, disc TEXT, tags TEXT, text TEXT, entry TEXT
);
CREATE TABLE settings (folder TEXT, quantity TEXT, value REAL);
CREATE INDEX by_folder ON settings (folder);
CREATE INDEX by_time ON runs (begun);
"""


@dataclass(frozen=True, kw_only=True, slots=True)
class FoundRuns:
    """Runs that a query has found.

    Parameters
    ----------
    entries : tuple of CatalogueEntry
        The oldest first.
    of : int
        Number of all runs in the folder.
    caveats : tuple of str
        Runs that cannot be read, and what was done to the index.
    """

    entries: tuple[CatalogueEntry, ...]
    of: int
    caveats: tuple[str, ...]


def query_runs(parent: Path, query: RunQuery = ()) -> FoundRuns:
    """Runs in a folder that meet a query; the index is brought up to date first.

    Parameters
    ----------
    parent : Path
    query : RunQuery, optional
        All runs without it.

    Returns
    -------
    FoundRuns

    Raises
    ------
    InvalidInput
        If the folder cannot be read.
    """
    folders = run_folders(parent)
    try:
        return _found(parent, folders, query, parent / CATALOGUE)
    except InvalidInput as failure:  # such as a full disk: the folders are the truth
        found = _found(parent, folders, query, None)
        return replace(found, caveats=(f"listed without an index: {failure}", *found.caveats))


def _found(parent: Path, folders: list[Path], query: RunQuery, index: Path | None) -> FoundRuns:
    """Runs that meet a query, by an index that is brought up to date; by one in memory where it is None."""
    caveats: list[str] = []
    condition = " WHERE " + " AND ".join(term for term, _ in query) if query else ""
    values = [value for _, of_term in query for value in of_term]
    with _opened(index, caveats) as connection:
        _refresh(connection, folders, caveats)
        (total,) = connection.execute("SELECT count(*) FROM runs").fetchone()
        rows = connection.execute(f"SELECT entry FROM runs{condition} ORDER BY begun, folder", values).fetchall()
    return FoundRuns(entries=tuple(_entry(parent, row[0]) for row in rows), of=total, caveats=tuple(caveats))


@contextmanager
def _opened(path: Path | None, caveats: list[str]) -> "Iterator[Connection]":
    """Provide the index, rebuilt where it is damaged or old, in memory where none can be written."""
    place = path
    try:
        if path is not None and not _is_current(path):
            caveats.append(f"{path.name} was damaged or of another version, and is built anew")
            set_database_aside(path)
    except InvalidInput:
        place = None
    with database(place) as connection:
        if connection.execute("PRAGMA user_version").fetchone()[0] != _FORMAT:
            connection.executescript(_SCHEMA)
            connection.execute(f"PRAGMA application_id={_OWN}")
            connection.execute(f"PRAGMA user_version={_FORMAT}")
        yield connection


def _is_current(path: Path) -> bool:
    """Whether an index is whole and of this version, or none exists but can be made.

    Raises
    ------
    InvalidInput
        If it cannot be written, or is somebody else's.
    """
    exists = path.exists()
    try:
        with database(path) as connection:
            own, version = (
                connection.execute(f"PRAGMA {name}").fetchone()[0] for name in ("application_id", "user_version")
            )
            if own == _OWN and version == _FORMAT:
                connection.execute("SELECT folder, stamp, begun, entry FROM runs").fetchone()
                return bool(connection.execute("PRAGMA quick_check").fetchone()[0] == "ok")
            is_new = own == 0 and version == 0 and not connection.execute("SELECT 1 FROM sqlite_master").fetchone()
    except InvalidInput:
        if exists and path.is_file():
            return False
        raise
    if own != _OWN and not is_new:
        raise InvalidInput(f"{path}: is a database of another program")
    return is_new


def _refresh(connection: "Connection", folders: list[Path], caveats: list[str]) -> None:
    """Bring the index up to date with the folders."""
    known = dict(connection.execute("SELECT folder, stamp FROM runs").fetchall())
    for name in known.keys() - {folder.name for folder in folders}:
        _remove(connection, name)
    for folder in folders:
        stamp = _stamp(folder)
        if known.get(folder.name) == stamp:
            continue
        _remove(connection, folder.name)
        try:
            entry = catalogue_entry(folder)
        except InvalidInput as failure:
            caveats.append(str(failure))
            continue
        connection.execute(f"INSERT INTO runs VALUES ({', '.join('?' * 9)})", _row(folder.name, stamp, entry))
        settings = {"load": entry.normal_loads, "speed": entry.sliding_speeds}
        rows = [(folder.name, quantity, value) for quantity, values in settings.items() for value in values]
        connection.executemany("INSERT INTO settings VALUES (?, ?, ?)", rows)


def _remove(connection: "Connection", name: str) -> None:
    """Remove a run from the index."""
    for table in ("runs", "settings"):
        connection.execute(f"DELETE FROM {table} WHERE folder = ?", (name,))


def _stamp(folder: Path) -> str:
    """Text that changes where the record of a run changes."""
    marks = []
    for name in (RUN, DOCUMENTS, PROTOCOL):
        try:
            found = (folder / name).stat()
            marks.append(f"{found.st_mtime_ns}-{found.st_size}-{found.st_ino}")
        except OSError:
            marks.append("-")
    return " ".join([*marks, str(is_locked(folder))])


def _row(name: str, stamp: str, entry: CatalogueEntry) -> tuple[Any, ...]:
    """Row of a run."""
    summary = entry.summary
    content = {field: getattr(entry, field) for field in CatalogueEntry.__slots__ if field not in ("summary", "text")}
    content |= {field: getattr(summary, field) for field in RunSummary.__slots__ if field != "folder"}
    tags = "".join(f",{tag.casefold()}" for tag in entry.tags) + ","
    return (
        *(name, stamp, summary.begun, summary.outcome, entry.pin_material.casefold(), entry.disc_material.casefold()),
        *(tags, entry.text.casefold()),
        json.dumps({"folder": name, **content}),
    )


def _entry(parent: Path, text: str) -> CatalogueEntry:
    """Entry of a row."""
    content = json.loads(text)
    content = {name: tuple(value) if isinstance(value, list) else value for name, value in content.items()}
    summary = {field: content.pop(field) for field in RunSummary.__slots__}
    summary["folder"] = parent / summary["folder"]
    return CatalogueEntry(**content, summary=RunSummary(**summary), text="")
