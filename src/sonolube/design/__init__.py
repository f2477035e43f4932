"""Design of experiments and devices: parameter sweeps, maps, uncertainty propagation and Sobol indices of a rig."""

from sonolube.design.gaussian_process import GaussianProcessMap, gaussian_process_map
from sonolube.design.map_figures import map_figure, map_page, measured_map_figure
from sonolube.design.maps import (
    MAP_LAYOUTS,
    MAPS,
    SATURATION_GAIN,
    frequency_voltage_map,
    saturation_power,
    velocity_power_map,
    velocity_stress_map,
)
from sonolube.design.parameter_sweep import CHUNK_POINTS, compute_points, sweep
from sonolube.design.sobol import SobolIndices, saltelli_sample, sobol_indices, sobol_sample
from sonolube.design.statistics import QUANTILES, IntervalEstimate, SampleStatistics, sample_statistics
from sonolube.design.sweep_figures import sweep_figure, swept_variables
from sonolube.design.sweep_plan import OPERATING_CONDITIONS, SweepPlan, grid_plan, latin_hypercube_plan, list_plan
from sonolube.design.uncertainty import available_outcomes, propagate
from sonolube.design.uncertainty_figures import band_figure, histogram_figure, outcome_statistics, sobol_figure

__all__ = [
    "CHUNK_POINTS",
    "MAPS",
    "MAP_LAYOUTS",
    "OPERATING_CONDITIONS",
    "QUANTILES",
    "SATURATION_GAIN",
    "GaussianProcessMap",
    "IntervalEstimate",
    "SampleStatistics",
    "SobolIndices",
    "SweepPlan",
    "available_outcomes",
    "band_figure",
    "compute_points",
    "frequency_voltage_map",
    "gaussian_process_map",
    "grid_plan",
    "histogram_figure",
    "latin_hypercube_plan",
    "list_plan",
    "map_figure",
    "map_page",
    "measured_map_figure",
    "outcome_statistics",
    "propagate",
    "saltelli_sample",
    "sample_statistics",
    "saturation_power",
    "sobol_figure",
    "sobol_indices",
    "sobol_sample",
    "sweep",
    "sweep_figure",
    "swept_variables",
    "velocity_power_map",
    "velocity_stress_map",
]
