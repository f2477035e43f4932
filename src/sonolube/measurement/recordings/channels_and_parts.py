"""Channels and parts that make a recording: choice by group, label and length, and parts of a test on one time axis.

Parts are sections, segments, and files.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube import __version__
from sonolube.checks import Floats
from sonolube.errors import InvalidInput, suggestion
from sonolube.measurement.recordings.mapping import Selection
from sonolube.measurement.recordings.raw_table import is_written_unit
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

TIME_LABELS = frozenset({"time", "t", "x_value", "timestamp", "elapsed_time", "run_time", "test_time", "zeit"})
"""Names of columns that hold the time of a recording."""

_UNIT_OF_LABEL = re.compile(r"(?:\[([^\[\]]*)\]|\(([^()]*)\))(?: #\d+)?\Z")
_UNIT_BEHIND = re.compile(r"(.+?)[\s_]+([^\W\d_]+(?:/[^\W\d_]+)?|%)")
_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_MAX_LISTED = 16
FRICTION = ("friction_force", "friction_coefficient")
"""Channels of which one is the friction."""


@dataclass(frozen=True, slots=True)
class ChannelEntry:
    """One channel of a file before its values are read.

    Parameters
    ----------
    label : str
        Unique in the file.
    group : str
        Group that holds it; empty where the file has no groups.
    samples : int
        Number of its values.
    """

    label: str
    group: str
    samples: int

    @property
    def name(self) -> str:
        """Label without the group."""
        inside = self.group and self.label.startswith(self.group) and len(self.label) > len(self.group) + 1
        return self.label[len(self.group) + 1 :] if inside else self.label


def name_and_unit(label: str) -> tuple[str, str | None]:
    """Name of a channel from the label of its column, and the unit in brackets behind it."""
    text, unit = label.strip(), None
    if match := _UNIT_OF_LABEL.search(text):
        text, unit = text[: match.start()], match[1] if match[1] is not None else match[2]
    name = _plain(text)
    behind = _UNIT_BEHIND.fullmatch(text) if unit is None and name not in quantities() else None
    if behind and is_written_unit(behind[2]) and (stem := _plain(_CAPITAL.sub("_", behind[1]))) in _known_names():
        return stem, behind[2]
    return name, unit


def _plain(text: str) -> str:
    """Words of a label in small letters, with underscores between them."""
    return re.sub(r"\W+", "_", text.strip().lower()).strip("_") or "channel"


@cache
def _known_names() -> frozenset[str]:
    """Names of quantities and of times, and the other headings of friction."""
    return TIME_LABELS | frozenset(quantities()) | frozenset(friction_headings())


@cache
def friction_headings() -> Mapping[str, str]:
    """Quantity of friction by each other heading that the vocabulary has for it, as a name of a channel."""
    return {_plain(word): quantity for quantity in FRICTION for word in quantities()[quantity].also}


def chosen_channels(entries: Sequence[ChannelEntry], selection: Selection, path: Path) -> list[tuple[int, str]]:
    """Channels that a selection chooses, with their labels among themselves.

    Index among the entries, and label: that of the entry, or its name where that is unique among the chosen ones.
    Columns of the time are kept where they have the length of the chosen channels and their group.
    """
    if not (selection.group or selection.channels):
        return [(index, entry.label) for index, entry in enumerate(entries)]
    indices = _of_group(entries, selection.group, path) if selection.group else list(range(len(entries)))
    if selection.channels:
        named = [_index_of(entries, indices, name, path) for name in dict.fromkeys(selection.channels)]
        bases = {(entries[index].group, entries[index].samples) for index in named}
        along = [index for index in indices if (entries[index].group, entries[index].samples) in bases]
        times = [index for index in along if name_and_unit(entries[index].name)[0] in TIME_LABELS]
        indices = sorted({*times, *named})
    names = [entries[index].name for index in indices]
    counts = Counter(names)
    return [
        (index, entries[index].label if counts[name] > 1 else name) for index, name in zip(indices, names, strict=True)
    ]


def require_common_length(entries: Sequence[ChannelEntry], path: Path) -> int:
    """Number of samples that all channels have; refuse channels of different lengths, listing them."""
    if len({entry.samples for entry in entries}) > 1:
        raise InvalidInput(
            f"{path}: channels have different numbers of samples ({listed_channels(entries)});"
            " choose with --group or --channel, or with a mapping"
        )
    return entries[0].samples if entries else 0


def listed_channels(entries: Sequence[ChannelEntry]) -> str:
    """Channels with their numbers of samples by group, for a message of one line."""
    groups: dict[str, list[str]] = {}
    first_of_each = {(entry.group, entry.samples): entry for entry in reversed(entries)}
    listed = entries if len(entries) <= _MAX_LISTED else list(reversed(first_of_each.values()))[:_MAX_LISTED]
    for entry in listed:
        groups.setdefault(entry.group, []).append(f"{entry.name} {entry.samples}")
    named = len(groups) > 1
    text = "; ".join((f"{group}: " if named else "") + ", ".join(names) for group, names in groups.items())
    more = len(entries) - len(listed)
    return " ".join(text.split()) + (f" and {more} more" if more > 0 else "")


def _of_group(entries: Sequence[ChannelEntry], group: str, path: Path) -> list[int]:
    """Indices of the channels in a group; refuse an unknown one, listing all."""
    found = [index for index, entry in enumerate(entries) if entry.group == group]
    if not found:
        paths = (entry.group or re.sub(r"(?:^|[/.])[^/.]*$", "", entry.label) for entry in entries)
        groups = [known for known in dict.fromkeys(paths) if known]
        if not groups:
            raise InvalidInput(f"{path}: has no groups of channels, so that none is {group!r}")
        hint = suggestion(group, groups) or "it has " + ", ".join(groups[:_MAX_LISTED])
        raise InvalidInput(f"{path}: has no group {group!r}; {hint}")
    return found


def _index_of(entries: Sequence[ChannelEntry], indices: Sequence[int], name: str, path: Path) -> int:
    """Index of the channel of a name, by label first; refuse an unknown or ambiguous one."""
    found = [index for index in indices if entries[index].label == name] or [
        index for index in indices if name in (entries[index].name, f"{entries[index].group}/{entries[index].name}")
    ]
    if len(found) == 1:
        return found[0]
    among = [entries[index] for index in indices]
    if found:
        groups = " and ".join(entries[index].group or "the file" for index in found[:_MAX_LISTED])
        raise InvalidInput(f"{path}: {name!r} is in {groups}; choose one with --group")
    hint = suggestion(name, [entry.name for entry in among]) or "it has " + listed_channels(among)
    raise InvalidInput(f"{path}: has no channel {name!r}; {hint}")


_STAMP = re.compile(r"(\d{4})[-/](\d{1,2})[-/](\d{1,2})[ T](\d{1,2}):(\d{1,2}):(\d{1,2})(?:[.,](\d{1,30}))?", re.ASCII)


def begun_at(text: str) -> datetime | None:
    """Date and time of a start as readers state it, such as 2016/03/04 14:10:11.5; None for other text."""
    match = _STAMP.match(text.strip())
    if match is None:
        return None
    try:
        year, month, day, hour, minute, second = (int(part) for part in match.groups()[:6])
        return datetime(year, month, day, hour, minute, second) + timedelta(seconds=float(f"0.{match[7] or 0}"))
    except (ValueError, OverflowError):
        return None


def time_shifts(times: Sequence[Floats], starts: Sequence[datetime | None]) -> tuple[list[float], bool]:
    """Shifts of the times of consecutive parts that place them on the axis of the first.

    `shifts`: Zero where the times of every part continue those of the one before; the difference of the starts where
    the times restart and the parts then follow each other; else what places each part one sample interval after the one
    before, in seconds. `assumed`: Whether the parts were placed one sample interval apart because no start tells their
    distance.
    """
    none = [0.0] * len(times)
    if _follow(times, none):
        return none, False
    first = starts[0]
    if first is not None and all(start is not None for start in starts):
        stated = [(start - first).total_seconds() for start in starts if start is not None]
        if _follow(times, stated):
            return stated, False
    steps = np.concatenate([np.diff(part) for part in times])
    interval = float(np.median(steps)) if steps.size else 1.0
    shifts = [0.0]
    for before, part in pairwise(times):
        shifts.append(shifts[-1] + float(before[-1]) + interval - float(part[0]))
    return shifts, True


def _follow(times: Sequence[Floats], shifts: Sequence[float]) -> bool:
    """Whether each part begins after the end of the one before."""
    begins = [part[0] + shift for part, shift in zip(times[1:], shifts[1:], strict=True)]
    ends = [part[-1] + shift for part, shift in zip(times[:-1], shifts[:-1], strict=True)]
    return all(begin > end for begin, end in zip(begins, ends, strict=True))


_GAP = 1.5  # sample intervals between parts beyond which samples are missing between them
_MAX_LEFT_OUT = 12


def join_recordings(recordings: Sequence["xr.Dataset"]) -> "xr.Dataset":
    """Recordings of consecutive parts of one test as one recording.

    Parameters
    ----------
    recordings : sequence of xarray.Dataset
        As `read_recording` returns them, in the order of the test.

    Returns
    -------
    xarray.Dataset
        The channels that all parts have, along the time of the first. Where the times of a part do not continue those
        of the one before, it begins at the difference of the stated starts, or, where no starts are stated or they
        overlap, one sample interval after the one before, which is a caveat. A sample without values stands in each
        gap, so that nothing is integrated across it. The attribute `part_starts` holds the first time of each part.

    Raises
    ------
    InvalidInput
        If there are no recordings, one has no time, no channel is in all, or a channel differs in its unit.

    See Also
    --------
    sonolube.measurement.recordings.reader.read_recording : a file.
    """
    import xarray as xr

    if not recordings:
        raise InvalidInput("there are no recordings to join")
    for part in recordings:
        if "time" not in part.coords:
            raise InvalidInput(f"{_name(part)} has no time along which it could be joined with others")
    names = [str(name) for name in recordings[0].data_vars if all(name in part for part in recordings)]
    if not names:
        raise InvalidInput(f"{_name(recordings[0])} has no channel in common with the files after it")
    for name in names:
        units = {str(part[name].attrs.get("units")) for part in recordings}
        if len(units) > 1:
            raise InvalidInput(f"channel {name!r} is in {' and '.join(sorted(units))} in the files to join")
    times = [part["time"].to_numpy() for part in recordings]
    shifts, assumed = time_shifts(times, [begun_at(str(part.attrs.get("begun", ""))) for part in recordings])
    placed = [time + shift for time, shift in zip(times, shifts, strict=True)]
    interval = float(np.median(np.concatenate([np.diff(time) for time in times if time.size > 1] or [np.ones(1)])))
    gaps = [after[0] - before[-1] > _GAP * interval for before, after in pairwise(placed)]
    middles = [(before[-1] + after[0]) / 2 for before, after in pairwise(placed)]
    channels = {
        name: (
            "time",
            _with_gaps([part[name].to_numpy() for part in recordings], gaps, None),
            recordings[0][name].attrs,
        )
        for name in names
    }
    return xr.Dataset(
        channels,
        coords={"time": ("time", _with_gaps(placed, gaps, middles), recordings[0]["time"].attrs)},
        attrs={
            "title": f"{len(recordings)} files as one test",
            "source": f"sonolube {__version__}",
            "file_name": f"{_name(recordings[0])} to {_name(recordings[-1])}",
            "file_format": str(recordings[0].attrs.get("file_format", "")),
            "sample_rate": 1 / interval,
            "dropped_samples": sum(int(part.attrs.get("dropped_samples", 0)) for part in recordings),
            "part_starts": [float(time[0]) for time in placed],
            "caveats": "\n".join(_caveats(recordings, names, assumed=assumed)),
        },
    )


def _caveats(recordings: Sequence["xr.Dataset"], names: Sequence[str], *, assumed: bool) -> list[str]:
    """Caveats of the parts, each once, and those of their joining."""
    caveats = [line for part in recordings for line in str(part.attrs.get("caveats", "")).splitlines()]
    left_out = {str(name) for part in recordings for name in part.data_vars} - set(names)
    if left_out:
        caveats.append(f"channels that not all files have were left out: {', '.join(sorted(left_out)[:_MAX_LEFT_OUT])}")
    if assumed:
        caveats.append(
            "the times restart in the files and their starts are not stated: each was placed one sample interval after"
            " the one before"
        )
    return list(dict.fromkeys(caveats))


def _with_gaps(parts: Sequence[Floats], gaps: Sequence[bool], between: Sequence[float] | None) -> Floats:
    """Parts one after the other, with one value in each gap: that given for it, or NaN."""
    pieces = [parts[0]]
    for index, part in enumerate(parts[1:]):
        if gaps[index]:
            pieces.append(np.array([np.nan if between is None else between[index]]))
        pieces.append(part)
    return np.concatenate(pieces)


def _name(recording: "xr.Dataset") -> str:
    """Name of the file of a recording, for messages."""
    return str(recording.attrs.get("file_name", "the recording"))
