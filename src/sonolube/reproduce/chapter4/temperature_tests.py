"""The temperature measurements of D 4.3 as its printed numbers describe them, and what is assumed beside them."""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats
from sonolube.friction import sine_stick_slip_ratio
from sonolube.materials import material
from sonolube.thermal import (
    ContactTemperatureHistory,
    EllipticSource,
    HeatedContact,
    ThermalNetwork,
    ThermalSolid,
    contact_temperature_history,
    frictional_heat_rate,
)
from sonolube.validation.inputs import said
from sonolube.validation.power_map import actuator_power, printed

ROOM_TEMPERATURE = 294.15
"""Temperature of the room in K: 21 degC, that of D's other tests."""

FRICTION_KEPT = 0.9
"""Friction with vibration over friction without, in the example: 10 % less at 5.1 and 10.3 V, from there on it falls
further by an amount not printed. Held at 10 % at every voltage, what cools least."""

POWDER_COATING = ThermalSolid(thermal_conductivity=0.25, density=1500.0, specific_heat_capacity=1200.0)
"""The coating of the disc, assumed: a filled thermoset, of which D prints only thickness and hardness."""

_NUT = ThermalNetwork(heat_capacity=(1.5,), links=(), losses=(0.05,))  # 3 g of steel on a thread
_DECAY_LENGTH = 2e-6

ASSUMED = (
    "Assumed, for D prints none of it: room at 21 degC, coating with 0.25 W/(m K), a coefficient of friction of 0.1 "
    "(E18), a thermocouple that conducts like the nut's stainless steel, the nut 3 g and 0.05 W/K"
)


@dataclass(frozen=True, kw_only=True, slots=True)
class TemperatureTest:
    """One of the tests: its load and speed, and how long each level of voltage lasted.

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    sliding_speed : float
        Speed of the sliding. [m/s]
    vibrated : bool
        Whether the voltages were applied.
    """

    normal_load: float
    sliding_speed: float
    vibrated: bool = True


def voltages() -> Floats:
    """Return the five voltages, peak to peak, in V."""
    return np.array([voltage.value for voltage in printed("4.4", "voltage_peak_to_peak").values()])


def speeds() -> Floats:
    """Return the six sliding speeds, in m/s."""
    return np.array([speed.value for speed in printed("4.4", "sliding_speed").values()])


def loads() -> Floats:
    """Return both loads, in N."""
    return np.array([load.value for load in printed("4.4", "normal_load").values()])


def dry_heat(*, normal_load: float, sliding_speed: float) -> float:
    """Return the heat of friction without vibration. [W]

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    sliding_speed : float
        Speed of the sliding. [m/s]

    Returns
    -------
    float
    """
    friction = said("4.1.3-friction-coated-last").value * normal_load  # a coefficient: erratum E18
    return float(frictional_heat_rate(friction_force=friction, sliding_speed=sliding_speed))


def example_heat() -> float:
    """Return the heat of friction of the example, 3 N and 220 mm/s, without vibration. [W]"""
    return dry_heat(normal_load=float(loads()[0]), sliding_speed=said("4.3.4-example-speed").value)


def vibration_heat_window() -> tuple[float, float]:
    """Return the least and greatest share of the actuator's power for which the example cools and warms as D says.

    At 10.3 V the vibration must bring less heat than the friction loses, at 20.7 V more.
    """
    power = actuator_power(voltage_peak_to_peak=voltages())
    lost = (1 - FRICTION_KEPT) * example_heat()
    return lost / float(power[3]), lost / float(power[1])


def vibration_heat_fraction() -> float:
    """Return the geometric mean of that window: what the model takes, since D tells no more. []"""
    low, high = vibration_heat_window()
    return float(np.sqrt(low * high))


def vibration_heat() -> Floats:
    """Return the heat of vibration at the five voltages, in W."""
    return vibration_heat_fraction() * actuator_power(voltage_peak_to_peak=voltages())


def slow_friction_kept() -> Floats:
    """Return what the vibration leaves of friction at the lowest speed and the five voltages, by stick-slip."""
    return sine_stick_slip_ratio(
        decay_length=_DECAY_LENGTH,
        vibration_amplitude=[amplitude.value for amplitude in printed("4.4", "vibration_amplitude").values()],
        frequency=printed("4.4", "frequency")[0].value,
        sliding_speed=float(speeds()[0]),
    )


def heated_contact(*, disc: ThermalSolid = POWDER_COATING) -> HeatedContact:
    """Return the contact of the thermocouple's tip with the disc."""
    steel = material("stainless_steel_304")
    pin = ThermalSolid(
        thermal_conductivity=steel.value("thermal_conductivity"),
        density=steel.value("density"),
        specific_heat_capacity=steel.value("specific_heat_capacity"),
    )
    radius = float(np.sqrt(printed("4.4", "nominal_area")[0].value / np.pi))
    return HeatedContact(pin=pin, disc=disc, source=EllipticSource(half_length=radius, half_width=radius), network=_NUT)


def history(test: TemperatureTest, *, step: float = 0.25) -> ContactTemperatureHistory:
    """Return the computed temperature of a test in time, at steps of `step` seconds."""
    start, dry = said("4.3.3-motor-start").value, said("4.3.3-vibration-start").value
    level, rest = said("4.3.3-level-duration").value, said("4.3.3-cooling-duration").value
    end = dry + level * voltages().size
    moments = np.arange(0.0, end + rest + step / 2, step)
    middle = (moments[1:] + moments[:-1]) / 2
    turning = (middle > start) & (middle < end)
    shaken = turning & (middle > dry) & test.vibrated
    at_level = np.clip((middle - dry) // level, 0, voltages().size - 1).astype(int)
    friction = said("4.1.3-friction-coated-last").value * test.normal_load * np.where(shaken, FRICTION_KEPT, 1.0)
    return contact_temperature_history(
        heated_contact(),
        time=moments,
        friction_force=np.where(turning, friction, 0.0),
        sliding_speed=np.where(turning, test.sliding_speed, 0.0),
        vibration_heat_rate=np.where(shaken, vibration_heat()[at_level], 0.0),
    )
