"""Temperature tests of D 4.3: printed settings, assumptions, heat of friction and vibration, computed histories."""

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.facts.published import column_numbers, si_value
from sonolube.models import thermal
from sonolube.models.contact import ExponentialHeights
from sonolube.models.friction import sine_stick_slip_ratio
from sonolube.reproduction.chapter4.power_map import actuator_power
from sonolube.rig import thermal_solid
from sonolube.validation.contacts import RMS_OVER_ARITHMETIC_MEAN

ROOM_TEMPERATURE: Final = 294.15
"""Room temperature, that of the other tests of D, 21 degC. [K]"""

EXAMPLE_FRICTION_RATIO: Final = 0.9
"""Friction with vibration over friction without in the example: 10 % less at 5.1 and 10.3 V, beyond which it falls
further by an unprinted amount. Kept at 10 % at every voltage, the case of the least cooling. []"""

POWDER_COATING: Final = thermal_solid("powder_coating")
"""Coating of the disc, assumed: a filled thermoset, of which D prints only thickness and hardness."""

_NUT: Final = thermal.ThermalNetwork(heat_capacity=(1.5,), links=(), losses=(0.05,))  # 3 g of steel on a thread

ASSUMED: Final = (
    "Assumed, for D prints none of it: room at 21 degC, coating with 0.25 W/(m K), a coefficient of friction of 0.1 "
    "(E18), a thermocouple that conducts like the nut's stainless steel, the nut 3 g and 0.05 W/K"
)
"""Assumptions of the computed histories, in words."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TemperatureTest:
    """One temperature test: load, speed, and whether the five voltages were applied.

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    sliding_speed : float
        Sliding speed. [m/s]
    vibrated : bool
        Whether the voltages were applied.
    """

    normal_load: float
    sliding_speed: float
    vibrated: bool = True


def voltages() -> Floats:
    """Five voltages, peak to peak. [V]"""
    return _column("voltage_peak_to_peak")


def speeds() -> Floats:
    """Six sliding speeds. [m/s]"""
    return _column("sliding_speed")


def loads() -> Floats:
    """Both loads. [N]"""
    return _column("normal_load")


def dry_heat(*, normal_load: float, sliding_speed: float) -> float:
    """Heat of friction without vibration. [W]"""
    friction = si_value("4.1.3-friction-coated-last") * normal_load  # a coefficient: erratum E18
    return float(thermal.frictional_heat_rate(friction_force=friction, sliding_speed=sliding_speed))


def example_heat() -> float:
    """Heat of friction of the example, 3 N and 220 mm/s, without vibration. [W]"""
    return dry_heat(normal_load=float(loads()[0]), sliding_speed=si_value("4.3.4-example-speed"))


def vibration_heat_window() -> tuple[float, float]:
    """Limits of the fraction of the actuator's power at which the example cools and warms as in D. []

    At 10.3 V the heat of vibration must be less than the loss of frictional heat, at 20.7 V more.
    """
    power = actuator_power(voltage_peak_to_peak=voltages())
    lost = (1 - EXAMPLE_FRICTION_RATIO) * example_heat()
    return lost / float(power[3]), lost / float(power[1])


def vibration_heat_fraction() -> float:
    """Fraction of the actuator's power that heats the contact: the geometric mean of its limits. []"""
    low, high = vibration_heat_window()
    return float(np.sqrt(low * high))


def vibration_heat(fraction: float | None = None) -> Floats:
    """Heat of vibration at the five voltages, by default at the geometric mean of the limits. [W]"""
    share = vibration_heat_fraction() if fraction is None else fraction
    return share * actuator_power(voltage_peak_to_peak=voltages())


def slow_friction_ratio() -> Floats:
    """Friction ratio at the lowest speed and the five voltages by asperity stick-slip. []"""
    return sine_stick_slip_ratio(
        decay_length=RMS_OVER_ARITHMETIC_MEAN * si_value("4.1.3-roughness-coated") / ExponentialHeights().decay,
        vibration_amplitude=_column("vibration_amplitude"),
        frequency=si_value("table-4.4-frequency-1"),
        sliding_speed=float(speeds()[0]),
    )


def heated_contact(*, disc: thermal.ThermalSolid = POWDER_COATING) -> thermal.HeatedContact:
    """Contact of the thermocouple's tip with the disc."""
    pin = thermal_solid("stainless_steel_304")
    radius = float(np.sqrt(si_value("table-4.4-nominal_area-1") / np.pi))
    return thermal.HeatedContact(
        pin=pin, disc=disc, source=thermal.EllipticSource(half_length=radius, half_width=radius), network=_NUT
    )


def history(test: TemperatureTest, *, step: float = 0.25) -> thermal.ContactTemperatureHistory:
    """Computed temperature history of a test."""
    start, dry = si_value("4.3.3-motor-start"), si_value("4.3.3-vibration-start")
    level, rest = si_value("4.3.3-level-duration"), si_value("4.3.3-cooling-duration")
    end = dry + level * voltages().size
    moments = np.arange(0.0, end + rest + step / 2, step)
    middle = (moments[1:] + moments[:-1]) / 2
    turning = (middle > start) & (middle < end)
    shaken = turning & (middle > dry) & test.vibrated
    at_level = np.clip((middle - dry) // level, 0, voltages().size - 1).astype(int)
    friction = si_value("4.1.3-friction-coated-last") * test.normal_load * np.where(shaken, EXAMPLE_FRICTION_RATIO, 1.0)
    return thermal.contact_temperature_history(
        heated_contact(),
        time=moments,
        friction_force=np.where(turning, friction, 0.0),
        sliding_speed=np.where(turning, test.sliding_speed, 0.0),
        vibration_heat_rate=np.where(shaken, vibration_heat()[at_level], 0.0),
    )


@cache
def dry_rises() -> Floats:
    """Temperature rises without vibration at the moment when it starts, by load and speed. [K]"""
    start = si_value("4.3.3-vibration-start")

    def rise(load: float, speed: float) -> float:
        record = history(TemperatureTest(normal_load=load, sliding_speed=speed, vibrated=False))
        return float(np.interp(start, record.time, record.temperature_rise))

    return np.array([[rise(float(load), float(speed)) for speed in speeds()] for load in loads()])


def _column(name: str) -> Floats:
    """Numbers of a column of Table 4.4, in SI."""
    return np.array([number.value for number in column_numbers("4.4", name).values()])
