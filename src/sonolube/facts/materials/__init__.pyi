from .catalogue import (
    Material as Material,
    SourcedText as SourcedText,
    SourcedValue as SourcedValue,
    material as material,
    material_classes as material_classes,
    material_families as material_families,
    material_names as material_names,
)
from .pair_friction import (
    TABOR_FACTOR as TABOR_FACTOR,
    DryFriction as DryFriction,
    FrictionPair as FrictionPair,
    YieldStrengthEstimate as YieldStrengthEstimate,
    dry_friction as dry_friction,
    dry_friction_classes as dry_friction_classes,
    dry_friction_pairs as dry_friction_pairs,
    yield_strength_from_hardness as yield_strength_from_hardness,
)
from .piezoelectric import (
    PiezoCeramic as PiezoCeramic,
    piezo_ceramic as piezo_ceramic,
    piezo_ceramic_from_strain_charge as piezo_ceramic_from_strain_charge,
    piezo_ceramic_from_stress_charge as piezo_ceramic_from_stress_charge,
    piezo_ceramic_names as piezo_ceramic_names,
)
