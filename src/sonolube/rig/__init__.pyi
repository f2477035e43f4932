from .amplitude_source import ResolvedVibration as ResolvedVibration, available_sources as available_sources
from .contact_temperature import (
    TemperaturePoint as TemperaturePoint,
    temperature_point as temperature_point,
    thermal_solid as thermal_solid,
)
from .datasets import dataset as dataset, gridded as gridded, write_netcdf as write_netcdf
from .distribution import Distribution as Distribution, LogNormal as LogNormal, Normal as Normal, Uniform as Uniform
from .driven_rig import DrivenRig as DrivenRig
from .figures import STUDY_CHARTS as STUDY_CHARTS
from .file.reader import (
    read_rig as read_rig,
    rig_content as rig_content,
    rig_from as rig_from,
    structure_by_stack as structure_by_stack,
    structure_entries as structure_entries,
    with_tables as with_tables,
)
from .file.toml_file import rig_schema as rig_schema
from .friction_and_wear import (
    PUBLISHED_DECAY_LENGTH as PUBLISHED_DECAY_LENGTH,
    DecayLengthPopulation as DecayLengthPopulation,
    decay_length_caveat as decay_length_caveat,
    friction_ratios as friction_ratios,
)
from .least_power import least_power_study as least_power_study
from .lubrication import (
    LubricationMap as LubricationMap,
    LubricationPoint as LubricationPoint,
    lubrication_map as lubrication_map,
    lubrication_point as lubrication_point,
    wear_of_materials as wear_of_materials,
)
from .operating_conditions import (
    AMPLITUDE as AMPLITUDE,
    VOLTAGE as VOLTAGE,
    CommandedQuantity as CommandedQuantity,
    commanded_quantity as commanded_quantity,
    level_settings as level_settings,
    own_level as own_level,
    quantity_of_axis as quantity_of_axis,
    require_commanded as require_commanded,
)
from .operating_point import (
    ContactPoint as ContactPoint,
    FrictionPoint as FrictionPoint,
    WearPoint as WearPoint,
    contact_point as contact_point,
)
from .operating_point_batch import (
    NUMBERS as NUMBERS,
    STATUSES as STATUSES,
    PointBatch as PointBatch,
    point_batch as point_batch,
)
from .operating_point_grid import (
    OperatingPoints as OperatingPoints,
    operating_points as operating_points,
    steady_states as steady_states,
)
from .parametric_study import (
    amplitude_study as amplitude_study,
    frequency_study as frequency_study,
    load_study as load_study,
    speed_study as speed_study,
    voltage_study as voltage_study,
    waveform_study as waveform_study,
)
from .power import (
    FiguredPower as FiguredPower,
    PowerToSupply as PowerToSupply,
    larger_power as larger_power,
    power_to_supply as power_to_supply,
)
from .record import (
    AMPLITUDE_SOURCES as AMPLITUDE_SOURCES,
    DECAY_LENGTH_ORIGINS as DECAY_LENGTH_ORIGINS,
    AmplitudeSource as AmplitudeSource,
    DecayLengthOrigin as DecayLengthOrigin,
    MeasuredUnder as MeasuredUnder,
    Rig as Rig,
)
from .resolved_rig import ResolvedRig as ResolvedRig, amplitude_labels as amplitude_labels
from .response_curve import Jump as Jump, RigResponseCurve as RigResponseCurve, rig_response_curve as rig_response_curve
from .responses import (
    FrequencyResponse as FrequencyResponse,
    StartUp as StartUp,
    frequency_grid as frequency_grid,
    frequency_response as frequency_response,
    start_up as start_up,
    structure_in_contact as structure_in_contact,
)
from .simulation import (
    Simulation as Simulation,
    friction_point as friction_point,
    operating_caveats as operating_caveats,
    simulate as simulate,
    wear_point as wear_point,
)
from .vibration import (
    SteadyVibration as SteadyVibration,
    gap_motion as gap_motion,
    steady_vibration as steady_vibration,
)
