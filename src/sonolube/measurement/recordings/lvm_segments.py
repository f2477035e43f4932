"""Segments of a LabVIEW measurement file (LVM): their channels, units and times, and their concatenation."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import parse_numbers
from sonolube.measurement.recordings.channels_and_parts import ChannelEntry, begun_at, chosen_channels, time_shifts
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, convert_to_si
from sonolube.measurement.recordings.text_tables import NumberedCells, column_values

_X_LABEL = "X_Value"
_MISSING = frozenset({"NaN", "-NaN", "nan"})
_KEYS_OF_EVERY_CHANNEL = ("Samples", "X_Dimension", "Delta_X", "X0", "Date", "Time")
_MAX_LISTED = 8


@dataclass(frozen=True, kw_only=True, slots=True)
class Header:
    """The keys of a header, each with its cells, and the line on which the header ends."""

    keys: dict[str, list[str]]
    line: int

    @property
    def begun(self) -> str:
        """Date and time at which the recording or the segment begins, as stated."""
        return f"{self.text('Date', '')} {self.text('Time', '')}".strip()

    def text(self, key: str, default: str) -> str:
        """First cell of a key that is not empty."""
        return next((cell for cell in self.keys.get(key, []) if cell), default)


@dataclass(frozen=True, kw_only=True, slots=True)
class LvmSegment:
    """One segment as written: header, column labels with their line, which times it holds, and rows."""

    header: Header
    labels: list[str]
    line: int
    x_columns: str
    rows: list[NumberedCells] = field(default_factory=list)

    @property
    def channels(self) -> list[tuple[int, str]]:
        """Index and label of each column that is not a time."""
        return [(index, label) for index, label in enumerate(self.labels) if label and label != _X_LABEL]

    @property
    def stated_samples(self) -> int:
        """Largest number of samples that the header states for a channel; 0 where it states none."""
        cells = self.header.keys.get("Samples", [])
        return max((int(cell) for cell in cells if cell.isascii() and cell.isdigit() and len(cell) < 12), default=0)

    def cells_of_channels(self, key: str) -> list[str]:
        """Cell of a key for each channel.

        The cells of a header stand in the columns of the channels, with the cells of time columns empty between
        them; files that list them without gaps are told by the keys that every channel has.
        """
        channels = self.channels
        cells = self.header.keys.get(key, [])
        places = [index - 1 for index, _ in channels] if self._aligned() else list(range(len(channels)))
        return [cells[place] if 0 <= place < len(cells) else "" for place in places]

    def _aligned(self) -> bool:
        """Whether the cells of the header stand in the columns of the channels."""
        aligned = [index - 1 for index, _ in self.channels]
        for key in _KEYS_OF_EVERY_CHANNEL:
            cells = self.header.keys.get(key, [])
            for places, answer in ((aligned, True), (range(len(aligned)), False)):
                if all(0 <= place < len(cells) and cells[place] for place in places):
                    return answer
        return True


@dataclass(frozen=True, kw_only=True, slots=True)
class _Abscissa:
    """Time of one channel in one segment: start and step of the header, the time column where written, rows it has."""

    start: float
    step: float
    written: Floats | None
    samples: int

    def times(self, rows: int) -> Floats:
        """Time of each row in seconds; NaN where the channel has no time."""
        return self.written if self.written is not None else self.start + self.step * np.arange(rows, dtype=np.float64)

    def agrees(self, other: "_Abscissa") -> bool:
        """Whether two channels have the same time at each row."""
        if self.written is None or other.written is None:
            return self.written is other.written and (self.start, self.step) == (other.start, other.step)
        both = np.isfinite(self.written) & np.isfinite(other.written)
        return bool((self.written[both] == other.written[both]).all())


def joined_segments(
    segments: Sequence[LvmSegment], path: Path, *, decimal_sign: str, mapping: RecordingMapping | None
) -> tuple[tuple[RawColumn, ...], NDArray[np.int64], tuple[str, ...]]:
    """Chosen channels of all segments with one time, the line of each row, and caveats."""
    for segment in segments:
        _require_count(segment, path)
        if [label for _, label in segment.channels] != [label for _, label in segments[0].channels]:
            raise InvalidInput(f"{path}: line {segment.line}: this segment has other channels than the first")
    labels = [label for _, label in segments[0].channels]
    values = [
        [column_values(segment.rows, index, label, decimal_sign, _MISSING, path) for index, label in segment.channels]
        for segment in segments
    ]
    filled = [any(np.isfinite(part[channel]).any() for part in values) for channel in range(len(labels))]
    kept = [channel for channel, holds in enumerate(filled) if holds] or list(range(len(labels)))
    abscissae = [_abscissae(segment, part, decimal_sign, path) for segment, part in zip(segments, values, strict=True)]
    chosen = _of_one_time([labels[channel] for channel in kept], kept, abscissae, values, mapping, path)
    times, assumed = _times(segments, chosen, abscissae)
    units = [segment.cells_of_channels("Y_Unit_Label") for segment in segments]
    columns = [RawColumn(label=_X_LABEL, values=np.concatenate(times), unit="s")]
    for channel in chosen:
        stated = {own[channel] for own in units}
        if len(stated) > 1:
            raise InvalidInput(
                f"{path}: {labels[channel]!r} has the units {' and '.join(sorted(stated))} in its segments"
            )
        joined = np.concatenate([part[channel] for part in values])
        columns.append(RawColumn(label=labels[channel], values=joined, unit=stated.pop() or None))
    caveats: tuple[str, ...] = ()
    if len(kept) < len(labels):
        empty = [label for label, holds in zip(labels, filled, strict=True) if not holds]
        caveats += (f"channels without values were left out: {', '.join(empty[:_MAX_LISTED])}",)
    if assumed:
        caveats += ("times restart in later segments, whose headers state no later start: each follows the one before",)
    lines = np.array([line for segment in segments for line, _ in segment.rows], dtype=np.int64)
    filled_rows = [max(own[channel].samples for channel in chosen) for own in abscissae]
    rows = np.concatenate([np.arange(part.size) < most for part, most in zip(times, filled_rows, strict=True)])
    return tuple(replace(column, values=column.values[rows]) for column in columns), lines[rows], caveats


def _require_count(segment: LvmSegment, path: Path) -> None:
    """Refuse a segment whose header states another number of channels than its labels, or an abscissa but the time."""
    text = segment.header.text("Channels", "")
    if not (text.isascii() and text.isdigit() and 0 < len(text) < 7 and int(text) > 0):
        raise InvalidInput(f"{path}: line {segment.header.line}: Channels is {text[:40]!r}, not a count")
    if len(segment.channels) != int(text):
        found, line = len(segment.channels), segment.line
        raise InvalidInput(f"{path}: line {line}: names {found} channels where the header has {text}")
    other = next((cell for cell in segment.cells_of_channels("X_Dimension") if cell not in ("", "Time")), None)
    if other is not None:
        raise InvalidInput(f"{path}: line {segment.header.line}: X_Dimension is {other[:40]!r}, not Time")


def _abscissae(segment: LvmSegment, values: Sequence[Floats], decimal_sign: str, path: Path) -> list[_Abscissa]:
    """Time of each channel of a segment."""
    starts, steps = (_numbers(segment, key, decimal_sign, path) for key in ("X0", "Delta_X"))
    time_columns = {
        index: column_values(segment.rows, index, _X_LABEL, decimal_sign, _MISSING, path)
        for index, label in enumerate(segment.labels)
        if label == _X_LABEL
    }
    written_ones = [index for index, column in time_columns.items() if np.isfinite(column).any()]
    units, counts = segment.cells_of_channels("X_Unit_Label"), segment.cells_of_channels("Samples")
    first = next((channel for channel, own in enumerate(values) if np.isfinite(own).any()), 0)
    found = []
    for channel, (index, _) in enumerate(segment.channels):
        scale = float(convert_to_si(np.ones(1), written_unit=units[channel] or "s", unit="s", name=f"{path}: time")[0])
        before = [at for at in written_ones if at < index]
        own_base = (starts[channel], steps[channel])
        rows = np.flatnonzero(np.isfinite(values[channel]))
        samples = int(rows[-1]) + 1 if rows.size else 0
        # a single column holds the times of the first channel, and of those with its start and step
        same = own_base == (starts[first], steps[first]) or np.isnan(own_base[1])
        shares = len(time_columns) > 1 or samples < 2 or same
        written = time_columns[before[-1]] * scale if before and shares else None
        start, step = (0.0 if np.isnan(own_base[0]) else own_base[0]), own_base[1]
        if written is None and samples > 0 and not np.isfinite(step):
            raise InvalidInput(
                f"{path}: line {segment.header.line}: X0 and Delta_X must give the times of every channel"
            )
        if written is None and samples:
            stated = counts[channel]
            samples = max(samples, min(int(stated), len(segment.rows))) if stated.isdecimal() else samples
        if written is not None and samples:
            samples = max(samples, int(np.flatnonzero(np.isfinite(written))[-1]) + 1)
        found.append(_Abscissa(start=start * scale, step=step * scale, written=written, samples=samples))
    return found


def _numbers(segment: LvmSegment, key: str, decimal_sign: str, path: Path) -> list[float]:
    """Number of a key for each channel; NaN where it has none."""
    cells = segment.cells_of_channels(key)
    values, invalid_row = parse_numbers(cells, decimal_sign=decimal_sign, missing=frozenset())
    if invalid_row is not None or np.isinf(values).any():
        cell = cells[invalid_row if invalid_row is not None else int(np.argmax(np.isinf(values)))][:40]
        raise InvalidInput(f"{path}: line {segment.header.line}: {key} is {cell!r}, which is not a number")
    return [float(value) for value in values]


def _of_one_time(
    labels: Sequence[str],
    channels: Sequence[int],
    abscissae: Sequence[Sequence[_Abscissa]],
    values: Sequence[Sequence[Floats]],
    mapping: RecordingMapping | None,
    path: Path,
) -> list[int]:
    """Channels to read, by index; refuse ones that have different times."""
    entries = [
        ChannelEntry(label, "", sum(int(np.isfinite(part[channel]).sum()) for part in values))
        for label, channel in zip(labels, channels, strict=True)
    ]
    wanted = list(range(len(entries)))
    if mapping is not None and mapping.selection.channels:
        wanted = [index for index, _ in chosen_channels(entries, mapping.selection, path)]
    elif mapping is not None and mapping.channels:
        named = {label for source in mapping.channels.values() for label in source.labels}
        wanted = [index for index, entry in enumerate(entries) if entry.label in named] or wanted
    chosen = [channels[index] for index in wanted]
    for own in abscissae:
        sampled = [channel for channel in chosen if own[channel].samples > 0]
        longest = max(sampled, key=lambda channel: own[channel].samples, default=None)
        other = next(
            (channel for channel in sampled if longest is not None and not own[channel].agrees(own[longest])), None
        )
        if other is not None and longest is not None:
            by_index = dict(zip(channels, entries, strict=True))
            text = " and ".join(f"{by_index[c].label!r} ({by_index[c].samples} samples)" for c in (longest, other))
            raise InvalidInput(f"{path}: channels have different times, such as {text}; choose with --channel")
    return chosen


def _times(
    segments: Sequence[LvmSegment], chosen: Sequence[int], abscissae: Sequence[Sequence[_Abscissa]]
) -> tuple[list[Floats], bool]:
    """Time of each segment, shifted to the start of the first, and whether a distance was assumed."""
    times = []
    for segment, own in zip(segments, abscissae, strict=True):
        longest = max(chosen, key=lambda channel: own[channel].samples)
        times.append(own[longest].times(len(segment.rows)))
    filled = [part for part in times if part.size and np.isfinite(part).all()]
    if len(filled) < 2:
        return times, False
    starts = [begun_at(segment.header.begun) for segment, part in zip(segments, times, strict=True) if part.size]
    if len(filled) != len(starts):
        return times, False
    shifts, assumed = time_shifts(filled, starts)
    shift = iter(shifts)
    return [part + next(shift) if part.size else part for part in times], assumed
