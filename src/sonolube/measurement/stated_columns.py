"""Meaning of the columns of a text table, by its headings and by statements, and the mapping of them."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

from sonolube.errors import InvalidInput, UnknownName
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, Selection, TextLayout
from sonolube.measurement.recordings.repeated_labels import column_of_label, numbered_labels
from sonolube.measurement.recordings.text_tables import TextTable
from sonolube.measurement.run_columns import TEXT_NAMES
from sonolube.measurement.run_headings import RunHeading, fits, run_heading
from sonolube.text.units import unit_description
from sonolube.vocabulary import quantities

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
