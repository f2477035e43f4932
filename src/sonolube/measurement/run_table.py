"""Tables of runs as text files or spreadsheets: columns by a mapping or their headings, numbers in SI, and texts."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import read_head
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, TextLayout
from sonolube.measurement.recordings.raw_table import column_of_label, numbered_labels, si_conversion
from sonolube.measurement.recordings.table_layout import is_summary
from sonolube.measurement.recordings.text_recordings import DelimitedText
from sonolube.measurement.recordings.text_tables import (
    NumberedCells,
    TextTable,
    decoded_text,
    require_rows,
    text_tables,
)
from sonolube.measurement.run_columns import DIRECTION_COLUMN, DIRECTION_WORDS, TEXT_NAMES, heading
from sonolube.measurement.run_headings import (
    LEFT_OUT,
    RunHeading,
    fits,
    is_spread,
    is_without_vibration,
    likely_statements,
    meaning_at_stake,
    run_heading,
    spread_headings,
    state_column,
    uncertainty_of,
)
from sonolube.measurement.run_layout import LaidOut, laid_out, laid_out_text
from sonolube.measurement.run_numbers import OF_A_DIGIT, CellNumber, cell_number, decimal_sign_of
from sonolube.measurement.spreadsheets import is_spreadsheet, spreadsheet_rows
from sonolube.text.units import unit_description
from sonolube.vocabulary import quantities

_NO_HEADING: Final = re.compile(r"column \d+")
_NO_NUMBER: Final = CellNumber(float("nan"), float("nan"))
_ARCHIVE: Final = b"PK\x03\x04"
_UTF_16: Final = (b"\xff\xfe", b"\xfe\xff")
_LARGEST: Final = 1e30  # in any unit; keeps squares of quantities within the range of floats
_MAX_RUNS: Final = 100_000
_QUOTED: Final = 40  # characters of a cell in an error message
_MAX_NAMED: Final = 12  # columns in a caveat


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
        Assumptions of the reader, and lines and columns that are left out.
    digits : mapping of str to ndarray, shape (rows,)
        Standard uncertainties of the columns by their digits as they are written, in SI.
    without : ndarray of bool, shape (rows,), or None
        Whether a column says that a row is without vibration; None where no column says so.
    unread : tuple of str
        Headings of columns that are neither quantities nor texts here.
    """

    columns: Mapping[str, Floats]
    texts: Mapping[str, list[str]]
    lines: list[int]
    caveats: tuple[str, ...] = ()
    digits: Mapping[str, Floats] = field(default_factory=lambda: MappingProxyType({}))
    without: NDArray[np.bool_] | None = None
    unread: tuple[str, ...] = ()


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
    """Columns of a table of runs in a text or a spreadsheet, by a mapping, a recipe for its labels, or headings."""
    from sonolube.measurement.recordings.reader import recipe_of_runs  # which filters signals, with scipy

    found, caveats = _found(path, mapping)
    if mapping is None and (mapping := recipe_of_runs(path, found.table.labels)) is not None:
        caveats = (*caveats, f"read by the recipe {mapping.name!r}")
    columns = assigned_columns(
        path,
        found.table.line,
        found.table.labels,
        found.table.rows,
        mapping=mapping,
        separator=found.table.separator,
        place="column" if found.is_turned else "line",
    )
    return replace(columns, caveats=(*caveats, *columns.caveats))


def unread_columns(path: Path) -> tuple[str, ...]:
    """Headings of a table of runs whose cells are not among its columns."""
    return run_table(path).unread


def run_text(path: Path, mapping: RecordingMapping | None = None) -> tuple[TextTable, tuple[str, ...]]:
    """Labels and rows of a table of runs, with the caveats of its decoding and layout; parameters as `run_table`."""
    found, caveats = _found(path, mapping)
    return found.table, caveats


def _found(path: Path, mapping: RecordingMapping | None) -> tuple[LaidOut, tuple[str, ...]]:
    """Table of a file, with the caveats of its decoding and its layout."""
    head = read_head(path)
    if head.startswith(_ARCHIVE):
        if not is_spreadsheet(path):
            raise InvalidInput(f"{path}: is an archive; unpack it, and save the table as CSV")
        found, caveats = _sheet(path, mapping)
    else:
        if not (DelimitedText().recognises(head, path) or head[:2] in _UTF_16):
            raise InvalidInput(f"{path}: not a table of comma-separated values")
        found, caveats = _text(path, mapping)
    table = found.table
    if not table.rows:
        raise InvalidInput(f"{path}: needs a head and at least one run")
    if len(table.rows) > _MAX_RUNS:
        raise InvalidInput(f"{path}: has {len(table.rows)} rows, but at most {_MAX_RUNS} runs are read")
    require_rows(table, mapping.rows if mapping else {}, path)
    return found, (*caveats, *found.left_out)


def _text(path: Path, mapping: RecordingMapping | None) -> tuple[LaidOut, tuple[str, ...]]:
    """Table of a text, by its own layout or that of a mapping."""
    layout = mapping.text if mapping else TextLayout()
    sections = mapping.selection.sections if mapping else ()
    text, caveats = decoded_text(path, encoding=layout.encoding)
    has_layout = layout.header or layout.section or layout.units_row or layout.comment or layout.ends_at_blank_line
    if not (has_layout or sections):
        return laid_out_text(text, layout, path), caveats
    tables = text_tables(text, layout, sections, path, allows_short_rows=True)
    if len(tables) > 1:
        raise InvalidInput(f"{path}: has {len(tables)} sections; choose one by selection.sections of the mapping")
    return LaidOut(table=tables[0], left_out=(), is_turned=False, known=0), caveats


def _sheet(path: Path, mapping: RecordingMapping | None) -> tuple[LaidOut, tuple[str, ...]]:
    """Table of the sheet whose headings name the most quantities, or that a mapping selects."""
    sheets = spreadsheet_rows(path)
    sections = mapping.selection.sections if mapping else ()
    if unknown := [name for name in sections if name not in sheets]:
        raise InvalidInput(f"{path}: has no sheet {unknown[0]!r} with cells; it has {', '.join(sheets) or 'none'}")
    tables = {name: laid_out(rows, path, separator="") for name, rows in sheets.items() if name in (sections or sheets)}
    if not tables:
        raise InvalidInput(f"{path}: is empty")
    most = max(found.known for found in tables.values())
    best = [name for name, found in tables.items() if found.known == most]
    if len(best) > 1:
        raise InvalidInput(
            f"{path}: sheets {best[0]!r} and {best[1]!r} may both be the table; choose one by"
            f' selection.sections = ["{best[0]}"] in a mapping, or delete the other'
        )
    caveat = f"of {len(sheets)} sheets only {best[0]!r} is read"
    return tables[best[0]], (caveat,) if len(sheets) > 1 and not sections else ()


def assigned_columns(
    path: Path,
    line: int,
    labels: Sequence[str],
    rows: Sequence[NumberedCells],
    *,
    mapping: RecordingMapping | None = None,
    separator: str = ",",
    place: str = "line",
) -> RunTable:
    """Columns of a table of runs by its labels and rows, whose numbers are those of lines, or of columns."""
    rows, summaries = _runs_and_summaries(rows, place)
    if not rows:
        raise InvalidInput(f"{path}: needs a head and at least one run")
    mapped = _by_mapping(path, labels, mapping) if mapping else []
    taken = {*(each.source.column for each in mapped), *(mapping.selection.without if mapping else ())}
    state = state_column(labels, rows, taken)
    others, left_out = _by_headings(path, line, labels, mapped, mapping, state, rows)
    layout = mapping.text if mapping else TextLayout()
    numbers = [each for each in (*mapped, *others) if each.name not in TEXT_NAMES]
    words = [each for each in (*mapped, *others) if each.name in TEXT_NAMES]
    filled = [_cell(cells, each.place) for _, cells in rows for each in numbers]
    has_only_points = separator in (",", "") and not any("," in cell for cell in filled)
    sign = layout.decimal_sign or ("." if has_only_points else decimal_sign_of(filled, path))
    cells = _Cells(path=path, line=line, sign=sign, missing=frozenset(layout.missing), place=place)
    texts = {each.name: [_cell(cells, each.place) for _, cells in rows] for each in words}
    directions = [_word(row, each) for each in numbers for _, row in rows if each.name == DIRECTION_COLUMN]
    read = {each.name: cells.in_si(each, rows) for each in numbers}
    columns = {name: found.values for name, found in read.items()}
    stated, unused = _stated_uncertainties(read, columns)
    halved = tuple(_gain_caveat(each) for each in (*mapped, *others) if _is_of_other_peaks(each))
    spread = tuple(
        f"{_quoted(each.source.column)} is taken as the {each.name.replace('_', ' ')}"
        for each in (*mapped, *others)
        if is_spread(each.source.column)
    )
    columns |= {  # a spread of zero is one below its last digit
        name: np.maximum(columns[name], found.digits) for name, found in read.items() if name.endswith("_uncertainty")
    }
    return RunTable(
        columns=columns | stated,
        texts=texts | ({f"{DIRECTION_COLUMN}_word": directions} if any(directions) else {}),
        lines=[number for number, _ in rows],
        caveats=(*summaries, *halved, *spread, *unused, *left_out_caveat(left_out)),
        digits={name: found.digits for name, found in read.items()},
        without=None if state is None else np.array([is_without_vibration(cells, state) for _, cells in rows]),
        unread=(*left_out, *(() if state is None else (labels[state],))),
    )


def _stated_uncertainties(
    read: Mapping[str, "_Read"], columns: Mapping[str, Floats]
) -> tuple[dict[str, Floats], list[str]]:
    """Columns of the uncertainties that stand beside numbers in cells, and caveats on them."""
    stated: dict[str, Floats] = {}
    caveats = []
    for name, found in read.items():
        if not np.isfinite(found.uncertainties).any():
            continue
        own = uncertainty_of(name)
        if own in columns or not own:
            caveats.append(f"the uncertainties behind {name} are left out")
        else:
            stated[own] = found.uncertainties
            caveats.append(f"what stands behind +- in {name} is taken as its standard uncertainty")
    return stated, caveats


def _is_of_other_peaks(column: _Column) -> bool:
    """Whether the heading of a column says other peaks than its quantity has, and it is read so."""
    found = run_heading(column.source.column)
    return found is not None and found.gain == column.source.gain != 1


def _gain_caveat(column: _Column) -> str:
    """Caveat on an amplitude or a voltage that is read from between other peaks."""
    told = "peak to peak: the amplitude is half of it" if column.source.gain < 1 else "zero to peak, and doubled"
    return f"{_quoted(column.source.column)} is read as {told}"


def _runs_and_summaries(rows: Sequence[NumberedCells], place: str) -> tuple[Sequence[NumberedCells], tuple[str, ...]]:
    """Rows of runs, and a caveat on each row that summarises others."""
    words = {number: next((cell for cell in cells if is_summary(cell)), "") for number, cells in rows}
    caveats = tuple(
        f"{place} {number} is no run and left out: {_quoted(word)}" for number, word in words.items() if word
    )
    return [(number, cells) for number, cells in rows if not words[number]], caveats


def _by_mapping(path: Path, labels: Sequence[str], mapping: RecordingMapping) -> list[_Column]:
    """Columns that a mapping names."""
    places = {label: place for place, label in enumerate(numbered_labels(labels))}
    return [
        _Column(name, column_of_label(places, source.column, path), source)
        for name, source in mapping.for_labels(labels).channels.items()
        if not (source.optional and source.column not in places)
    ]


def _by_headings(
    path: Path,
    line: int,
    labels: Sequence[str],
    mapped: Sequence[_Column],
    mapping: RecordingMapping | None,
    state: int | None,
    rows: Sequence[NumberedCells],
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
    spreads = _spreads(labels, mapped)
    for place, (label, numbered) in enumerate(zip(labels, numbered_labels(labels), strict=True)):
        if place in places or place == state:
            continue
        found = spreads.get(place) or run_heading(label)
        if (
            not without.isdisjoint((label, numbered))
            or (found is not None and found.name in names)
            or (is_spread(label) and place not in spreads)
        ):
            left_out.append(numbered)
        elif found is not None and found.name == "time" and not _has_numbers(rows, place):
            left_out.append(numbered)  # of the day
        elif found is None:
            _require_harmless(path, line, place, label)
            left_out.append(numbered)
        else:
            if found.name in known:
                first = known[found.name]
                both = "" if first == label else f", {_quoted(first)} and {_quoted(label)}"
                raise InvalidInput(f"{path}: two columns are named {found.name}{both}")
            known[found.name] = label
            columns.append(_Column(found.name, place, replace(found.source(label), unit=found.unit)))
    return columns, left_out


def _spreads(labels: Sequence[str], mapped: Sequence[_Column]) -> dict[int, RunHeading]:
    """Uncertainties that columns of spreads hold, by their places; none of a column with a calibration."""
    meanings = [found if (found := run_heading(label)) is not None and fits(found) else None for label in labels]
    for each in mapped:
        source = each.source
        meanings[each.place] = None if source.is_calibrated else RunHeading(each.name, source.unit or "")
    return spread_headings(labels, meanings)


def _has_numbers(rows: Sequence[NumberedCells], place: int) -> bool:
    """Whether each filled cell of a column holds a number with either decimal sign."""
    cells = [cell for _, row in rows if (cell := _cell(row, place))]
    return all(any(cell_number(cell, sign=sign) is not None for sign in ".,") for cell in cells)


def _require_harmless(path: Path, line: int, place: int, label: str) -> None:
    """Refuse a column of unknown meaning that must not be left out unasked."""
    if not label:
        raise InvalidInput(f"{path}: line {line}: column {place + 1} has no heading; name it, or delete the column")
    if _NO_HEADING.fullmatch(label):
        raise InvalidInput(
            f"{path}: line {line}: has no headings: write them above the numbers, or state each column by"
            f" sonolube mapping, such as --column '{label}=normal_load N'"
        )
    if stake := meaning_at_stake(label):
        likely = likely_statements(label) or [LEFT_OUT]
        choices = " or ".join(f"'{label}={each}'" for each in likely)
        raise InvalidInput(
            f"{path}: line {line}: column {_quoted(label)} must name a quantity, such as sliding_speed [mm/s]: it looks"
            f" like {stake}; map it (sonolube mapping FILE --column {choices}), or delete the column"
        )


@dataclass(frozen=True, slots=True)
class _Read:
    """Numbers of a column in SI, NaN where a cell is empty, with their uncertainties by digits and as stated."""

    values: Floats
    digits: Floats
    uncertainties: Floats


@dataclass(frozen=True, kw_only=True, slots=True)
class _Cells:
    """Reading of the cells of one table: its file, the line of its headings, decimal sign and texts for no value."""

    path: Path
    line: int
    sign: str
    missing: frozenset[str]
    place: str

    def in_si(self, column: _Column, rows: Sequence[NumberedCells]) -> _Read:
        """Numbers of a column in SI."""
        if column.name == DIRECTION_COLUMN and any(_word(cells, column) for _, cells in rows):
            return self._angles(column, rows)
        source = column.source
        unit = quantities()[column.name].unit
        found = run_heading(source.column)
        of_heading = found.unit if found else _bracketed(source.column)
        numbers = [self._number(*row, column) for row in rows]
        values, digits, errors = (
            np.array([getattr(number, name) for number in numbers]) for name in ("value", "digit", "uncertainty")
        )
        written = np.array([number.unit for number in numbers])
        for each in dict.fromkeys(written.tolist()):
            here = written == each
            if not each and np.isnan(values[here]).all() and np.any(~here):
                continue
            stated = each or (of_heading if source.unit is None else source.unit)
            line = self.line if not each else rows[int(np.argmax(here))][0]
            name = f"{self.path}: {self.place if each else 'line'} {line}: {column.shown}"
            if unit and not stated:
                raise InvalidInput(
                    f"{name} has no unit; expected {unit_description(unit)}: put it into the heading, such as"
                    f" {_example(column.name, unit)}"
                )
            gain, offset, _ = si_conversion(stated, unit=unit, name=name)
            values[here] = offset + gain * source.calibrated(values[here], stated=each or of_heading, name=name)
            slope = abs(gain * source.gain)
            digits[here], errors[here] = slope * OF_A_DIGIT * digits[here], slope * errors[here]
        return _Read(values, digits, errors)

    def _angles(self, column: _Column, rows: Sequence[NumberedCells]) -> _Read:
        """Angles of a column that has words too, in rad: those of its words, NaN for one along the normal."""
        words = [_word(cells, column) for _, cells in rows]
        others = [(number, cells) for (number, cells), word in zip(rows, words, strict=True) if not word]
        angles = np.array([DIRECTION_WORDS.get(word, np.nan) for word in words])
        if any(_cell(cells, column.place) not in ("", *self.missing) for _, cells in others):
            angles[[not word for word in words]] = self.in_si(column, others).values
        unknown = np.full(angles.size, np.nan)
        return _Read(angles, unknown, unknown)

    def _number(self, line: int, row: Sequence[str], column: _Column) -> CellNumber:
        """Number in a cell of a row, in the unit of its column; NaN where it is empty."""
        cell = _cell(row, column.place)
        if not cell or cell in self.missing:
            return _NO_NUMBER
        number = cell_number(cell, sign=self.sign)
        if number is not None and abs(number.value) <= _LARGEST:
            return number
        reason = f"is no number{_sign_hint(cell, self.sign)}" if number is None else "lies beyond any run"
        raise InvalidInput(f"{self.path}: {self.place} {line}: {column.shown} {_quoted(cell)} {reason}")


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


def _sign_hint(cell: str, sign: str) -> str:
    """Other reading of a cell: a number of the other decimal sign."""
    other = {".": ",", ",": "."}[sign]
    return (
        f" with the decimal sign {sign!r}; give the other by sonolube mapping FILE --decimal-sign"
        if other in cell
        else ""
    )


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
