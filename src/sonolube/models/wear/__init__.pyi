from .archard import (
    ArchardWear as ArchardWear,
    archard_wear_rate as archard_wear_rate,
    vibration_contact_count as vibration_contact_count,
)
from .cube import (
    DEFAULT_WEAR_MODEL as DEFAULT_WEAR_MODEL,
    WEAR_MODELS as WEAR_MODELS,
    cube_wear_rate as cube_wear_rate,
    full_period_wear_ratio as full_period_wear_ratio,
    half_period_wear_ratio as half_period_wear_ratio,
    load_balanced_wear_ratio as load_balanced_wear_ratio,
    vibrating_cube_wear_rate as vibrating_cube_wear_rate,
)
from .mechanism import (
    CrystalStructure as CrystalStructure,
    VibrationEffect as VibrationEffect,
    WearMechanism as WearMechanism,
    WearMechanismAssessment as WearMechanismAssessment,
    WearPairBody as WearPairBody,
    assess_wear_mechanism as assess_wear_mechanism,
)
