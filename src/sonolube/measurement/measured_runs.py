"""Measured runs by their tables, as estimates need them.

Friction follows from the columns that give it, in SI, with what was left out; ratios are possible ones, settings of the
rig are filled in, and copies are reported.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping, read_mapping
from sonolube.measurement.recordings.raw_table import si_conversion
from sonolube.measurement.run_columns import DIRECTION_COLUMN, FRICTION_COLUMNS, TEXT_NAMES, heading
from sonolube.measurement.run_table import RunTable, assigned_columns, left_out_caveat, run_table
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_MAX_LINES = 6  # named in a caveat
_VIBRATIONS = ("vibration_amplitude", "voltage_peak_to_peak", "vibration_velocity")
_FRICTIONS = ("friction_force", "friction_coefficient")  # each with that without vibration, named intrinsic_...


def read_runs(path: str | Path, *, mapping: RecordingMapping | Path | None = None) -> "xr.Dataset":
    """Measured runs from a text file whose headings name quantities, such as `sliding_speed [mm/s]` or `Load (N)`.

    Parameters
    ----------
    path : str or Path
        Table between commas, semicolons or tabs, as `run_table` reads it. With columns of `RUN_COLUMNS` or of the
        vocabulary, among them `friction_reduction`, `friction_ratio`, or force or coefficient of friction with and
        without vibration. An empty cell is not measured. Rows at an amplitude, velocity or voltage of 0 give the
        friction without vibration of the rows of the same speed and load that state none.
    mapping : RecordingMapping, Path or None
        Assignment of columns, or the TOML file that holds it; other columns count by their headings.

    Returns
    -------
    xarray.Dataset
        Over `run`, in SI, NaN where nothing was measured, with a friction reduction in every run, and the attribute
        `caveats`, a line each.

    Raises
    ------
    InvalidInput
        Naming the file, the line, the column and the cell, if the table cannot be read or holds no friction.

    Examples
    --------
    >>> import sonolube as sl
    >>> runs = sl.read_runs("examples/tribometer-runs.csv")
    >>> runs["friction_force"].values.tolist()
    [0.52, 0.91, 0.83, 0.67]
    """
    path = Path(path)
    given = read_mapping(mapping) if isinstance(mapping, Path) else mapping
    return _runs(run_table(path, mapping=given), path)


def runs_of_rows(path: Path, rows: Sequence[list[str]]) -> "xr.Dataset":
    """Measured runs from the rows of a table, its header first, as `read_runs`."""
    header, *body = rows
    return _runs(assigned_columns(path, 1, header, list(enumerate(body, 2))), path)


def runs_of_dataset(dataset: "xr.Dataset", *, name: str = "runs") -> "xr.Dataset":
    """Measured runs from a dataset of one dimension, with a friction reduction in every run.

    Parameters
    ----------
    dataset : xarray.Dataset
        Variables by the names of `RUN_COLUMNS` or of the vocabulary, in SI or in the unit of their attribute `units`,
        among them what `read_runs` needs. A dataset of `read_runs` is returned as it is.
    name : str
        Of the dataset in refusals.

    Returns
    -------
    xarray.Dataset
        As of `read_runs`.

    Raises
    ------
    InvalidInput
        If the dataset has no runs, or none with a friction.
    """
    given = dataset.variables.get("friction_reduction")
    if (
        given is not None
        and given.dims == ("run",)
        and given.dtype.kind == "f"
        and given.size
        and len(dataset.sizes) == 1
    ):
        return dataset
    wide = {each: variable for each, variable in dataset.variables.items() if variable.ndim}
    dimensions = {variable.dims for variable in wide.values()}
    if len(dimensions) != 1 or len(next(iter(dimensions))) != 1:
        sizes = ", ".join(f"{each} ({size})" for each, size in list(dataset.sizes.items())[:_MAX_LINES])
        raise InvalidInput(f"{name}: a dataset of runs has one dimension, got {sizes or 'none'}")
    columns: dict[str, Floats] = {}
    texts: dict[str, list[str]] = {}
    left_out = []
    for label, variable in wide.items():
        if label in quantities() and variable.dtype.kind in "fiu":
            columns[str(label)] = _in_si(str(label), variable, name)
        elif label in (*TEXT_NAMES, "run", f"{DIRECTION_COLUMN}_word"):
            texts[str(label)] = [str(each) for each in variable.values.tolist()]
        elif label not in dataset.indexes:
            left_out.append(str(label))
    lines = list(range(1, next(iter(wide.values())).size + 1))
    return _runs(RunTable(columns=columns, texts=texts, lines=lines, caveats=left_out_caveat(left_out)), Path(name))


def _in_si(label: str, variable: "xr.Variable", name: str) -> Floats:
    """Values of a variable in SI, in which they are where it states no unit."""
    unit, stated = quantities()[label].unit, str(variable.attrs.get("units", ""))
    gain, offset, _ = si_conversion(stated or unit, unit=unit, name=f"{name}: {label}")
    return offset + gain * np.asarray(variable.values, float)


def _runs(table: RunTable, path: Path) -> "xr.Dataset":
    """Measured runs of the columns of a table."""
    import xarray as xr

    columns, without = _with_references(dict(table.columns), _FRICTIONS[0])
    columns, of_coefficients = _with_references(columns, _FRICTIONS[1])
    without |= of_coefficients
    _derive_wear(columns)
    reduction = _friction_reductions(path, columns, table.lines)
    columns["friction_reduction"] = reduction
    _derive_uncertainty(columns)
    known = np.isfinite(reduction)
    empty = ~known & ~without
    if not known.any():
        raise InvalidInput(f"{path}: no run has a result yet: fill in {FRICTION_COLUMNS}")
    data = {name: ("run", values[known]) for name, values in columns.items()}
    data |= {name: ("run", np.array(cells)[known]) for name, cells in table.texts.items()}
    caveats = [*table.caveats, *([_skipped(empty, table.lines)] if empty.any() else [])]
    return xr.Dataset(data, attrs={"title": f"{path.name}, in %", "caveats": "\n".join(caveats)})


def run_caveats(runs: "xr.Dataset") -> tuple[str, ...]:
    """Caveats of the reading of a table of runs, a line each."""
    return tuple(line for line in str(runs.attrs.get("caveats", "")).split("\n") if line)


def _with_references(columns: dict[str, Floats], name: str) -> tuple[dict[str, Floats], np.ndarray]:
    """Columns with the friction without vibration of rows at amplitude 0 in the others, and which rows these are.

    `name` is that of the friction, a force or a coefficient.

    A row at amplitude 0 serves only those of its speed and load, and is no run of its own.
    """
    count = next(iter(columns.values())).size if columns else 0
    given = [columns[name] for name in _VIBRATIONS if name in columns]
    force = columns.get(name, np.full(count, np.nan))
    without = np.zeros(count, bool)
    if given:
        without = np.all([(values == 0) | np.isnan(values) for values in given], axis=0)
        without &= np.any([values == 0 for values in given], axis=0) & np.isfinite(force)
    if not without.any():
        return columns, without
    settings = np.stack([columns.get(name, np.zeros(count)) for name in ("sliding_speed", "normal_load")], axis=1)
    intrinsic = columns.get(f"intrinsic_{name}", np.full(count, np.nan)).copy()
    deviation = columns.get(f"{name}_uncertainty", np.full(count, np.nan))
    of_intrinsic = columns.get(f"intrinsic_{name}_uncertainty", np.full(count, np.nan)).copy()
    for row in np.flatnonzero(np.isnan(intrinsic) & ~without):
        same = without & np.all(np.isclose(settings, settings[row], rtol=1e-2, equal_nan=True), axis=1)
        if same.any():
            intrinsic[row] = np.mean(force[same])
            of_intrinsic[row] = np.sqrt(np.sum(deviation[same] ** 2)) / np.count_nonzero(same)
    stated = {f"intrinsic_{name}_uncertainty": of_intrinsic} if np.isfinite(of_intrinsic).any() else {}
    return columns | stated | {f"intrinsic_{name}": intrinsic, name: np.where(without, np.nan, force)}, without


def _friction_reductions(path: Path, columns: dict[str, Floats], lines: Sequence[int]) -> Floats:
    """Friction reduction of each run, by the columns that give it; NaN where none does."""
    count = next(iter(columns.values())).size if columns else 0
    reduction = columns.get("friction_reduction", np.full(count, np.nan))
    reduction = np.where(np.isnan(reduction), 1 - columns.get("friction_ratio", np.full(count, np.nan)), reduction)
    pairs = [name for name in _FRICTIONS if {name, f"intrinsic_{name}"} <= columns.keys()]
    for name in pairs:
        without = columns[f"intrinsic_{name}"]
        for line, each in zip(lines, without, strict=True):
            if not (each > 0 or np.isnan(each)):
                got = format_si(each, quantities()[name].unit)
                raise InvalidInput(f"{path}: line {line}: intrinsic_{name} must be positive, got {got}")
        reduction = np.where(np.isnan(reduction), 1 - columns[name] / without, reduction)
    if not pairs and "friction_reduction" not in columns and "friction_ratio" not in columns:
        raise InvalidInput(f"{path}: needs a column {FRICTION_COLUMNS}")
    return reduction


def _derive_wear(columns: dict[str, Floats]) -> None:
    """Add the ratio of the wear rates where only the rates are stated."""
    if {"wear_rate", "intrinsic_wear_rate"} <= columns.keys() and not {"wear_rate_ratio", "wear_reduction"} & set(
        columns
    ):
        with np.errstate(divide="ignore", invalid="ignore"):
            columns["wear_rate_ratio"] = columns["wear_rate"] / columns["intrinsic_wear_rate"]


def _derive_uncertainty(columns: dict[str, Floats]) -> None:
    """Add the standard uncertainty of the reduction where only those of the forces are stated, independent."""
    names = ("friction_force", "intrinsic_friction_force", "friction_force_uncertainty")
    if not set(names) <= columns.keys():
        return
    force, without, deviation = (columns[name] for name in names)
    other = columns.get("intrinsic_friction_force_uncertainty", np.zeros(force.size))
    derived = np.hypot(deviation, force / without * np.where(np.isnan(other), 0.0, other)) / without
    stated = columns.get("friction_reduction_uncertainty", np.full(force.size, np.nan))
    columns["friction_reduction_uncertainty"] = np.where(np.isnan(stated), derived, stated)


def _skipped(empty: np.ndarray, lines: Sequence[int]) -> str:
    """Caveat about the rows without a result."""
    left_out = [str(lines[int(row)]) for row in np.flatnonzero(empty)]
    named = ", ".join(left_out[:_MAX_LINES]) + (", ..." if len(left_out) > _MAX_LINES else "")
    return f"{len(left_out)} of {empty.size} runs have no friction yet and are left out (line {named})"


_LARGEST_RATIO: Final = 2.0  # beyond it, vibration along the normal is not what changed
_SMALLEST_RATIO: Final = -0.2  # of a force whose zero is off


def checked_ratios(runs: "xr.Dataset", *, title: str) -> Floats:
    """Friction ratio of each run; shape (n,)."""
    ratio = 1 - np.asarray(runs["friction_reduction"].to_numpy(), float)
    outside = (ratio < _SMALLEST_RATIO) | (ratio > _LARGEST_RATIO)
    if np.any(outside):
        raise InvalidInput(
            f"{title}: run {int(np.argmax(outside)) + 1} has a friction ratio of {ratio[np.argmax(outside)]:.3g};"
            f" vibration gives {_SMALLEST_RATIO:g} to {_LARGEST_RATIO:g}: check zero and sign of the force"
        )
    return ratio


def copies_caveat(runs: "xr.Dataset") -> tuple[str, ...]:
    """Caveat about runs that equal an earlier one in every digit, which count as repeats.

    Empty where there is no such run.
    """
    numbers = [runs[name].to_numpy() for name in runs.data_vars if runs[name].dtype.kind == "f"]
    columns = [np.nan_to_num(np.asarray(column, float), nan=np.inf) for column in numbers]
    if "run" in runs.coords:
        columns.append(np.unique(runs["run"].to_numpy(), return_inverse=True)[1].astype(float))
    rows = np.column_stack(columns)
    copies = len(rows) - len(np.unique(rows, axis=0))
    if not copies:
        return ()
    return (
        f"{copies} of {len(rows)} runs equal another in every digit; they count as repeats: remove them where they are"
        " copies of one run",
    )


def setting(runs: "xr.Dataset", name: str, otherwise: ArrayLike) -> Floats:
    """Column of the runs, with another value where it is missing or its cell is empty; shape (n,)."""
    other = np.broadcast_to(np.asarray(otherwise, float), (runs.sizes["run"],))
    if name not in runs:
        return other.copy()
    values = np.asarray(runs[name].to_numpy(), float)
    return np.where(np.isnan(values), other, values)


def direction_words(runs: "xr.Dataset") -> frozenset[str]:
    """Words for directions that are no angles, along the normal or torsional, in any run; one for each meaning."""
    cells = runs[f"{DIRECTION_COLUMN}_word"].to_numpy() if f"{DIRECTION_COLUMN}_word" in runs else ()
    same = {"perpendicular": "normal", "normal": "normal", "torsional": "torsional"}
    return frozenset(same[word] for word in map(str, cells) if word in same)


def with_columns(runs: "xr.Dataset", *names: str) -> tuple["xr.Dataset", tuple[str, ...]]:
    """Runs whose cells in some columns are filled in, and a caveat about the others."""
    for name in names:
        if name not in runs:
            raise InvalidInput(f"measured runs need a column {name}: add {heading(name)}")
    filled = np.all([np.isfinite(runs[name].to_numpy()) for name in names], axis=0)
    if not filled.any():
        raise InvalidInput(f"measured runs: no run has {' and '.join(names)}: fill in these columns")
    if filled.all():
        return runs, ()
    count = int((~filled).sum())
    return runs.isel(run=filled), (f"{count} of {filled.size} runs lack {' or '.join(names)} and are left out",)
