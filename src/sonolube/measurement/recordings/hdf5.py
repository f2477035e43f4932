"""HDF5 and netCDF files, among them the recordings that `write_recording` writes."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, refuse_library_errors

FORMAT_HDF5 = "HDF5"
FORMAT_NETCDF3 = "netCDF 3"
HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"
NETCDF3_MAGIC = b"CDF"
_ORIGIN = ("title", "file_name", "file_format", "sha256", "begun")


def read_hierarchical(path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
    """Return the vectors of an HDF5 or netCDF file; those inside groups as `group/vector`.

    Parameters
    ----------
    path : Path
        Of the file.
    mapping : RecordingMapping or None
        Not needed here: vectors are all read.

    Returns
    -------
    Table
        Units come from the attributes `units` or `unit`, the time between samples from `sample_rate` of the vector or
        of the file, in Hz.

    Raises
    ------
    InvalidInput
        Naming the file, if it cannot be read or holds no vector of numbers.
    """
    with path.open("rb") as stream:
        old = stream.read(3) == NETCDF3_MAGIC
    name = FORMAT_NETCDF3 if old else FORMAT_HDF5
    with refuse_library_errors(path, format_name=name):
        columns, attributes = _netcdf3(path) if old else _hdf5(path)
    if not columns:
        raise InvalidInput(f"{path}: holds no vector of numbers")
    return RawTable(columns=tuple(columns), format=name, begun=attributes.pop("begun", ""), origin=attributes)


def _origin(attributes: Mapping[str, Any]) -> dict[str, str]:
    """What a file says of the one it came from, the first one where it came through several."""
    origin = {}
    for key in _ORIGIN:
        value = attributes.get(f"original_{key}", attributes.get(key))
        if value is not None:
            origin[key] = value.decode(errors="replace") if isinstance(value, bytes) else str(value)
    return origin


def _hdf5(path: Path) -> tuple[list[RawColumn], dict[str, str]]:
    import h5py

    columns: list[RawColumn] = []

    with h5py.File(path, "r") as file:
        rate = file.attrs.get("sample_rate")

        def visit(name: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiub" and item.ndim == 1:
                columns.append(_column(name, np.asarray(item[()]), dict(item.attrs), rate))

        file.visititems(visit)
        return columns, _origin(file.attrs)


def _netcdf3(path: Path) -> tuple[list[RawColumn], dict[str, str]]:
    from scipy.io import netcdf_file

    with netcdf_file(path, "r", mmap=False) as file:
        rate = getattr(file, "sample_rate", None)
        columns = [
            _column(name, np.array(variable[:]), dict(variable._attributes), rate)
            for name, variable in file.variables.items()
            if variable.data.dtype.kind in "fiub" and len(variable.shape) == 1
        ]
        return columns, _origin(file._attributes)


def _column(name: str, values: Any, attributes: dict[str, Any], rate: Any) -> RawColumn:
    unit = attributes.get("units", attributes.get("unit"))
    rate = attributes.get("sample_rate", rate)
    rate = float(np.ravel(rate)[0]) if rate is not None else 0.0
    fill = attributes.get("_FillValue")
    numbers = values.astype(np.float64)
    if fill is not None and np.ravel(fill).size == 1:
        numbers = np.where(values == np.ravel(fill)[0], np.nan, numbers)
    return RawColumn(
        label=name,
        values=numbers,
        unit=unit.decode() if isinstance(unit, bytes) else (str(unit) if unit is not None else None),
        start=0.0,
        interval=1 / rate if rate > 0 else None,
    )
