"""Design: what a designer makes of a rig: sweeps over its parameters, maps, uncertainty, friction control."""

from sonolube.design.map_figures import map_figure, map_page, measured_figure
from sonolube.design.maps import (
    MAPS,
    PLACES,
    SATURATION,
    frequency_voltage_map,
    sufficient_power,
    velocity_power_map,
    velocity_stress_map,
)
from sonolube.design.measured_map import MeasuredMap, measured_map
from sonolube.design.plan import SETTINGS, SweepPlan, grid_plan, latin_hypercube_plan, list_plan
from sonolube.design.sample_statistics import QUANTILES, Estimated, Spread, spread
from sonolube.design.sobol import SobolIndices, saltelli_points, sobol_indices, sobol_points
from sonolube.design.sweep import CHUNK_POINTS, points_of, sweep
from sonolube.design.sweep_figures import sweep_figure, swept_names
from sonolube.design.uncertainty import outcomes_of, propagate
from sonolube.design.uncertainty_figures import band_figure, indices_figure, spread_figure, spread_of

__all__ = [
    "CHUNK_POINTS",
    "MAPS",
    "PLACES",
    "QUANTILES",
    "SATURATION",
    "SETTINGS",
    "Estimated",
    "MeasuredMap",
    "SobolIndices",
    "Spread",
    "SweepPlan",
    "band_figure",
    "frequency_voltage_map",
    "grid_plan",
    "indices_figure",
    "latin_hypercube_plan",
    "list_plan",
    "map_figure",
    "map_page",
    "measured_figure",
    "measured_map",
    "outcomes_of",
    "points_of",
    "propagate",
    "saltelli_points",
    "sobol_indices",
    "sobol_points",
    "spread",
    "spread_figure",
    "spread_of",
    "sufficient_power",
    "sweep",
    "sweep_figure",
    "swept_names",
    "velocity_power_map",
    "velocity_stress_map",
]
