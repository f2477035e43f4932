"""Models of the flash temperature under a sliding source, by name."""

from sonolube.models.thermal.flash import MovingRise
from sonolube.variants import VariantTable

FLASH_MODELS: VariantTable[MovingRise] = VariantTable(
    "flash temperature model",
    {
        "quadrature": "sonolube.models.thermal.flash:moving_ellipse_rise",
        "tian_kennedy_1994": "sonolube.models.thermal.flash:flash_rise",
    },
)
"""Models of the flash temperature by name: the integral over a uniform ellipse, and the published interpolation."""
