"""Wear models by name: ratios of the wear rates with and without vibration under a given motion of the gap."""

from collections.abc import Callable

from sonolube.checks import Floats
from sonolube.models.contact.contact_motion import ContactMotion
from sonolube.models.contact.rough import RoughContact
from sonolube.variants import VariantTable

WEAR_MODELS: VariantTable[Callable[[RoughContact, ContactMotion], Floats]] = VariantTable(
    "wear model",
    {
        "dong_2015_full_period": "sonolube.models.wear.cube:full_period_wear_ratio",
        "dong_2015_half_period": "sonolube.models.wear.cube:half_period_wear_ratio",
        "dong_2015_load_balanced": "sonolube.models.wear.cube:load_balanced_wear_ratio",
    },
)
"""Wear models by name; a new model takes its file and one line here."""

DEFAULT_WEAR_MODEL = "dong_2015_half_period"
"""Model by which the wear tables of the dissertation were computed."""
