"""Reading and writing of recordings as xarray datasets, whole or in blocks, in any format of `RECORDING_FORMATS`.

A format is one class and one line of the table; detection, messages and documentation derive from it.
"""

import hashlib
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from sonolube.errors import InvalidInput, suggestion
from sonolube.measurement.measured_files import (
    FileFormat,
    change_since_recorded,
    detect_format,
    read_head,
    refuse_unreadable,
)
from sonolube.measurement.recordings.dataset import recording_dataset, require_increasing_axis
from sonolube.measurement.recordings.mapping import RecordingMapping, mapping_toml, read_mapping
from sonolube.measurement.recordings.raw_table import RawTable, recorded_warnings
from sonolube.storage.files import user_state_folder, write_atomically
from sonolube.storage.user_files import open_input, require_file
from sonolube.variants import VariantTable

if TYPE_CHECKING:
    import xarray as xr


class RecordingFormat(FileFormat, Protocol):
    """Reader of one file format of recordings."""

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Columns of a file.

        Parameters
        ----------
        path : Path
            Of the file.
        mapping : RecordingMapping or None
            Assignment of the columns, for formats that read only those it names or need its text layout.

        Returns
        -------
        RawTable

        Raises
        ------
        InvalidInput
            Naming the file, the line or byte where known, and the reason, if the file cannot be read.
        """


@runtime_checkable
class StreamedRecordingFormat(RecordingFormat, Protocol):
    """Reader of a file format that can also be read in blocks, without holding the file in memory."""

    def read_blocks(self, path: Path, *, mapping: RecordingMapping | None, block_samples: int) -> Iterator[RawTable]:
        """Yield the columns of a file in blocks of rows; the last may be shorter.

        Parameters
        ----------
        path : Path
            Of the file.
        mapping : RecordingMapping or None
            As `read`.
        block_samples : int
            Rows of a block.

        Yields
        ------
        RawTable

        Raises
        ------
        InvalidInput
            As `read`.
        """


RECORDING_FORMATS: VariantTable[RecordingFormat] = VariantTable(
    "recording format",
    {
        "TDMS": "sonolube.measurement.recordings.tdms:Tdms",
        "LabVIEW measurement text": "sonolube.measurement.recordings.text_recordings:LabviewText",
        "MATLAB": "sonolube.measurement.recordings.matlab:Matlab",
        "HDF5": "sonolube.measurement.recordings.library_formats:Hdf5",
        "netCDF 3": "sonolube.measurement.recordings.library_formats:NetCdf3",
        "universal file": "sonolube.measurement.recordings.library_formats:UniversalFile",
        "delimited text": "sonolube.measurement.recordings.text_recordings:DelimitedText",
    },
    made=lambda known: known(),
)
"""File formats of recordings in order of detection, the last one as fallback; a new one takes its file and one line."""


_TEXTS = ("LabVIEW measurement text", "delimited text")  # which are read once, also from a pipe


def recording_format(path: Path) -> RecordingFormat:
    """Format of a recording, by its signature, then by its suffix."""
    head = read_head(path)
    found = detect_format(tuple(RECORDING_FORMATS.values()), head, path)
    if found is None:
        known = ", ".join(RECORDING_FORMATS)
        raise InvalidInput(f"{path}: byte 0: begins with {head[:8]!r}, which is no known format of recordings: {known}")
    if found.name not in _TEXTS:
        with refuse_unreadable(path):
            require_file(path)
    return found


_FOLDER = Path(str(files("sonolube.measurement.recordings"))) / "instruments"


@cache
def instrument_mappings() -> dict[str, RecordingMapping]:
    """Mappings of the package by name, such as "umt"."""
    return {path.stem: read_mapping(path) for path in sorted(_FOLDER.glob("*.toml"))}


_RECIPES = "instruments"
_FIRST: ContextVar[Path | None] = ContextVar("folder of recipes", default=None)


@contextmanager
def recipes_first_in(folder: Path | None) -> Iterator[None]:
    """Look for recipes in a folder first, and keep new ones there, inside a `with` block; None for no such folder."""
    token = _FIRST.set(folder)
    try:
        yield
    finally:
        _FIRST.reset(token)


def recipe_folders(beside: Path) -> tuple[Path, ...]:
    """Folders of recipes, the mappings of a user's instruments: one in the folder of a file, and one of the user.

    Before them that of `recipes_first_in`.
    """
    first = _FIRST.get()
    return *(() if first is None else (first,)), beside.parent / _RECIPES, user_state_folder() / _RECIPES


def recipes(beside: Path) -> dict[str, RecordingMapping]:
    """Recipes by name that hold for a file, in the order of their folders."""
    found = [path for folder in recipe_folders(beside) if folder.is_dir() for path in sorted(folder.glob("*.toml"))]
    known: dict[str, RecordingMapping] = {}
    for path in found:
        known.setdefault(path.stem, read_mapping(path))
    return known


def keep_recipe(name: str, mapping: RecordingMapping, *, labels: str) -> Path:
    """Keep a mapping of the user for all files with a line of labels.

    Parameters
    ----------
    name : str
        Of the instrument.
    mapping : RecordingMapping
    labels : str
        Line of labels, by which files are recognised.

    Returns
    -------
    Path
        Of the recipe.

    Raises
    ------
    InvalidInput
        If the name is no name of a file or is that of a mapping of the package, or the line holds no words.
    """
    if not re.fullmatch(r"[\w-]{1,60}", name):
        raise InvalidInput(f"a name of an instrument has letters, digits and hyphens, got {name[:60]!r}")
    if name in instrument_mappings():
        raise InvalidInput(f"{name} is a mapping of sonolube; choose another name")
    line = labels.strip()
    if not re.search(r"[^\W\d_]{2}", line):
        raise InvalidInput(f"{line[:60]!r}: files are recognised by their labels, and these hold no words")
    pattern = re.sub(r"[^\x00-\x7f]+", ".+?", re.escape(line))
    text = replace(mapping.text, lines_to_skip=0)  # the lines above the labels differ from file to file
    known = replace(mapping, name=name, text=text, recognised_by=rf"(?m)^\s*{pattern}\s*$")
    return write_atomically((_FIRST.get() or user_state_folder() / _RECIPES) / f"{name}.toml", mapping_toml(known))


def labels_of_runs(labels: Sequence[str]) -> str:
    """Line by which recipes know a table of runs with these labels, however its file separates them."""
    return f"runs: {'; '.join(labels)}"


def recipe_of_runs(path: Path, labels: Sequence[str]) -> RecordingMapping | None:
    """Recipe for the tables of runs with these labels; None where there is none."""
    fitting = (known for known in recipes(path).values() if known.recognised_by)
    return next((known for known in fitting if re.search(known.recognised_by, labels_of_runs(labels))), None)


def mapping_by_name(text: str) -> RecordingMapping:
    """Mapping of the package or a recipe by its name, or one from a file.

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
    path = Path(text)
    if path.suffix == ".toml" or path.exists():
        return read_mapping(path)
    known = {**instrument_mappings(), **recipes(path)}
    if text in known:
        return known[text]
    hint = suggestion(text, known) or f"mappings are {', '.join(known)}"
    raise InvalidInput(f"{text}: no mapping of this name and no such file; {hint}")


def recognised_mapping(path: Path) -> RecordingMapping | None:
    """Recipe, or mapping of the package, that fits a file by its beginning; None where none does."""
    head = read_head(path)
    encoding = "utf-16" if head[:2] in (b"\xff\xfe", b"\xfe\xff") else "latin-1"  # patterns are ASCII
    text = (
        head.removeprefix(b"\xef\xbb\xbf").decode(encoding, errors="ignore").replace("\r\n", "\n").replace("\r", "\n")
    )
    every = (*recipes(path).values(), *instrument_mappings().values())
    fitting = (known for known in every if known.recognised_by)
    return next((known for known in fitting if re.search(known.recognised_by, text)), None)


def read_recording(path: str | Path, *, mapping: RecordingMapping | Path | None = None) -> "xr.Dataset":
    """Recording read from a file.

    Parameters
    ----------
    path : str or Path
        In any format of `RECORDING_FORMATS`, which is detected by content and then by suffix.
    mapping : RecordingMapping, Path or None
        Assignment of the columns, or the TOML file that holds it. Without it a mapping of the package is taken where
        the file is unmistakably an export of its instrument, else columns are assigned by their labels.

    Returns
    -------
    xarray.Dataset
        One variable per channel along `time`, or along `revolutions` for exports with one row per cycle. Variables have
        the attributes `units`, `long_name`, and the column, unit and calibration they come from; the dataset has
        `sample_rate`, `dropped_samples`, `file_name`, `file_format`, `sha256`, the version of the software, and
        `mapping` and `caveats` where there are any.

    Raises
    ------
    InvalidInput
        Naming the file, the line or byte, and the reason, if the file cannot be read or its time does not increase.

    See Also
    --------
    recording_blocks : the same in blocks, for files larger than memory.
    write_recording : the inverse, as netCDF.
    """
    path = Path(path)
    file_format = recording_format(path)
    columns = _mapping(mapping, path)
    with recorded_warnings() as complaints:
        table = file_format.read(path, mapping=columns)
    digest = _sha256(path)
    table = replace(table, caveats=(*change_since_recorded(path, digest), *table.caveats, *complaints))
    return recording_dataset(table, path=path, mapping=columns, digest=digest)


def recording_blocks(
    path: Path, *, mapping: RecordingMapping | Path | None = None, block_samples: int = 1 << 18
) -> Iterator["xr.Dataset"]:
    """Yield a recording in consecutive blocks of samples.

    Parameters
    ----------
    path : Path
        As `read_recording`.
    mapping : RecordingMapping, Path or None
        As `read_recording`.
    block_samples : int
        Samples of a block; the last may have fewer.

    Yields
    ------
    xarray.Dataset
        As `read_recording`, each with its own part of the time.

    Raises
    ------
    InvalidInput
        As `read_recording`, or if `block_samples` is not positive.

    Notes
    -----
    Formats that are `StreamedRecordingFormat` (TDMS) are streamed: memory holds one chunk, as it was written, and one
    block. LabVIEW writes small chunks; a defragmented file is one chunk. Files of other formats are read whole.
    """
    if block_samples < 1:
        raise InvalidInput(f"block_samples must be positive, got {block_samples}")
    file_format = recording_format(path)
    columns = _mapping(mapping, path)
    if not isinstance(file_format, StreamedRecordingFormat):
        whole = read_recording(path, mapping=columns)
        axis = next(iter(whole.sizes))
        for first in range(0, whole.sizes[axis], block_samples):
            yield whole.isel({axis: slice(first, first + block_samples)})
        return
    digest, last = _sha256(path), -math.inf
    for table in _recorded(file_format.read_blocks(path, mapping=columns, block_samples=block_samples)):
        block = recording_dataset(table, path=path, mapping=columns, digest=digest, partial=True)
        quantity = str(next(iter(block.sizes)))
        values = block[quantity].to_numpy()
        joint, place = np.array([last, values[0]]), f"sample {table.first_row}".format
        require_increasing_axis(joint, quantity=quantity, path=path, place=place)
        last = values[-1]
        yield block


def _recorded(blocks: Iterator[RawTable]) -> Iterator[RawTable]:
    """Yield blocks with the warnings that their reading issued as caveats."""
    while True:
        with recorded_warnings() as complaints:
            table = next(blocks, None)
        if table is None:
            return
        yield replace(table, caveats=(*table.caveats, *complaints))


def write_recording(recording: "xr.Dataset", *, path: Path) -> Path:
    """Write a recording as netCDF, atomically; `read_recording` reads it back.

    Parameters
    ----------
    recording : xarray.Dataset
        As returned by `read_recording`.
    path : Path
        Destination.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    InvalidInput
        If the destination cannot be written to.
    """
    return write_atomically(path, bytes(recording.to_netcdf(engine="h5netcdf")))


def recording_format_name(path: Path) -> str:
    """Name of the format of a recording, by its signature, then by its suffix.

    Parameters
    ----------
    path : Path
        Of the file.

    Returns
    -------
    str
        Name of an entry of `RECORDING_FORMATS`.

    Raises
    ------
    InvalidInput
        If the file is missing, empty, or of no known format.
    """
    return recording_format(path).name


def _mapping(mapping: RecordingMapping | Path | None, path: Path) -> RecordingMapping | None:
    """Mapping: read from its file where a path is given, else the one by which the file is recognised."""
    given = read_mapping(mapping) if isinstance(mapping, Path) else mapping
    if given is not None and not given.only_selects:
        return given
    found = recognised_mapping(path)
    if given is None or found is None:
        return found or given
    return replace(found, selection=given.selection)


def _sha256(path: Path) -> str:
    """SHA-256 digest of a file, in hexadecimal."""
    with open_input(path) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
