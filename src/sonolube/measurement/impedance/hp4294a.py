"""Impedance as an HP, Agilent or Keysight 4294A saves it: two traces of text, one after the other."""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.impedance.column_headings import impedance_from_parts
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.numeric_text import parse_number

HP_4294A = "HP 4294A"
MAGIC = "4294A"

_PARTS = {
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
    begins: int
    lines: list[int]
    rows: Floats


def read_hp4294a(path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
    """Return the sweeps of a 4294A: "data", and "memory" where the file has its traces.

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
        Naming the file and the line, if it was not swept over frequency, the traces are neither impedance nor
        admittance, differ in frequency, are cut short or hold something else than numbers.

    Notes
    -----
    The real part of trace A is the first part of the parameter measured, that of trace B the second. The memory trace
    often holds what the instrument computed from the circuit it fitted.
    """
    header, traces = _header_and_traces(path, lines)
    parameter, at = header.get("MEASURE PARAMETER", ("", 1))
    if parameter not in _PARTS:
        raise InvalidInput(f"{path}: line {at}: measures {parameter[:40]!r}; known: {', '.join(_PARTS)}")
    axis, at = header.get("SWEEP TYPE", ("", 1))
    if "FREQ" not in axis:
        raise InvalidInput(f"{path}: line {at}: sweeps {axis[:40]!r}, not frequency")
    if len(traces) != 2:
        raise InvalidInput(f"{path}: line {len(lines)}: holds {len(traces)} traces where A and B are wanted")
    first, second = traces
    _require_whole(path, header.get("NUMBER of POINTS"), traces)
    if not np.array_equal(first.rows[:, 0], second.rows[:, 0]):
        raise InvalidInput(f"{path}: line {second.begins}: trace B has other frequencies than trace A")
    one, two, scale = _PARTS[parameter]
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
    return header, [_trace(path, begins, rows) for begins, rows in blocks]


def _row(path: Path, at: int, text: str) -> list[float]:
    values = [parse_number(cell, decimal_sign=".") for cell in text.split("\t")]
    known = [value for value in values if value is not None and np.isfinite(value)]
    if len(known) != len(values) or len(known) not in (3, 5):
        raise InvalidInput(f"{path}: line {at}: must hold 3 or 5 numbers between tabs, got {text[:40]!r}")
    return known


def _trace(path: Path, begins: int, rows: list[tuple[int, list[float]]]) -> _Trace:
    if not rows:
        raise InvalidInput(f"{path}: line {begins}: no values follow")
    for at, row in rows:
        if len(row) != len(rows[0][1]):
            raise InvalidInput(
                f"{path}: line {at}: has {len(row)} numbers where the trace began with {len(rows[0][1])}"
            )
    return _Trace(begins, [at for at, _ in rows], np.array([row for _, row in rows]))


def _require_whole(path: Path, announced: tuple[str, int] | None, traces: list[_Trace]) -> None:
    points = announced[0] if announced else ""
    for trace in traces:
        if points.isdecimal() and str(len(trace.lines)) != points:
            last = trace.lines[-1]
            raise InvalidInput(f"{path}: line {last}: the trace ends after {len(trace.lines)} of {points[:12]} points")
        if len(trace.lines) != len(traces[0].lines):
            raise InvalidInput(f"{path}: line {trace.lines[-1]}: the traces differ in length")
