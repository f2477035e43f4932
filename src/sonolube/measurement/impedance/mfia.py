"""Sweeps (CSV) that LabOne writes for the Zurich Instruments MFIA and MFLI."""

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import first_lines
from sonolube.measurement.impedance.column_headings import MAGNITUDES, impedance_from_parts
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.limits import require_points
from sonolube.measurement.numeric_text import parse_number

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
    return ImpedanceSweep(
        frequency=columns["f"],
        impedance=impedance_from_parts(columns, parts),
        lines=np.full(int(measured.sum()), at),
        has_phase=parts not in MAGNITUDES,
    )


def _values(path: Path, line: int, cells: Iterable[str]) -> Floats:
    """Numbers of one line; NaN for empty cells."""
    values = []
    for cell in cells:
        value = parse_number(cell, decimal_sign=".") if cell else float("nan")
        if value is None or np.isinf(value):
            raise InvalidInput(f"{path}: line {line}: {cell[:40]!r} is not a number")
        values.append(value)
    return np.array(values, dtype=np.float64)
