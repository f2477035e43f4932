"""Impedance in text tables whose columns have headings: the table in its file, and the sweep of its columns."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, Final, final

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.headings import (
    ColumnHeading,
    is_phase_without_unit,
    is_unit,
    parse_heading,
    phase_symbol,
    unclear_heading,
)
from sonolube.measurement.impedance.parts import (
    COMPLEX_PARTS,
    MAGNITUDES,
    impedance_of_complex,
    pair_of,
    sweep_of_parts,
)
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.measured_files import parse_number
from sonolube.measurement.recordings.headed_tables import (
    cell_of_row,
    finite_numbers,
    headed_table,
    possible_headings,
    without_comments,
)
from sonolube.measurement.recordings.text_tables import NumberedCells

_LARGEST: Final = 1e30  # in any unit
_LONGEST_PREAMBLE: Final = 400  # lines
_LOOKED_AT: Final = 50  # rows by which columns of complex numbers and the decimal sign are told
_QUOTED: Final = 40  # characters of a heading in a message
_FULL_TURN: Final = 2 * math.pi * 1.001

_DIGITS: Final = r"\d+(?:[.,]\d*)?(?:[eE][-+]?\d+)?"
_COMPLEX: Final = re.compile(
    rf"\(?\s*(?P<re>[-+]?\s*{_DIGITS})\s*(?P<sign>[-+])\s*"
    rf"(?:[ij]\s*\*?\s*(?P<im>{_DIGITS})|(?P<im_before>{_DIGITS})\s*\*?\s*[ij])\s*\)?"
)
_POLAR: Final = re.compile(rf"(?P<abs>{_DIGITS})\s*(?:∠|@)\s*(?P<deg>[-+]?\s*{_DIGITS})\s*°?")
_REFERENCE: Final = re.compile(
    r"(?:\bz_?0|\bz_?ref|\br_?ref|reference (?:impedance|resistance)|system (?:impedance|resistance)"
    r"|port impedance|bezugs(?:widerstand|impedanz)|referenzimpedanz)\b[^\d\n]{0,20}?"
    rf"(?P<value>{_DIGITS})\s*(?P<unit>[km]?)\s*(?:ohm|ω|Ω|$|[,;\s])",
    re.IGNORECASE,
)
_REFERENCE_50: Final = 50.0  # ohm
_SAME: Final = 1e-12  # relative difference of one number in two units
_LONGEST_LIST: Final = 200  # characters of the headings that were read


@final
class NamedColumns:
    """Any text table whose columns have headings, such as `frequency (kHz)`, `|Z| (ohm)`, `phase (deg)`.

    Notes
    -----
    Has no signature: the fallback for every text file. The headings are the first line that names a frequency and an
    impedance; what stands before it is a preamble.
    """

    name: ClassVar[str] = "table with named columns"
    suffixes: ClassVar[tuple[str, ...]] = (".csv", ".tsv", ".txt")

    def recognises(self, head: bytes, path: Path) -> bool:
        """True: any text may be a table."""
        return True

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        """One sweep of a table, under an empty name."""
        found = headed_table(lines, path, is_complete=_is_complete, is_unit=is_unit)
        if found is None:
            raise InvalidInput(_reason_without_headings(path, without_comments(lines)))
        table, reference = found.table, stated_reference(found.preamble)
        return {
            "": sweep_from_columns(
                path, table.line, table.labels, table.rows, decimal_sign=found.decimal_sign, reference=reference
            )
        }


def _is_complete(labels: Sequence[str]) -> bool:
    """Whether headings name a frequency and an impedance."""
    symbols = {heading.symbol for label in labels if (heading := parse_heading(label))}
    return "f" in symbols and (pair_of(frozenset(symbols)) is not None or not symbols.isdisjoint(COMPLEX_PARTS))


def _reason_without_headings(path: Path, kept: list[str]) -> str:
    """Refusal of a file in which no line names frequency and impedance, with the readings of a heading that may."""
    first = next((at for at, line in enumerate(kept) if line.strip()), None)
    if first is None:
        return f"{path}: line {len(kept)}: holds no row"
    for at, _, labels in possible_headings(kept, path):
        if any(heading.symbol == "f" for label in labels if (heading := parse_heading(label))):
            unclear = ((label, unclear_heading(label)) for label in labels)
            if found := next((each for each in unclear if each[1]), None):
                return f"{path}: line {at + 1}: {found[0][:_QUOTED]!r} {found[1]}"
            first = at
    return (
        f"{path}: line {first + 1}: names no columns of frequency and impedance, such as"
        " 'frequency (Hz)', '|Z| (ohm)', 'phase (deg)' or 'R (ohm)', 'X (ohm)'"
    )


def stated_reference(preamble: Sequence[str]) -> float | None:
    """Reference impedance of reflection coefficients that the lines before the headings state. [ohm]"""
    for line in preamble:
        if found := _REFERENCE.search(line[:_LONGEST_PREAMBLE]):
            scale = {"": 1.0, "k": 1e3, "m": 1e-3}[found["unit"].lower()]
            value = scale * float(found["value"].replace(",", "."))
            return value if value > 0 else None
    return None


def sweep_from_columns(
    path: Path,
    heading_line: int,
    labels: Sequence[str],
    rows: Sequence[NumberedCells],
    *,
    decimal_sign: str,
    reference: float | None = None,
) -> ImpedanceSweep:
    """Sweep of a table by the headings of its columns; an empty heading leaves its column out.

    By a column of complex numbers, else by the first pair of `IMPEDANCE_PARTS` that the table has: the magnitude alone
    only where there is nothing else.
    """
    if not rows:
        raise InvalidInput(f"{path}: line {heading_line}: no values follow")
    table = _Columns(path, heading_line, labels, rows, decimal_sign, [parse_heading(label) for label in labels])
    place = table.complex_place()
    caveats: tuple[str, ...] = ()
    if place is None and table.pair in (None, *MAGNITUDES):
        table, caveats = table.with_phase_by_values()
    if not table.places("f") or (place is None and table.pair is None):
        raise InvalidInput(_reason_without_headings(path, [*[""] * (heading_line - 1), ";".join(labels)]))
    lines = np.array([line for line, _ in rows])
    frequency = table.values("f")
    if place is not None:
        symbols = ["f", table.symbol(place)]
        impedance = impedance_of_complex(table.complex_values(place), symbols[1], reference=reference or _REFERENCE_50)
        sweep = ImpedanceSweep(frequency=frequency, impedance=impedance, lines=lines)
    else:
        pair = table.pair or MAGNITUDES[0]
        symbols = ["f", *dict.fromkeys(pair)]
        columns = {"f": frequency} | {symbol: table.values(symbol) for symbol in symbols[1:]}
        sweep = sweep_of_parts(columns, pair, lines=lines, reference=reference or _REFERENCE_50)
    if reference is None and any("S" in symbol for symbol in symbols):
        caveats += (
            "the file does not state the reference impedance of its reflection coefficient, which was taken as 50 ohm",
        )
    read = ", ".join(labels[table.places(symbol)[0]] for symbol in symbols)
    return replace(sweep, columns=read[:_LONGEST_LIST], caveats=caveats)


@dataclass(frozen=True, slots=True)
class _Columns:
    """Rows of a table and the meaning of its columns."""

    path: Path
    line: int
    labels: Sequence[str]
    rows: Sequence[NumberedCells]
    decimal_sign: str
    headings: Sequence[ColumnHeading | None]

    @property
    def pair(self) -> tuple[str, str] | None:
        """First pair of parts of an impedance."""
        return pair_of(frozenset(heading.symbol for heading in self.headings if heading))

    def places(self, symbol: str) -> list[int]:
        """Columns of a quantity."""
        return [at for at, heading in enumerate(self.headings) if heading and heading.symbol == symbol]

    def symbol(self, place: int) -> str:
        """Quantity of a column; empty where it is not known."""
        heading = self.headings[place]
        return heading.symbol if heading else ""

    def complex_place(self) -> int | None:
        """First column of an impedance, admittance or reflection whose cells are complex numbers."""
        for symbol in COMPLEX_PARTS:
            for place in self.places(symbol):
                cells = [row[place].strip() for _, row in self.rows[:_LOOKED_AT] if place < len(row)]
                if any(_complex_number(cell, self.decimal_sign) is not None for cell in cells):
                    return place
        return None

    def complex_values(self, place: int) -> Complexes:
        """Complex numbers of a column in SI."""
        heading = self.headings[place]
        numbers = [self._complex_cell(row, place) for row in self.rows]
        return (heading.scale if heading else 1.0) * np.array(numbers, dtype=np.complex128)

    def values(self, symbol: str) -> Floats:
        """Numbers of a quantity in SI; refuse several columns of it that differ."""
        found = {place: self._in_si(place) for place in self.places(symbol)}
        first, *others = found.values()
        if not all(np.allclose(first, other, rtol=_SAME, atol=0.0) for other in others):
            numbers = " and ".join(str(place + 1) for place in found)
            raise InvalidInput(
                f"{self.path}: line {self.line}: columns {numbers} are all of {symbol} and differ; keep one of them"
            )
        return first

    def with_phase_by_values(self) -> "tuple[_Columns, tuple[str, ...]]":
        """Table with a phase without unit in degrees where its numbers exceed a full turn in radians.

        `caveats`: One where it was taken so. Refuses a phase whose numbers may be either.
        """
        place = next((at for at, label in enumerate(self.labels) if is_phase_without_unit(label)), None)
        if place is None or not any(self.places(symbol) for symbol in COMPLEX_PARTS):
            return self, ()
        label = self.labels[place].strip()[:_QUOTED]
        largest = float(np.max(np.abs(self._numbers(place))))
        if not largest > _FULL_TURN:
            raise InvalidInput(
                f"{self.path}: line {self.line}: {label!r} needs a unit, 'phase (deg)' or '(rad)': its numbers of up to"
                f" {largest:.4g} may be either"
            )
        heading = ColumnHeading(phase_symbol(label), math.pi / 180)
        headings = [heading if at == place else each for at, each in enumerate(self.headings)]
        caveat = f"{label!r} states no unit and was read in degrees, since its numbers reach {largest:.4g}"
        return replace(self, headings=headings), (caveat,)

    def _in_si(self, place: int) -> Floats:
        """Numbers of one column in SI."""
        heading = self.headings[place]
        numbers = self._numbers(place)
        with np.errstate(all="ignore"):
            return np.asarray(heading.in_si(numbers) if heading else numbers)

    def _numbers(self, place: int) -> Floats:
        """Numbers of one column as written."""
        return finite_numbers(self.rows, place, decimal_sign=self.decimal_sign, path=self.path)

    def _complex_cell(self, row: NumberedCells, place: int) -> complex:
        """Complex number in one cell of a row."""
        line, cell = cell_of_row(row, place, self.path)
        value = _complex_number(cell.strip(), self.decimal_sign)
        if value is None or not abs(value) < _LARGEST:
            raise InvalidInput(f"{self.path}: line {line}: {cell.strip()[:_QUOTED]!r} is not a complex number")
        return value


def _complex_number(cell: str, decimal_sign: str) -> complex | None:
    """Complex number in a cell, as its parts or as magnitude and angle in degrees; None where it holds none."""
    if found := _COMPLEX.fullmatch(cell):
        parts = (found["re"].replace(" ", ""), found["im"] or found["im_before"])
        first, second = (parse_number(part, decimal_sign=decimal_sign) for part in parts)
        return None if first is None or second is None else complex(first, -second if found["sign"] == "-" else second)
    if found := _POLAR.fullmatch(cell):
        first, second = (parse_number(found[key].replace(" ", ""), decimal_sign=decimal_sign) for key in ("abs", "deg"))
        return None if first is None or second is None else first * complex(np.exp(1j * math.radians(second)))
    return None
