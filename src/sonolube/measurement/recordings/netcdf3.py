"""Classic netCDF files (version 3)."""

import warnings
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from sonolube.measurement.limits import ClippedReader, require_channels, require_values
from sonolube.measurement.recordings.attributes import column_from_attributes, table_from_attributes
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, refuse_library_errors

_SIGNATURES = (b"CDF\1", b"CDF\2", b"CDF\5")  # classic, 64-bit offset, 64-bit data


@final
class NetCdf3:
    """Classic netCDF files (version 3) whose one-dimensional numeric variables are channels."""

    name: ClassVar[str] = "netCDF 3"
    suffixes: ClassVar[tuple[str, ...]] = (".nc",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the file begins with a signature of classic netCDF."""
        return head.startswith(_SIGNATURES)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Vectors of a classic netCDF file.

        Units are those of the attributes `units` or `unit`, the sample interval that of the attribute `sample_rate` of
        the vector or of the file, in Hz.
        """
        from scipy.io import netcdf_file

        with refuse_library_errors(path, format_name=self.name), warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # that a refusal still refers to the mapped file
            with ClippedReader(path) as stream, netcdf_file(stream, "r", mmap=True) as file:
                return table_from_attributes(_columns(file, path), file._attributes, path, self.name)


def _columns(file: Any, path: Path) -> list[RawColumn]:
    """Copies of the vectors of a mapped file, whose variables may overlap and so state more than the file."""
    rate = getattr(file, "sample_rate", None)
    columns: list[RawColumn] = []
    values = 0
    for label, variable in file.variables.items():
        if variable.data.dtype.kind in "fiub" and len(variable.shape) == 1:
            values += variable.data.size
            require_values(values, path, part=f"variable {label!r}")
            require_channels(len(columns) + 1, path, kind="variables")
            columns.append(column_from_attributes(label, np.array(variable[:]), dict(variable._attributes), rate))
    return columns
