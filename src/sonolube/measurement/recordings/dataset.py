"""Assembly of a recording (xarray dataset) from raw columns: vocabulary names, SI units, one axis and provenance."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube import __version__
from sonolube.checks import Floats
from sonolube.errors import InvalidInput, suggestion
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, common_length
from sonolube.units import convert
from sonolube.vocabulary import quantities, unit_of

if TYPE_CHECKING:
    import xarray as xr

_LABEL_AND_UNIT = re.compile(r"^(.*?)\s*(?:\[([^\[\]]*)\]|\(([^()]*)\))\s*$", re.DOTALL)
_LARGEST_READING = 1e30  # in any unit; keeps powers of samples within the range of a float
_TIME_LABELS = {"time", "t", "x_value", "timestamp", "elapsed_time"}

# Unit spellings of instruments, as (factor, unit): pint reads rpm as an angular speed and gauss in another unit system.
_UNIT_SPELLINGS = {
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
    """Return a recording assembled from the columns of a file.

    Parameters
    ----------
    table : RawTable
        As the reader of the format returns it.
    path : Path
        Of the file.
    mapping : RecordingMapping or None
        Assignment of the columns; without it they are assigned by their labels.
    digest : str
        SHA-256 of the file.
    partial : bool
        Whether the rows are a block of the file, in which a channel may have missing values only.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InvalidInput
        If there are no rows or no channels, a column that the mapping names is missing, a unit has another dimension,
        the axis does not increase, a value is infinite or beyond 1e30, or a channel holds no value at all.
    """
    import xarray as xr

    sources = _channel_sources(table, path, mapping)
    quantity = _axis_quantity(table, mapping)
    axis = _axis(table, path, mapping, sources, quantity)
    if axis.size == 0:
        raise InvalidInput(f"{path}: holds no samples")
    lengths = {source.column: _column(table, path, source.column).values.size for source in sources.values()}
    common_length({quantity: axis.size} | lengths, path)
    require_increasing_axis(axis, quantity=quantity, path=path, place=table.place)
    variables = {name: (quantity, *_channel(name, table, path, source, partial)) for name, source in sources.items()}
    if not variables:
        raise InvalidInput(f"{path}: holds no channel beside its {quantity}")
    known = quantities()[quantity]
    return xr.Dataset(
        variables,
        coords={quantity: (quantity, axis, {"units": known.unit or "1", "long_name": known.meaning})},
        attrs=_attributes(table, path, mapping, digest, axis if quantity == "time" else None),
    )


def _axis_quantity(table: RawTable, mapping: RecordingMapping | None) -> str:
    """Return the quantity of the axis: that of the mapping, else revolutions where no column is a time, else time."""
    if mapping is not None:
        return mapping.axis_quantity
    names = {_name_and_unit(column)[0] for column in table.columns}
    timed = names & _TIME_LABELS or any(column.interval is not None for column in table.columns)
    return "revolutions" if "revolutions" in names and not timed else "time"


def _channel_sources(table: RawTable, path: Path, mapping: RecordingMapping | None) -> dict[str, ChannelSource]:
    """Return the source of each channel, by the mapping or by the labels of the columns."""
    if mapping is not None and mapping.channels:
        return dict(mapping.channels)
    axis_quantity = _axis_quantity(table, mapping)
    sources: dict[str, ChannelSource] = {}
    for column in table.columns:
        name, unit = _name_and_unit(column)
        if name in _TIME_LABELS or name == axis_quantity:
            continue
        if name in sources:
            raise InvalidInput(f"{path}: two columns have the label {column.label!r}; choose one with a mapping")
        sources[name] = ChannelSource(column=column.label, unit=unit)
    return sources


def _name_and_unit(column: RawColumn) -> tuple[str, str | None]:
    """Return the name of a channel from the label of its column, and the unit stated for it."""
    match = _LABEL_AND_UNIT.match(column.label)
    label, unit = (match[1], match[2] if match[2] is not None else match[3]) if match else (column.label, None)
    name = re.sub(r"\W+", "_", label.strip().lower()).strip("_") or "channel"
    return name, column.unit if column.unit is not None else unit


def _column(table: RawTable, path: Path, label: str) -> RawColumn:
    """Return the column of a label; refuse one that is not there, with the closest."""
    if label in table.by_label:
        return table.by_label[label]
    labels = [column.label for column in table.columns]
    hint = suggestion(label, labels) or "it has " + ", ".join(labels[:12])
    raise InvalidInput(f"{path}: has no column {label!r}; {hint}")


def _channel(
    name: str, table: RawTable, path: Path, source: ChannelSource, partial: bool
) -> tuple[Floats, dict[str, str | float]]:
    """Return the calibrated values of a channel in SI, and its attributes."""
    column = _column(table, path, source.column)
    values = column.values
    excessive = np.abs(values) > _LARGEST_READING
    if excessive.any():
        row = int(np.argmax(excessive))
        fault = "infinite" if np.isinf(values[row]) else f"{values[row]:g}, beyond any sensor"
        raise InvalidInput(f"{path}: {table.place(row)}: {column.label!r} is {fault}")
    if values.size and not partial and np.isnan(values).all():
        raise InvalidInput(f"{path}: {column.label!r} holds no value among {values.size}")
    stated = source.unit if source.unit is not None else _name_and_unit(column)[1]
    known = quantities().get(name)
    calibrated = values if (source.gain, source.offset) == (1.0, 0.0) else values * source.gain + source.offset
    unit = known.unit if known else (stated or "")
    if known and stated is not None:
        calibrated = convert_to_si(calibrated, written_unit=stated, unit=unit, name=f"{path}: {column.label!r}")
    return calibrated, {
        "units": unit or "1",
        "long_name": known.meaning if known else column.label,
        "source_column": column.label,
        "source_unit": "not stated, taken as SI" if stated is None else stated,
        "calibration_gain": source.gain,
        "calibration_offset": source.offset,
    }


def convert_to_si(values: Floats, *, written_unit: str, unit: str, name: str) -> Floats:
    """Return values in an SI unit, converted from the unit in which an instrument wrote them.

    Parameters
    ----------
    values : ndarray
        As written.
    written_unit : str
        In the spelling of instruments; "rpm" is revolutions per minute, "G" is gauss.
    unit : str
        The SI unit of the result.
    name : str
        Name of the values in error messages.

    Returns
    -------
    ndarray, shape of `values`

    Raises
    ------
    InvalidInput
        If the unit is unknown or of another dimension.
    """
    written = " ".join(written_unit.split())
    factor, spelled = _UNIT_SPELLINGS.get(written.lower(), (1.0, written))
    if spelled == unit and factor == 1:
        return values
    try:
        offset = convert(0.0, from_unit=spelled, to_unit=unit)
        gain = (convert(1.0, from_unit=spelled, to_unit=unit) - offset) * factor
    except InvalidInput as failure:
        raise InvalidInput(f"{name}: {str(failure).removeprefix('value 0.0 ')}") from None
    return values * gain + offset


def _axis(
    table: RawTable, path: Path, mapping: RecordingMapping | None, sources: dict[str, ChannelSource], quantity: str
) -> Floats:
    """Return the axis in SI: of the mapping's column or sample rate, of a time column, or of stated intervals."""
    if mapping is not None and mapping.axis is not None:
        return _axis_column(_column(table, path, mapping.axis.column), table, path, quantity, mapping.axis)
    labels = dict.fromkeys(source.column for source in sources.values())
    rows = common_length({label: _column(table, path, label).values.size for label in labels}, path)
    if mapping is not None and mapping.sample_rate is not None:
        return (table.first_row + np.arange(rows)) / mapping.sample_rate
    for column in table.columns:
        name, unit = _name_and_unit(column)
        if name in _TIME_LABELS or name == quantity:
            return _axis_column(column, table, path, quantity, ChannelSource(column=column.label, unit=unit))
    time_bases = {(c.start or 0.0, c.interval) for c in table.columns if c.label in labels and c.interval is not None}
    if len(time_bases) != 1:
        problem = "its channels have different time bases" if time_bases else "no column or property gives the time"
        raise InvalidInput(f"{path}: {problem}; name one with a mapping: axis.column or axis.sample_rate")
    start, interval = next(iter(time_bases))
    if interval is None or not (np.isfinite(start) and np.isfinite(interval) and interval > 0):
        raise InvalidInput(f"{path}: the time between samples is {interval!r} s")
    return start + interval * (table.first_row + np.arange(rows, dtype=np.float64))


def _axis_column(column: RawColumn, table: RawTable, path: Path, quantity: str, source: ChannelSource) -> Floats:
    """Return the calibrated values of the axis column in SI; refuse missing and infinite ones."""
    values = column.values * source.gain + source.offset
    missing = ~np.isfinite(values)
    if missing.any():
        raise InvalidInput(f"{path}: {table.place(int(np.argmax(missing)))}: {column.label!r} is not a number")
    stated = source.unit if source.unit is not None else column.unit
    if stated is None:
        return values
    return convert_to_si(values, written_unit=stated, unit=unit_of(quantity), name=f"{path}: {column.label!r}")


def require_increasing_axis(axis: Floats, *, quantity: str, path: Path, place: Callable[[int], str]) -> None:
    """Refuse an axis that does not increase.

    Parameters
    ----------
    axis : ndarray
        The values, in SI.
    quantity : str
        Their quantity in the vocabulary.
    path : Path
        The file, for the message.
    place : callable
        Returns the sample or line number of a row in the file, for the message.

    Raises
    ------
    InvalidInput
        Naming the file and the first row at which a value repeats or decreases.
    """
    wrong = np.diff(axis) <= 0
    if wrong.any():
        row = int(np.argmax(wrong)) + 1
        fault = "repeats" if axis[row] == axis[row - 1] else "decreases to"
        raise InvalidInput(f"{path}: {place(row)}: {quantity} {fault} {axis[row]:.10g} {unit_of(quantity)}".rstrip())


def _attributes(
    table: RawTable, path: Path, mapping: RecordingMapping | None, digest: str, time: Floats | None
) -> dict[str, str | int | float]:
    """Return the attributes of a recording: title, provenance, sample rate and number of dropped samples."""
    attributes: dict[str, str | int | float] = {
        "title": mapping.title if mapping and mapping.title else path.stem,
        "source": f"sonolube {__version__}",
        "file_name": path.name,
        "file_format": table.format_name,
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
