"""Contact temperature history: energy balance and proportionality to the heat of friction and of vibration."""

import numpy as np
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.thermal import (
    EllipticSource,
    HeatedContact,
    ThermalNetwork,
    ThermalSolid,
    contact_rise,
    contact_temperature_history,
    frictional_heat_rate,
    superimposed_heat_rate,
)

STEEL = ThermalSolid(thermal_conductivity=16.2, density=8000.0, specific_heat_capacity=500.0)
COATING = ThermalSolid(thermal_conductivity=0.25, density=1500.0, specific_heat_capacity=1200.0)
CONTACT = HeatedContact(
    pin=STEEL,
    disc=COATING,
    source=EllipticSource(half_length=2e-4, half_width=2e-4),
    network=ThermalNetwork(heat_capacity=(1.5,), links=(), losses=(0.05,)),
)
TIME = np.linspace(0.0, 40.0, 2001)


def test_the_work_of_friction_is_stored_in_the_pin_lost_or_taken_by_the_disc() -> None:
    middle = (TIME[1:] + TIME[:-1]) / 2
    friction = np.where(middle < 20, 0.3, 0.0)
    record = contact_temperature_history(CONTACT, time=TIME, friction_force=friction, sliding_speed=0.2)
    step = TIME[1]
    into_disc = np.sum((1 - record.heat_partition) * record.heat_rate) * step
    lost = 0.05 * np.sum((record.bulk_rise[1:] + record.bulk_rise[:-1]) / 2) * step
    stored = 1.5 * record.bulk_rise[-1]
    assert into_disc + lost + stored == approx(0.3 * 0.2 * 20.0, rel=1e-5)


def test_the_contact_is_warmer_than_the_bulk_by_the_flash_rise() -> None:
    record = contact_temperature_history(CONTACT, time=TIME, friction_force=0.3, sliding_speed=0.2)
    flash = contact_rise(STEEL, COATING, CONTACT.source, heat_rate=0.06, sliding_speed=0.2).mean_temperature_rise
    assert record.temperature_rise[1:] - record.bulk_rise[1:] == approx(np.full(2000, flash))


def test_the_rise_is_proportional_to_frictional_heat_plus_heat_of_vibration() -> None:
    def end(friction: float, vibration: float) -> float:
        record = contact_temperature_history(
            CONTACT, time=TIME, friction_force=friction, sliding_speed=0.2, vibration_heat_rate=vibration
        )
        return float(record.temperature_rise[-1])

    assert end(0.27, 0.0) == approx(0.9 * end(0.3, 0.0))
    assert end(0.27, 0.006) == approx(end(0.3, 0.0))  # the 6 mW that friction lost
    assert end(0.27, 0.012) > end(0.3, 0.0)


def test_the_published_heat_rate_is_friction_times_the_superimposed_speed_of_table_4_5() -> None:
    heat = superimposed_heat_rate(friction_force=0.5, sliding_speed=0.220, vibration_velocity=0.319)
    assert heat == approx(0.5 * np.hypot(0.220, 0.319 / np.pi))
    assert superimposed_heat_rate(friction_force=0.5, sliding_speed=0.2, vibration_velocity=0.0) == approx(
        frictional_heat_rate(friction_force=0.5, sliding_speed=0.2)
    )


def test_friction_forces_that_do_not_fit_the_times_are_refused() -> None:
    with raises(InvalidInput, match="one value for each interval of time"):
        contact_temperature_history(CONTACT, time=[0.0, 1.0, 2.0], friction_force=[0.1, 0.1, 0.1], sliding_speed=0.1)
