"""Placement of consecutive parts of a test on one time axis: sections, segments and files."""

import re
from collections.abc import Sequence
from datetime import datetime, timedelta
from itertools import pairwise

import numpy as np

from sonolube.checks import Floats

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
