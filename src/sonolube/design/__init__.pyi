from .map_figures import (
    MAP_LAYOUTS as MAP_LAYOUTS,
    map_chart as map_chart,
    map_layout as map_layout,
    map_page as map_page,
    measured_map_chart as measured_map_chart,
)
from .maps import (
    MAPS as MAPS,
    frequency_amplitude_map as frequency_amplitude_map,
    frequency_voltage_map as frequency_voltage_map,
    map_kinds as map_kinds,
    velocity_amplitude_map as velocity_amplitude_map,
    velocity_power_map as velocity_power_map,
    velocity_stress_map as velocity_stress_map,
)
from .parameter_sweep import CHUNK_POINTS as CHUNK_POINTS, compute_points as compute_points, sweep as sweep
from .point_statistics import SATURATION_GAIN as SATURATION_GAIN, saturation_power as saturation_power
from .runs_map import GaussianProcessMap as GaussianProcessMap, gaussian_process_map as gaussian_process_map
from .statistics import (
    QUANTILES as QUANTILES,
    IntervalEstimate as IntervalEstimate,
    SampleStatistics as SampleStatistics,
    SobolIndices as SobolIndices,
    saltelli_sample as saltelli_sample,
    sample_statistics as sample_statistics,
    sobol_indices as sobol_indices,
    sobol_sample as sobol_sample,
)
from .sweep_figures import sweep_chart as sweep_chart, swept_variables as swept_variables
from .sweep_plan import (
    OPERATING_CONDITIONS as OPERATING_CONDITIONS,
    SweepPlan as SweepPlan,
    grid_plan as grid_plan,
    latin_hypercube_plan as latin_hypercube_plan,
    list_plan as list_plan,
)
from .uncertainty import available_outcomes as available_outcomes, propagate as propagate
from .uncertainty_summary import (
    band_chart as band_chart,
    histogram_chart as histogram_chart,
    outcome_statistics as outcome_statistics,
    sobol_chart as sobol_chart,
)
