"""Times of the rows of a text table by time stamps, by dates and times of a clock, or by a stated start and step."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date

import numpy as np

from sonolube.checks import Floats
from sonolube.measurement.measured_files import parse_number
from sonolube.measurement.recordings.raw_table import RawColumn
from sonolube.measurement.recordings.text_tables import TextTable

_STAMP = re.compile(
    r"(?:(?:(?P<day>\d{1,2})\.(?P<month>\d{1,2})\.(?P<year>\d{4})|(?P<iso>\d{4}[-/]\d{2}[-/]\d{2})"
    r"|(?P<a>\d{1,2})/(?P<b>\d{1,2})/(?P<of>\d{4}))[ T]+)?"
    r"(?P<h>\d{1,2}):(?P<m>\d{2}):(?P<s>\d{2}(?:[.,]\d{1,9})?)\s*(?P<half>[AaPp])?(?:(?<=[AaPp])\.?[Mm]\.?)?"
    r"\s*(?:Z|(?P<zone>[+-]\d{2}):?(?P<minutes>\d{2}))?",
    re.ASCII,
)
_DATE = re.compile(r"\d{1,2}\.\d{1,2}\.\d{4}|\d{4}[-/]\d{2}[-/]\d{2}|\d{1,2}/\d{1,2}/\d{4}", re.ASCII)
_DAY = 86400.0  # s
STATED = ("Start", "Increment")
"""Labels below which some oscilloscopes state the clock."""

SEQUENCE = ("Sequence",)
"""Texts in the line of units above numbers that count the rows."""


def stamped_seconds(cells: Sequence[str]) -> Floats | None:
    """Seconds since the first of time stamps, with or without a date; None where a cell is none.

    Without a date the clock of a day goes on after midnight. None, too, for dates such as 3/5/2026 whose order of day
    and month is in doubt and matters.
    """
    stamps = [_STAMP.fullmatch(cell.strip()) for cell in cells]
    found = [stamp for stamp in stamps if stamp is not None]
    if not cells or len(found) < len(stamps):
        return None
    clock = np.array([_seconds_of_day(stamp) for stamp in found])
    orders = (True,) if found[0]["half"] else (True, False)
    days = [each for month_first in orders if (each := _days(found, month_first=month_first)) is not None]
    if not days or any(not np.array_equal(each - each[0], days[0] - days[0][0]) for each in days):
        return None
    passed = days[0] - days[0][0]
    passed += np.cumsum((np.diff(clock + _DAY * passed, prepend=clock[0]) < -_DAY / 2) & (passed == 0))
    return np.asarray(clock - clock[0] + _DAY * passed)


@dataclass(frozen=True, slots=True)
class RowClock:
    """Times of the rows of a table, and the labels of the columns that have them."""

    times: RawColumn
    labels: tuple[str, ...]


def clock_of_rows(table: TextTable) -> RowClock | None:
    """Times by time stamps, whose date may stand in a column of its own; None where no column has them."""
    if not table.rows:
        return None
    columns = {label: [_cell(cells, at) for _, cells in table.rows] for at, label in enumerate(table.labels)}
    stamps = {(label,): cells for label, cells in columns.items() if _STAMP.fullmatch(cells[0])}
    dates = [label for label, cells in columns.items() if _DATE.fullmatch(cells[0])]
    dated = {
        (dates[0], *labels): [" ".join(pair) for pair in zip(columns[dates[0]], cells, strict=True)]
        for labels, cells in stamps.items()
        if dates
    }
    for labels, cells in (*dated.items(), *stamps.items()):
        if (seconds := stamped_seconds(cells)) is not None:
            return RowClock(RawColumn(label="time", values=seconds, unit="s"), labels)
    return None


def stated_clock(table: TextTable) -> tuple[float, float] | None:
    """Start and step in s that stand below labels of these names in the line of units; None where there are none."""
    stated = dict(zip(table.labels, table.units, strict=False))
    start, step = (parse_number(stated.get(label, ""), decimal_sign=".") for label in STATED)
    return None if start is None or step is None or not step > 0 else (start, step)


def _cell(cells: Sequence[str], place: int) -> str:
    """Text of a cell; empty where the row is shorter."""
    return cells[place].strip() if place < len(cells) else ""


def _days(stamps: Sequence[re.Match[str]], *, month_first: bool) -> Floats | None:
    """Numbers of the days of time stamps, 0 without a date; None for a date that does not exist."""
    try:
        return np.array([_day(stamp, month_first=month_first) for stamp in stamps], dtype=np.float64)
    except ValueError:
        return None


def _day(stamp: re.Match[str], *, month_first: bool) -> int:
    """Number of the day of a time stamp, 0 without a date."""
    if stamp["iso"]:
        return date.fromisoformat(stamp["iso"].replace("/", "-")).toordinal()
    if stamp["day"]:
        return date(int(stamp["year"]), int(stamp["month"]), int(stamp["day"])).toordinal()
    if stamp["a"]:
        month, day = (stamp["a"], stamp["b"]) if month_first else (stamp["b"], stamp["a"])
        return date(int(stamp["of"]), int(month), int(day)).toordinal()
    return 0


def _seconds_of_day(stamp: re.Match[str]) -> float:
    """Seconds of a time stamp since midnight, in one zone."""
    hour = int(stamp["h"]) if not stamp["half"] else int(stamp["h"]) % 12 + 12 * (stamp["half"] in "Pp")
    zone = (
        int(f"{stamp['zone']}") * 3600.0 + int(f"{stamp['zone'][0]}{stamp['minutes']}") * 60.0 if stamp["zone"] else 0.0
    )
    return 3600.0 * hour + 60.0 * int(stamp["m"]) + float(stamp["s"].replace(",", ".")) - zone
