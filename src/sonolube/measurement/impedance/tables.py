"""Impedance in tables of text: Keysight E4990A, Zurich Instruments MFIA, and any table with named columns."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.column_headings import (
    IMPEDANCE_PARTS,
    ColumnHeading,
    impedance_from_parts,
    parse_heading,
)
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.numeric_text import parse_number

KEYSIGHT_E4990A = "Keysight E4990A"
MFIA = "Zurich Instruments MFIA"
COLUMNS = "table with named columns"

_COMMENT = ("#", "!", "%")
_MFIA_FIRST = 4  # cells before the values: chunk, timestamp, size, fieldname
_MFIA_PAIRS = (("realz", "imagz"), ("absz", "phasez"))

Row = tuple[int, list[str]]  # the line on which it stands, and its cells


def read_keysight_e4990a(path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
    """Return the sweeps of a trace file of a Keysight E4990A: "data", and "memory" where it was saved.

    Parameters
    ----------
    path : Path
        Of the file, for messages.
    lines : list of str
        Of the file.

    Returns
    -------
    dict of str to Points

    Raises
    ------
    InvalidInput
        Naming the file and the line, if the file ends early, its columns are no impedance or a cell is no number.
    """
    last = next((at for at, line in enumerate(lines) if line.strip() == "END"), None)
    if last is None:
        raise InvalidInput(f"{path}: line {len(lines)}: ends without END; was it cut off?")
    rows = [
        (at, line.split(","))
        for at, line in enumerate(lines[:last], start=1)
        if line.strip() and not line.startswith("!") and not line.startswith("BEGIN")
    ]
    at, labels = rows[0] if rows else (last + 1, [])
    kinds = [label.strip().rpartition("-") for label in labels]
    sweeps = {}
    for sweep, suffix in (("data", "data"), ("memory", "mem")):
        own = [_e4990a_heading(text, kind, suffix) for text, _, kind in kinds]
        if sweep == "data" or sum(part is not None for part in own) > 1:
            sweeps[sweep] = _points(path, at, own, rows[1:], decimal_sign=".")
    return sweeps


def _e4990a_heading(text: str, kind: str, suffix: str) -> ColumnHeading | None:
    if not text:  # the frequency's heading has no suffix
        return parse_heading(kind)
    return parse_heading(text) if kind.lower().startswith(suffix) else None


def read_mfia(path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
    """Return the sweeps that LabOne wrote for an MFIA or MFLI, by their chunk numbers.

    Parameters
    ----------
    path : Path
        Of the file, for messages.
    lines : list of str
        Of the file: one line a chunk and field, `chunk;timestamp;size;fieldname` and the values.

    Returns
    -------
    dict of str to Points
        Points that an unfinished sweep left open are not among them.

    Raises
    ------
    InvalidInput
        Naming the file and the line, if a value is no number, fields differ in length or a field is missing.
    """
    separator = ";" if ";" in lines[0] else ","
    chunks: dict[str, dict[str, tuple[int, Floats]]] = {}
    for at, line in enumerate(lines[1:], start=2):
        cells = [cell.strip() for cell in line.split(separator)]
        if not line.strip() or cells[0] == "chunk":
            continue
        if len(cells) < _MFIA_FIRST:
            raise InvalidInput(
                f"{path}: line {at}: has {len(cells)} cells where chunk, timestamp, size, fieldname begin"
            )
        field = cells[_MFIA_FIRST - 1]
        if field in ("frequency", "grid") or any(field in pair for pair in _MFIA_PAIRS):
            chunks.setdefault(cells[0], {})[field] = (at, _values(path, at, cells[_MFIA_FIRST:]))
    if not chunks:
        raise InvalidInput(f"{path}: line 1: announces fields, but none is a frequency or an impedance")
    return {chunk: _chunk_points(path, chunk, fields) for chunk, fields in chunks.items()}


def _chunk_points(path: Path, chunk: str, fields: dict[str, tuple[int, Floats]]) -> ImpedanceSweep:
    first = min(at for at, _ in fields.values())
    axis = next((name for name in ("frequency", "grid") if name in fields), None)
    pair = next((pair for pair in _MFIA_PAIRS if all(name in fields for name in pair)), None)
    if axis is None or pair is None:
        raise InvalidInput(
            f"{path}: line {first}: chunk {chunk[:20]!r} lacks frequency, realz and imagz (or absz, phasez)"
        )
    (_, f), (at, one), (_, two) = fields[axis], fields[pair[0]], fields[pair[1]]
    if not f.size == one.size == two.size:
        raise InvalidInput(
            f"{path}: line {at}: {pair[0]} has {one.size} values, {axis} {f.size} and {pair[1]} {two.size}"
        )
    measured = ~(np.isnan(f) | np.isnan(one) | np.isnan(two))
    if not measured.any():
        raise InvalidInput(f"{path}: line {at}: chunk {chunk[:20]!r} holds no finished point")
    parts = ("R", "X") if pair[0] == "realz" else ("|Z|", "theta_Z")
    columns = {"f": f[measured], parts[0]: one[measured], parts[1]: two[measured]}
    return ImpedanceSweep(
        frequency=columns["f"], impedance=impedance_from_parts(columns, parts), lines=np.full(int(measured.sum()), at)
    )


def read_columns(path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
    """Return the one sweep of a table whose first row names its columns.

    Parameters
    ----------
    path : Path
        Of the file, for messages.
    lines : list of str
        Of the file. Lines that begin with #, ! or % are passed over; cells stand between tabs, semicolons or commas.

    Returns
    -------
    dict of str to Points

    Raises
    ------
    InvalidInput
        Naming the file and the line, if the headings name no frequency and impedance, or a cell is no number.
    """
    told = [(at, line) for at, line in enumerate(lines, start=1) if line.strip() and not line.startswith(_COMMENT)]
    if not told:
        raise InvalidInput(f"{path}: line {len(lines)}: holds no row")
    separator = next((sign for sign in "\t;," if sign in told[0][1]), ",")
    rows = [(at, line.split(separator)) for at, line in told]
    at, labels = rows[0]
    decimal_sign = "," if separator != "," and any("," in cell for _, row in rows[1:9] for cell in row) else "."
    return {"": _points(path, at, [parse_heading(label) for label in labels], rows[1:], decimal_sign=decimal_sign)}


def _points(
    path: Path, heading_line: int, headings: list[ColumnHeading | None], rows: list[Row], *, decimal_sign: str
) -> ImpedanceSweep:
    place = {part.symbol: at for at, part in reversed(list(enumerate(headings))) if part}
    pair = next((pair for pair in IMPEDANCE_PARTS if all(part in place for part in pair)), None)
    if "f" not in place or pair is None:
        raise InvalidInput(
            f"{path}: line {heading_line}: names no columns of frequency and impedance, such as"
            " 'frequency (Hz)', '|Z| (ohm)', 'phase (deg)' or 'R (ohm)', 'X (ohm)'"
        )
    if not rows:
        raise InvalidInput(f"{path}: line {heading_line}: no values follow")
    columns = {}
    for symbol in ("f", *pair):
        values = np.array([_cell(path, row, place[symbol], decimal_sign) for row in rows])
        scale = next(part.scale for part in headings if part and part.symbol == symbol)
        with np.errstate(all="ignore"):
            columns[symbol] = scale * values
    return ImpedanceSweep(
        frequency=columns["f"],
        impedance=impedance_from_parts(columns, pair),
        lines=np.array([line for line, _ in rows]),
    )


def _cell(path: Path, row: Row, at: int, decimal_sign: str) -> float:
    line, cells = row
    if at >= len(cells):
        raise InvalidInput(f"{path}: line {line}: has {len(cells)} cells where column {at + 1} is wanted")
    value = parse_number(cells[at], decimal_sign=decimal_sign)
    if value is None or not np.isfinite(value):
        raise InvalidInput(f"{path}: line {line}: {cells[at].strip()[:40]!r} is not a finite number")
    return value


def _values(path: Path, line: int, cells: Iterable[str]) -> Floats:
    values = []
    for cell in cells:
        value = parse_number(cell, decimal_sign=".") if cell else float("nan")
        if value is None or np.isinf(value):
            raise InvalidInput(f"{path}: line {line}: {cell[:40]!r} is not a number")
        values.append(value)
    return np.array(values, dtype=np.float64)
