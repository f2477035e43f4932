"""Materials: engineering materials and piezoelectric ceramics, each property with the source it was read from."""

from sonolube.materials.catalogue import Material, SourcedText, SourcedValue, material, material_names
from sonolube.materials.piezoelectric import (
    PiezoCeramic,
    coupling_factors,
    piezo_ceramic,
    piezo_ceramic_from_strain_charge,
    piezo_ceramic_from_stress_charge,
    piezo_ceramic_names,
)

__all__ = [
    "Material",
    "PiezoCeramic",
    "SourcedText",
    "SourcedValue",
    "coupling_factors",
    "material",
    "material_names",
    "piezo_ceramic",
    "piezo_ceramic_from_strain_charge",
    "piezo_ceramic_from_stress_charge",
    "piezo_ceramic_names",
]
