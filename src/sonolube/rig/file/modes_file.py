"""Files of modes beside a rig's: lists that a command computed (TOML), or a table with a row to a mode (CSV)."""

import csv
import io
from collections.abc import Mapping, Sequence
from math import isfinite, sqrt
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pydantic import Field

from sonolube.errors import InvalidInput, suggestion
from sonolube.rig.file.section import Section
from sonolube.rig.file.structures import MODE_LISTS
from sonolube.rig.file.toml_file import prefixed, validated
from sonolube.text.toml_text import read_toml, text_of
from sonolube.text.units import convert

MODE_COLUMNS: Mapping[str, str] = MappingProxyType(
    {
        "natural_frequency": "Hz",
        "damping_ratio": "",
        "quality_factor": "",
        "drive_participation": "N/V",
        "port_participation": "",
        "contact_participation": "",
        "modal_mass": "kg",
    }
)
"""Columns of a table of modes with their SI units."""

_INSTEAD = {"damping_ratio": "quality_factor", "drive_participation": "port_participation"}
_ORIGIN = {"command", "frequency_error", "assumptions"}


class ModesFile(Section):
    """A file of modes as `sonolube modes --contact` and `sonolube modes --from` write it, or as it is typed."""

    command: str | None = Field(default=None, min_length=1, description="Command that computed the modes")
    frequency_error: float | None = Field(
        default=None, gt=0, lt=1, description="Estimated relative error of the natural frequencies"
    )
    assumptions: list[str] = Field(default_factory=list, description="What was assumed, such as damping")
    natural_frequency: list[float]
    damping_ratio: list[float] | None = None
    quality_factor: list[float] | None = None
    drive_participation: list[float] | None = None
    port_participation: list[float] | None = None
    contact_participation: list[float]
    modal_mass: list[float] | None = None
    clamped_capacitance: float | None = None


def read_modes(path: Path, *, force_per_volt: float | None = None) -> dict[str, Any]:
    """Read the modes of a structure from a file.

    The four columns of `MODE_LISTS` by name, as lists in SI for modal masses of 1 kg; of a TOML file also
    `clamped_capacitance`, as it is written. A quality factor Q becomes the damping ratio 1/2Q, a participation of
    shapes of the modal mass m is divided by the root of m, and an elongation of the stack (`port_participation`) is
    multiplied by the blocked force per volt.
    """
    with prefixed(str(path)):
        if path.suffix == ".toml":
            content = read_toml(path, kind="a file of modes")
            validated(ModesFile, content)
            kept = {key: value for key, value in content.items() if key not in _ORIGIN}
            columns = {key: [float(each) for each in value] for key, value in kept.items() if key in MODE_COLUMNS}
            return kept_apart(kept) | _complete(columns, force_per_volt)
        return _complete(_modes(text_of(path, kind="a file of modes")), force_per_volt)


def kept_apart(content: Mapping[str, Any]) -> dict[str, Any]:
    """Entries of a file of modes that are no columns."""
    return {key: value for key, value in content.items() if key not in MODE_COLUMNS}


def _complete(columns: Mapping[str, Sequence[float]], force_per_volt: float | None) -> dict[str, Any]:
    """The four lists for modal masses of 1 kg."""
    _require_columns(columns)
    found = {name: list(columns[name]) for name in MODE_LISTS if name in columns}
    if "quality_factor" in columns:
        found["damping_ratio"] = [0.5 / each for each in _positive(columns, "quality_factor")]
    if "port_participation" in columns:
        if force_per_volt is None:
            raise InvalidInput(
                "port_participation needs the blocked force per volt: sonolube modes --from with --force-per-volt"
                " writes the modes for a rig"
            )
        found["drive_participation"] = [force_per_volt * each for each in columns["port_participation"]]
    elif force_per_volt is not None:
        raise InvalidInput("has drive_participation, with the blocked force in it; leave out force_per_volt")
    if "modal_mass" in columns:
        masses = _positive(columns, "modal_mass")
        for name in ("drive_participation", "contact_participation"):
            found[name] = [each / sqrt(mass) for each, mass in zip(found[name], masses, strict=True)]
    return {name: found[name] for name in MODE_LISTS}


def _require_columns(columns: Mapping[str, Sequence[float]]) -> None:
    """Refuse a table in which a column is missing, stated in two ways, of another length, or not finite."""
    for name in MODE_LISTS:
        other = _INSTEAD.get(name, "")
        if name not in columns and other not in columns:
            raise InvalidInput(f"column {name} is missing; a file of modes has {', '.join(MODE_LISTS)}")
        if name in columns and other in columns:
            raise InvalidInput(f"has both {name} and {other}; keep one of them")
    for name, values in columns.items():  # TOML may have lists of any length
        if len(values) != len(columns["natural_frequency"]):
            count = len(columns["natural_frequency"])
            raise InvalidInput(f"{name} has {len(values)} entries, natural_frequency {count}")
        if not all(map(isfinite, values)):
            raise InvalidInput(f"{name} must be finite")
    if min(columns["natural_frequency"], default=0.0) < 0:
        raise InvalidInput("natural_frequency must not be negative; 0 is a rigid motion")


def _positive(columns: Mapping[str, Sequence[float]], name: str) -> Sequence[float]:
    """Entries of a column, refused where one is not positive."""
    for number, each in enumerate(columns[name], start=1):
        if not each > 0:
            raise InvalidInput(f"mode {number}: {name} must be positive, got {each:g}")
    return columns[name]


def _modes(text: str) -> dict[str, list[float]]:
    """Columns of a table of comma-separated values, in SI."""
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
    _require_columns(dict.fromkeys(names, ()))
    if not rows:
        raise InvalidInput("has no modes below its headings")
    modes: dict[str, list[float]] = {name: [] for name in names}
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
    if name not in MODE_COLUMNS:
        raise InvalidInput(f"unknown column {name!r}; {suggestion(name, MODE_COLUMNS)}".removesuffix("; "))
    if MODE_COLUMNS[name] and not unit:
        raise InvalidInput(f"column {name} has no unit; write it like {name} [{MODE_COLUMNS[name]}]")
    return name, unit


def _number(entry: str, unit: str, name: str, place: str) -> float:
    """Number of a cell in SI."""
    try:
        value = float(entry)
    except ValueError:
        raise InvalidInput(f"{place}: {name} {entry!r} is no number") from None
    return convert(value, from_unit=unit, to_unit=MODE_COLUMNS[name]) if unit else value
