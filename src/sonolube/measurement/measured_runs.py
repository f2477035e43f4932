"""Reader of measured runs from CSV: one row a run, one column a quantity with its unit; the list of the columns."""

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.input_files import open_input
from sonolube.measurement.file_format import refuse_unreadable
from sonolube.units import to_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_HEADING = re.compile(r"(\w+)\s*(?:\[([^\]]*)\])?")
_LARGEST = 1e30  # in any unit; keeps squares of quantities within the range of floats
_MOST_RUNS = 100_000
_QUOTED = 40  # characters of a cell in an error message
_MOST_LINES = 6  # named in a caveat
_VIBRATIONS = ("vibration_amplitude", "voltage_peak_to_peak", "vibration_velocity")

Columns = dict[str, Floats]


@dataclass(frozen=True, kw_only=True, slots=True)
class RunColumn:
    """Column of a table of runs.

    Parameters
    ----------
    name : str
        Quantity of the vocabulary, or the name of a text.
    unit : str
        Unit as usually written in the heading; any unit of the same kind is read. Empty for pure numbers and texts.
    meaning : str
    needed : str
        When it is needed, and what stands for it otherwise.
    is_text : bool
        Whether the cells are free text.
    is_result : bool
        Whether it is measured, not set.
    """

    name: str
    unit: str
    meaning: str
    needed: str
    is_text: bool = False
    is_result: bool = False

    @property
    def heading(self) -> str:
        """Name with the unit in brackets, as at the head of the column."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def _setting(name: str, unit: str, meaning: str, needed: str) -> RunColumn:
    """Column of a quantity that is set."""
    return RunColumn(name=name, unit=unit, meaning=meaning, needed=needed)


def _result(name: str, unit: str, meaning: str, needed: str) -> RunColumn:
    """Column of a quantity that is measured."""
    return RunColumn(name=name, unit=unit, meaning=meaning, needed=needed, is_result=True)


def _text(name: str, meaning: str, needed: str = "never") -> RunColumn:
    """Column of free text."""
    return RunColumn(name=name, unit="", meaning=meaning, needed=needed, is_text=True)


_RIGS: Final = "where it is not the rig's, and without a rig file"
RUN_COLUMNS: Final = (
    _text("run", "Name of the run", "where equal rows are runs of their own; without it they count as copies"),
    _text("block", "Runs made in one go: a day, a mounting, a pair of specimens"),
    _setting("vibration_amplitude", "um", "Amplitude of the vibration, zero to peak", _RIGS),
    _setting("voltage_peak_to_peak", "V", "Voltage of the drive, peak to peak", "instead of the amplitude, with a rig"),
    _setting("vibration_velocity", "m/s", "Peak velocity of the vibration", "instead of amplitude and frequency"),
    _setting("vibration_direction", "deg", "Angle between vibration and sliding", "for vibration in the contact plane"),
    _setting("frequency", "kHz", "Frequency of the vibration", _RIGS),
    _setting("sliding_speed", "mm/s", "Sliding speed", _RIGS),
    _setting("normal_load", "N", "Force pressing the bodies together", _RIGS),
    _setting("nominal_area", "mm2", "Nominal contact area", "for efficiency, where it is not the rig's"),
    _setting("nominal_pressure", "MPa", "Load over nominal area", "on maps over stress"),
    _setting("lowest_speed", "mm/s", "Lowest sliding speed", "in the literature, where a range is stated"),
    _result("friction_force", "N", "Friction with vibration", "with intrinsic_friction_force, or a ratio or reduction"),
    _result("intrinsic_friction_force", "N", "Friction without vibration", "with friction_force"),
    _result("friction_ratio", "", "Friction with vibration over that without", "where no forces are stated"),
    _result("friction_reduction", "%", "One minus the friction ratio", "where no forces are stated"),
    _result("friction_force_uncertainty", "N", "Standard uncertainty of friction_force", "without repeats"),
    _result("intrinsic_friction_force_uncertainty", "N", "That of intrinsic_friction_force", "without repeats"),
    _result("friction_reduction_uncertainty", "%", "That of reduction or ratio", "without repeats"),
    _result("wear_rate", "mm3/m", "Wear volume per sliding distance", "for wear, with intrinsic_wear_rate"),
    _result("intrinsic_wear_rate", "mm3/m", "The same without vibration", "for wear, with wear_rate"),
    _result("wear_rate_ratio", "", "Wear rate with vibration over that without", "for wear"),
    _result("wear_reduction", "%", "One minus the ratio of the wear rates", "for wear"),
    _result("actuator_power", "W", "Power drawn by the actuator", "for efficiency, and on maps over power"),
    _result("temperature", "degC", "Temperature of the specimen", "never"),
    _text("study", "Authors", "in the literature"),
    _text("direction", "longitudinal, transverse, in plane or perpendicular", "in the literature, where it is stated"),
    _text("source", "Document and table or page of the numbers", "in the literature"),
    _text("note", "Anything else"),
)
"""Columns that a table of runs may have; further quantities of the vocabulary are read, and empty cells are allowed."""

_TEXTS = tuple(column.name for column in RUN_COLUMNS if column.is_text)
_BY_NAME = {column.name: column for column in RUN_COLUMNS}
FRICTION_COLUMNS: Final = (
    f"{_BY_NAME['friction_reduction'].heading}, or friction_ratio, or {_BY_NAME['friction_force'].heading} and"
    f" {_BY_NAME['intrinsic_friction_force'].heading}"
)
"""Columns of which one set gives the friction of a run, in words."""


def heading(name: str) -> str:
    """Return the heading of a column of `RUN_COLUMNS`, its usual unit in brackets."""
    return _BY_NAME[name].heading


def runs_help(beginning: str) -> str:
    """Return a help text of an option that takes a table of runs: a beginning, then the columns.

    Parameters
    ----------
    beginning : str

    Returns
    -------
    str
    """
    settings = ", ".join(heading(name) for name in ("vibration_amplitude", "voltage_peak_to_peak", "sliding_speed"))
    return f"{beginning}: {FRICTION_COLUMNS}; {settings}, normal_load and others where they vary; cells may be empty."


def read_runs(path: str | Path) -> "xr.Dataset":
    """Measured runs from a CSV file whose header names quantities, such as `sliding_speed [mm/s]`.

    Parameters
    ----------
    path : str or Path
        With columns of `RUN_COLUMNS` or of the vocabulary, among them `friction_reduction`, `friction_ratio`, or
        `friction_force` and `intrinsic_friction_force`. An empty cell is not measured. Rows at an amplitude, velocity
        or voltage of 0 give the friction without vibration of the rows of the same speed and load that state none.

    Returns
    -------
    xarray.Dataset
        Over `run`, in SI, NaN where nothing was measured, with a friction reduction in every run, and the attribute
        `caveats`, a line each.

    Raises
    ------
    InvalidInput
        Naming the file, the column and the cell, if the table cannot be read or holds no friction.
    """
    path = Path(path)
    return runs_of_rows(path, _rows(path))


def runs_of_rows(path: Path, rows: Sequence[list[str]]) -> "xr.Dataset":
    """Measured runs from the rows of a table, its header first, as `read_runs`.

    Parameters
    ----------
    path : Path
        Of the table, for messages and title.
    rows : sequence of list of str

    Returns
    -------
    xarray.Dataset
    """
    import xarray as xr

    header, *rows = rows
    columns, texts = _read_columns(path, header, rows)
    columns, without = _with_references(columns)
    _derive_wear(columns)
    reduction = _friction_reductions(path, columns)
    columns["friction_reduction"] = reduction
    _derive_uncertainty(columns)
    known = np.isfinite(reduction)
    empty = ~known & ~without
    if not known.any():
        raise InvalidInput(f"{path}: no run has a result yet: fill in {FRICTION_COLUMNS}")
    data = {name: ("run", values[known]) for name, values in columns.items()}
    data |= {name: ("run", np.array(cells)[known]) for name, cells in texts.items()}
    caveats = [] if not empty.any() else [_skipped(empty)]
    return xr.Dataset(data, attrs={"title": f"{path.name}, in %", "caveats": "\n".join(caveats)})


def run_caveats(runs: "xr.Dataset") -> tuple[str, ...]:
    """Return the caveats of the reading of a table of runs, a line each."""
    return tuple(line for line in str(runs.attrs.get("caveats", "")).split("\n") if line)


def _read_columns(path: Path, header: list[str], rows: list[list[str]]) -> tuple[Columns, dict[str, list[str]]]:
    """Columns of quantities in SI and those of texts."""
    columns: Columns = {}
    texts: dict[str, list[str]] = {}
    for place, head in enumerate(header):
        found = _HEADING.fullmatch(head.strip())
        if not found or found[1] not in (*quantities(), *_TEXTS):
            remedy = "separate columns by commas" if ";" in head or "\t" in head else "such as sliding_speed [mm/s]"
            raise InvalidInput(f"{path}: column {_quoted(head)} must name a quantity; {remedy}")
        name, unit = found[1], found[2] or ""
        if name in columns or name in texts:
            raise InvalidInput(f"{path}: two columns are named {name}")
        if name in _TEXTS:
            texts[name] = [_cell(row, place) for row in rows]
            continue
        place_of_unit = f"{path}: line 2: {name}"
        numbers = np.array([_number(path, line, row, place, name) for line, row in enumerate(rows, 2)])
        first = numbers[0] if np.isfinite(numbers[0]) else 1.0
        known = (first, 0, 1)  # a wrong unit is told with the first value
        _, zero, one = (to_si(f"{at} {unit}", unit=quantities()[name].unit, name=place_of_unit) for at in known)
        columns[name] = zero + (one - zero) * numbers
    return columns, texts


def _with_references(columns: Columns) -> tuple[Columns, np.ndarray]:
    """Columns with the friction without vibration of rows at amplitude 0 in the others, and which rows these are.

    A row at amplitude 0 serves only those of its speed and load, and is no run of its own.
    """
    count = next(iter(columns.values())).size if columns else 0
    given = [columns[name] for name in _VIBRATIONS if name in columns]
    force = columns.get("friction_force", np.full(count, np.nan))
    without = np.zeros(count, bool)
    if given:
        without = np.all([(values == 0) | np.isnan(values) for values in given], axis=0)
        without &= np.any([values == 0 for values in given], axis=0) & np.isfinite(force)
    if not without.any():
        return columns, without
    settings = np.stack([columns.get(name, np.zeros(count)) for name in ("sliding_speed", "normal_load")], axis=1)
    intrinsic = columns.get("intrinsic_friction_force", np.full(count, np.nan)).copy()
    for row in np.flatnonzero(np.isnan(intrinsic) & ~without):
        same = without & np.all(np.isclose(settings, settings[row], rtol=1e-2, equal_nan=True), axis=1)
        if same.any():
            intrinsic[row] = np.mean(force[same])
    return columns | {
        "intrinsic_friction_force": intrinsic,
        "friction_force": np.where(without, np.nan, force),
    }, without


def _friction_reductions(path: Path, columns: Columns) -> Floats:
    """Friction reduction of each run, by the columns that give it; NaN where none does."""
    count = next(iter(columns.values())).size if columns else 0
    reduction = columns.get("friction_reduction", np.full(count, np.nan))
    reduction = np.where(np.isnan(reduction), 1 - columns.get("friction_ratio", np.full(count, np.nan)), reduction)
    forces = [columns.get(name) for name in ("friction_force", "intrinsic_friction_force")]
    force, without = forces
    if force is not None and without is not None:
        for line, each in enumerate(without, 2):
            if not (each > 0 or np.isnan(each)):
                raise InvalidInput(f"{path}: line {line}: intrinsic_friction_force must be positive, got {each:g} N")
        reduction = np.where(np.isnan(reduction), 1 - force / without, reduction)
    elif "friction_reduction" not in columns and "friction_ratio" not in columns:
        raise InvalidInput(f"{path}: needs a column {FRICTION_COLUMNS}")
    return reduction


def _derive_wear(columns: Columns) -> None:
    """Add the ratio of the wear rates where only the rates are stated."""
    if {"wear_rate", "intrinsic_wear_rate"} <= columns.keys() and not {"wear_rate_ratio", "wear_reduction"} & set(
        columns
    ):
        with np.errstate(divide="ignore", invalid="ignore"):
            columns["wear_rate_ratio"] = columns["wear_rate"] / columns["intrinsic_wear_rate"]


def _derive_uncertainty(columns: Columns) -> None:
    """Add the standard uncertainty of the reduction where only those of the forces are stated, independent."""
    names = ("friction_force", "intrinsic_friction_force", "friction_force_uncertainty")
    if "friction_reduction_uncertainty" in columns or not set(names) <= columns.keys():
        return
    force, without, deviation = (columns[name] for name in names)
    other = columns.get("intrinsic_friction_force_uncertainty", np.zeros(force.size))
    columns["friction_reduction_uncertainty"] = np.hypot(deviation, force / without * other) / without


def _skipped(empty: np.ndarray) -> str:
    """Caveat about the rows without a result."""
    lines = [str(line) for line in np.flatnonzero(empty) + 2]
    named = ", ".join(lines[:_MOST_LINES]) + (", ..." if len(lines) > _MOST_LINES else "")
    return f"{len(lines)} of {empty.size} runs have no friction yet and are left out (line {named})"


def _rows(path: Path) -> list[list[str]]:
    """Header and rows of a CSV file, empty rows left out, no row longer than the header."""
    try:
        with refuse_unreadable(path), open_input(path) as stream:
            text = io.TextIOWrapper(stream, encoding="utf-8-sig", newline="")
            rows = [row for row in csv.reader(text) if any(cell.strip() for cell in row)]
    except (UnicodeDecodeError, csv.Error):
        raise InvalidInput(f"{path}: not a table of comma-separated values") from None
    if len(rows) > _MOST_RUNS:
        raise InvalidInput(f"{path}: has {len(rows)} rows, but at most {_MOST_RUNS} runs are read")
    if len(rows) < 2:
        raise InvalidInput(f"{path}: needs a head and at least one run")
    for line, row in enumerate(rows[1:], 2):
        if len(row) > len(rows[0]):
            raise InvalidInput(f"{path}: line {line}: has {len(row)} cells where {len(rows[0])} columns are named")
    return rows


def _cell(row: list[str], place: int) -> str:
    """Text of a cell; empty where the row is shorter."""
    return row[place].strip() if place < len(row) else ""


def _number(path: Path, line: int, row: list[str], place: int, name: str) -> float:
    """Number in a cell of a row, in the unit of its column; NaN where it is empty."""
    cell = _cell(row, place)
    if not cell:
        return float("nan")
    try:
        number = float(cell)
    except ValueError:
        raise InvalidInput(f"{path}: line {line}: {name} {_quoted(cell)} is no number") from None
    if not abs(number) <= _LARGEST:
        raise InvalidInput(f"{path}: line {line}: {name} {_quoted(cell)} lies beyond any run")
    return number


def _quoted(cell: str) -> str:
    """Cell in quotation marks, shortened where it is long."""
    text = cell.strip()
    return repr(text if len(text) <= _QUOTED else text[:_QUOTED] + "...")
