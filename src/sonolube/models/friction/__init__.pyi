from .bristle import RIGID as RIGID, Holder as Holder
from .elliptical_motion import (
    contact_time_fraction as contact_time_fraction,
    elliptical_traction_ratio as elliptical_traction_ratio,
)
from .laws.coulomb import (
    friction_coefficient as friction_coefficient,
    oblique_vibration_ratio as oblique_vibration_ratio,
    parallel_vibration_ratio as parallel_vibration_ratio,
    torsional_vibration_ratio as torsional_vibration_ratio,
    transverse_vibration_ratio as transverse_vibration_ratio,
)
from .laws.dahl import (
    DahlFriction as DahlFriction,
    dahl_friction_history as dahl_friction_history,
    dahl_under_vibration as dahl_under_vibration,
)
from .laws.lugre import (
    LuGreFriction as LuGreFriction,
    lugre_ratios as lugre_ratios,
    lugre_under_vibration as lugre_under_vibration,
)
from .laws.lugre_stick_slip import (
    SlidingKind as SlidingKind,
    StickSlipHistory as StickSlipHistory,
    lugre_stick_slip as lugre_stick_slip,
)
from .laws.spring_driven_slider import (
    DriveForce as DriveForce,
    spring_driven_slider_force as spring_driven_slider_force,
)
from .lubricant_film import (
    FilmLubricant as FilmLubricant,
    MixedLubrication as MixedLubrication,
    elastohydrodynamic_thickness as elastohydrodynamic_thickness,
    inclined_pad as inclined_pad,
    mixed_lubrication as mixed_lubrication,
)
from .lubrication import (
    BoundaryLubricant as BoundaryLubricant,
    LubricationCoefficients as LubricationCoefficients,
    LubricationMethod as LubricationMethod,
    StribeckCurve as StribeckCurve,
    asperity_load_fraction as asperity_load_fraction,
    best_lubrication_method as best_lubrication_method,
    hersey_number as hersey_number,
    lubrication_coefficients as lubrication_coefficients,
    shared_coefficients as shared_coefficients,
    stribeck_coefficient as stribeck_coefficient,
)
from .metal_cutting import (
    feed_contact_fraction as feed_contact_fraction,
    tool_contact_fraction as tool_contact_fraction,
)
from .metal_forming import (
    ZINC_STRESS_RATIO as ZINC_STRESS_RATIO,
    acoustic_intensity as acoustic_intensity,
    acoustic_softening_ratio as acoustic_softening_ratio,
    drawing_stress as drawing_stress,
    reference_intensity_from_test as reference_intensity_from_test,
    superposed_mean_stress as superposed_mean_stress,
    vibrated_drawing_stress as vibrated_drawing_stress,
)
from .models import (
    FRICTION_MODELS as FRICTION_MODELS,
    FrictionModel as FrictionModel,
    MeanGap as MeanGap,
    ModelParameter as ModelParameter,
    parameter as parameter,
)
from .models.asperity_stick_slip import AsperityStickSlip as AsperityStickSlip
from .models.asperity_stick_slip_batch import (
    SINE_TOLERANCE as SINE_TOLERANCE,
    batched_stick_slip_ratio as batched_stick_slip_ratio,
)
from .models.asperity_stick_slip_sine import (
    EMPIRICAL_MEMORY_LENGTH as EMPIRICAL_MEMORY_LENGTH,
    mindlin_memory_length as mindlin_memory_length,
    sine_stick_slip_ratio as sine_stick_slip_ratio,
    tabulated_stick_slip_ratio as tabulated_stick_slip_ratio,
)
from .models.bristle_with_holder import BristleWithHolder as BristleWithHolder
from .models.coulomb import Coulomb as Coulomb, sliding_power_ratio as sliding_power_ratio
from .models.dong_2015 import (
    Dong2015FullPeriod as Dong2015FullPeriod,
    Dong2015HalfPeriod as Dong2015HalfPeriod,
    Dong2015LoadBalanced as Dong2015LoadBalanced,
    dong_2015_deformation_ratio as dong_2015_deformation_ratio,
    dong_2015_half_period_ratio as dong_2015_half_period_ratio,
)
from .models.kinematic import Kinematic as Kinematic
from .models.range_check import (
    CheckedRatio as CheckedRatio,
    checked_ratio as checked_ratio,
    model_friction as model_friction,
    ratio_caveats as ratio_caveats,
)
from .models.soft_layer import SoftLayerModel as SoftLayerModel
from .models.squeeze_film import PartialLevitation as PartialLevitation, SqueezeFilm as SqueezeFilm
from .oscillating_contact.approximations import (
    approximate_guided_ratio as approximate_guided_ratio,
    approximate_longitudinal_ratio as approximate_longitudinal_ratio,
    approximate_normal_ratio as approximate_normal_ratio,
    approximate_transverse_ratio as approximate_transverse_ratio,
)
from .oscillating_contact.driven_spring import (
    combined_oscillation_ratio as combined_oscillation_ratio,
    guided_critical_speed as guided_critical_speed,
    guided_oscillation_ratio as guided_oscillation_ratio,
)
from .oscillating_contact.exponential_contact import (
    exponential_longitudinal_ratio as exponential_longitudinal_ratio,
    exponential_static_ratio as exponential_static_ratio,
)
from .oscillating_contact.rigid_guide import (
    longitudinal_oscillation_ratio as longitudinal_oscillation_ratio,
    normal_oscillation_ratio as normal_oscillation_ratio,
    tabulated_spring_ratio as tabulated_spring_ratio,
)
from .oscillating_contact.spring_contact import (
    SpringContact as SpringContact,
    critical_speed as critical_speed,
    load_balanced_approach as load_balanced_approach,
    longitudinal_static_ratio as longitudinal_static_ratio,
    normal_static_ratio as normal_static_ratio,
    transverse_static_ratio as transverse_static_ratio,
)
from .soft_counterface import (
    FaceVibrationMode as FaceVibrationMode,
    exponential_layer_ratio as exponential_layer_ratio,
    linear_layer_ratio as linear_layer_ratio,
)
