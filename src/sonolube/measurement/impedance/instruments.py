"""Files of impedance analysers: HP 4294A, Keysight E4990A, and Zurich Instruments MFIA."""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar, NamedTuple, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.headings import parse_heading
from sonolube.measurement.impedance.named_columns import stated_reference, sweep_from_columns
from sonolube.measurement.impedance.parts import sweep_of_parts
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.measured_files import first_lines, parse_number, require_channels, require_points

_SIGNATURE = "4294A"

_PARAMETERS = {  # parts of trace A and trace B, and the SI value of the unit of trace B
    "IMPEDANCE MAG PHASE (DEG)": ("|Z|", "theta_Z", np.pi / 180),
    "IMPEDANCE MAG PHASE (RAD)": ("|Z|", "theta_Z", 1.0),
    "IMPEDANCE REAL IMAG": ("R", "X", 1.0),
    "ADMITTANCE MAG PHASE (DEG)": ("|Y|", "theta_Y", np.pi / 180),
    "ADMITTANCE MAG PHASE (RAD)": ("|Y|", "theta_Y", 1.0),
    "ADMITTANCE REAL IMAG": ("G", "B", 1.0),
}
_ENTRY = re.compile(r'"([^":]+):\s*([^"]*)"')
_SWEEPS = {"data": 1, "memory": 3}  # columns of their real parts


class _Trace(NamedTuple):
    """One trace: line of its heading, lines of its rows, and their numbers."""

    heading_line: int
    lines: list[int]
    rows: Floats


@final
class Hp4294A:
    """Text files of the HP, Agilent or Keysight 4294A impedance analyser."""

    name: ClassVar[str] = "HP 4294A"
    suffixes: ClassVar[tuple[str, ...]] = ()

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the first line begins with the name of the instrument."""
        return first_lines(head)[0].startswith(_SIGNATURE)

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        """Sweep "data", and "memory" where the file has its traces.

        The real part of trace A is the first part of the measured parameter, that of trace B the second. The memory
        trace often holds the response that the instrument computed from a fitted circuit.
        """
        header, traces = _header_and_traces(path, lines)
        parameter, at = header.get("MEASURE PARAMETER", ("", 1))
        if parameter not in _PARAMETERS:
            raise InvalidInput(f"{path}: line {at}: measures {parameter[:40]!r}; known: {', '.join(_PARAMETERS)}")
        axis, at = header.get("SWEEP TYPE", ("", 1))
        if "FREQ" not in axis:
            raise InvalidInput(f"{path}: line {at}: sweeps {axis[:40]!r}, not frequency")
        if len(traces) != 2:
            raise InvalidInput(f"{path}: line {len(lines)}: holds {len(traces)} traces where A and B are required")
        first, second = traces
        _require_complete(path, header.get("NUMBER of POINTS"), traces)
        if not np.array_equal(first.rows[:, 0], second.rows[:, 0]):
            raise InvalidInput(f"{path}: line {second.heading_line}: trace B has other frequencies than trace A")
        one, two, scale = _PARAMETERS[parameter]
        sweeps = {}
        for sweep, column in _SWEEPS.items():
            if column < min(first.rows.shape[1], second.rows.shape[1]):
                with np.errstate(all="ignore"):
                    columns = {"f": first.rows[:, 0], one: first.rows[:, column], two: scale * second.rows[:, column]}
                if sweep == "data" or np.any(columns[one] != 0):
                    sweeps[sweep] = sweep_of_parts(columns, (one, two), lines=np.array(first.lines))
        return sweeps


def _header_and_traces(path: Path, lines: list[str]) -> tuple[dict[str, tuple[str, int]], list[_Trace]]:
    """Entries of the header, each with its line, and the traces."""
    header: dict[str, tuple[str, int]] = {}
    blocks: list[tuple[int, list[tuple[int, list[float]]]]] = []
    for at, line in enumerate(lines[1:], start=2):
        text = line.strip()
        if text.startswith('"'):
            if text.startswith('"Frequency"'):
                blocks.append((at, []))
            elif found := _ENTRY.match(text):
                header[found[1]] = (found[2].strip(), at)
        elif text:
            if not blocks:
                raise InvalidInput(f"{path}: line {at}: values before any heading of columns")
            blocks[-1][1].append((at, _row(path, at, text)))
    return header, [_trace(path, heading_line, rows) for heading_line, rows in blocks]


def _row(path: Path, at: int, text: str) -> list[float]:
    """Numbers of a row: frequency, and real and imaginary part of data and perhaps memory."""
    values = [parse_number(cell, decimal_sign=".") for cell in text.split("\t")]
    known = [value for value in values if value is not None and np.isfinite(value)]
    if len(known) != len(values) or len(known) not in (3, 5):
        raise InvalidInput(f"{path}: line {at}: must hold 3 or 5 numbers between tabs, got {text[:40]!r}")
    return known


def _trace(path: Path, heading_line: int, rows: list[tuple[int, list[float]]]) -> _Trace:
    """Rows of a trace as one array; refuse none, and rows of different lengths."""
    if not rows:
        raise InvalidInput(f"{path}: line {heading_line}: no values follow")
    for at, row in rows:
        if len(row) != len(rows[0][1]):
            raise InvalidInput(f"{path}: line {at}: has {len(row)} numbers; the trace began with {len(rows[0][1])}")
    return _Trace(heading_line, [at for at, _ in rows], np.array([row for _, row in rows]))


def _require_complete(path: Path, announced: tuple[str, int] | None, traces: list[_Trace]) -> None:
    """Refuse traces with fewer points than the header announces, or of different lengths."""
    points = announced[0] if announced else ""
    for trace in traces:
        if points.isdecimal() and str(len(trace.lines)) != points:
            last = trace.lines[-1]
            raise InvalidInput(f"{path}: line {last}: the trace ends after {len(trace.lines)} of {points[:12]} points")
        if len(trace.lines) != len(traces[0].lines):
            raise InvalidInput(f"{path}: line {trace.lines[-1]}: the traces differ in length")


@final
class KeysightE4990A:
    """Trace files (CSV) of the Keysight E4990A impedance analyser."""

    name: ClassVar[str] = "Keysight E4990A"
    suffixes: ClassVar[tuple[str, ...]] = ()

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the file begins with comments that name the instrument."""
        lines = first_lines(head)
        return lines[0].startswith("!") and any("E4990A" in line for line in lines[:4])

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        """Sweep "data", and "memory" where it was saved."""
        last = next((at for at, line in enumerate(lines) if line.strip() == "END"), None)
        if last is None:
            raise InvalidInput(f"{path}: line {len(lines)}: ends without END; was it cut off?")
        rows = [
            (at, line.split(","))
            for at, line in enumerate(lines[:last], start=1)
            if line.strip() and not line.startswith("!") and not line.startswith("BEGIN")
        ]
        at, labels = rows[0] if rows else (last + 1, [])
        require_channels(len(labels), path, kind="columns")
        split_labels = [label.strip().rpartition("-") for label in labels]
        sweeps = {}
        for sweep, suffix in (("data", "data"), ("memory", "mem")):
            own = [_trace_label(text, kind, suffix) for text, _, kind in split_labels]
            of_kind = [label for label, (text, _, _) in zip(own, split_labels, strict=True) if text]
            if sweep == "data" or any(parse_heading(label) for label in of_kind):
                reference = stated_reference(lines[:at])
                sweeps[sweep] = sweep_from_columns(path, at, own, rows[1:], decimal_sign=".", reference=reference)
        return sweeps


def _trace_label(text: str, kind: str, suffix: str) -> str:
    """Heading of a column of one kind of trace, or of the frequency, whose label has no suffix; empty for another."""
    if not text:
        return kind
    return text if kind.lower().startswith(suffix) else ""


_LEADING_CELLS = 4  # cells before the values: chunk, timestamp, size, fieldname
_FREQUENCY_FIELDS = ("frequency", "grid")
_IMPEDANCE_FIELDS = {
    ("realz", "imagz"): ("R", "X"),
    ("absz", "phasez"): ("|Z|", "theta_Z"),
    ("absz", "absz"): ("|Z|", "|Z|"),
}


@final
class Mfia:
    """Sweeps (CSV) that LabOne writes for the Zurich Instruments MFIA and MFLI, one line per chunk and field."""

    name: ClassVar[str] = "Zurich Instruments MFIA"
    suffixes: ClassVar[tuple[str, ...]] = ()

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the first line names the columns chunk and fieldname."""
        cells = [cell.strip() for cell in first_lines(head)[0].replace(",", ";").lower().split(";")]
        return cells[0] == "chunk" and "fieldname" in cells

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        """Sweeps by their chunk numbers.

        Without the points that an unfinished sweep left empty.
        """
        separator = ";" if ";" in lines[0] else ","
        chunks: dict[str, dict[str, tuple[int, Floats]]] = {}
        for at, line in enumerate(lines[1:], start=2):
            require_points(line.count(separator), path, line=at)
            cells = [cell.strip() for cell in line.split(separator)]
            if not line.strip() or cells[0] == "chunk":
                continue
            if len(cells) < _LEADING_CELLS:
                raise InvalidInput(f"{path}: line {at}: has {len(cells)} cells, not chunk, timestamp, size, fieldname")
            field = cells[_LEADING_CELLS - 1]
            if field in _FREQUENCY_FIELDS or any(field in pair for pair in _IMPEDANCE_FIELDS):
                fields = chunks.setdefault(cells[0], {})
                if field in fields:
                    raise InvalidInput(
                        f"{path}: line {at}: chunk {cells[0][:20]!r} has {field} a second time, after line"
                        f" {fields[field][0]}; keep one of them"
                    )
                fields[field] = (at, _values(path, at, cells[_LEADING_CELLS:]))
        if not chunks:
            raise InvalidInput(f"{path}: line 1: announces fields, but none is a frequency or an impedance")
        return {chunk: _chunk_sweep(path, chunk, fields) for chunk, fields in chunks.items()}


def _chunk_sweep(path: Path, chunk: str, fields: dict[str, tuple[int, Floats]]) -> ImpedanceSweep:
    """Finished points of one chunk."""
    first = min(at for at, _ in fields.values())
    axis = next((name for name in _FREQUENCY_FIELDS if name in fields), None)
    pair = next((pair for pair in _IMPEDANCE_FIELDS if all(name in fields for name in pair)), None)
    if axis is None or pair is None:
        raise InvalidInput(f"{path}: line {first}: chunk {chunk[:20]!r} lacks frequency, realz, imagz or absz, phasez")
    (_, f), (at, one), (_, two) = fields[axis], fields[pair[0]], fields[pair[1]]
    if not f.size == one.size == two.size:
        raise InvalidInput(
            f"{path}: line {at}: {pair[0]} has {one.size} values, {axis} {f.size} and {pair[1]} {two.size}"
        )
    measured = ~(np.isnan(f) | np.isnan(one) | np.isnan(two))
    if not measured.any():
        raise InvalidInput(f"{path}: line {at}: chunk {chunk[:20]!r} holds no finished point")
    parts = _IMPEDANCE_FIELDS[pair]
    columns = {"f": f[measured], parts[0]: one[measured], parts[1]: two[measured]}
    return sweep_of_parts(columns, parts, lines=np.full(int(measured.sum()), at))


def _values(path: Path, line: int, cells: Iterable[str]) -> Floats:
    """Numbers of one line; NaN for empty cells."""
    values = []
    for cell in cells:
        value = parse_number(cell, decimal_sign=".") if cell else float("nan")
        if value is None or np.isinf(value):
            raise InvalidInput(f"{path}: line {line}: {cell[:40]!r} is not a number")
        values.append(value)
    return np.array(values, dtype=np.float64)
