from .asperity import (
    ASPERITY_LAWS as ASPERITY_LAWS,
    AsperityLaw as AsperityLaw,
    ChangEtsionBogy as ChangEtsionBogy,
    ChangEtsionBogy1987 as ChangEtsionBogy1987,
    Dong2015Asperity as Dong2015Asperity,
    ElasticAsperity as ElasticAsperity,
    JacksonGreen as JacksonGreen,
    KogutEtsion as KogutEtsion,
)
from .contact_motion import (
    ContactMotion as ContactMotion,
    GapMotionBatch as GapMotionBatch,
    gap_harmonics as gap_harmonics,
    load_balanced_motion as load_balanced_motion,
    sinusoidal_motion as sinusoidal_motion,
)
from .elastic_bodies import (
    CoatedBody as CoatedBody,
    ContactPair as ContactPair,
    ElasticBody as ElasticBody,
    contact_pair as contact_pair,
    equivalent_plane_strain_modulus as equivalent_plane_strain_modulus,
    identical_materials_mindlin_ratio as identical_materials_mindlin_ratio,
    layer_compliance_ratio as layer_compliance_ratio,
)
from .greenwood_williamson import (
    asperity_area as asperity_area,
    asperity_force as asperity_force,
    critical_interference as critical_interference,
)
from .height_distribution import (
    HEIGHT_DISTRIBUTIONS as HEIGHT_DISTRIBUTIONS,
    ExponentialHeights as ExponentialHeights,
    GaussianHeights as GaussianHeights,
    HeightDistribution as HeightDistribution,
)
from .hertz import (
    SphereOnFlat as SphereOnFlat,
    hertz_axial_shear_stress as hertz_axial_shear_stress,
    hertz_axial_stresses as hertz_axial_stresses,
    hertz_contact_radius as hertz_contact_radius,
    hertz_mean_pressure as hertz_mean_pressure,
    hertz_peak_pressure as hertz_peak_pressure,
    tip_radius_for_pressure as tip_radius_for_pressure,
)
from .persson import (
    PerssonContact as PerssonContact,
    persson_area as persson_area,
    persson_area_fraction as persson_area_fraction,
    persson_load as persson_load,
    persson_separation as persson_separation,
    persson_stiffness as persson_stiffness,
)
from .rough import (
    RoughContact as RoughContact,
    contact_count as contact_count,
    decay_length as decay_length,
    normal_force as normal_force,
    normal_stiffness as normal_stiffness,
    real_contact_area as real_contact_area,
    separation as separation,
    separation_range as separation_range,
)
from .soft_layer import (
    PronySeries as PronySeries,
    SoftLayer as SoftLayer,
    complex_modulus as complex_modulus,
    dynamic_stiffness_ratio as dynamic_stiffness_ratio,
    layer_loss_power as layer_loss_power,
    layer_normal_stiffness as layer_normal_stiffness,
    layer_tangential_stiffness as layer_tangential_stiffness,
    oedometric_modulus as oedometric_modulus,
)
from .squeeze_film import (
    leakage_factor as leakage_factor,
    levitation_amplitude as levitation_amplitude,
    levitation_gap as levitation_gap,
    squeeze_film_pressure as squeeze_film_pressure,
    squeeze_number as squeeze_number,
)
from .tangential_stiffness import (
    DEFAULT_TANGENTIAL_STIFFNESS as DEFAULT_TANGENTIAL_STIFFNESS,
    TANGENTIAL_STIFFNESSES as TANGENTIAL_STIFFNESSES,
    TangentialStiffness as TangentialStiffness,
    cube_tangential_stiffness as cube_tangential_stiffness,
    mindlin_tangential_stiffness as mindlin_tangential_stiffness,
)
from .validity_range import contact_caveats as contact_caveats, exponential_validity_range as exponential_validity_range
