"""From the columns of a file to a recording: vocabulary names, SI units, one axis, provenance."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube import __version__
from sonolube.checks import Floats
from sonolube.errors import InvalidInput, suggestion
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable
from sonolube.units import convert
from sonolube.vocabulary import quantities, unit_of

if TYPE_CHECKING:
    import xarray as xr

_LABEL_AND_UNIT = re.compile(r"^(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*)\))\s*$", re.DOTALL)
_BEYOND_ANY_SENSOR = 1e30  # in any unit; keeps powers of samples within what a float can hold
_AXIS_LABELS = {"time", "t", "x_value", "timestamp", "elapsed_time"}

# What instruments write, as (factor, unit): pint takes rpm for an angular speed and gauss for a unit of another system.
_SPELLINGS = {
    "newtons": (1.0, "N"),
    "volts": (1.0, "V"),
    "amps": (1.0, "A"),
    "amperes": (1.0, "A"),
    "seconds": (1.0, "s"),
    "sec": (1.0, "s"),
    "deg c": (1.0, "degC"),
    "°c": (1.0, "degC"),
    "celsius": (1.0, "degC"),
    "g": (1e-4, "T"),
    "gauss": (1e-4, "T"),
    "rpm": (1 / 60, "1/s"),
    "u/min": (1 / 60, "1/s"),
    "1": (1.0, ""),
    "-": (1.0, ""),
}


def recording_dataset(
    table: RawTable, *, path: Path, mapping: RecordingMapping | None, digest: str, partial: bool = False
) -> "xr.Dataset":
    """Return the recording that the columns of a file make.

    Parameters
    ----------
    table : Table
        As its reader gives it.
    path : Path
        Of the file.
    mapping : RecordingMapping or None
        What the columns mean; without one they are taken by their labels.
    digest : str
        SHA-256 of the file.
    partial : bool
        Whether the rows are a block of the file, in which a channel may hold no value.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InvalidInput
        If there are no rows or no channels, a column that the mapping names is missing, a unit is of another kind,
        the axis does not increase, a value is infinite or beyond 1e30, or a channel holds no value at all.
    """
    import xarray as xr

    sources = _sources(table, path, mapping)
    along = _along(table, mapping)
    axis = _axis(table, path, mapping, sources, along)
    if axis.size == 0:
        raise InvalidInput(f"{path}: holds no samples")
    require_increasing_axis(axis, along=along, path=path, place=table.place)
    variables = {name: (along, *_channel(name, table, path, source, partial)) for name, source in sources.items()}
    if not variables:
        raise InvalidInput(f"{path}: holds no channel beside its {along}")
    known = quantities()[along]
    return xr.Dataset(
        variables,
        coords={along: (along, axis, {"units": known.unit or "1", "long_name": known.meaning})},
        attrs=_attributes(table, path, mapping, digest, axis if along == "time" else None),
    )


def _along(table: RawTable, mapping: RecordingMapping | None) -> str:
    if mapping is not None:
        return mapping.along
    names = {_name_and_unit(column)[0] for column in table.columns}
    timed = names & _AXIS_LABELS or any(column.interval is not None for column in table.columns)
    return "revolutions" if "revolutions" in names and not timed else "time"


def _sources(table: RawTable, path: Path, mapping: RecordingMapping | None) -> dict[str, ChannelSource]:
    if mapping is not None and mapping.channels:
        return dict(mapping.channels)
    sources: dict[str, ChannelSource] = {}
    for column in table.columns:
        name, unit = _name_and_unit(column)
        if name in _AXIS_LABELS or name == _along(table, mapping):
            continue
        if name in sources:
            raise InvalidInput(f"{path}: two columns are called {column.label!r}; say with a mapping which is wanted")
        sources[name] = ChannelSource(column=column.label, unit=unit)
    return sources


def _name_and_unit(column: RawColumn) -> tuple[str, str | None]:
    match = _LABEL_AND_UNIT.match(column.label)
    label, unit = (match[1], match[2] if match[2] is not None else match[3]) if match else (column.label, None)
    name = re.sub(r"\W+", "_", label.strip().lower()).strip("_") or "channel"
    return name, column.unit if column.unit is not None else unit


def _column(table: RawTable, path: Path, label: str) -> RawColumn:
    for column in table.columns:
        if column.label == label:
            return column
    labels = [column.label for column in table.columns]
    hint = suggestion(label, labels) or "it has " + ", ".join(labels[:12])
    raise InvalidInput(f"{path}: has no column {label!r}; {hint}")


def _channel(
    name: str, table: RawTable, path: Path, source: ChannelSource, partial: bool
) -> tuple[Floats, dict[str, str | float]]:
    column = _column(table, path, source.column)
    values = column.values
    beyond = np.abs(values) > _BEYOND_ANY_SENSOR
    if beyond.any():
        row = int(np.argmax(beyond))
        told = "infinite" if np.isinf(values[row]) else f"{values[row]:g}, beyond any sensor"
        raise InvalidInput(f"{path}: {table.place(row)}: {column.label!r} is {told}")
    if values.size and not partial and np.isnan(values).all():
        raise InvalidInput(f"{path}: {column.label!r} holds no value among {values.size}")
    written = source.unit if source.unit is not None else _name_and_unit(column)[1]
    known = quantities().get(name)
    calibrated = values if (source.gain, source.offset) == (1.0, 0.0) else values * source.gain + source.offset
    unit = known.unit if known else (written or "")
    if known and written is not None:
        calibrated = convert_to_si(calibrated, written_unit=written, unit=unit, name=f"{path}: {column.label!r}")
    return calibrated, {
        "units": unit or "1",
        "long_name": known.meaning if known else column.label,
        "source_column": column.label,
        "source_unit": "not stated, taken as SI" if written is None else written,
        "calibration_gain": source.gain,
        "calibration_offset": source.offset,
    }


def convert_to_si(values: Floats, *, written_unit: str, unit: str, name: str) -> Floats:
    """Return values in SI that were written in another unit of the kind.

    Parameters
    ----------
    values : ndarray
        As written.
    written_unit : str
        As instruments write it; "rpm" means turns, "G" means gauss.
    unit : str
        The SI unit wanted.
    name : str
        What to call the values in an error.

    Returns
    -------
    ndarray, shape of `values`

    Raises
    ------
    InvalidInput
        If the unit is unknown or of another kind.
    """
    written = " ".join(written_unit.split())
    factor, spelled = _SPELLINGS.get(written.lower(), (1.0, written))
    if spelled == unit and factor == 1:
        return values
    try:
        offset = convert(0.0, from_unit=spelled, to_unit=unit)
        gain = (convert(1.0, from_unit=spelled, to_unit=unit) - offset) * factor
    except InvalidInput as failure:
        raise InvalidInput(f"{name}: {str(failure).removeprefix('value 0.0 ')}") from None
    return values * gain + offset


def _axis(
    table: RawTable,
    path: Path,
    mapping: RecordingMapping | None,
    sources: dict[str, ChannelSource],
    along: str,
) -> Floats:
    if mapping is not None and mapping.axis is not None:
        return _axis_column(_column(table, path, mapping.axis.column), table, path, along, mapping.axis)
    rows = _rows(table, path, sources)
    if mapping is not None and mapping.sample_rate is not None:
        return (table.first_row + np.arange(rows)) / mapping.sample_rate
    for column in table.columns:
        name, unit = _name_and_unit(column)
        if name in _AXIS_LABELS or name == along:
            return _axis_column(column, table, path, along, ChannelSource(column=column.label, unit=unit))
    wanted = {source.column for source in sources.values()}
    waves = {(c.start or 0.0, c.interval) for c in table.columns if c.label in wanted and c.interval is not None}
    if len(waves) != 1:
        problem = "its channels have different time bases" if waves else "no column or property gives the time"
        raise InvalidInput(f"{path}: {problem}; name one with a mapping: axis.column or axis.sample_rate")
    start, interval = next(iter(waves))
    if interval is None or not (np.isfinite(start) and np.isfinite(interval) and interval > 0):
        raise InvalidInput(f"{path}: the time between samples is {interval!r} s")
    return start + interval * (table.first_row + np.arange(rows, dtype=np.float64))


def _rows(table: RawTable, path: Path, sources: dict[str, ChannelSource]) -> int:
    lengths = {source.column: _column(table, path, source.column).values.size for source in sources.values()}
    if len(set(lengths.values())) > 1:
        text = ", ".join(f"{label} {size}" for label, size in lengths.items())
        raise InvalidInput(f"{path}: channels have different numbers of samples ({text[:200]}); choose with a mapping")
    return next(iter(lengths.values()), 0)


def _axis_column(column: RawColumn, table: RawTable, path: Path, along: str, source: ChannelSource) -> Floats:
    values = column.values * source.gain + source.offset
    lost = ~np.isfinite(values)
    if lost.any():
        raise InvalidInput(f"{path}: {table.place(int(np.argmax(lost)))}: {column.label!r} is not a number")
    written = source.unit if source.unit is not None else column.unit
    if written is None:
        return values
    return convert_to_si(values, written_unit=written, unit=unit_of(along), name=f"{path}: {column.label!r}")


def require_increasing_axis(axis: Floats, *, along: str, path: Path, place: Callable[[int], str]) -> None:
    """Refuse an axis that does not increase.

    Parameters
    ----------
    axis : ndarray
        The values, in SI.
    along : str
        What they are: a word of the vocabulary.
    path : Path
        The file, for the message.
    place : callable
        Where in the file a row stands, for the message.

    Raises
    ------
    InvalidInput
        Naming the file and the first row at which it repeats or runs backwards.
    """
    wrong = np.diff(axis) <= 0
    if wrong.any():
        row = int(np.argmax(wrong)) + 1
        kind = "repeats" if axis[row] == axis[row - 1] else "runs backwards at"
        raise InvalidInput(f"{path}: {place(row)}: {along} {kind} {axis[row]:.10g} {unit_of(along)}".rstrip())


def _attributes(
    table: RawTable, path: Path, mapping: RecordingMapping | None, digest: str, time: Floats | None
) -> dict[str, str | int | float]:
    attributes: dict[str, str | int | float] = {
        "title": mapping.title if mapping and mapping.title else path.stem,
        "source": f"sonolube {__version__}",
        "file_name": path.name,
        "file_format": table.format,
        "sha256": digest,
    }
    attributes |= {f"original_{name}": value for name, value in table.origin.items()}
    if table.begun:
        attributes["begun"] = table.begun
    if table.incomplete:
        attributes["incomplete"] = "the file ends before the data it announces"
    if time is not None and time.size > 1:
        interval = float(np.median(np.diff(time)))
        steps = np.diff(time) / interval
        attributes["sample_rate"] = 1 / interval
        attributes["dropped_samples"] = int(np.sum(np.round(steps[steps > 1.5]) - 1))
    return attributes
