"""Power maps of section 4.1: published actuator, example test and efficiency line, with the cube model."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.facts.metrics import efficiency_at, efficiency_coefficient, friction_at_power, power_for_friction
from sonolube.facts.published import PrintedNumber, column_numbers, published_number, si_value, table
from sonolube.models.actuator import linear_amplifier_power
from sonolube.models.friction import dong_2015_half_period_ratio
from sonolube.validation.contacts import STEEL_YIELD_STRENGTH, efficiency_line, uncoated_plate_contact


@dataclass(frozen=True, kw_only=True, slots=True)
class ExamplePoint:
    """One voltage of the example test.

    Parameters
    ----------
    row : int
        Row of Table 4.2, counted from 1.
    voltage_peak_to_peak : float
        Drive voltage, peak to peak. [V]
    actuator_power : float
        Power of the actuator at that voltage. [W]
    friction : PrintedNumber
        Friction with its scatter.
    """

    row: int
    voltage_peak_to_peak: float
    actuator_power: float
    friction: PrintedNumber


def actuator_power(*, voltage_peak_to_peak: ArrayLike) -> Floats:
    """Amplifier's power for the actuator of Table 4.1, driven from zero to its highest voltage, D 1.9. [W]"""
    return linear_amplifier_power(
        capacitance=si_value("table-4.1-capacitance-1"),
        voltage_maximum=voltage_peak_to_peak,
        voltage_peak_to_peak=voltage_peak_to_peak,
        frequency=si_value("table-4.1-frequency-1"),
    )


def vibration_amplitude(*, voltage_peak_to_peak: ArrayLike) -> Floats:
    """Amplitude in proportion to the voltage, through the highest of both in Table 4.1. [m]"""
    columns = table("4.1").columns
    amplitude, voltage = (np.nanmax(columns[name].values) for name in ("vibration_amplitude", "voltage_peak_to_peak"))
    return np.asarray(voltage_peak_to_peak, dtype=np.float64) * (amplitude / voltage)


def example_test() -> dict[str, float]:
    """Friction without vibration, speed, area and load of the example test as arguments of metrics, in SI."""
    return {
        "intrinsic_friction_force": si_value("table-4.2-friction_force-1"),
        "sliding_speed": si_value("4.1.2-sliding-speed"),
        "nominal_area": si_value("4.1.1-nominal-area"),
        "normal_load": si_value("4.1.2-normal-load"),
    }


def example_points() -> tuple[ExamplePoint, ...]:
    """Points of Table 4.2 with vibration."""
    return tuple(
        ExamplePoint(
            row=row,
            voltage_peak_to_peak=voltage.value,
            actuator_power=float(actuator_power(voltage_peak_to_peak=voltage.value)),
            friction=published_number(f"table-4.2-friction_force-{row}"),
        )
        for row, voltage in column_numbers("4.2", "voltage_peak_to_peak").items()
        if voltage.value > 0
    )


def cube_friction(*, voltage_peak_to_peak: ArrayLike, yield_strength: float = STEEL_YIELD_STRENGTH) -> Floats:
    """Friction of the example test by the cube over the separating half period, D 3.15. [N]"""
    test = example_test()
    ratio = dong_2015_half_period_ratio(
        uncoated_plate_contact(yield_strength=yield_strength),
        normal_load=test["normal_load"],
        vibration_amplitude=vibration_amplitude(voltage_peak_to_peak=voltage_peak_to_peak),
    )
    return test["intrinsic_friction_force"] * ratio


def point_efficiency(point: ExamplePoint, *, friction: float) -> float:
    """Efficiency coefficient of the example test at a voltage and a friction, D 4.1. [m2/N]"""
    return float(
        efficiency_coefficient(reduced_friction_force=friction, actuator_power=point.actuator_power, **example_test())
    )


def sufficient_power(test: dict[str, float]) -> float:
    """Power at which the efficiency line has no friction left, D 4.3. [W]"""
    return float(power_for_friction(efficiency_line(), reduced_friction_force=0.0, **test))


def line_friction(test: dict[str, float], *, actuator_power: ArrayLike) -> Floats:
    """Friction at a power on the efficiency line, D 4.4: zero from the sufficient power on. [N]"""
    power = np.minimum(actuator_power, sufficient_power(test))
    return friction_at_power(efficiency_line(), actuator_power=power, **test)


def line_efficiency(*, sliding_speed: ArrayLike) -> Floats:
    """Efficiency coefficient on the efficiency line. [m2/N]"""
    return efficiency_at(efficiency_line(), sliding_speed=sliding_speed)


def line_end() -> float:
    """Sliding speed at which the efficiency line reaches zero. [m/s]"""
    line = efficiency_line()
    return -line.intercept / line.slope
