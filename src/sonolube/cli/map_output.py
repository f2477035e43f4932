"""What the command `map` says and writes."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.cli.design_page import notes_of, status_counts, status_tables
from sonolube.cli.output import closing_lines
from sonolube.design import MAP_LAYOUTS, gaussian_process_map, map_figure, map_page, measured_map_figure
from sonolube.errors import InvalidInput
from sonolube.figure import publication_style
from sonolube.files import write_atomically
from sonolube.report import Finding, FindingTable, write_findings
from sonolube.rig import Rig, write_netcdf
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_FEWEST = 6  # runs that can be interpolated
_COLUMNS = ("friction_reduction", "sliding_speed", "actuator_power")
_MEASURED = "The measured runs alone: friction reduction between them by a Gaussian process, and its uncertainty."
_TOLD = ("friction_reduction", "sliding_speed", "normal_load", "frequency", "voltage_peak_to_peak", "actuator_power")


def write_map(
    rig: Rig,
    mapped: "xr.Dataset",
    runs: "xr.Dataset | None",
    *,
    asked: list[tuple[str, str]],
    folder: Path,
    name: str,
    forms: list[str],
) -> list[Path]:
    """Write the report of a map, its figures and netCDF, that of the measured runs beside, and return the files."""
    page = map_page(mapped) if "html" in forms else None  # refuses before anything is written
    across, up, panel = MAP_LAYOUTS[mapped.attrs["map"]]
    between = _interpolated(mapped, runs, across, up, panel)
    with publication_style():
        figures = [Finding(name=name, caption=_caption(mapped, runs), figure=map_figure(mapped, measured=runs))]
        if between is not None and runs is not None:
            figures.append(
                Finding(name=f"{name}-measured", caption=_MEASURED, figure=measured_map_figure(between, runs))
            )
    written = write_findings(
        title=f"Friction reduction over {_lower(across)} and {_lower(up)}: {rig.title}",
        asked=asked,
        facts=[("points", f"{mapped['status'].size}"), *_facts(mapped), *_facts_of_runs(runs, between)],
        tables=[*_panel_table(mapped, panel), *status_tables(status_counts(mapped), _failures(mapped))],
        figures=figures,
        notes=notes_of((), rig.assumptions),
        folder=folder,
        name="map",
        forms=[form for form in forms if form != "html"],
    )
    if page is not None:
        written.append(write_atomically(folder / f"{name}.html", page))
    if between is not None:
        written.append(write_netcdf(between, path=folder / f"{name}-measured.nc"))
    return [*written, write_netcdf(mapped, path=folder / f"{name}.nc")]


def require_drawable(runs: "xr.Dataset", *, kind: str) -> None:
    """Refuse measured runs that a map of this kind has no place for."""
    across, up, panel = MAP_LAYOUTS[kind]
    for axis in (across, up):
        if axis not in runs:
            raise InvalidInput(f"measured runs need a column {axis} for a {kind} map")
    several = panel is not None and panel in runs and np.unique(runs[panel].values).size > 1
    if several and runs.sizes["run"] >= _FEWEST:
        raise InvalidInput(f"measured runs at several values of {panel} make several maps: give one file to each")


def _interpolated(
    mapped: "xr.Dataset", runs: "xr.Dataset | None", across: str, up: str, panel: str | None
) -> "xr.Dataset | None":
    """Return the map of the runs alone, where they are enough and of one panel."""
    import xarray as xr

    if runs is None or runs.sizes["run"] < _FEWEST:
        return None
    x, y = (np.linspace(float(runs[axis].min()), float(runs[axis].max()), 61) for axis in (across, up))
    known = "friction_reduction_uncertainty"
    found = gaussian_process_map(
        runs=np.stack([runs[across].values, runs[up].values], axis=1),
        friction_reduction=runs["friction_reduction"].values,
        friction_reduction_uncertainty=runs[known].values if known in runs else 0.0,
        points=np.stack(np.meshgrid(x, y), axis=-1),
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
        "friction_model": rig.friction_model.name,
        "points": int(mapped["status"].size),
        "without_result": int(np.isnan(mapped["friction_reduction"].values).sum()),
        "most_reduction": {name: {"value": value, "unit": quantity(name).unit} for name, value in best.items()},
        "assumptions": dict(rig.assumptions),
        "files": [str(path) for path in written],
    }


def map_lines(rig: Rig, mapped: "xr.Dataset", written: list[Path]) -> list[str]:
    """Return what a map shows as lines."""
    return [
        f"{rig.title}, {mapped['status'].size} points, friction model {rig.friction_model.name}",
        *[f"  {name:<20} {value}" for name, value in _facts(mapped)],
        *[f"  without result       {points}: {reason}" for reason, points in _failures(mapped)],
        *closing_lines(written, assumptions=rig.assumptions),
    ]


def _facts(mapped: "xr.Dataset") -> list[tuple[str, str]]:
    facts = []
    best = [format_si(value, quantity(name).unit) for name, value in _best(mapped).items()]
    if best:
        facts.append(("most reduction", f"{best[0]} at {', '.join(best[1:])}"))
    ridge = _ridge(mapped)
    if ridge:
        facts.append(("ridge", f"{ridge}; beyond it doubling the power buys less than 5 %"))
    return facts


def _facts_of_runs(runs: "xr.Dataset | None", between: "xr.Dataset | None") -> list[tuple[str, str]]:
    if runs is None:
        return []
    told = f"{runs.sizes['run']}"
    if between is None:
        return [("measured runs", f"{told}; {_FEWEST} make a map of their own")]
    scatter, error = (100 * float(between.attrs[name]) for name in ("scatter", "leave_one_out_error"))
    left_out = f"a run left out is missed by {error:.2g} %"
    return [("measured runs", f"{told}; they scatter by {scatter:.2g} % about a smooth map, and {left_out}")]


def _panel_table(mapped: "xr.Dataset", panel: str | None) -> list[FindingTable]:
    """Return the most reduction at each load or voltage, and the ridge where the map has one."""
    if panel is None:
        return []
    rows = []
    for index in range(mapped.sizes[panel]):
        part = mapped.isel({panel: index})
        at = {name: format_si(value, quantity(name).unit) for name, value in _best(part).items()}
        value = format_si(float(part[panel]), quantity(panel).unit)
        rows.append((value, *(at.get(name, "") for name in _COLUMNS), _ridge(part)))
    heads = (quantity(panel).meaning, *(quantity(name).meaning for name in _COLUMNS), "Ridge")
    with_ridge = any(row[-1] for row in rows)
    shown = slice(None) if with_ridge else slice(-1)
    return [
        FindingTable(title="Most reduction", heads=heads[shown], rows=tuple(tuple(row[shown]) for row in rows)),
    ]


def _ridge(mapped: "xr.Dataset") -> str:
    ridge = mapped["saturation_power"].values if "saturation_power" in mapped else np.array([])
    if not np.isfinite(ridge).any():
        return ""
    low, high = (format_si(float(pick(ridge)), "W") for pick in (np.nanmin, np.nanmax))
    return f"{low} to {high}"


def _failures(mapped: "xr.Dataset") -> list[tuple[str, int]]:
    failed = np.isnan(mapped["friction_reduction"].values)
    reasons, counts = np.unique(mapped["reason"].values[failed], return_counts=True)
    return [(str(reason), int(count)) for reason, count in zip(reasons, counts, strict=True)]


def _caption(mapped: "xr.Dataset", runs: "xr.Dataset | None") -> str:
    told = "Friction reduction by the model."
    if _ridge(mapped):
        told += " Dashed: the power beyond which doubling it reduces friction by less than another 5 %."
    return told if runs is None else f"{told} Circles: measured runs, with their reductions in percent."


def _lower(name: str) -> str:
    meaning = quantity(name).meaning.partition(",")[0]
    return meaning[:1].lower() + meaning[1:]


def _best(mapped: "xr.Dataset") -> dict[str, float]:
    reduction = mapped["friction_reduction"]
    if np.isnan(reduction.values).all():
        return {}
    place = np.unravel_index(int(np.nanargmax(reduction.values)), reduction.shape)
    point = mapped.isel(dict(zip(reduction.dims, map(int, place), strict=True)))
    return {name: float(point[name]) for name in _TOLD if name in point and point[name].ndim == 0}
