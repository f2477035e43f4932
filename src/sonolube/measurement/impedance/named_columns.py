"""Impedance in text tables whose first row names the columns, and the sweep that named columns define."""

from pathlib import Path
from typing import ClassVar, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.column_headings import (
    IMPEDANCE_PARTS,
    MAGNITUDES,
    ColumnHeading,
    impedance_from_parts,
    is_phase_without_unit,
    parse_heading,
)
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.limits import require_channels
from sonolube.measurement.numeric_text import parse_number

_COMMENTS = ("#", "!", "%")

NumberedCells = tuple[int, list[str]]  # line of a row, and its cells


@final
class NamedColumns:
    """Any text table whose first row names the columns, such as `frequency (kHz)`, `|Z| (ohm)`, `phase (deg)`.

    Notes
    -----
    Has no signature: the fallback for every text file.
    """

    name: ClassVar[str] = "table with named columns"
    suffixes: ClassVar[tuple[str, ...]] = (".csv", ".tsv", ".txt")

    def recognises(self, head: bytes, path: Path) -> bool:
        """True: any text may be a table."""
        return True

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        """One sweep of a table, under an empty name."""
        numbered = [(at, line) for at, line in enumerate(lines, 1) if line.strip() and not line.startswith(_COMMENTS)]
        if not numbered:
            raise InvalidInput(f"{path}: line {len(lines)}: holds no row")
        separator = next((sign for sign in "\t;," if sign in numbered[0][1]), ",")
        require_channels(numbered[0][1].count(separator) + 1, path, kind="columns")
        rows = [(at, line.split(separator)) for at, line in numbered]
        at, labels = rows[0]
        decimal_sign = "," if separator != "," and any("," in cell for _, row in rows[1:9] for cell in row) else "."
        headings = [parse_heading(label) for label in labels]
        _require_units_of_phases(path, at, labels, headings)
        return {"": sweep_from_columns(path, at, headings, rows[1:], decimal_sign=decimal_sign)}


def _require_units_of_phases(path: Path, line: int, labels: list[str], headings: list[ColumnHeading | None]) -> None:
    """Refuse a phase without unit where without it the table would define magnitudes only."""
    symbols = {heading.symbol for heading in headings if heading}
    complete = any({*pair} <= symbols for pair in IMPEDANCE_PARTS if pair not in MAGNITUDES)
    label = next((label for label in labels if is_phase_without_unit(label)), None)
    if label is not None and not complete:
        raise InvalidInput(f"{path}: line {line}: {label.strip()[:40]!r} needs a unit, 'phase (deg)' or '(rad)'")


def sweep_from_columns(
    path: Path, heading_line: int, headings: list[ColumnHeading | None], rows: list[NumberedCells], *, decimal_sign: str
) -> ImpedanceSweep:
    """Sweep of a table by the headings of its columns.

    Of the first pair of `IMPEDANCE_PARTS` that the table has: the magnitude alone only where there is nothing else.
    """
    known = {heading.symbol for heading in headings if heading}
    pair = next((pair for pair in IMPEDANCE_PARTS if all(part in known for part in pair)), None)
    if "f" not in known or pair is None:
        raise InvalidInput(
            f"{path}: line {heading_line}: names no columns of frequency and impedance, such as"
            " 'frequency (Hz)', '|Z| (ohm)', 'phase (deg)' or 'R (ohm)', 'X (ohm)'"
        )
    if not rows:
        raise InvalidInput(f"{path}: line {heading_line}: no values follow")
    columns = {}
    for symbol in ("f", *pair):
        several = {at: heading for at, heading in enumerate(headings) if heading and heading.symbol == symbol}
        found = {at: _column(path, rows, at, heading, decimal_sign) for at, heading in several.items()}
        columns[symbol], *others = found.values()
        if not all(np.array_equal(columns[symbol], other) for other in others):
            numbers = " and ".join(str(at + 1) for at in found)
            raise InvalidInput(
                f"{path}: line {heading_line}: columns {numbers} are all of {symbol} and differ; keep one of them"
            )
    return ImpedanceSweep(
        frequency=columns["f"],
        impedance=impedance_from_parts(columns, pair),
        lines=np.array([line for line, _ in rows]),
        has_phase=pair not in MAGNITUDES,
    )


def _column(path: Path, rows: list[NumberedCells], at: int, heading: ColumnHeading, decimal_sign: str) -> Floats:
    """Numbers of one column in SI."""
    values = np.array([_finite_number(path, row, at, decimal_sign) for row in rows])
    with np.errstate(all="ignore"):
        return np.asarray(heading.scale * values)


def _finite_number(path: Path, row: NumberedCells, at: int, decimal_sign: str) -> float:
    """Number in one cell of a row; refuse a missing cell and what is no finite number."""
    line, cells = row
    if at >= len(cells):
        raise InvalidInput(f"{path}: line {line}: has {len(cells)} cells where column {at + 1} is required")
    value = parse_number(cells[at], decimal_sign=decimal_sign)
    if value is None or not np.isfinite(value):
        raise InvalidInput(f"{path}: line {line}: {cells[at].strip()[:40]!r} is not a finite number")
    return value
