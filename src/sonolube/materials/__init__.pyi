from .catalogue import (
    Material as Material,
    SourcedText as SourcedText,
    SourcedValue as SourcedValue,
    material as material,
    material_names as material_names,
)
from .piezoelectric import (
    PiezoCeramic as PiezoCeramic,
    coupling_factors as coupling_factors,
    piezo_ceramic as piezo_ceramic,
    piezo_ceramic_from_strain_charge as piezo_ceramic_from_strain_charge,
    piezo_ceramic_from_stress_charge as piezo_ceramic_from_stress_charge,
    piezo_ceramic_names as piezo_ceramic_names,
)
