"""Headings of columns in tables of runs: the quantity by its names in the vocabulary, and the unit behind it."""

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.written_units import si_conversion
from sonolube.measurement.run_columns import RUN_COLUMNS, TEXT_NAMES
from sonolube.text.common_units import COMMON_FACTORS
from sonolube.vocabulary import quantities

_OWN: Final = re.compile(r"(\w+)\s*(?:\[([^\]]*)\])?")  # as the tables of sonolube have it
_WITH_UNIT: Final = tuple(
    re.compile(rf"(.+?){between}")
    for between in (r"\s*\[([^\[\]]*)\]", r"\s*\(([^()]*)\)", r"\s*/\s*(.+)", r"\s+in\s+(.+)", r"\s*,\s*(.+)")
)
_LONGEST: Final = 200  # characters of a heading that is looked at
_DIRECTION: Final = re.compile(
    r"direction|orientation|longitudinal|transvers|perpendicular|angle|richtung|orientierung|längs|\bquer|winkel"
)
_LUBRICANT: Final = re.compile(
    r"lubric|schmier|\boils?\b|\b\w*öl\b|grease|\bfett\b|coolant|emulsion|\bfluid|\bdry\b|trocken"
)
_UNIT: Final = re.compile(r"\b(?:units?|einheit(?:en)?)\b")
_SETTING: Final = re.compile(
    r"voltage|spannung|amplitude|frequency|frequenz|speed|velocity|geschwindigkeit|drehzahl|rpm"
)
_NOT_BY_LIKENESS: Final = "direction"  # a text that no estimate uses: only a table that spells it so means that
_PARTS: Final = ("%", "‰")  # units of pure numbers
_UNITS: Final = frozenset(
    {unit for factors in COMMON_FACTORS.values() for unit in factors if unit}
    | {"°", "deg", "°c", "degc", "rpm", "1/min", "µm", "μm", "µm/s", "μm/s"}
)


@dataclass(frozen=True, slots=True)
class RunHeading:
    """Meaning of a heading.

    Parameters
    ----------
    name : str
        Quantity of the vocabulary, or name of a text.
    unit : str
        As written; empty where none is.
    """

    name: str
    unit: str = ""


def run_heading(label: str) -> RunHeading | None:
    """Quantity and unit of the heading of a column; None where it is not known."""
    text = label.strip()
    own = _OWN.fullmatch(text)
    if own and (own[1] in quantities() or own[1] in TEXT_NAMES):
        return RunHeading(own[1], own[2] or "")
    if len(text) > _LONGEST:
        return None
    with_unit = list(_with_unit(text))
    whole = _names().get(_plain(text))
    by_whole = RunHeading(whole) if whole else None
    return next(filter(fits, with_unit), None) or by_whole or next(iter(with_unit), None)


def fits(found: RunHeading) -> bool:
    """Whether the unit of a heading is one of its quantity, and is there where the quantity has one."""
    if found.name in TEXT_NAMES:
        return not found.unit
    unit = quantities()[found.name].unit
    if not found.unit:
        return not unit
    try:
        si_conversion(found.unit, unit=unit, name=found.name)
    except InvalidInput:
        return False
    return True


def meaning_at_stake(label: str) -> str:
    """Why a column of unknown heading must not be left out unasked: what it looks like; empty where it may be."""
    text = _plain(label)
    bare = label.strip().strip("[]()").strip()
    if _UNIT.search(text) or bare in _UNITS or bare.lower() in _UNITS:
        return "a unit"
    if _DIRECTION.search(text):
        return "a direction"
    if _LUBRICANT.search(text):
        return "a lubricant"
    if _SETTING.search(text) or any(f" {words} " in f" {text} " for words in _settings()):
        return "a setting of the run"
    return ""


def _with_unit(text: str) -> Iterator[RunHeading]:
    """Headings of a known name before a unit; behind a blank or an underscore only what is a unit of the quantity."""
    for pattern in _WITH_UNIT:
        if (found := pattern.fullmatch(text)) and (name := _names().get(_plain(found[1]))):
            yield RunHeading(name, found[2].strip())
    for gap in reversed(list(re.finditer(r"[\s_]+", text))):
        if name := _names().get(_plain(text[: gap.start()])):
            found_behind = RunHeading(name, text[gap.end() :])
            is_number = name not in TEXT_NAMES and not quantities()[name].unit
            if fits(found_behind) and (not is_number or found_behind.unit in _PARTS):
                yield found_behind


def _plain(text: str) -> str:
    """Words of a heading in small letters, without signs between them."""
    return re.sub(r"[\W_]+", " ", unicodedata.normalize("NFKC", text).casefold()).strip()


@cache
def _names() -> dict[str, str]:
    """Names of quantities and texts by their headings in plain words; another heading counts before a name."""
    names = {_plain(each): known.name for known in quantities().values() for each in known.also}
    names |= {_plain(each): column.name for column in RUN_COLUMNS for each in column.also}
    for name in (*quantities(), *TEXT_NAMES):
        if name != _NOT_BY_LIKENESS:
            names.setdefault(_plain(name), name)
    return names


@cache
def _settings() -> tuple[str, ...]:
    """Headings of what is set in a run, in plain words of four letters or more."""
    names = [column.name for column in RUN_COLUMNS if not (column.is_text or column.is_result)]
    every = {_plain(each) for name in names for each in (name, *quantities()[name].also)}
    return tuple(sorted(words for words in every if len(words) >= 4))
