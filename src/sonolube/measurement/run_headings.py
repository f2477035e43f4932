"""Meaning of the columns of a table of runs: quantity and unit by heading or statement, and the mapping of them."""

import re
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Final

from sonolube.errors import InvalidInput, UnknownName
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, Selection, TextLayout
from sonolube.measurement.recordings.raw_table import column_of_label, numbered_labels, si_conversion
from sonolube.measurement.recordings.text_tables import TextTable
from sonolube.measurement.run_columns import RUN_COLUMNS, TEXT_NAMES
from sonolube.text.units import COMMON_FACTORS, unit_description
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


LEFT_OUT: Final = "-"
"""Statement that leaves a column out."""

_MAX_CELLS: Final = 3  # that tell what a column holds

Meaning = RunHeading | str
"""Quantity and unit of a column, or `LEFT_OUT`."""


def stated_columns(table: TextTable, statements: Mapping[str, str], path: Path) -> dict[str, Meaning | None]:
    """Meaning of each column by its label: as stated, else by its heading; None without meaning or unit."""
    labels = numbered_labels(table.labels)
    if "" in labels:
        place = labels.index("") + 1
        raise InvalidInput(f"{path}: line {table.line}: column {place} has no heading; name it, or delete the column")
    known = {label: label for label in labels}
    stated = {column_of_label(known, label, path): meaning(text, label) for label, text in statements.items()}
    return {label: stated.get(label) or _by_heading(own) for label, own in zip(labels, table.labels, strict=True)}


def meaning(text: str, label: str) -> Meaning:
    """Quantity and unit that a text such as "friction_force N" states, or `LEFT_OUT`."""
    if text.strip() == LEFT_OUT:
        return LEFT_OUT
    name, _, unit = text.strip().partition(" ")
    found = run_heading(text)
    if name in quantities() or name in TEXT_NAMES:
        found = RunHeading(name, unit.strip(" []()"))
    if found is None:
        raise UnknownName.among((*quantities(), *TEXT_NAMES), kind=f"quantity of column {label!r}:", name=name)
    if not fits(found):
        unit = "" if found.name in TEXT_NAMES else quantities()[found.name].unit
        expected = unit_description(unit) if unit else "none"
        raise InvalidInput(f"column {label!r}: {text!r} has no unit of {found.name}; expected {expected}")
    return found


def samples(table: TextTable, label: str) -> list[str]:
    """First cells of a column that are not empty."""
    place = numbered_labels(table.labels).index(label)
    filled = [cells[place].strip() for _, cells in table.rows if "".join(cells[place : place + 1]).strip()]
    return filled[:_MAX_CELLS]


def _by_heading(label: str) -> RunHeading | None:
    """Meaning of a column by its heading, where that has its unit too."""
    found = run_heading(label)
    return found if found is not None and fits(found) else None


def mapping_of_columns(table: TextTable, columns: Mapping[str, Meaning]) -> RecordingMapping:
    """Mapping of the columns of a table; a time is the axis, which tables of runs have no use for."""
    sources = {
        found.name: ChannelSource(column=label, unit=None if found.name in TEXT_NAMES else found.unit)
        for label, found in columns.items()
        if isinstance(found, RunHeading)
    }
    axis = sources.pop("time", None)
    return RecordingMapping(
        channels=MappingProxyType(sources),
        axis=axis,
        selection=Selection(without=tuple(label for label, found in columns.items() if found == LEFT_OUT)),
        text=TextLayout(lines_to_skip=table.line - 1),
    )
