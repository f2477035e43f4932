"""Heat of friction and vibration: flash temperature, partition, bulk rise, transients."""

from sonolube.thermal.bulk import (
    HeatedDisc,
    HeatedPin,
    disc_track_rise,
    half_space_rise,
    lumped_rise,
    pin_conductance,
    pin_rise,
)
from sonolube.thermal.flash import (
    ContactHeat,
    FlashRise,
    blok_partition,
    contact_rise,
    fast_rise,
    flash_rise,
    peclet_number,
    stationary_rise,
)
from sonolube.thermal.jaeger import moving_band_rise, moving_rectangle_rise
from sonolube.thermal.network import ThermalNetwork, network_rise
from sonolube.thermal.solid import ThermalSolid
from sonolube.thermal.source import EllipticSource, HeatSource, HertzianSource, RectangularSource
from sonolube.thermal.contact_history import (
    ContactHistory,
    HeatedContact,
    frictional_heat_rate,
    superimposed_heat_rate,
    two_factor_history,
)
from sonolube.thermal.vibration_heat import (
    half_wave_energy,
    inferred_conductance,
    layer_conductance,
    loss_heat_rate,
    warming_heat_rate,
)

__all__ = [
    "ContactHeat",
    "ContactHistory",
    "EllipticSource",
    "FlashRise",
    "HeatSource",
    "HeatedContact",
    "HeatedDisc",
    "HeatedPin",
    "HertzianSource",
    "RectangularSource",
    "ThermalNetwork",
    "ThermalSolid",
    "blok_partition",
    "contact_rise",
    "disc_track_rise",
    "fast_rise",
    "flash_rise",
    "frictional_heat_rate",
    "half_space_rise",
    "half_wave_energy",
    "inferred_conductance",
    "layer_conductance",
    "loss_heat_rate",
    "lumped_rise",
    "moving_band_rise",
    "moving_rectangle_rise",
    "network_rise",
    "peclet_number",
    "pin_conductance",
    "pin_rise",
    "stationary_rise",
    "superimposed_heat_rate",
    "two_factor_history",
    "warming_heat_rate",
]
