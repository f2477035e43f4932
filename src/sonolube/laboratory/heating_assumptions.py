"""Thermal properties of a rig that its file does not hold, and the load of an actuator as a capacitance."""

from dataclasses import dataclass
from math import pi

import numpy as np

from sonolube.checks import require_non_negative, require_positive
from sonolube.laboratory.devices import DriveSetting
from sonolube.models.actuator import AmplifierRequirements, Drive, amplifier_requirements
from sonolube.rig.driven_rig import DriveVoltage


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatingAssumptions:
    """Thermal properties that a rig file does not hold; each body has one temperature (first order).

    Parameters
    ----------
    pin_heat_capacity : float
        Heat that warms the pin by a kelvin, in J/K; that of `sonolube thermal`.
    pin_conductance : float
        Heat that leaves the pin per kelvin, in W/K; that of `sonolube thermal`.
    actuator_heat_capacity : float
        Heat that warms the actuator by a kelvin, in J/K; 70 g of PZT at 350 J/(kg K).
    actuator_conductance : float
        Heat that leaves the actuator per kelvin, in W/K; 20 cm2 in an air stream at 50 W/(m2 K).
    loss_factor : float
        Heat of the actuator over its capacitive power.
    ambient_temperature : float
        21 degC by D Table 2.2. [K]
    pin_material, disc_material : str or None
        Of the catalogue, instead of those of rig and protocol.

    Notes
    -----
    The loss factor holds dielectric and mechanical losses together. It is the one with which 28 V peak to peak at
    22 kHz on 360 nF warm the actuator by the 10 K of D Table 2.2 (31 against 21 degC, cooled by air) at this
    conductance. Dielectric loss alone would be near 0.02.
    """

    pin_heat_capacity: float = 1.5
    pin_conductance: float = 0.05
    actuator_heat_capacity: float = 24.5
    actuator_conductance: float = 0.1
    loss_factor: float = 0.205
    ambient_temperature: float = 294.15
    pin_material: str | None = None
    disc_material: str | None = None

    def __post_init__(self) -> None:
        require_positive(
            pin_heat_capacity=self.pin_heat_capacity,
            pin_conductance=self.pin_conductance,
            actuator_heat_capacity=self.actuator_heat_capacity,
            actuator_conductance=self.actuator_conductance,
            ambient_temperature=self.ambient_temperature,
        )
        require_non_negative(loss_factor=self.loss_factor)


def capacitive_load(setting: DriveSetting, *, capacitance: float) -> AmplifierRequirements:
    """Current, slew rate and power of a drive on a capacitance, summed over its harmonics."""
    f = setting.frequency
    drive = Drive(frequency=f, voltage_peak_to_peak=setting.voltage_peak_to_peak, waveform=setting.waveform)
    harmonics = np.atleast_1d(DriveVoltage(drive=drive).harmonics())
    admittance = 2j * pi * f * capacitance * np.arange(1, harmonics.size + 1)
    return amplifier_requirements(admittance=admittance, voltage_amplitude=harmonics, frequency=f)
