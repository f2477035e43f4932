"""Tables of runs as text files: the columns by a mapping or by their headings, numbers in SI, texts as they are."""

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import detected_decimal_sign, parse_number, read_head
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, TextLayout
from sonolube.measurement.recordings.raw_table import column_of_label, numbered_labels, si_conversion
from sonolube.measurement.recordings.text_recordings import DelimitedText
from sonolube.measurement.recordings.text_tables import (
    NumberedCells,
    TextTable,
    decoded_text,
    require_rows,
    text_tables,
)
from sonolube.measurement.run_columns import DIRECTION_COLUMN, DIRECTION_WORDS, TEXT_NAMES, heading
from sonolube.measurement.run_headings import fits, meaning_at_stake, run_heading
from sonolube.text.units import unit_description
from sonolube.vocabulary import quantities

_PREAMBLE: Final = re.compile(r'"?\s*(?:[#%](?!\s*[;,\t|])|//)|[\s;,"|]*\Z')  # comments, and lines without any text
_SEPARATOR_LINE: Final = re.compile(r"sep=(.)", re.IGNORECASE)  # with which Excel tells its separator
_SUMMARIES: Final = frozenset(
    {
        *("mean", "mean value", "average", "avg", "median", "mittel", "mittelwert", "mw", "durchschnitt"),
        *("sd", "s.d", "std", "std dev", "stdev", "standard deviation", "stabw", "stdabw", "standardabweichung"),
        *("sem", "standard error", "cv", "variance", "varianz", "min", "minimum", "max", "maximum"),
        *("sum", "summe", "total", "gesamt"),
    }
)
_THOUSANDS: Final = re.compile(r"[-+]?[1-9]\d{0,2}([.,])\d{3}(?:\1\d{3})*")
_LARGEST: Final = 1e30  # in any unit; keeps squares of quantities within the range of floats
_MAX_RUNS: Final = 100_000
_QUOTED: Final = 40  # characters of a cell in an error message
_MAX_NAMED: Final = 12  # columns in a caveat
_SPREADSHEET: Final = b"PK\x03\x04"


@dataclass(frozen=True, kw_only=True, slots=True)
class RunTable:
    """Columns of a table of runs.

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (rows,)
        Quantities in SI by name, NaN where a cell is empty.
    texts : mapping of str to list of str
        Texts by name; `vibration_direction_word` has the words of `DIRECTION_WORDS` in the column of that name.
    lines : list of int
        Of the file, for each row.
    caveats : tuple of str
        Assumptions of the reader, and columns that are left out.
    """

    columns: Mapping[str, Floats]
    texts: Mapping[str, list[str]]
    lines: list[int]
    caveats: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Column:
    """Column of a table: its name in the result, place, label, and source."""

    name: str
    place: int
    source: ChannelSource

    @property
    def shown(self) -> str:
        """Name as messages have it: that of the quantity where the heading has it too, else the heading."""
        label = self.source.column
        return self.name if re.fullmatch(rf"{self.name}\W*.*", label) else f"column {_quoted(label)}"


def run_table(path: Path, *, mapping: RecordingMapping | None = None) -> RunTable:
    """Columns of a table of runs in a text file."""
    table, caveats = run_text(path, mapping)
    found = assigned_columns(path, table.line, table.labels, table.rows, mapping=mapping, separator=table.separator)
    return replace(found, caveats=(*caveats, *found.caveats))


def run_text(path: Path, mapping: RecordingMapping | None = None) -> tuple[TextTable, tuple[str, ...]]:
    """Labels and rows of the text of a table of runs, with the caveats of its decoding; parameters as `run_table`."""
    head = read_head(path)
    if head.startswith(_SPREADSHEET):
        raise InvalidInput(f"{path}: is a spreadsheet or archive; save the table as CSV")
    if not DelimitedText().recognises(head, path):
        raise InvalidInput(f"{path}: not a table of comma-separated values")
    layout = mapping.text if mapping else TextLayout()
    text, caveats = decoded_text(path, encoding=layout.encoding)
    if not (layout.lines_to_skip or layout.header or layout.section):
        layout = _below_preamble(text, layout)
    tables = text_tables(text, layout, mapping.selection.sections if mapping else (), path, allows_short_rows=True)
    if len(tables) > 1:
        raise InvalidInput(f"{path}: has {len(tables)} sections; choose one by selection.sections of the mapping")
    table = tables[0] if layout.units_row else _with_units(tables[0])
    if not table.rows:
        raise InvalidInput(f"{path}: needs a head and at least one run")
    if len(table.rows) > _MAX_RUNS:
        raise InvalidInput(f"{path}: has {len(table.rows)} rows, but at most {_MAX_RUNS} runs are read")
    require_rows(table, mapping.rows if mapping else {}, path)
    return table, caveats


def _with_units(table: TextTable) -> TextTable:
    """Table whose labels have the units of the row below them, where that row holds units and nothing else."""
    if not table.rows:
        return table
    cells = [cell.strip(" []()") for cell in table.rows[0][1]]
    meant = [(run_heading(f"{label} [{cell}]"), cell) for label, cell in zip(table.labels, cells, strict=False)]
    stated = [found for found, cell in meant if cell and found is not None and found.name not in TEXT_NAMES]
    if len(stated) < 2 or not all(map(fits, stated)) or any(parse_number(cell, decimal_sign=".") for cell in cells):
        return table
    labels = [f"{label} [{cell}]" if cell else label for label, cell in zip(table.labels, cells, strict=False)]
    return replace(table, labels=labels + table.labels[len(labels) :], rows=table.rows[1:])


def assigned_columns(
    path: Path,
    line: int,
    labels: Sequence[str],
    rows: Sequence[NumberedCells],
    *,
    mapping: RecordingMapping | None = None,
    separator: str = ",",
) -> RunTable:
    """Columns of a table of runs by its labels and rows."""
    rows, summaries = _runs_and_summaries(rows)
    if not rows:
        raise InvalidInput(f"{path}: needs a head and at least one run")
    mapped = _by_mapping(path, labels, mapping) if mapping else []
    others, left_out = _by_headings(path, line, labels, mapped, mapping)
    layout = mapping.text if mapping else TextLayout()
    numbers = [each for each in (*mapped, *others) if each.name not in TEXT_NAMES]
    words = [each for each in (*mapped, *others) if each.name in TEXT_NAMES]
    filled = [_cell(cells, each.place) for _, cells in rows for each in numbers]
    sign = layout.decimal_sign or ("." if separator == "," else _decimal_sign(path, filled))
    missing = frozenset(layout.missing)
    texts = {each.name: [_cell(cells, each.place) for _, cells in rows] for each in words}
    directions = [_word(cells, each) for each in numbers for _, cells in rows if each.name == DIRECTION_COLUMN]
    return RunTable(
        columns={each.name: _in_si(path, line, each, rows, sign, missing) for each in numbers},
        texts=texts | ({f"{DIRECTION_COLUMN}_word": directions} if any(directions) else {}),
        lines=[number for number, _ in rows],
        caveats=(*summaries, *left_out_caveat(left_out)),
    )


def _runs_and_summaries(rows: Sequence[NumberedCells]) -> tuple[Sequence[NumberedCells], tuple[str, ...]]:
    """Rows of runs, and a caveat on each row that summarises others."""
    words = {number: next((cell for cell in cells if _is_summary(cell)), "") for number, cells in rows}
    caveats = tuple(f"line {number} is no run and left out: {_quoted(word)}" for number, word in words.items() if word)
    return [(number, cells) for number, cells in rows if not words[number]], caveats


def _is_summary(cell: str) -> bool:
    """Whether a cell marks its row as a summary of others, such as a mean."""
    return len(cell) <= _QUOTED and cell.strip(" .:*()[]=\t").casefold() in _SUMMARIES


def _decimal_sign(path: Path, cells: Sequence[str]) -> str:
    """Decimal sign of the numbers of a table; refuse a mark that may as well separate thousands."""
    marked = [cell for cell in cells if "," in cell or "." in cell]
    if marked and all(_THOUSANDS.fullmatch(cell) for cell in marked):
        small, large = float(marked[0].replace(",", ".")), re.sub(r"\D", "", marked[0])
        raise InvalidInput(
            f"{path}: {_quoted(marked[0])} may be {small:g} or {large}: each number with a mark has three digits behind"
            " it; state text.decimal_sign in a mapping, or write one of them with other digits"
        )
    return detected_decimal_sign(cells)


def _below_preamble(text: str, layout: TextLayout) -> TextLayout:
    """Layout with the lines before the headings to skip, and the separator that one of them states."""
    skipped = 0
    for text_line in io.StringIO(text, newline=""):
        if stated := _SEPARATOR_LINE.fullmatch(text_line.strip("\r\n")):
            layout = replace(layout, separator=layout.separator or stated[1])
        elif not _PREAMBLE.match(text_line):
            break
        skipped += 1
    return replace(layout, lines_to_skip=skipped)


def _by_mapping(path: Path, labels: Sequence[str], mapping: RecordingMapping) -> list[_Column]:
    """Columns that a mapping names."""
    places = {label: place for place, label in enumerate(numbered_labels(labels))}
    return [
        _Column(name, column_of_label(places, source.column, path), source)
        for name, source in mapping.for_labels(labels).channels.items()
        if not (source.optional and source.column not in places)
    ]


def _by_headings(
    path: Path, line: int, labels: Sequence[str], mapped: Sequence[_Column], mapping: RecordingMapping | None
) -> tuple[list[_Column], list[str]]:
    """Other columns by their headings, and labels of those left out; of unknown meaning, refused where it matters."""
    places, names = {each.place for each in mapped}, {each.name for each in mapped}
    without = {
        *(mapping.selection.without if mapping else ()),
        *(mapping.axis.labels if mapping and mapping.axis else ()),
    }
    columns: list[_Column] = []
    left_out: list[str] = []
    known: dict[str, str] = {}
    for place, (label, numbered) in enumerate(zip(labels, numbered_labels(labels), strict=True)):
        if place in places:
            continue
        found = run_heading(label)
        if not without.isdisjoint((label, numbered)) or (found is not None and found.name in names):
            left_out.append(numbered)
        elif found is None:
            _require_harmless(path, line, place, label)
            left_out.append(numbered)
        else:
            if found.name in known:
                first = known[found.name]
                both = "" if first == label else f", {_quoted(first)} and {_quoted(label)}"
                raise InvalidInput(f"{path}: two columns are named {found.name}{both}")
            known[found.name] = label
            columns.append(_Column(found.name, place, ChannelSource(column=label, unit=found.unit)))
    return columns, left_out


def _require_harmless(path: Path, line: int, place: int, label: str) -> None:
    """Refuse a column of unknown meaning that must not be left out unasked."""
    if not label:
        raise InvalidInput(f"{path}: line {line}: column {place + 1} has no heading; name it, or delete the column")
    if stake := meaning_at_stake(label):
        raise InvalidInput(
            f"{path}: line {line}: column {_quoted(label)} must name a quantity, such as sliding_speed [mm/s]: it looks"
            f" like {stake}; map it (sonolube mapping), or delete the column"
        )


def _in_si(
    path: Path, line: int, column: _Column, rows: Sequence[NumberedCells], sign: str, missing: frozenset[str]
) -> Floats:
    """Numbers of a column in SI, NaN where a cell is empty."""
    if column.name == DIRECTION_COLUMN and any(_word(cells, column) for _, cells in rows):
        return _angles(path, line, column, rows, sign, missing)
    source = column.source
    unit = quantities()[column.name].unit
    found = run_heading(source.column)
    of_heading = found.unit if found else _bracketed(source.column)
    stated = of_heading if source.unit is None else source.unit
    if unit and not stated:
        raise InvalidInput(
            f"{path}: line {line}: {column.shown} has no unit; expected {unit_description(unit)}: put it into the"
            f" heading, such as {_example(column.name, unit)}"
        )
    gain, offset, _ = si_conversion(stated, unit=unit, name=f"{path}: line {line}: {column.shown}")
    numbers = np.array([_number(path, *row, column, sign, missing) for row in rows])
    readings = source.calibrated(numbers, stated=of_heading, name=f"{path}: line {line}: {column.shown}")
    return offset + gain * readings


def _angles(
    path: Path, line: int, column: _Column, rows: Sequence[NumberedCells], sign: str, missing: frozenset[str]
) -> Floats:
    """Angles of a column that has words too, in rad: those of its words, NaN for one along the normal or torsional."""
    words = [_word(cells, column) for _, cells in rows]
    others = [(number, cells) for (number, cells), word in zip(rows, words, strict=True) if not word]
    angles = np.array([DIRECTION_WORDS.get(word, np.nan) for word in words])
    if any(_cell(cells, column.place) not in ("", *missing) for _, cells in others):
        angles[[not word for word in words]] = _in_si(path, line, column, others, sign, missing)
    return angles


def _word(cells: Sequence[str], column: _Column) -> str:
    """Word for a direction in a cell; empty where it has none."""
    word = _cell(cells, column.place).lower()
    return word if word in DIRECTION_WORDS else ""


def _bracketed(label: str) -> str:
    """Unit in brackets at the end of a label."""
    found = re.search(r"[\[(]([^\[\]()]*)[\])]\s*\Z", label[-_QUOTED:])
    return found[1] if found else ""


def _example(name: str, unit: str) -> str:
    """Heading with a unit, the usual one where the quantity is among the columns of runs."""
    try:
        return heading(name)
    except KeyError:
        return f"{name} [{unit}]"


def _number(path: Path, line: int, cells: Sequence[str], column: _Column, sign: str, missing: frozenset[str]) -> float:
    """Number in a cell of a row, in the unit of its column; NaN where it is empty."""
    cell = _cell(cells, column.place)
    if not cell or cell in missing:
        return float("nan")
    number = parse_number(cell, decimal_sign=sign)
    if number is None:
        number = _with_thousands(cell, sign)
    if number is None:
        raise InvalidInput(f"{path}: line {line}: {column.shown} {_quoted(cell)} is no number{_sign_hint(cell, sign)}")
    if not abs(number) <= _LARGEST:
        raise InvalidInput(f"{path}: line {line}: {column.shown} {_quoted(cell)} lies beyond any run")
    return number


def _with_thousands(cell: str, sign: str) -> float | None:
    """Number whose thousands are separated by the mark that is not its decimal sign; None where it has none."""
    other = {".": ",", ",": "."}[sign]
    if re.fullmatch(rf"[-+]?\d{{1,3}}(?:\{other}\d{{3}})+(?:\{sign}\d+)?", cell) is None:
        return None
    return parse_number(cell.replace(other, ""), decimal_sign=sign)


def _sign_hint(cell: str, sign: str) -> str:
    """Other reading of a cell: a number of the other decimal sign."""
    other = {".": ",", ",": "."}[sign]
    return f" with the decimal sign {sign!r}; give text.decimal_sign in a mapping" if other in cell else ""


def left_out_caveat(labels: Sequence[str]) -> tuple[str, ...]:
    """Caveat about the columns that are not read."""
    if not labels:
        return ()
    named = ", ".join(map(_quoted, labels[:_MAX_NAMED])) + (", ..." if len(labels) > _MAX_NAMED else "")
    return (f"{len(labels)} {'column is' if len(labels) == 1 else 'columns are'} left out: {named}",)


def _cell(cells: Sequence[str], place: int) -> str:
    """Text of a cell; empty where the row is shorter."""
    return cells[place].strip() if place < len(cells) else ""


def _quoted(cell: str) -> str:
    """Cell in quotation marks, shortened where it is long."""
    text = cell.strip()
    return repr(text if len(text) <= _QUOTED else text[:_QUOTED] + "...")
