"""Assembly of a recording (xarray dataset) from raw columns: vocabulary names, SI units, one axis and provenance.

Caveats name samples far beyond all others of their channel, as a lost bit leaves them, and missing ones.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sonolube import __version__
from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.channels_and_parts import (
    FRICTION,
    TIME_LABELS,
    ChannelEntry,
    chosen_channels,
    friction_headings,
    name_and_unit,
    require_common_length,
)
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping
from sonolube.measurement.recordings.raw_table import (
    RawColumn,
    RawTable,
    column_of_label,
    convert_to_si,
    numbered_labels,
    si_conversion,
)
from sonolube.measurement.time_series import changes_rate
from sonolube.vocabulary import quantities, unit_of

if TYPE_CHECKING:
    import xarray as xr

_MOST = 3  # samples of a channel that can be damaged; more are a signal
_REACH = 20.0  # distance from the median over the largest of all other samples
_FEWEST = 20  # samples of a channel of which one can be judged
_STANDS = 0.02  # of the samples at one end of the range, from which a channel is saturated
_SOME = 1000  # samples by which most channels are told to have no damaged one
_VALUES = 50  # different ones, from which a channel is neither switched nor coarse
_VELOCITY, _SPEEDS = "relative_velocity", ("sliding_speed", "rotation_speed")
_SAME_SIGN = 0.2  # of the larger end of a range, up to which the other one is noise or an error of the zero
_SET_POINT = "_set"  # end of the names of set points, which are unknown before they are set


def damaged_sample_caveats(name: str, values: Floats, *, unit: str, axis: Floats, axis_label: str) -> tuple[str, ...]:
    """Caveat for every sample of a channel that lies far beyond all others.

    Empty where more than three samples lie out, or none lies 20 times as far from the median as all the others:
    impacts, switches and starts of a drive are signals. Empty, too, for a channel that is constant but for them, such
    as a trigger.
    """
    known = np.flatnonzero(np.isfinite(values))
    if known.size < _FEWEST or _is_spread(values, known):
        return ()
    with np.errstate(over="ignore"):
        distance = np.abs(values[known] - np.median(values[known]))
    last = min(_MOST + 1, distance.size)
    ordered = np.sort(np.partition(distance, -last)[-last:])
    count = next((k for k in range(1, _MOST + 1) if ordered[-k] > _REACH * ordered[-k - 1] > 0), 0)
    if not count:
        return ()
    return tuple(
        f"{name} is {values[place]:.3g} {unit} at {axis_label} = {axis[place]:.6g}, {_REACH:g} times or more as far"
        " from its median as every other sample: a damaged sample, which each mean contains; leave its line out"
        for place in known[np.sort(np.argsort(distance)[-count:])]
    )


def _is_spread(values: Floats, known: NDArray[np.int64]) -> bool:
    """Whether more samples than can be damaged lie apart, by some of them: the rest of a damaged channel does not.

    All but `_MOST` of that lie within the largest distance over `_REACH` of the median, and so do those of any part.
    """
    some = np.sort(values[known[:: max(1, known.size // _SOME)]])
    with np.errstate(over="ignore"):
        widest = 2 / _REACH * (np.fmax.reduce(values) - np.fmin.reduce(values))
        return bool(some[-1 - _MOST] - some[_MOST] > widest)


def missing_sample_caveat(name: str, values: Floats, *, axis: Floats, axis_label: str) -> tuple[str, ...]:
    """Caveat for a channel that misses samples, with the first of them or the end of its column.

    Empty where none is missing, and for set points.
    """
    missing = np.flatnonzero(~np.isfinite(values))
    if not missing.size or name.endswith(_SET_POINT):
        return ()
    if missing.size == values.size:
        return (f"{name} holds no value",)
    first = missing[0]
    if missing.size == values.size - first:
        where = f"ends at {axis_label} = {axis[first - 1]:.6g}, before the recording"
    else:
        where = f"misses {missing.size} of {values.size} samples, the first at {axis_label} = {axis[first]:.6g}"
    return (f"{name} {where}: numbers are of the others",)


def saturation_caveat(name: str, values: Floats, *, unit: str) -> tuple[str, ...]:
    """Caveat for a channel that stands at its highest or lowest value, as a sensor or an amplifier at its limit does.

    Empty for set points, and for a channel of few values, such as one that is switched or coarsely digitised.
    """
    known = values[np.isfinite(values)]
    if name.endswith(_SET_POINT) or known.size < _FEWEST:
        return ()
    for end, word in ((known.max(), "highest"), (known.min(), "lowest")):
        share = np.count_nonzero(known == end) / known.size
        if share > _STANDS and np.unique(known).size > _VALUES:
            return (
                f"{name} stands at its {word} value, {end:.4g} {unit}, in {share:.0%} of the samples: its sensor or"
                " amplifier may be saturated, and each mean too small in magnitude",
            )
    return ()


_LARGEST_READING = 1e30  # in any unit; keeps powers of samples within the range of a float


def recording_dataset(
    table: RawTable, *, path: Path, mapping: RecordingMapping | None, digest: str, partial: bool = False
) -> "xr.Dataset":
    """Recording assembled from the columns of a file."""
    import xarray as xr

    if mapping is None:
        table = _without_structure(table)
    else:
        table = _selected(table, mapping, path)
        mapping = mapping.for_labels([column.label for column in table.columns])
    if not partial and (mapping is None or (mapping.axis, mapping.sample_rate) == (None, None)):
        table = _aligned(table, path)
    quantity = _axis_quantity(table, mapping)
    sources = _channel_sources(table, path, mapping, quantity)
    axis = _axis(table, path, mapping, sources, quantity)
    if axis.size == 0:
        raise InvalidInput(f"{path}: holds no samples")
    if not partial and quantity == "time" and (even := _unrounded(axis)) is not None:
        rate = f"{1 / (even[1] - even[0]):.6g}"
        rounded = f"the clock repeats itself, as one of rounded times does: its samples are taken as {rate} a second"
        axis, table = even, replace(table, caveats=(*table.caveats, rounded))
    require_increasing_axis(axis, quantity=quantity, path=path, place=table.place)
    variables = {name: (quantity, *_channel(name, table, path, source, partial)) for name, source in sources.items()}
    if not variables:
        raise InvalidInput(f"{path}: holds no channel beside its {quantity}")
    known = quantities()[quantity]
    if not partial:
        variables, reversed_signs = _with_friction_positive(variables)
        found = (*reversed_signs, *_uneven(axis, quantity), *_damaged(variables, axis, quantity))
        table = replace(table, caveats=(*table.caveats, *found))
    return xr.Dataset(
        variables,
        coords={quantity: (quantity, axis, {"units": known.unit or "1", "long_name": known.meaning})},
        attrs=_attributes(table, path, mapping, digest, axis if quantity == "time" else None),
    )


def _aligned(table: RawTable, path: Path) -> RawTable:
    """Table whose columns of one sample interval all begin and end together, to half an interval."""
    starts = [column.start or 0.0 for column in table.columns if column.interval is not None]
    intervals = {column.interval for column in table.columns}
    if len(set(starts)) < 2 or len(intervals) != 1:
        return table
    (interval,) = intervals
    begin = max(starts)
    if interval is None or not (interval > 0 and isfinite(begin) and isfinite(interval)):
        return table
    left_out = [round((begin - start) / interval) for start in starts]
    rows = min(column.values.size - out for column, out in zip(table.columns, left_out, strict=True))
    if rows < 1:
        raise InvalidInput(
            f"{path}: its channels begin at times up to {begin - min(starts):.6g} s apart and have none in common;"
            " choose with --group or --channel"
        )
    columns = tuple(
        replace(column, start=begin, values=column.values[out : out + rows])
        for column, out in zip(table.columns, left_out, strict=True)
    )
    caveat = (
        f"the channels begin at different times, up to {begin - min(starts):.6g} s apart: the {rows * interval:.6g} s"
        " that all of them cover are read"
    )
    return replace(table, columns=columns, caveats=(*table.caveats, caveat))


_Variables = dict[str, tuple[str, Floats, dict[str, str | float]]]


def _with_friction_positive(variables: _Variables) -> tuple[_Variables, list[str]]:
    """Channels with the sign of friction reversed where the sensor has it negative in one direction, and the caveats.

    A velocity, or a speed that changes its sign, tells that the friction does: the signs of both belong together.
    """
    speeds = [variables[name][1] for name in _SPEEDS if name in variables]
    if _VELOCITY in variables or any(map(_of_both_signs, speeds)):
        return variables, []
    changed, caveats = dict(variables), []
    for name in set(FRICTION) & variables.keys():
        axis, values, attributes = variables[name]
        if not np.any(values < 0):
            continue
        low, high = _ends(values)
        if np.count_nonzero(np.isfinite(values)) >= _FEWEST and low < 0 and high < _SAME_SIGN * -low:
            gain, offset = (-float(attributes[f"calibration_{each}"]) for each in ("gain", "offset"))
            changed[name] = (axis, -values, attributes | {"calibration_gain": gain, "calibration_offset": offset})
            caveats.append(
                f"{name} is negative by the sign of the sensor, down to {low:.4g} {attributes['units']}: its magnitude"
                " is taken"
            )
    return changed, caveats


def _of_both_signs(values: Floats) -> bool:
    """Whether a speed has both signs, beyond noise."""
    low, high = _ends(values)
    return low < -_SAME_SIGN * high and high > -_SAME_SIGN * low


def _ends(values: Floats) -> tuple[float, float]:
    """5th and 95th percentile of the known values; NaN where there are none."""
    known = values[np.isfinite(values)]
    low, high = np.percentile(known, [5, 95]) if known.size else (np.nan, np.nan)
    return float(low), float(high)


def _uneven(axis: Floats, quantity: str) -> list[str]:
    """Caveat on a clock whose rate changes."""
    if quantity != "time" or axis.size < _FEWEST or not changes_rate(time=axis):
        return []
    return [
        "the samples are not evenly spaced in time: each mean is one of samples, not of time; measure parts of one rate"
    ]


def _damaged(
    variables: Mapping[str, tuple[str, Floats, dict[str, str | float]]], axis: Floats, quantity: str
) -> list[str]:
    """Caveats on damaged, missing and saturated samples of all channels."""
    label = f"{quantity} [{unit_of(quantity) or '1'}]"
    return [
        caveat
        for name, (_, values, attributes) in variables.items()
        for caveat in (
            *damaged_sample_caveats(name, values, unit=str(attributes["units"]), axis=axis, axis_label=label),
            *missing_sample_caveat(name, values, axis=axis, axis_label=label),
            *saturation_caveat(name, values, unit=str(attributes["units"])),
        )
    ]


def _without_structure(table: RawTable) -> RawTable:
    """Table whose labels are those of the fields, where all columns are fields of one structure."""
    parts = [column.label.rpartition(".") for column in table.columns]
    if len({structure for structure, _, _ in parts}) > 1 or not all(point for _, point, _ in parts):
        return table
    return replace(
        table, columns=tuple(replace(each, label=part[2]) for each, part in zip(table.columns, parts, strict=True))
    )


def _selected(table: RawTable, mapping: RecordingMapping, path: Path) -> RawTable:
    """Columns that the selection of a mapping chooses."""
    if left_out := set(mapping.selection.without):
        kept = [column for label, column in table.by_label.items() if left_out.isdisjoint((label, column.label))]
        table = replace(table, columns=tuple(kept))
    group = mapping.selection.group
    numbered = list(table.by_label)
    entries = [
        replace(
            entry, label=label, group=entry.group or (group if label.startswith((f"{group}/", f"{group}.")) else "")
        )
        for entry, label in zip(_entries(table.columns), numbered, strict=True)
    ]
    chosen = chosen_channels(entries, mapping.selection, path)
    if len(chosen) == len(table.columns) and not mapping.selection.group:
        return table
    columns = [table.columns[index] for index, _ in chosen]
    labels = [label for _, label in chosen]
    if not mapping.channels:  # a label that is the only one of its kind among those chosen needs no number
        numbers = [numbered[index].removeprefix(table.columns[index].label) for index, _ in chosen]
        plain = [label.removesuffix(number) for label, number in zip(labels, numbers, strict=True)]
        labels = [own if plain.count(own) == 1 else label for own, label in zip(plain, labels, strict=True)]
    columns = [replace(column, label=label) for column, label in zip(columns, labels, strict=True)]
    return replace(table, columns=tuple(columns))


def _entries(columns: Iterable[RawColumn]) -> list[ChannelEntry]:
    """Label, group and length of columns."""
    return [ChannelEntry(column.label, column.group, column.values.size) for column in columns]


def _axis_quantity(table: RawTable, mapping: RecordingMapping | None) -> str:
    """Quantity of the axis: that of the mapping, else revolutions where no column is a time, else time."""
    if mapping is not None:
        return mapping.axis_quantity
    names = {_name_and_unit(column)[0] for column in table.columns}
    timed = names & TIME_LABELS or any(column.interval is not None for column in table.columns)
    return "revolutions" if "revolutions" in names and not timed else "time"


def _channel_sources(
    table: RawTable, path: Path, mapping: RecordingMapping | None, quantity: str
) -> dict[str, ChannelSource]:
    """Source of each channel, by the mapping or by the labels of the columns."""
    if mapping is not None and mapping.channels:
        return dict(mapping.channels)
    axis = mapping.axis.column if mapping is not None and mapping.axis is not None else None
    sources: dict[str, ChannelSource] = {}
    for column in table.columns:
        name, unit = _name_and_unit(column)
        if name in TIME_LABELS or name == quantity or column.label == axis:
            continue
        if name in sources:
            several = numbered_labels([own.label for own in table.columns if _name_and_unit(own)[0] == name])
            raise InvalidInput(
                f"{path}: {len(several)} columns are named {name!r}; choose one by --channel or a mapping,"
                f" {several[0]!r} to {several[-1]!r}"
            )
        sources[name] = ChannelSource(column=column.label, unit=unit)
    return sources


def _name_and_unit(column: RawColumn) -> tuple[str, str | None]:
    """Name of a channel from the label of its column, and the unit stated for it."""
    name, unit = name_and_unit(column.label)
    return friction_headings().get(name, name), column.unit if column.unit is not None else unit


def _channel(
    name: str, table: RawTable, path: Path, source: ChannelSource, partial: bool
) -> tuple[Floats, dict[str, str | float]]:
    """Calibrated values of a channel in SI, and its attributes."""
    column = column_of_label(table.by_label, source.column, path)
    values = column.values
    largest = max(np.fmax.reduce(values), -np.fmin.reduce(values)) if values.size else 0.0
    if largest > _LARGEST_READING:
        row = int(np.argmax(np.abs(values) > _LARGEST_READING))
        fault = "infinite" if np.isinf(values[row]) else f"{values[row]:g}, beyond any sensor"
        raise InvalidInput(f"{path}: {table.place(row)}: {column.label!r} is {fault}")
    if not partial and np.isnan(largest):
        raise InvalidInput(f"{path}: {column.label!r} holds no value among {values.size}")
    stated = source.unit if source.unit is not None else _name_and_unit(column)[1]
    known = quantities().get(name)
    calibrated = source.calibrated(values, stated=_name_and_unit(column)[1], name=f"{path}: {column.label!r}")
    unit = known.unit if known else (stated or "")
    understood = stated
    if known and stated is not None:
        gain, offset, understood = si_conversion(stated, unit=unit, name=f"{path}: {column.label!r}")
        calibrated = calibrated if (gain, offset) == (1.0, 0.0) else calibrated * gain + offset
    return calibrated, {
        "units": unit or "1",
        "long_name": known.meaning if known else column.label,
        "source_column": column.label,
        "source_unit": _source_unit(stated, understood),
        "calibration_gain": source.gain,
        "calibration_offset": source.offset,
    }


def _source_unit(stated: str | None, understood: str | None) -> str:
    """Unit stated in a file, with the one as which it was understood where that differs."""
    if stated is None:
        return "not stated, taken as SI"
    return stated if understood is None or stated.split() == understood.split() else f"{stated} ({understood})"


def _axis(
    table: RawTable, path: Path, mapping: RecordingMapping | None, sources: dict[str, ChannelSource], quantity: str
) -> Floats:
    """Axis in SI: of the mapping's column or sample rate, of a time column, or of stated intervals."""
    used = [column_of_label(table.by_label, source.column, path) for source in sources.values()]
    if mapping is not None and mapping.axis is not None:
        axis = column_of_label(table.by_label, mapping.axis.column, path)
        require_common_length(_entries([axis, *used]), path)
        return _axis_column(axis, table, path, quantity, mapping.axis)
    rows = require_common_length(_entries(used), path)
    if mapping is not None and mapping.sample_rate is not None:
        return (table.first_row + np.arange(rows)) / mapping.sample_rate
    for column in table.columns:
        name, unit = _name_and_unit(column)
        if name in TIME_LABELS or name == quantity:
            require_common_length(_entries([column, *used]), path)
            _require_one_axis(column, table, path)
            return _axis_column(column, table, path, quantity, ChannelSource(column=column.label, unit=unit))
    time_bases = {(column.start or 0.0, column.interval) for column in used if column.interval is not None}
    if len(time_bases) != 1:
        several = "its channels have different time bases; choose with --group or --channel, or"
        problem = several if time_bases else "no column or property gives the time;"
        raise InvalidInput(f"{path}: {problem} name one with a mapping: axis.column or axis.sample_rate")
    start, interval = next(iter(time_bases))
    if interval is None or not (np.isfinite(start) and np.isfinite(interval) and interval > 0):
        raise InvalidInput(f"{path}: the time between samples is {interval!r} s")
    return start + interval * (table.first_row + np.arange(rows, dtype=np.float64))


def _unrounded(time: Floats) -> Floats | None:
    """Even times of a clock that was rounded to coarser steps than its samples; None where it was not."""
    if time.size <= _FEWEST or np.all(time[1:] > time[:-1]):
        return None
    steps = np.diff(time)
    if np.any(steps < 0) or not np.any(steps > 0):
        return None
    slope, start = np.polyfit(np.arange(time.size), time, 1)
    even = start + slope * np.arange(time.size)
    if np.max(np.abs(time - even)) > np.min(steps[steps > 0]):
        return None
    return np.asarray(even + (time[0] - even[0]))


def _require_one_axis(axis: RawColumn, table: RawTable, path: Path) -> None:
    """Refuse a table with several columns of the label of the axis, where their values differ."""
    several = [column for column in table.columns if column.label == axis.label]
    if not all(np.array_equal(column.values, axis.values, equal_nan=True) for column in several):
        raise InvalidInput(
            f"{path}: {len(several)} columns are named {axis.label!r} and differ; choose one with a mapping:"
            f' axis.column = "{axis.label} #1" to "{axis.label} #{len(several)}"'
        )


def _axis_column(column: RawColumn, table: RawTable, path: Path, quantity: str, source: ChannelSource) -> Floats:
    """Calibrated values of the axis column in SI; refuse missing and infinite ones."""
    values = column.values * source.gain + source.offset if source.is_calibrated else column.values
    known = np.isfinite(values)
    if not known.all():
        raise InvalidInput(f"{path}: {table.place(int(np.argmin(known)))}: {column.label!r} is not a number")
    stated = source.unit if source.unit is not None else column.unit
    if stated is None:
        return values
    stated = stated.partition(" since ")[0]  # of a time by the CF conventions, which begins at a date
    return convert_to_si(values, written_unit=stated, unit=unit_of(quantity), name=f"{path}: {column.label!r}")


def require_increasing_axis(axis: Floats, *, quantity: str, path: Path, place: Callable[[int], str]) -> None:
    """Refuse an axis that does not increase."""
    wrong = axis[1:] <= axis[:-1]
    if wrong.any():
        row = int(np.argmax(wrong)) + 1
        fault = "repeats" if axis[row] == axis[row - 1] else "decreases to"
        raise InvalidInput(f"{path}: {place(row)}: {quantity} {fault} {axis[row]:.10g} {unit_of(quantity)}".rstrip())


def _attributes(
    table: RawTable, path: Path, mapping: RecordingMapping | None, digest: str, time: Floats | None
) -> dict[str, str | int | float]:
    """Attributes of a recording: title, provenance, sample rate and number of dropped samples."""
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
    if mapping is not None and mapping.name:
        attributes["mapping"] = mapping.name
    if table.caveats:
        attributes["caveats"] = "\n".join(table.caveats)
    if table.incomplete:
        attributes["incomplete"] = "the file ends before the data it announces"
    if time is not None and time.size > 1:
        steps = np.diff(time)
        interval = float(np.median(steps))
        attributes["sample_rate"] = 1 / interval
        attributes["dropped_samples"] = int(np.sum(np.round(steps[steps > 1.5 * interval] / interval) - 1))
    return attributes
