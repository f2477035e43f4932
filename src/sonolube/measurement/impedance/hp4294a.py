"""Text files of the HP, Agilent or Keysight 4294A impedance analyser: two traces, one after the other."""

import re
from pathlib import Path
from typing import ClassVar, NamedTuple, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import first_lines
from sonolube.measurement.impedance.column_headings import impedance_from_parts
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.numeric_text import parse_number

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
                    sweeps[sweep] = ImpedanceSweep(
                        frequency=columns["f"],
                        impedance=impedance_from_parts(columns, (one, two)),
                        lines=np.array(first.lines),
                    )
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
