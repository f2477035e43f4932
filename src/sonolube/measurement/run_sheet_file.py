"""File of a table of own runs: read with its state, and written whole only where nobody changed it meanwhile."""

import csv
import hashlib
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.run_columns import RUN_COLUMNS
from sonolube.measurement.run_sheet import RunSheet, read_sheet
from sonolube.measurement.run_table import unread_columns
from sonolube.storage.files import write_atomically

_FIRST: Final = (
    *("run", "vibration_amplitude", "voltage_peak_to_peak", "frequency", "sliding_speed", "normal_load"),
    *("friction_force", "intrinsic_friction_force", "source", "used"),
)
EMPTY_TABLE: Final = ",".join(column.heading for column in RUN_COLUMNS if column.name in _FIRST) + "\n"
"""Headings with their units of a table without a run."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SheetFile:
    """File of a table of own runs as it was read.

    Parameters
    ----------
    path : Path
    state : str
        Digest of its content; empty where there was no file.
    """

    path: Path
    state: str = ""


def state_of_file(path: Path) -> SheetFile:
    """File as it is now, for a table that takes its place."""
    content = _content(path)
    return SheetFile(path=path, state="" if content is None else _state(content))


def stored_sheet(path: Path, *, mapping: RecordingMapping | None = None) -> tuple[RunSheet, SheetFile]:
    """Table of own runs of a file, without a run where it has headings alone or does not exist, and its state.

    Raises
    ------
    InvalidInput
        If the file cannot be read as a table of runs.
    """
    content = _content(path)
    if content is None:
        return RunSheet(), SheetFile(path=path)
    sheet = read_sheet(path, mapping=mapping) if _has_rows(content) else RunSheet()
    return sheet, SheetFile(path=path, state=_state(content))


def store_sheet(sheet: RunSheet, file: SheetFile) -> SheetFile:
    """Write a table to the file that it was read from, whole or not at all, and return the new state.

    Raises
    ------
    InvalidInput
        If another program changed the file since it was read, or it has columns that would be lost.
    """
    content, path = _content(file.path), file.path
    if (_state(content) if content is not None else "") != file.state:
        raise InvalidInput(
            f"{path.name}: another program changed it since it was read; read it again, or save to another file",
            key="changed",
        )
    if content is not None and _has_rows(content) and (lost := unread_columns(path)):
        raise InvalidInput(
            f"{path.name}: {', '.join(map(repr, lost[:6]))} would be lost, as columns that no table of runs has;"
            " save to another file",
            key="lost",
        )
    text = sheet.csv() or EMPTY_TABLE
    write_atomically(path, text)
    return SheetFile(path=path, state=_state(text.encode()))


def has_runs_in_use(path: Path) -> bool:
    """Whether a file is a table with a run that is not switched off."""
    sheet, _ = stored_sheet(path)
    return any(sheet.is_used(row) for row in range(len(sheet.rows)))


def _content(path: Path) -> bytes | None:
    """Bytes of a file; None where there is none."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as failure:
        raise InvalidInput(f"{path}: cannot be read: {failure.strerror}") from None


def _state(content: bytes) -> str:
    """Digest of a content."""
    return hashlib.sha256(content).hexdigest()


def _has_rows(content: bytes) -> bool:
    """Whether a text has a line with a cell below its headings."""
    rows = csv.reader(io.StringIO(content.decode("utf-8-sig", "replace")))
    try:
        return sum(any(cell.strip() for cell in row) for row in rows) > 1
    except csv.Error:
        return True  # which its reader refuses
