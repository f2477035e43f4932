"""Measured runs by their tables, as estimates need them.

Friction follows from the columns that give it, in SI, with what was left out; ratios are possible ones, settings of the
rig are filled in, and copies are reported.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping, read_mapping
from sonolube.measurement.recordings.raw_table import si_conversion
from sonolube.measurement.run_columns import (
    DIRECTION_COLUMN,
    FRICTION_COLUMNS,
    SWITCH,
    SWITCHED_OFF,
    TEXT_NAMES,
    heading,
)
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

    table = _switched_on(table, path)
    columns, digits = dict(table.columns), dict(table.digits)
    count, turned = len(table.lines), _turn_signs(columns)
    without = np.zeros(count, bool)
    for name in _FRICTIONS:
        is_reference = _references(columns, name, table.without)
        if is_reference.any():
            _refer(columns, digits, name, is_reference, table.texts.get("run"))
            without |= is_reference
    _derive_wear(columns)
    reduction = _friction_reductions(path, columns, table.lines)
    columns["friction_reduction"] = reduction
    _derive_uncertainty(columns)
    resolution = _resolution(columns, digits)
    if np.isfinite(resolution).any():
        columns["friction_reduction_resolution"] = resolution
    known = np.isfinite(reduction)
    empty = ~known & ~without
    if not known.any():
        raise InvalidInput(f"{path}: no run has a result yet: fill in {FRICTION_COLUMNS}")
    data = {name: ("run", values[known]) for name, values in columns.items()}
    data |= {name: ("run", np.array(cells)[known]) for name, cells in table.texts.items()}
    caveats = [*table.caveats, *turned, *([_skipped(empty, table.lines)] if empty.any() else [])]
    return xr.Dataset(data, attrs={"title": f"{path.name}, in %", "caveats": "\n".join(caveats)})


def _switched_on(table: RunTable, path: Path) -> RunTable:
    """Table without the runs that its column `used` switches off, and a caveat on them."""
    used = np.array([cell.strip().casefold() not in SWITCHED_OFF for cell in table.texts.get(SWITCH, ())], bool)
    if used.all():
        return table
    if not used.any():
        raise InvalidInput(f"{path}: every run is switched off by the column {SWITCH!r}")
    off = [line for line, is_used in zip(table.lines, used, strict=True) if not is_used]
    named = ", ".join(map(str, off[:_MAX_LINES])) + (", ..." if len(off) > _MAX_LINES else "")
    return replace(
        table,
        columns={name: values[used] for name, values in table.columns.items()},
        digits={name: values[used] for name, values in table.digits.items()},
        texts={name: [cells[at] for at in np.flatnonzero(used)] for name, cells in table.texts.items()},
        lines=[table.lines[at] for at in np.flatnonzero(used)],
        without=None if table.without is None else table.without[used],
        caveats=(*table.caveats, f"switched off by the column {SWITCH!r} and left out: line {named}"),
    )


_USED = ("sliding_speed", "normal_load", *_VIBRATIONS, "frequency", "vibration_direction")
_OF_FRICTION = ("friction_reduction", "friction_ratio", *_FRICTIONS)


def runs_text(runs: "xr.Dataset") -> str:
    """What a table of runs was understood as, in a line: its runs, their settings and the range of their ratios."""
    ratio = 1 - np.asarray(runs["friction_reduction"].to_numpy(), float)
    stated = [name for name in _USED if name in runs and np.isfinite(runs[name].to_numpy()).any()]
    varied = [name for name in stated if np.ptp(runs[name].to_numpy()[np.isfinite(runs[name].to_numpy())]) > 0]
    constant = [
        f"{_named(name)} {format_si(float(np.nanmax(runs[name].to_numpy())), quantities()[name].unit)}"
        for name in stated
        if name not in varied
    ]
    pairs = [name for name in _FRICTIONS if {name, f"intrinsic_{name}"} <= set(runs.data_vars)]
    by = f"by {_named(pairs[0])} with and without vibration" if pairs else "as stated"
    given = ", ".join([*map(_named, varied), *constant]) or "no settings"
    title = str(runs.attrs.get("title", "runs")).removesuffix(", in %")
    return f"{title}: {ratio.size} runs with {given}; friction ratio {np.min(ratio):.3g} to {np.max(ratio):.3g} {by}"


def _named(name: str) -> str:
    """Name of a column in words."""
    return name.replace("_", " ")


def run_caveats(runs: "xr.Dataset") -> tuple[str, ...]:
    """Caveats of the reading of a table of runs, a line each."""
    return tuple(line for line in str(runs.attrs.get("caveats", "")).split("\n") if line)


def _turn_signs(columns: dict[str, Floats]) -> tuple[str, ...]:
    """Make forces positive of which none is, the sign being that of the sensor, with a caveat."""
    names = [name for name in (_FRICTIONS[0], f"intrinsic_{_FRICTIONS[0]}") if name in columns]
    forces = np.concatenate([columns[name] for name in names]) if names else np.array([])
    if "force_zero" in columns or not np.any(forces < 0) or np.any(forces > 0):
        return ()
    for name in names:
        columns[name] = -columns[name]
    return ("no friction force is positive: the sign is taken as that of the sensor, and turned",)


def _references(columns: Mapping[str, Floats], name: str, stated: NDArray[np.bool_] | None) -> NDArray[np.bool_]:
    """Which rows hold friction without vibration, of a force or a coefficient: as stated, or by an amplitude of 0."""
    count = next(iter(columns.values())).size if columns else 0
    given = [columns[each] for each in _VIBRATIONS if each in columns]
    has_friction = np.isfinite(columns.get(name, np.full(count, np.nan)))
    if stated is not None:
        return stated & has_friction
    if not given:
        return np.zeros(count, bool)
    none = np.all([(values == 0) | np.isnan(values) for values in given], axis=0)
    return np.asarray(none & np.any([values == 0 for values in given], axis=0) & has_friction)


def _refer(
    columns: dict[str, Floats],
    digits: dict[str, Floats],
    name: str,
    without: NDArray[np.bool_],
    runs: Sequence[str] | None,
) -> None:
    """Add the friction without vibration of rows that hold it to the others, of which they are no runs.

    A row serves those of its speed and load; those of the run that it names, where there are such.
    """
    count, force = without.size, columns[name]
    unknown = np.full(count, np.nan)
    settings = np.stack([columns.get(each, np.zeros(count)) for each in ("sliding_speed", "normal_load")], axis=1)
    intrinsic = columns.get(f"intrinsic_{name}", unknown).copy()
    deviation, written = columns.get(f"{name}_uncertainty", unknown), digits.get(name, unknown)
    of_intrinsic = columns.get(f"intrinsic_{name}_uncertainty", unknown).copy()
    of_digits = digits.get(f"intrinsic_{name}", unknown).copy()
    names = np.array(runs) if runs is not None else np.full(count, "")
    for row in np.flatnonzero(np.isnan(intrinsic) & ~without):
        alike = without & np.all(np.isclose(settings, settings[row], rtol=1e-2, equal_nan=True), axis=1)
        of_run = alike & (names == names[row]) & (names != "")
        same = of_run if of_run.any() else alike
        if same.any():
            intrinsic[row] = np.mean(force[same])
            of_intrinsic[row] = np.sqrt(np.sum(deviation[same] ** 2)) / np.count_nonzero(same)
            of_digits[row] = np.mean(written[same])
    if np.isfinite(of_intrinsic).any():
        columns[f"intrinsic_{name}_uncertainty"] = of_intrinsic
    columns[f"intrinsic_{name}"], digits[f"intrinsic_{name}"] = intrinsic, of_digits
    columns[name] = np.where(without, np.nan, force)


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


def _of_ratios(columns: Mapping[str, Floats], name: str, deviation: Floats, of_intrinsic: Floats) -> Floats:
    """Standard uncertainty of the reduction of two frictions, to first order, by independent ones of each."""
    friction, without = columns[name], columns[f"intrinsic_{name}"]
    other = np.where(np.isnan(of_intrinsic), 0.0, of_intrinsic)
    return np.asarray(np.hypot(deviation, friction / without * other) / without)


def _derive_uncertainty(columns: dict[str, Floats]) -> None:
    """Add the standard uncertainty of the reduction where only those of forces, coefficients or their zero are stated.

    Frictions are independent but for the zero of the force, which both have: with the ratio r and the force F0 without
    vibration, its uncertainty times (1 - r) / F0.
    """
    for name in _FRICTIONS:
        if not {name, f"intrinsic_{name}"} <= columns.keys():
            continue
        unknown = np.full(columns[name].size, np.nan)
        of_friction, of_intrinsic = (
            columns.get(f"{each}_uncertainty", unknown) for each in (name, f"intrinsic_{name}")
        )
        derived = _of_ratios(columns, name, of_friction, of_intrinsic)
        zero = columns.get("force_zero_uncertainty", unknown)
        if name == _FRICTIONS[0] and np.isfinite(zero).any():
            shared = np.abs(1 - columns[name] / columns[f"intrinsic_{name}"]) * zero / columns[f"intrinsic_{name}"]
            derived = np.where(np.isnan(shared), derived, np.hypot(np.nan_to_num(derived), shared))
        if np.isfinite(derived).any():
            stated = columns.get("friction_reduction_uncertainty", unknown)
            columns["friction_reduction_uncertainty"] = np.where(np.isnan(stated), derived, stated)


def _resolution(columns: Mapping[str, Floats], digits: Mapping[str, Floats]) -> Floats:
    """Standard uncertainty of each reduction by the digits of what it follows from; NaN where they are not known."""
    unknown = np.full(columns["friction_reduction"].size, np.nan)
    found = unknown
    for name in ("friction_reduction", "friction_ratio"):
        found = np.where(np.isnan(found), digits.get(name, unknown), found)
    for name in _FRICTIONS:
        if {name, f"intrinsic_{name}"} <= columns.keys():
            own, intrinsic = digits.get(name, unknown), digits.get(f"intrinsic_{name}", unknown)
            found = np.where(np.isnan(found), _of_ratios(columns, name, own, intrinsic), found)
    return found


def resolution(runs: "xr.Dataset") -> Floats:
    """Standard uncertainty of each reduction by the digits as written, zero where they are not known; shape (n,)."""
    return setting(runs, "friction_reduction_resolution", 0.0)


def intrinsic_coefficients(runs: "xr.Dataset", loads: Floats) -> Floats:
    """Coefficient of friction without vibration of each run: its force over the load, or as stated; shape (n,)."""
    force, stated = (setting(runs, f"intrinsic_{name}", np.nan) for name in _FRICTIONS)
    return np.where(np.isnan(force), stated, force / loads)


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
