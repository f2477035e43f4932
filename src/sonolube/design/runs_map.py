"""Map of friction reduction between measured runs, interpolated by a Gaussian process."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.design.gaussian_process import MIN_RUNS, gaussian_process_map
from sonolube.design.map_layouts import MAP_LAYOUTS, map_layout, same_panels
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import run_caveats
from sonolube.measurement.run_selection import setting, with_columns
from sonolube.rig import VOLTAGE, CommandedQuantity, Rig, own_level
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_STAND_INS = {"actuator_power": "voltage_peak_to_peak"}  # that give an axis
_BY_THE_RIG = ("nominal_pressure",)  # axes that a rig gives where no column does
_POINTS = 61  # of the interpolated map along each axis
_MATCH = 1e-3  # relative difference of a load or voltage below which a run belongs to a panel as it is
_UNCERTAINTY = "friction_reduction_uncertainty"


def require_mappable(runs: "xr.Dataset", *, kind: str, commanded: CommandedQuantity) -> None:
    """Raise if measured runs cannot be drawn on a kind of map."""
    across, up, panel = MAP_LAYOUTS[kind]
    panel = commanded.name if panel == VOLTAGE.name else panel
    for axis in (across, up):
        if axis not in runs and _STAND_INS.get(axis) not in runs and axis not in _BY_THE_RIG:
            raise InvalidInput(f"measured runs need a column {axis} for a {kind} map")
    several = panel is not None and panel in runs and np.unique(runs[panel].values).size > 1
    if several and runs.sizes["run"] >= MIN_RUNS:
        raise InvalidInput(f"measured runs at several values of {panel} make several maps: give one file to each")


def runs_on_map(runs: "xr.Dataset", rig: Rig, computed: "xr.Dataset") -> tuple["xr.Dataset", tuple[str, ...]]:
    """Measured runs with the quantities of both axes of a map, and caveats about those without a place on it.

    The runs with a place, each with the number of its `panel`, -1 for none, and `shown_friction_reduction`: as measured
    where its load or voltage is that of the panel, else moved to the nearest panel by the difference of the model
    (`is_moved`).
    """
    across, up, _ = map_layout(computed)
    if up == "actuator_power":
        voltage = setting(runs, "voltage_peak_to_peak", np.nan)
        power = np.interp(voltage, computed["voltage_peak_to_peak"], computed[up], left=np.nan, right=np.nan)
        runs = runs.assign({up: ("run", setting(runs, up, power))})
    if up == "nominal_pressure":
        pressure = setting(runs, "normal_load", rig.normal_load) / rig.contact.nominal_area
        runs = runs.assign({up: ("run", setting(runs, up, pressure))})
    placed, skipped = with_columns(runs, across, up)
    shown, beyond = _on_panels(placed, rig, computed)
    return shown, (*run_caveats(runs), *skipped, *beyond)


def _on_panels(runs: "xr.Dataset", rig: Rig, computed: "xr.Dataset") -> tuple["xr.Dataset", tuple[str, ...]]:
    """Runs with the nearest panel and the reduction there, and caveats about those that are moved or beyond it."""
    panel = map_layout(computed)[2]
    count = runs.sizes["run"]
    place, shift = np.zeros(count, int), np.zeros(count)
    name = ""
    if panel is not None and not same_panels(computed):
        name = quantity(panel).meaning.partition(",")[0].lower()
        values, own = computed[panel].values, setting(runs, panel, _rigs_own(rig, panel))
        place = np.argmin(np.abs(values - own[:, None]), axis=1)
        matching = np.isclose(own, values[place], rtol=_MATCH)
        shift = np.where(matching, 0.0, _model(computed, runs, values[place]) - _model(computed, runs, own))
    moved, beyond = shift != 0.0, np.isnan(shift)
    shown = runs.assign(
        panel=("run", np.where(beyond, -1, place)),
        is_moved=("run", moved & ~beyond),
        shown_friction_reduction=("run", runs["friction_reduction"].values + np.nan_to_num(shift)),
    )
    caveats = []
    if (moved & ~beyond).any():
        number = f"{int((moved & ~beyond).sum())} of {count} runs"
        caveats.append(f"{number} are drawn at the {name} of the nearest panel, moved there by the model")
    if beyond.any():
        caveats.append(
            f"{int(beyond.sum())} of {count} runs are not drawn: their {name} lies beyond the panels of the map"
        )
    return shown, tuple(caveats)


def _rigs_own(rig: Rig, panel: str) -> float:
    """Load of a rig, or its voltage or amplitude, for runs that state none."""
    if panel == "normal_load":
        return rig.normal_load
    return own_level(rig)


def _model(computed: "xr.Dataset", runs: "xr.Dataset", at: Floats) -> Floats:
    """Reduction on a map at the places of runs and at values of the quantity of its panels; NaN beyond it."""
    from scipy.interpolate import RegularGridInterpolator

    across, up, panel = map_layout(computed)
    assert panel is not None
    if computed.sizes[panel] < 2:
        return np.full(at.size, np.nan)
    values = computed["friction_reduction"].transpose(panel, computed[up].dims[0], computed[across].dims[0]).values
    axes = tuple(computed[name].values for name in (panel, up, across))
    interpolated = RegularGridInterpolator(axes, values, bounds_error=False)
    return np.asarray(interpolated(np.stack([at, runs[up].values, runs[across].values], axis=1)), float)


def runs_map(runs: "xr.Dataset", *, kind: str) -> "xr.Dataset | None":
    """Friction reduction between measured runs over the axes of a map, with its uncertainty.

    Over both axes of the map, with the scatter of the runs and their leave-one-out error as attributes; None for fewer
    than `MIN_RUNS` runs.

    See Also
    --------
    measured_map
    """
    import xarray as xr

    if runs.sizes["run"] < MIN_RUNS:
        return None
    across, up, _ = MAP_LAYOUTS[kind]
    x, y = (np.linspace(float(runs[axis].min()), float(runs[axis].max()), _POINTS) for axis in (across, up))
    interpolated = gaussian_process_map(
        runs=np.stack([runs[across].values, runs[up].values], axis=1),
        friction_reduction=runs["friction_reduction"].values,
        friction_reduction_uncertainty=runs[_UNCERTAINTY].values if _UNCERTAINTY in runs else 0.0,
        points=np.stack(np.meshgrid(x, y), axis=-1),
    )
    return xr.Dataset(
        {
            "friction_reduction": ((up, across), interpolated.friction_reduction, {"units": "1"}),
            _UNCERTAINTY: ((up, across), interpolated.friction_reduction_uncertainty, {"units": "1"}),
        },
        coords={across: (across, x, {"units": quantity(across).unit}), up: (up, y, {"units": quantity(up).unit})},
        attrs={
            "title": f"Friction reduction between {runs.sizes['run']} measured runs",
            "map": kind,
            "scatter": interpolated.scatter,
            "leave_one_out_error": interpolated.leave_one_out_error,
        },
    )
