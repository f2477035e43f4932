"""HDF5 and netCDF 4 files, among them the recordings written by `write_recording`."""

from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from sonolube.measurement.recordings.attributes import column_from_attributes, table_from_attributes
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, refuse_library_errors

_SIGNATURE = b"\x89HDF\r\n\x1a\n"


@final
class Hdf5:
    """HDF5 files (also netCDF 4) whose one-dimensional numeric datasets are channels."""

    name: ClassVar[str] = "HDF5"
    suffixes: ClassVar[tuple[str, ...]] = (".h5", ".hdf5", ".nc")

    def recognises(self, head: bytes, path: Path) -> bool:
        """Return whether the file begins with the signature of HDF5."""
        return head.startswith(_SIGNATURE)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Return the vectors of an HDF5 file; those inside groups are labelled `group/vector`.

        Parameters
        ----------
        path : Path
            Of the file.
        mapping : RecordingMapping or None
            Not used: all vectors are read.

        Returns
        -------
        RawTable
            Units are those of the attributes `units` or `unit`, the sample interval that of the attribute `sample_rate`
            of the vector or of the file, in Hz.

        Raises
        ------
        InvalidInput
            Naming the file, if it cannot be read or holds no vector of numbers.
        """
        import h5py

        columns: list[RawColumn] = []
        with refuse_library_errors(path, format_name=self.name), h5py.File(path, "r") as file:
            rate = file.attrs.get("sample_rate")

            def visit(label: str, item: Any) -> None:
                if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiub" and item.ndim == 1:
                    columns.append(column_from_attributes(label, np.asarray(item[()]), dict(item.attrs), rate))

            file.visititems(visit)
            return table_from_attributes(columns, file.attrs, path, self.name)
