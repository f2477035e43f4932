"""Measured runs as estimates need them: possible ratios, settings of the rig filled in, copies reported."""

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.run_columns import heading

if TYPE_CHECKING:
    import xarray as xr

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
