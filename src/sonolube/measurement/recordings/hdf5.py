"""HDF5 and netCDF 4 files, among them the recordings written by `write_recording`."""

from pathlib import Path
from typing import ClassVar, final

import numpy as np

from sonolube.measurement.hdf5_datasets import attributes_of, numeric_datasets
from sonolube.measurement.recordings.attributes import (
    COLUMN_ATTRIBUTES,
    FILE_ATTRIBUTES,
    column_from_attributes,
    table_from_attributes,
)
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawTable, refuse_library_errors

_SIGNATURE = b"\x89HDF\r\n\x1a\n"


@final
class Hdf5:
    """HDF5 files (also netCDF 4) whose one-dimensional numeric datasets are channels."""

    name: ClassVar[str] = "HDF5"
    suffixes: ClassVar[tuple[str, ...]] = (".h5", ".hdf5", ".nc")

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the file begins with the signature of HDF5."""
        return head.startswith(_SIGNATURE)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Vectors of an HDF5 file; those inside groups are labelled `group/vector`.

        Units are those of the attributes `units` or `unit`, the sample interval that of the attribute `sample_rate` of
        the vector or of the file, in Hz.
        """
        import h5py

        with refuse_library_errors(path, format_name=self.name), h5py.File(path, "r") as file:
            attributes = attributes_of(file, FILE_ATTRIBUTES, path)
            columns = [
                column_from_attributes(
                    label,
                    np.asarray(dataset[()]),
                    attributes_of(dataset, COLUMN_ATTRIBUTES, path),
                    attributes.get("sample_rate"),
                )
                for label, dataset in numeric_datasets(file, path, wanted=lambda label, dataset: dataset.ndim == 1)
            ]
            return table_from_attributes(columns, attributes, path, self.name)
