"""Trace files (CSV) of the Keysight E4990A impedance analyser."""

from pathlib import Path
from typing import ClassVar, final

from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import first_lines
from sonolube.measurement.impedance.column_headings import ColumnHeading, parse_heading
from sonolube.measurement.impedance.named_columns import sweep_from_columns
from sonolube.measurement.impedance.spectrum import ImpedanceSweep
from sonolube.measurement.limits import require_channels


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
            headings = [_heading(text, kind, suffix) for text, _, kind in split_labels]
            if sweep == "data" or sum(heading is not None for heading in headings) > 1:
                sweeps[sweep] = sweep_from_columns(path, at, headings, rows[1:], decimal_sign=".")
        return sweeps


def _heading(text: str, kind: str, suffix: str) -> ColumnHeading | None:
    """Heading of a column of one kind of trace, or of the frequency, whose label has no suffix."""
    if not text:
        return parse_heading(kind)
    return parse_heading(text) if kind.lower().startswith(suffix) else None
