"""Files of modes: lists that a command computed (TOML), or a table with a row to a mode (CSV)."""

import csv
import io
from pathlib import Path
from typing import Any

from pydantic import Field

from sonolube.errors import InvalidInput, suggestion
from sonolube.rig.file.section import Section
from sonolube.rig.file.structures import MODE_LISTS
from sonolube.rig.file.toml_file import prefixed, validated
from sonolube.text.toml_text import read_toml, text_of
from sonolube.text.units import convert

_UNITS = {"natural_frequency": "Hz", "damping_ratio": "", "drive_participation": "N/V", "contact_participation": ""}
_ORIGIN = {"command", "frequency_error", "assumptions"}


class ModesFile(Section):
    """A file of modes as `sonolube modes --contact` writes it."""

    command: str = Field(min_length=1, description="Command that computed the modes")
    frequency_error: float = Field(gt=0, lt=1, description="Estimated relative error of the natural frequencies")
    assumptions: list[str] = Field(default_factory=list, description="What was assumed, such as damping")
    natural_frequency: list[float]
    damping_ratio: list[float]
    drive_participation: list[float]
    contact_participation: list[float]
    clamped_capacitance: float


def read_modes(path: Path) -> dict[str, Any]:
    """Read the modes of a structure from a file.

    The four columns by name, as lists in SI; of a TOML file also `clamped_capacitance`, as it is written.
    """
    with prefixed(str(path)):
        if path.suffix == ".toml":
            content = read_toml(path, kind="a file of modes")
            validated(ModesFile, content)
            return {key: value for key, value in content.items() if key not in _ORIGIN}
        return _modes(text_of(path, kind="a file of modes"))


def _modes(text: str) -> dict[str, list[float]]:
    kept = "\n".join(line for line in text.splitlines() if line.strip() and not line.startswith("#"))
    try:
        heads, *rows = list(csv.reader(io.StringIO(kept))) or [[]]
    except csv.Error as failure:
        raise InvalidInput(f"not a table of comma-separated values: {failure}") from None
    columns = [_column(head) for head in heads]
    names = [known for known, _ in columns]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice:
        raise InvalidInput(f"two columns are named {twice}; keep one of them")
    missing = [name for name in MODE_LISTS if name not in names]
    if missing:
        raise InvalidInput(f"column {missing[0]} is missing; a file of modes has {', '.join(MODE_LISTS)}")
    if not rows:
        raise InvalidInput("has no modes below its headings")
    modes: dict[str, list[float]] = {name: [] for name in MODE_LISTS}
    for number, row in enumerate(rows, start=1):
        if len(row) != len(columns):
            raise InvalidInput(f"mode {number} has {len(row)} entries, its headings are {len(columns)}")
        for (name, unit), entry in zip(columns, row, strict=True):
            modes[name].append(_number(entry, unit, name, f"mode {number}"))
    return modes


def _column(head: str) -> tuple[str, str]:
    """Name of a column and the unit of its entries."""
    name, _, rest = head.strip().partition("[")
    name, unit = name.strip(), rest.strip().removesuffix("]").strip()
    if name not in MODE_LISTS:
        raise InvalidInput(f"unknown column {name!r}; {suggestion(name, MODE_LISTS)}".removesuffix("; "))
    if _UNITS[name] and not unit:
        raise InvalidInput(f"column {name} has no unit; write it like {name} [{_UNITS[name]}]")
    return name, unit


def _number(entry: str, unit: str, name: str, place: str) -> float:
    try:
        value = float(entry)
    except ValueError:
        raise InvalidInput(f"{place}: {name} {entry!r} is no number") from None
    return convert(value, from_unit=unit, to_unit=_UNITS[name]) if unit else value
