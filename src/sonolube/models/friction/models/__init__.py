"""Friction models: the mean friction ratio under a given motion of the gap, one model a file."""

from sonolube.models.friction.models.model import FrictionModel, MeanGap, ModelParameter, parameter
from sonolube.variants import VariantTable

__all__ = ["FRICTION_MODELS", "FrictionModel", "MeanGap", "ModelParameter", "parameter"]

FRICTION_MODELS: VariantTable[type[FrictionModel]] = VariantTable(
    "friction model",
    {
        "asperity_stick_slip": "sonolube.models.friction.models.asperity_stick_slip:AsperityStickSlip",
        "bristle_with_holder": "sonolube.models.friction.models.bristle_with_holder:BristleWithHolder",
        "coulomb": "sonolube.models.friction.models.coulomb:Coulomb",
        "dahl": "sonolube.models.friction.models.dahl:Dahl",
        "kinematic": "sonolube.models.friction.models.kinematic:Kinematic",
        "lugre": "sonolube.models.friction.models.lugre:LuGre",
        "dong_2015_full_period": "sonolube.models.friction.models.dong_2015:Dong2015FullPeriod",
        "dong_2015_half_period": "sonolube.models.friction.models.dong_2015:Dong2015HalfPeriod",
        "dong_2015_load_balanced": "sonolube.models.friction.models.dong_2015:Dong2015LoadBalanced",
        "soft_layer": "sonolube.models.friction.models.soft_layer:SoftLayerModel",
        "squeeze_film": "sonolube.models.friction.models.squeeze_film:SqueezeFilm",
    },
)
"""Friction models by name; a new model takes its file and one line here."""
