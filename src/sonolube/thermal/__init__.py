"""Heat of friction and vibration: flash temperature, heat partition, bulk temperature and thermal networks."""

from sonolube.thermal.bulk import (
    HeatedDisc,
    HeatedPin,
    disc_track_rise,
    half_space_rise,
    lumped_rise,
    pin_conductance,
    pin_rise,
)
from sonolube.thermal.contact_history import (
    ContactTemperatureHistory,
    HeatedContact,
    contact_temperature_history,
    frictional_heat_rate,
    superimposed_heat_rate,
)
from sonolube.thermal.flash import (
    ContactRise,
    FlashRise,
    blok_partition,
    contact_rise,
    flash_rise,
    high_peclet_rise,
    low_peclet_rise,
    peclet_number,
)
from sonolube.thermal.jaeger import moving_band_rise, moving_rectangle_rise
from sonolube.thermal.network import ThermalNetwork, network_rise
from sonolube.thermal.solid import ThermalSolid
from sonolube.thermal.source import EllipticSource, HeatSource, HertzianSource, RectangularSource
from sonolube.thermal.vibration_heat import (
    adiabatic_heat_rate,
    half_wave_bar_energy,
    interface_conductance,
    layer_conductance,
    vibration_loss_heat_rate,
)

__all__ = [
    "ContactRise",
    "ContactTemperatureHistory",
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
    "adiabatic_heat_rate",
    "blok_partition",
    "contact_rise",
    "contact_temperature_history",
    "disc_track_rise",
    "flash_rise",
    "frictional_heat_rate",
    "half_space_rise",
    "half_wave_bar_energy",
    "high_peclet_rise",
    "interface_conductance",
    "layer_conductance",
    "low_peclet_rise",
    "lumped_rise",
    "moving_band_rise",
    "moving_rectangle_rise",
    "network_rise",
    "peclet_number",
    "pin_conductance",
    "pin_rise",
    "superimposed_heat_rate",
    "vibration_loss_heat_rate",
]
