"""Statements of what the columns of a file hold, as a page or a terminal takes them, and the mapping that they make."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final

from sonolube.errors import InvalidInput, UnknownName
from sonolube.measurement.recordings.channels_and_parts import TIME_LABELS, name_and_unit
from sonolube.measurement.recordings.mapping import AXIS_QUANTITIES, ChannelSource, RecordingMapping, source_with_gain
from sonolube.measurement.recordings.raw_table import numbered_labels
from sonolube.measurement.run_columns import TEXT_NAMES
from sonolube.measurement.run_headings import (
    LEFT_OUT,
    STATES,
    RunHeading,
    fits,
    meaning,
    run_heading,
    spread_headings,
    state_column,
)
from sonolube.measurement.run_numbers import cell_number
from sonolube.vocabulary import quantities

_MAX_TEXTS: Final = 60  # different cells of a column by which rows are chosen
_MAX_CELLS: Final = 3  # that tell what a column holds


@dataclass(frozen=True, kw_only=True, slots=True)
class FileColumn:
    """Column of a file with what it is taken for.

    Parameters
    ----------
    label : str
        Of the file, numbered where several have it.
    statement : str
        Quantity and unit, such as "friction_force N", or "-" for a column that is left out; a suggestion where asked.
    is_asked : bool
        Whether the file does not tell quantity or unit.
    cells : tuple of str
        First cells that are not empty.
    texts : tuple of str
        Different cells of a column of words, by which rows can be chosen; empty for numbers.
    """

    label: str
    statement: str
    is_asked: bool
    cells: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()


def stated_file_columns(
    labels: Sequence[str], units: Sequence[str], cells: Sequence[Sequence[str]], mapping: RecordingMapping | None
) -> list[FileColumn]:
    """Columns of a file with their meaning by a mapping, else by their labels and units.

    Parameters
    ----------
    labels, units : sequence of str
        Of the columns as written; a unit is empty where it is not known beside the label.
    cells : sequence of sequence of str
        Cells of each column; empty where the file has no text.
    mapping : RecordingMapping or None
    """
    known = {} if mapping is None else _sources(mapping.for_labels(list(labels)))
    without = set() if mapping is None else set(mapping.selection.without)
    headings = [f"{label} [{unit}]" if unit else label for label, unit in zip(labels, units, strict=True)]
    spreads = spread_headings(labels, list(map(run_heading, headings)))
    columns = []
    for place, (label, own, unit, column) in enumerate(zip(numbered_labels(labels), labels, units, cells, strict=True)):
        filled = [cell.strip() for cell in column if cell.strip()]
        is_words = bool(filled) and not any(map(_is_number, filled[:_MAX_TEXTS]))
        if label in known:
            statement, is_asked = known[label], False
        elif label in without or not label:
            statement, is_asked = LEFT_OUT, False
        elif place in spreads:
            statement, is_asked = spreads[place].statement, False
        elif state_column([own], [(0, [cell]) for cell in column], ()) is not None:
            statement, is_asked = STATES, False
        elif is_words:
            found = run_heading(own)
            statement, is_asked = (found.name if found and found.name in TEXT_NAMES else LEFT_OUT), False
        else:
            statement, is_asked = _by_label(own, unit)
        texts = tuple(dict.fromkeys(filled)) if is_words or (mapping and label in mapping.rows) else ()
        columns.append(
            FileColumn(
                label=label,
                statement=statement,
                is_asked=is_asked and mapping is None,
                cells=tuple(filled[:_MAX_CELLS]),
                texts=texts if len(texts) <= _MAX_TEXTS else (),
            )
        )
    return columns


def mapping_of_statements(
    statements: Mapping[str, str],
    *,
    mapping: RecordingMapping | None = None,
    rows: Mapping[str, str] = MappingProxyType({}),
    sample_rate: float | None = None,
) -> RecordingMapping:
    """Mapping by statements of quantity and unit for each label.

    Parameters
    ----------
    statements : mapping of str to str
        Such as "friction_force N" by label, "friction_force 2 N/V" with a gain, or "-" for a column that is left out.
    mapping : RecordingMapping or None
        Whose calibrations, text layout and selection stay.
    rows : mapping of str to str
        Required cell by column label.
    sample_rate : float or None
        Rows per second, for a file without a column of the time. [Hz]

    Returns
    -------
    RecordingMapping

    Raises
    ------
    InvalidInput
        With the label as its key, if a statement cannot be read, or two columns are of one quantity.
    """
    before = {} if mapping is None else _by_label_of(mapping)
    sources: dict[str, ChannelSource] = {}
    without = []
    for label, text in statements.items():
        name, _, gain = text.strip().partition(" ")
        if name in quantities() and (calibrated := source_with_gain(label, gain)) is not None:
            sources[name] = calibrated
            continue
        found = _meaning(text, label)
        if not isinstance(found, RunHeading):
            without += [label] if found == LEFT_OUT else []
            continue
        if found.name in sources:
            raise InvalidInput(f"{sources[found.name].column!r} and {label!r} are both {found.name}", key=label)
        source = found.source(label)
        sources[found.name] = replace(before[label], unit=source.unit) if label in before else source
    axis_quantity = next((name for name in AXIS_QUANTITIES if name in sources), "time")
    axis = sources.pop(axis_quantity, None)
    known = mapping or RecordingMapping(channels={})
    return replace(
        known,
        channels=MappingProxyType(sources),
        axis=axis,
        axis_quantity=axis_quantity,
        sample_rate=None if axis else sample_rate,
        rows=MappingProxyType(dict(rows)),
        selection=replace(known.selection, without=tuple(without)) if without else known.selection,
    )


def _meaning(text: str, label: str) -> RunHeading | str:
    """Meaning of a statement, refused by its label."""
    try:
        return meaning(text, label)
    except (InvalidInput, UnknownName) as failure:
        raise InvalidInput(str(failure), key=label) from None


def _by_label_of(mapping: RecordingMapping) -> dict[str, ChannelSource]:
    """Sources of a mapping by the labels of their columns."""
    every = [*mapping.channels.values(), *([mapping.axis] if mapping.axis else [])]
    return {source.column: source for source in every}


def _sources(mapping: RecordingMapping) -> dict[str, str]:
    """Statements of a mapping by the labels of its columns."""
    named = {**mapping.channels, **({mapping.axis_quantity: mapping.axis} if mapping.axis else {})}
    return {source.column: " ".join(filter(None, (name, source.unit))) for name, source in named.items()}


def _by_label(label: str, unit: str) -> tuple[str, bool]:
    """Statement by a label and the unit beside it, and whether it must be asked for."""
    name, own = name_and_unit(label)
    name = "time" if name in TIME_LABELS else name
    if name in quantities():
        heading = RunHeading(name, unit or own or "")
        is_clear = fits(heading) or (name == "time" and not heading.unit)
        return f"{name} {heading.unit or quantities()[name].unit}".strip(), not is_clear
    found = run_heading(f"{label} [{unit}]" if unit else label)
    if found is None:
        return LEFT_OUT, True
    unit = found.unit or ("" if found.name in TEXT_NAMES else quantities()[found.name].unit)
    return replace(found, unit=unit).statement, True


def _is_number(cell: str) -> bool:
    """Whether a cell is a number with either decimal sign."""
    return any(cell_number(cell, sign=sign) is not None for sign in ".,")
