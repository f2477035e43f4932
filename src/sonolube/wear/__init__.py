"""Wear: Archard's law, the cube model with and without vibration, and the wear mechanism of a material pair."""

from sonolube.wear.archard import ArchardWear, archard_wear_rate
from sonolube.wear.cube import (
    cube_wear_rate,
    full_period_wear_ratio,
    half_period_wear_ratio,
    load_balanced_wear_ratio,
    vibrating_cube_wear_rate,
)
from sonolube.wear.measures import mass_loss, specific_wear_rate, vibration_contact_count
from sonolube.wear.mechanism import (
    CrystalStructure,
    VibrationEffect,
    WearMechanism,
    WearMechanismAssessment,
    WearPairBody,
    assess_wear_mechanism,
)
from sonolube.wear.models import DEFAULT_WEAR_MODEL, WEAR_MODELS

__all__ = [
    "DEFAULT_WEAR_MODEL",
    "WEAR_MODELS",
    "ArchardWear",
    "CrystalStructure",
    "VibrationEffect",
    "WearMechanism",
    "WearMechanismAssessment",
    "WearPairBody",
    "archard_wear_rate",
    "assess_wear_mechanism",
    "cube_wear_rate",
    "full_period_wear_ratio",
    "half_period_wear_ratio",
    "load_balanced_wear_ratio",
    "mass_loss",
    "specific_wear_rate",
    "vibrating_cube_wear_rate",
    "vibration_contact_count",
]
