"""Recordings of tribometers: datasets over time, read whole or in blocks, whatever wrote them."""

import hashlib
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Protocol

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.files import write_atomically
from sonolube.measurement.recordings import delimited, matlab, tdms
from sonolube.measurement.recordings import hdf5 as hierarchical
from sonolube.measurement.recordings import lvm as labview_text
from sonolube.measurement.recordings import uff as universal_file
from sonolube.measurement.recordings.dataset import assemble, refuse_unsorted
from sonolube.measurement.recordings.mapping import RecordingMapping, read_mapping
from sonolube.measurement.recordings.table import Table

if TYPE_CHECKING:
    import xarray as xr


class Reader(Protocol):
    """What reads one format."""

    def __call__(self, path: Path, *, mapping: RecordingMapping | None = None) -> Table:
        """Return the columns of a file."""
        ...


READERS: Mapping[str, Reader] = MappingProxyType(
    {
        tdms.FORMAT: tdms.read_tdms,
        labview_text.FORMAT: labview_text.read_labview_text,
        matlab.FORMAT: matlab.read_matlab,
        hierarchical.FORMAT_HDF5: hierarchical.read_hierarchical,
        hierarchical.FORMAT_NETCDF3: hierarchical.read_hierarchical,
        universal_file.FORMAT: universal_file.read_universal_file,
        delimited.FORMAT: delimited.read_delimited,
    }
)
_BINARY_SUFFIXES = {".mat": matlab.FORMAT, ".uff": universal_file.FORMAT, ".unv": universal_file.FORMAT}


def read_recording(path: Path, *, mapping: RecordingMapping | Path | None = None) -> "xr.Dataset":
    """Return the recording that a file holds.

    Parameters
    ----------
    path : Path
        TDMS, LVM, delimited text, MATLAB, HDF5, netCDF or universal file; known by its content, then its suffix.
    mapping : RecordingMapping, Path or None
        What the columns mean, or the TOML file that says it. Without it columns are taken by their labels.

    Returns
    -------
    xarray.Dataset
        One variable a channel along `time`, or along `revolutions` for exports with one row a cycle. Variables carry
        `units`, `long_name`, and how they came from the file's column; the dataset carries `sample_rate`,
        `dropped_samples`, `file_name`, `file_format`, `sha256` and the version of the software.

    Raises
    ------
    InvalidInput
        Naming the file, the line or byte, and the reason, if the file cannot be read or its time is no time.
    """
    known = _known(mapping)
    table = READERS[format_of(path)](path, mapping=known)
    return assemble(table, path=path, mapping=known, digest=_digest(path))


def blocks(
    path: Path, *, mapping: RecordingMapping | Path | None = None, block_samples: int = 1 << 18
) -> Iterator["xr.Dataset"]:
    """Yield a recording in blocks, one after the other.

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
        As `read_recording`, each with its own times.

    Raises
    ------
    InvalidInput
        As `read_recording`, or if `block_samples` is not positive.

    Notes
    -----
    Of a TDMS file memory holds one chunk, as it was written, and one block. LabVIEW's chunks are small; a file that was
    defragmented is one chunk. Files of other formats are read whole.
    """
    if block_samples < 1:
        raise InvalidInput(f"block_samples must be positive, got {block_samples}")
    known = _known(mapping)
    if format_of(path) != tdms.FORMAT:
        whole = read_recording(path, mapping=known)
        along = next(iter(whole.sizes))
        for first in range(0, whole.sizes[along], block_samples):
            yield whole.isel({along: slice(first, first + block_samples)})
        return
    digest, last = _digest(path), -math.inf
    for table in tdms.tdms_tables(path, mapping=known, block_samples=block_samples):
        block = assemble(table, path=path, mapping=known, digest=digest, partial=True)
        along = str(next(iter(block.sizes)))
        axis = block[along].to_numpy()
        refuse_unsorted(np.array([last, axis[0]]), along=along, path=path, place=f"sample {table.first_row}".format)
        last = axis[-1]
        yield block


def write_recording(recording: "xr.Dataset", *, path: Path) -> Path:
    """Write a recording as netCDF, whole or not at all; `read_recording` gives it back.

    Parameters
    ----------
    recording : xarray.Dataset
        As `read_recording` gives it.
    path : Path
        Where to.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    InvalidInput
        If the place cannot be written to.
    """
    return write_atomically(path, bytes(recording.to_netcdf(engine="h5netcdf")))


def format_of(path: Path) -> str:
    """Return the name of the format of a file, by its content and then its suffix.

    Parameters
    ----------
    path : Path
        Of the file.

    Returns
    -------
    str
        A key of `READERS`.

    Raises
    ------
    InvalidInput
        If the file is missing, empty, or of no format known.
    """
    try:
        with path.open("rb") as stream:
            head = stream.read(1024)
    except OSError as failure:
        raise InvalidInput(f"{path}: cannot be read: {failure.strerror}") from None
    if not head:
        raise InvalidInput(f"{path}: is empty")
    if found := _format_by_content(head):
        return found
    if path.suffix.lower() in _BINARY_SUFFIXES:
        return _BINARY_SUFFIXES[path.suffix.lower()]
    if b"\0" in head and not head.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InvalidInput(f"{path}: byte 0: begins with {head[:8]!r}, which no known format of recordings does")
    return delimited.FORMAT


def _format_by_content(head: bytes) -> str | None:
    if head.startswith(b"TDSm"):
        return tdms.FORMAT
    if head.startswith(b"MATLAB "):
        return matlab.FORMAT
    if head.startswith(hierarchical.HDF5_MAGIC):
        return hierarchical.FORMAT_HDF5
    if head[:3] == hierarchical.NETCDF3_MAGIC and head[3:4] in (b"\1", b"\2", b"\5"):
        return hierarchical.FORMAT_NETCDF3
    if head.removeprefix(b"\xef\xbb\xbf").startswith(labview_text.MAGIC.encode()):
        return labview_text.FORMAT
    lines = [line.strip() for line in head.splitlines()[:2]]
    if lines[:1] == [b"-1"] and len(lines) > 1 and lines[1][:6].split(b"b")[0].strip().isdigit():
        return universal_file.FORMAT
    return None


def _known(mapping: RecordingMapping | Path | None) -> RecordingMapping | None:
    return read_mapping(mapping) if isinstance(mapping, Path) else mapping


def _digest(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
