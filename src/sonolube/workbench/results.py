"""Results of a rig as labelled datasets: steady vibration, sweep, map and comparison of models."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from sonolube.design import MAPS, grid_plan, latin_hypercube_plan, list_plan, sweep as computed_sweep
from sonolube.design.maps import default_axes
from sonolube.design.ranges import ends_of, values_of
from sonolube.errors import InvalidInput, UnknownName
from sonolube.rig import Rig, operating_caveats, simulate as simulated
from sonolube.rig.result_datasets import simulation_arrays
from sonolube.validation.comparison import compare_models, compared_models, predict_rig
from sonolube.validation.rig_conditions import vibrated_rig
from sonolube.validation.tables import comparison_dataset

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["compare", "map", "simulate", "sweep"]


def simulate(rig: Rig) -> "xr.Dataset":
    """Steady vibration of a rig by the multi-scale model, and the friction, wear and power under it.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    xarray.Dataset
        Displacement and contact force over `time`; friction ratio, forces, amplitude, power and wear as scalars with
        their units. Attributes hold status and reason, source of the amplitude, caveats and assumptions.

    Raises
    ------
    InvalidInput
        If the rig does not vibrate.
    """
    return simulation_arrays(rig, simulated(rig)).dataset()


def sweep(
    rig: Rig,
    over: Mapping[str, str | ArrayLike],
    *,
    sample: Literal["grid", "list", "lhs"] = "grid",
    points: int = 1000,
    seed: int = 0,
    folder: str | Path | None = None,
) -> "xr.Dataset":
    """Operating points of a rig over entries of its file, with a status for each.

    Parameters
    ----------
    rig : Rig
    over : mapping of str to str or array_like
        By dotted key of the rig file, as on the command line, such as {"drive.voltage_peak_to_peak": "2V:28V:27"},
        or numbers in SI.
    sample : {"grid", "list", "lhs"}
        Every value with every other, row by row, or `points` drawn by Latin hypercube between two ends.
    points : int
        Drawn by Latin hypercube.
    seed : int
        Of these.
    folder : str or Path, optional
        For finished chunks, from which an interrupted sweep continues.

    Returns
    -------
    xarray.Dataset
        Over the keys of a grid, or over `point`.

    Raises
    ------
    InvalidInput
        If a key is unknown or a range cannot be read, or the rig was changed in Python since it was read.
    """
    if sample == "lhs":
        ends = {key: _ends(key, values) for key, values in over.items()}
        plan = latin_hypercube_plan(rig, over=ends, points=points, seed=seed)
    else:
        values = {key: values_of(key, each) if isinstance(each, str) else each for key, each in over.items()}
        plan = (grid_plan if sample == "grid" else list_plan)(rig, over=values)
    return computed_sweep(plan, folder=folder)


def map(  # noqa: A001 - the name of the command
    rig: Rig, kind: str = "velocity-power", *, over: Mapping[str, str | ArrayLike] | None = None
) -> "xr.Dataset":
    """Map of the friction reduction of a rig over two quantities.

    Parameters
    ----------
    rig : Rig
        With a drive voltage.
    kind : str
        Of `sonolube.design.MAPS`: "velocity-power", "velocity-stress" or "frequency-voltage".
    over : mapping of str to str or array_like, optional
        Other values of axes by dotted key of the rig file, as for `sweep`.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InvalidInput
        If a value is not positive or the rig lacks what the map needs.
    UnknownName
        If there is no such kind of map, or no such axis of it.
    """
    if kind not in MAPS:
        raise UnknownName.among(list(MAPS), kind="map", name=kind)
    axes = default_axes(rig, kind=kind)
    for key, values in (over or {}).items():
        name = key.rpartition(".")[2]
        if name not in axes:
            raise UnknownName.among(list(axes), kind="axis of this map", name=name)
        axes[name] = np.asarray(values_of(key, values) if isinstance(values, str) else values, float)
    mapped: xr.Dataset = MAPS[kind](rig, **axes)
    return mapped.assign_attrs(_notes(rig))


def compare(rig: Rig | None = None, *, models: Sequence[str] = ()) -> "xr.Dataset":
    """Models of friction under vibration against every published test: fitted, cross-validated, and for a rig.

    Parameters
    ----------
    rig : Rig, optional
        That every applicable model predicts too.
    models : sequence of str
        Names of models; all where empty.

    Returns
    -------
    xarray.Dataset
        Over `model` and `test`: fitted and cross-validated ratios and their errors; ratio and uncertainty for the rig.

    Raises
    ------
    UnknownName
        If there is no such model.
    """
    fits = compare_models(compared_models(models))
    if rig is None:
        return comparison_dataset(fits)
    labelled = comparison_dataset(fits, predict_rig(fits, vibrated_rig(rig)))
    return labelled.assign_attrs(rig=rig.title, **_notes(rig))


def _notes(rig: Rig) -> dict[str, str]:
    """Caveats and assumptions of a rig, as attributes."""
    assumptions = "\n".join(f"{key}: {reason}" for key, reason in rig.assumptions.items())
    return {"caveats": "\n".join(operating_caveats(rig)), "assumptions": assumptions}


def _ends(key: str, values: str | ArrayLike) -> tuple[float, float]:
    """Lowest and highest value of a key, as text or as numbers in SI."""
    if isinstance(values, str):
        return ends_of(key, values)
    numbers = np.asarray(values, float).ravel()
    if numbers.size != 2:
        raise InvalidInput(f"over {key}: points are drawn between two ends, got {numbers.size} numbers")
    return float(numbers[0]), float(numbers[1])
