"""What the command `map` says and writes."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.design import map_figure, map_page, measured_figure, measured_map
from sonolube.errors import InvalidInput
from sonolube.figure import publication_style, write_figure
from sonolube.files import write_whole
from sonolube.rig import Rig, write_netcdf
from sonolube.units import engineering
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_PLACES = {
    "velocity-stress": ("sliding_speed", "nominal_pressure", "voltage_peak_to_peak"),
    "velocity-power": ("sliding_speed", "actuator_power", "normal_load"),
    "frequency-voltage": ("frequency", "voltage_peak_to_peak", None),
}
_FEWEST = 6  # runs that can be interpolated
_TOLD = ("friction_reduction", "sliding_speed", "normal_load", "frequency", "voltage_peak_to_peak", "actuator_power")


def write_map(
    mapped: "xr.Dataset", runs: "xr.Dataset | None", *, folder: Path, name: str, forms: list[str]
) -> list[Path]:
    """Write a map as figures, page and netCDF, that of the measured runs beside, and return the files."""
    page = map_page(mapped) if "html" in forms else None  # refuses before anything is written
    across, up, panel = _PLACES[mapped.attrs["map"]]
    missing = [] if runs is None else [axis for axis in (across, up) if axis not in runs]
    if missing:
        raise InvalidInput(f"measured runs need a column {missing[0]} for a {mapped.attrs['map']} map")
    between = _interpolated(mapped, runs, across, up, panel)
    drawn = tuple(form for form in forms if form != "html")
    written = []
    with publication_style():
        if drawn:
            figure = map_figure(mapped, measured=runs)
            written += write_figure(figure, folder=folder, name=name, forms=drawn)
        if drawn and between is not None and runs is not None:
            written += write_figure(measured_figure(between, runs), folder=folder, name=f"{name}-measured", forms=drawn)
    if page is not None:
        written.append(write_whole(folder / f"{name}.html", page))
    if between is not None:
        written.append(write_netcdf(between, path=folder / f"{name}-measured.nc"))
    return [*written, write_netcdf(mapped, path=folder / f"{name}.nc")]


def _interpolated(
    mapped: "xr.Dataset", runs: "xr.Dataset | None", across: str, up: str, panel: str | None
) -> "xr.Dataset | None":
    """Return the map of the runs alone, where they are enough and of one panel."""
    import xarray as xr

    if runs is None or runs.sizes["run"] < _FEWEST:
        return None
    if panel is not None and panel in runs and np.unique(runs[panel].values).size > 1:
        raise InvalidInput(f"measured runs at several values of {panel} make several maps: give one file to each")
    x, y = (np.linspace(float(runs[axis].min()), float(runs[axis].max()), 61) for axis in (across, up))
    known = "friction_reduction_uncertainty"
    found = measured_map(
        runs=np.stack([runs[across].values, runs[up].values], axis=1),
        friction_reduction=runs["friction_reduction"].values,
        friction_reduction_uncertainty=runs[known].values if known in runs else 0.0,
        places=np.stack(np.meshgrid(x, y), axis=-1),
    )
    return xr.Dataset(
        {
            "friction_reduction": ((up, across), found.friction_reduction, {"units": "1"}),
            "friction_reduction_uncertainty": ((up, across), found.friction_reduction_uncertainty, {"units": "1"}),
        },
        coords={across: (across, x, {"units": quantity(across).unit}), up: (up, y, {"units": quantity(up).unit})},
        attrs={
            "title": f"Friction reduction between {runs.sizes['run']} measured runs",
            "map": mapped.attrs["map"],
            "scatter": found.scatter,
            "leave_one_out_error": found.leave_one_out_error,
        },
    )


def map_object(rig: Rig, mapped: "xr.Dataset", written: list[Path]) -> dict[str, Any]:
    """Return the most reduction of a map, and what failed, as they go into JSON."""
    best = _best(mapped)
    return {
        "rig": rig.title,
        "map": mapped.attrs["map"],
        "closure": rig.closure,
        "points": int(mapped["status"].size),
        "without_result": int(np.isnan(mapped["friction_reduction"].values).sum()),
        "most_reduction": {name: {"value": value, "unit": quantity(name).unit} for name, value in best.items()},
        "assumptions": dict(rig.assumptions),
        "files": [str(path) for path in written],
    }


def map_lines(rig: Rig, mapped: "xr.Dataset", written: list[Path]) -> list[str]:
    """Return what a map shows as lines."""
    failed = np.isnan(mapped["friction_reduction"].values)
    lines = [f"{rig.title}, {mapped['status'].size} points, closure {rig.closure}"]
    best = [engineering(value, quantity(name).unit) for name, value in _best(mapped).items()]
    if best:
        lines.append(f"  most reduction       {best[0]} at {', '.join(best[1:])}")
    ridge = mapped["sufficient_power"].values if "sufficient_power" in mapped else np.array([])
    if np.isfinite(ridge).any():
        low, high = (engineering(float(pick(ridge)), "W") for pick in (np.nanmin, np.nanmax))
        lines.append(f"  ridge                {low} to {high}; beyond it doubling the power buys less than 5 %")
    if failed.any():
        lines.append(f"  without result       {failed.sum()}: {mapped['reason'].values[failed][0]}")
    return [
        *lines,
        *[f"  assumed {key}: {reason}" for key, reason in rig.assumptions.items()],
        *map("  {}".format, written),
    ]


def _best(mapped: "xr.Dataset") -> dict[str, float]:
    reduction = mapped["friction_reduction"]
    if np.isnan(reduction.values).all():
        return {}
    place = np.unravel_index(int(np.nanargmax(reduction.values)), reduction.shape)
    point = mapped.isel(dict(zip(reduction.dims, map(int, place), strict=True)))
    return {name: float(point[name]) for name in _TOLD if name in point and point[name].ndim == 0}
