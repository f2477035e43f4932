from .bulk import (
    HeatedPin as HeatedPin,
    ThermalNetwork as ThermalNetwork,
    network_rise as network_rise,
    pin_conductance as pin_conductance,
    pin_rise as pin_rise,
)
from .contact_history import (
    ContactTemperatureHistory as ContactTemperatureHistory,
    HeatedContact as HeatedContact,
    adiabatic_heat_rate as adiabatic_heat_rate,
    contact_temperature_history as contact_temperature_history,
    frictional_heat_rate as frictional_heat_rate,
    half_wave_bar_energy as half_wave_bar_energy,
    interface_conductance as interface_conductance,
    layer_conductance as layer_conductance,
    superimposed_heat_rate as superimposed_heat_rate,
    vibration_loss_heat_rate as vibration_loss_heat_rate,
)
from .flash import (
    FLASH_MODELS as FLASH_MODELS,
    ContactRise as ContactRise,
    FlashRise as FlashRise,
    MovingRise as MovingRise,
    blok_partition as blok_partition,
    contact_rise as contact_rise,
    flash_rise as flash_rise,
    high_peclet_rise as high_peclet_rise,
    low_peclet_rise as low_peclet_rise,
    moving_ellipse_rise as moving_ellipse_rise,
    peclet_number as peclet_number,
    real_contact_spot as real_contact_spot,
)
from .jaeger import moving_rectangle_rise as moving_rectangle_rise
from .source import (
    EllipticSource as EllipticSource,
    HeatSource as HeatSource,
    HertzianSource as HertzianSource,
    RectangularSource as RectangularSource,
    ThermalSolid as ThermalSolid,
)
