"""What a measured file holds: a recording, a scan of a surface, an impedance spectrum or a table of runs."""

import re
from pathlib import Path
from typing import Final, Literal

from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.spectrum import IMPEDANCE_FORMATS, text_lines
from sonolube.measurement.measured_files import HEAD_SIZE, first_lines, read_head
from sonolube.measurement.recordings.reader import RECORDING_FORMATS, recipe_of_runs, recognised_mapping
from sonolube.measurement.recordings.text_recordings import UTF_16_MARKS
from sonolube.measurement.recordings.text_tables import decoded_content
from sonolube.measurement.run_columns import RUN_COLUMNS
from sonolube.measurement.run_headings import run_heading
from sonolube.measurement.run_table import run_text
from sonolube.measurement.surface_files.reader import SURFACE_FORMATS

FileKind = Literal["recording", "scan", "spectrum", "runs"]
"""What a file holds."""

_LARGEST_TABLE: Final = 1 << 22  # bytes of a table of runs
_COLUMNS: Final = (".csv", ".tsv", ".txt", ".dat", ".asc", ".lvm")  # of texts that may be columns of anything
_LETTERS: Final = re.compile(r"(?![eE][-+]?\d)[A-Za-z]{2}|\[|\(")  # in a line of headings
_AXES: Final = ("time", "revolutions")
_OF_RUNS: Final = (
    "intrinsic_friction_force",
    "friction_ratio",
    "friction_reduction",
    "wear_rate_ratio",
    "wear_reduction",
)
_FORCE: Final = "friction_force"
_SETTINGS: Final = frozenset(column.name for column in RUN_COLUMNS if not (column.is_text or column.is_result))


def file_kind(path: Path) -> FileKind:
    """What a file holds, by its first bytes, its suffix and its headings.

    Parameters
    ----------
    path : Path
        Of the file.

    Returns
    -------
    {"recording", "scan", "spectrum", "runs"}
        "recording" for a text of columns that is nothing else.

    Raises
    ------
    InvalidInput
        If the file is missing or empty.
    """
    head = read_head(path)
    *instruments, named_columns = IMPEDANCE_FORMATS.values()
    if any(known.recognises(head, path) for known in instruments):
        return "spectrum"
    *scans, _ = SURFACE_FORMATS.values()
    has_headings = path.suffix.lower() in _COLUMNS and _LETTERS.search(first_lines(head)[0]) is not None
    if not has_headings and recognised_mapping(path) is None and any(known.recognises(head, path) for known in scans):
        return "scan"
    *recordings, text = RECORDING_FORMATS.values()
    if any(known.recognises(head, path) for known in recordings):
        return "recording"
    if not text.recognises(head, path):
        return "recording" if any(path.suffix.lower() in known.suffixes for known in recordings) else "scan"
    try:
        named_columns.read(path, _whole_lines(head, path))
    except InvalidInput:
        return "runs" if _is_table_of_runs(path) else "recording"
    return "spectrum"


def _whole_lines(head: bytes, path: Path) -> list[str]:
    """Lines of the first bytes of a text, as its reader decodes them, without the one that is cut."""
    whole = head if len(head) < HEAD_SIZE else head[: head.rfind(b"\n") + 1] or head
    if whole.startswith(UTF_16_MARKS):
        return text_lines(head.decode("utf-16", errors="ignore"))[: -1 if len(head) == HEAD_SIZE else None]
    return text_lines(decoded_content(whole, path)[0])


def _is_table_of_runs(path: Path) -> bool:
    """Whether the headings of a text are those of runs: a result that only runs have, or settings and no time."""
    if path.stat().st_size > _LARGEST_TABLE or recognised_mapping(path) is not None:
        return False
    try:
        table, _ = run_text(path)
    except InvalidInput:
        return False
    names = {found.name for label in table.labels if (found := run_heading(label)) is not None}
    if (recipe := recipe_of_runs(path, table.labels)) is not None:
        names = {*names, *recipe.channels}
    if not names.isdisjoint(_AXES):
        return False
    return not names.isdisjoint(_OF_RUNS) or (_FORCE in names and not names.isdisjoint(_SETTINGS))
