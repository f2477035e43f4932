"""File formats of recordings: their protocol and the ordered table of all of them.

A format is one class in a file of its own and one line of `RECORDING_FORMATS`; detection, messages and documentation
derive from the table.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Protocol, runtime_checkable

from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import FileFormat, detect_format, read_head, refuse_unreadable
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawTable
from sonolube.storage.input_files import require_file
from sonolube.variants import VariantTable


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
        "LabVIEW measurement text": "sonolube.measurement.recordings.lvm:LabviewText",
        "MATLAB": "sonolube.measurement.recordings.matlab:Matlab",
        "HDF5": "sonolube.measurement.recordings.hdf5:Hdf5",
        "netCDF 3": "sonolube.measurement.recordings.netcdf3:NetCdf3",
        "universal file": "sonolube.measurement.recordings.uff:UniversalFile",
        "delimited text": "sonolube.measurement.recordings.delimited:DelimitedText",
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
