"""Design: what a designer makes of a rig: sweeps over its parameters, maps, friction control."""

from sonolube.design.map_figures import map_figure, map_page, measured_figure
from sonolube.design.maps import (
    MAPS,
    SATURATION,
    frequency_voltage_map,
    sufficient_power,
    velocity_power_map,
    velocity_stress_map,
)
from sonolube.design.measured_map import MeasuredMap, measured_map
from sonolube.design.plan import SETTINGS, SweepPlan, grid_plan, latin_hypercube_plan, list_plan
from sonolube.design.sweep import CHUNK_POINTS, points_of, sweep

__all__ = [
    "CHUNK_POINTS",
    "MAPS",
    "SATURATION",
    "SETTINGS",
    "MeasuredMap",
    "SweepPlan",
    "frequency_voltage_map",
    "grid_plan",
    "latin_hypercube_plan",
    "list_plan",
    "map_figure",
    "map_page",
    "measured_figure",
    "measured_map",
    "points_of",
    "sufficient_power",
    "sweep",
    "velocity_power_map",
    "velocity_stress_map",
]
