"""Mappings of the package for the exports of tribometers, by name and by the beginning of a file."""

import re
from functools import cache
from importlib.resources import files
from pathlib import Path

from sonolube.errors import InvalidInput, suggestion
from sonolube.measurement.file_format import read_head
from sonolube.measurement.recordings.mapping import RecordingMapping, read_mapping

_FOLDER = Path(str(files("sonolube.measurement.recordings"))) / "instruments"


@cache
def instrument_mappings() -> dict[str, RecordingMapping]:
    """Mappings of the package by name, such as "umt"."""
    return {path.stem: read_mapping(path) for path in sorted(_FOLDER.glob("*.toml"))}


def mapping_by_name(text: str) -> RecordingMapping:
    """Mapping of the package by its name, or one from a file.

    Parameters
    ----------
    text : str
        Name, such as "umt", or path of a TOML file.

    Returns
    -------
    RecordingMapping

    Raises
    ------
    InvalidInput
        If it is neither a name nor a file that can be read, with the closest name or all of them.
    """
    known = instrument_mappings()
    if text in known:
        return known[text]
    path = Path(text)
    if not path.exists() and path.suffix != ".toml":
        hint = suggestion(text, known) or f"mappings are {', '.join(known)}"
        raise InvalidInput(f"{text}: no mapping of this name and no such file; {hint}")
    return read_mapping(path)


def recognised_mapping(path: Path) -> RecordingMapping | None:
    """Mapping of the package that fits a file by its beginning; None where none does."""
    head = read_head(path)
    encoding = "utf-16" if head[:2] in (b"\xff\xfe", b"\xfe\xff") else "latin-1"  # patterns are ASCII
    text = (
        head.removeprefix(b"\xef\xbb\xbf").decode(encoding, errors="ignore").replace("\r\n", "\n").replace("\r", "\n")
    )
    fitting = (known for known in instrument_mappings().values() if known.recognised_by)
    return next((known for known in fitting if re.search(known.recognised_by, text)), None)
