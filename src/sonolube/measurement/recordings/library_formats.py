"""Recordings read through libraries: HDF5 (also netCDF 4), classic netCDF, and universal files of vibrometers."""

import warnings
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.hdf5_datasets import attributes_of, numeric_datasets
from sonolube.measurement.measured_files import ClippedReader, require_channels, require_values
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, refuse_library_errors

_ORIGIN_KEYS = ("title", "file_name", "file_format", "sha256", "begun")

COLUMN_ATTRIBUTES = ("units", "unit", "sample_rate", "_FillValue")
"""Attributes of a variable that are read."""

FILE_ATTRIBUTES = ("sample_rate", "caveats", *_ORIGIN_KEYS, *(f"original_{key}" for key in _ORIGIN_KEYS))
"""Attributes of a file that are read."""


def column_from_attributes(label: str, values: Any, attributes: Mapping[str, Any], file_rate: Any) -> RawColumn:
    """Column with unit, sample interval and missing values by the attributes of its variable."""
    unit = attributes.get("units", attributes.get("unit"))
    rate = attributes.get("sample_rate", file_rate)
    rate = float(np.ravel(rate)[0]) if rate is not None else 0.0
    fill = attributes.get("_FillValue")
    numbers = values.astype(np.float64, copy=False)
    if fill is not None and np.ravel(fill).size == 1:
        numbers = np.where(values == np.ravel(fill)[0], np.nan, numbers)
    return RawColumn(
        label=label,
        values=numbers,
        unit=unit.decode() if isinstance(unit, bytes) else (str(unit) if unit is not None else None),
        start=0.0,
        interval=1 / rate if rate > 0 else None,
    )


def table_from_attributes(
    columns: list[RawColumn], attributes: Mapping[str, Any], path: Path, format_name: str
) -> RawTable:
    """Table of at least one vector with the provenance of its first file, as the attributes of the file state it."""
    if not columns:
        raise InvalidInput(f"{path}: holds no vector of numbers")
    stated = {key: attributes.get(f"original_{key}", attributes.get(key)) for key in _ORIGIN_KEYS}
    origin = {key: _text(value) for key, value in stated.items() if value is not None}
    return RawTable(
        columns=tuple(columns),
        format_name=format_name,
        begun=origin.pop("begun", ""),
        origin=origin,
        caveats=tuple(filter(None, _text(attributes.get("caveats", "")).split("\n"))),
    )


def _text(value: object) -> str:
    """Attribute as text."""
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


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


_A_LINE = 6  # values of a line of a universal file, at most
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


_TIME_TYPES = (0, 1)  # function types of data set 58: general, and time response


@final
class UniversalFile:
    """Universal files (UFF) with time responses in data set 58."""

    name: ClassVar[str] = "universal file"
    suffixes: ClassVar[tuple[str, ...]] = (".uff", ".unv")

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the first line is the delimiter -1 and the second the number of a data set."""
        lines = [line.strip() for line in head.splitlines()[:2]]
        return lines[:1] == [b"-1"] and len(lines) > 1 and lines[1][:6].split(b"b")[0].strip().isdigit()

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Time responses of a universal file.

        Labels are those of the ordinate, or node and direction of the response where it has none.
        """
        import pyuff

        with refuse_library_errors(path, format_name=self.name):
            file = pyuff.UFF(str(path))
            types = np.atleast_1d(file.get_set_types())
            functions = np.flatnonzero(types == 58)
            require_channels(functions.size, path, kind="data sets")
            sets = [file.read_sets(int(index)) for index in functions]
            responses = [one for one in sets if one["func_type"] in _TIME_TYPES and not np.iscomplexobj(one["data"])]
            labels = Counter(_field_text(data, "ordinate_axis_lab") for data in responses)
            columns = [_column(data, labels) for data in responses]
        if not columns:
            raise InvalidInput(f"{path}: holds no time response (data set 58, function type 1)")
        for data in responses:
            if len(data["data"]) != data["num_pts"] and not _is_filled(data):
                raise InvalidInput(f"{path}: a response of {data['num_pts']} values has {len(data['data'])}")
        uneven = [data for data in responses if data["abscissa_spacing"] == 0]
        if uneven and len(responses) > 1:
            raise InvalidInput(f"{path}: unevenly sampled responses must each have a file of their own")
        if uneven:
            times = np.asarray(uneven[0]["x"][: int(uneven[0]["num_pts"])], dtype=np.float64)
            columns.insert(0, RawColumn(label="time", values=times, unit="s"))
        return RawTable(columns=tuple(columns), format_name=self.name)


def _is_filled(data: dict[str, Any]) -> bool:
    """Whether a response holds its values and zeros up to the end of its last line."""
    more = np.asarray(data["data"])[int(data["num_pts"]) :]
    return 0 < more.size < _A_LINE and not np.any(more)


def _column(data: dict[str, Any], labels: Counter[str]) -> RawColumn:
    """Column of one response, labelled uniquely among all responses."""
    label = _field_text(data, "ordinate_axis_lab")
    if not label or labels[label] > 1:
        label = f"{label or 'response'} node {data['rsp_node']} direction {data['rsp_dir']}"
    unit = _field_text(data, "ordinate_axis_units_lab")
    evenly_sampled = data["abscissa_spacing"] == 1
    return RawColumn(
        label=label,
        values=np.asarray(data["data"][: int(data["num_pts"])], dtype=np.float64),
        unit=unit or None,
        start=float(data["abscissa_min"]) if evenly_sampled else None,
        interval=float(data["abscissa_inc"]) if evenly_sampled else None,
    )


def _field_text(data: dict[str, Any], key: str) -> str:
    """Text field; empty for the placeholders NONE and NO NAME."""
    text = str(data.get(key, "")).strip()
    return "" if text.upper() in ("NONE", "NO NAME") else text
