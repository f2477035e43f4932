"""Folder of a rig: its file, and beside it own runs, recipes of instruments, records, answers and a posterior."""

from pathlib import Path
from typing import TYPE_CHECKING, Final

from sonolube.errors import InvalidInput

if TYPE_CHECKING:
    from sonolube.rig.record import Rig

RIG_FILE: Final = "rig.toml"
"""File of the rig; a folder that has one is that of a rig."""

RUNS_FILE: Final = "runs.csv"
"""Table of own runs."""

POSTERIOR_FILE: Final = "posterior.json"
"""Posterior by shipped and own published tests."""

INSTRUMENTS: Final = "instruments"
"""Folder of recipes, the mappings of instruments."""

RECORDS: Final = "records"
"""Folder of recorded runs."""

ANSWERS: Final = "answers"
"""Folder of figures, data and pages of answers."""


README_FILE: Final = "README.md"
"""What lies where in the folder."""

_README: Final = f"""# {{title}}

A rig of sonolube, whole when it is copied. Commands take this folder in place of a rig file, as in `sonolube predict .`

| | |
|---|---|
| `{RIG_FILE}` | the rig |
| `{RUNS_FILE}` | own runs, a row each, which predictions use; `--runs none` leaves them out |
| `{POSTERIOR_FILE}` | posterior by own published tests, where one lies here; `--evidence none` leaves it out |
| `{INSTRUMENTS}/` | recipes, by which files of instruments are read |
| `{RECORDS}/` | recorded runs, one folder each |
| `{ANSWERS}/` | figures, data and pages |
"""


def folder_contents(*, title: str, rig: str, runs: str) -> dict[str, str | None]:
    """Texts of the files of a new folder by their names, and None for each folder in it."""
    files = {RIG_FILE: rig, RUNS_FILE: runs, README_FILE: _README.format(title=title)}
    return files | dict.fromkeys((INSTRUMENTS, RECORDS, ANSWERS))


def rig_file(path: Path) -> Path:
    """File of a rig by its own path or that of its folder.

    Raises
    ------
    InvalidInput
        If it is a folder without one.
    """
    if not path.is_dir():
        return path
    if not (path / RIG_FILE).is_file():
        raise InvalidInput(f"{path}: cannot be read: is a folder, not a file, and without {RIG_FILE} not that of a rig")
    return path / RIG_FILE


def folder_of(rig: "Rig") -> Path | None:
    """Folder that a rig was read from; None where it was read from a file alone, or made in Python."""
    return rig.file if rig.file is not None and rig.file.is_dir() else None
