"""Raw columns and provenance from the attributes of hierarchical files (HDF5 and netCDF)."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable

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
