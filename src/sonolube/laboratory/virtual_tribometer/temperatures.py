"""Temperatures of actuator, pin and contact of a virtual rig, and the reading of its thermocouple."""

from math import pi, sqrt

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import SonolubeError
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.heating_assumptions import HeatingAssumptions, capacitive_load
from sonolube.laboratory.virtual_tribometer.disturbances import Disturbances
from sonolube.laboratory.virtual_tribometer.signals import Approach, Lagged
from sonolube.models.thermal import EllipticSource, ThermalSolid, contact_rise
from sonolube.rig import Rig, thermal_solid
from sonolube.rig.excitation import actuator_capacitance

_AT_ONCE = 1e-6  # s, in which the flash rise follows the heat


class Temperatures:
    """Temperatures over time, as heat is set between blocks.

    Parameters
    ----------
    rig : Rig
        Without materials of pin and disc, only the actuator warms.
    assumed : HeatingAssumptions
    sizes : Disturbances
        Place and lag of the thermocouple.

    Notes
    -----
    Actuator and pin have one temperature each, so that both approach a steady one exponentially; the flash rise of the
    contact follows its heat at once. Heat of friction is the mean force of the present setting times the speed.
    """

    def __init__(self, rig: Rig, assumed: HeatingAssumptions, sizes: Disturbances) -> None:
        self._rig, self._assumed, self._share = rig, assumed, sizes.contact_share
        self._capacitance = actuator_capacitance(rig) or 0.0
        self._bodies = _bodies(rig, assumed)
        lag = sizes.thermocouple_time
        times = (
            assumed.actuator_heat_capacity / assumed.actuator_conductance,
            assumed.pin_heat_capacity / assumed.pin_conductance,
            _AT_ONCE,
        )
        self._actuator, self._pin, self._flash = (
            Lagged(Approach(0.0, 0.0, 0.0, time * (1 + 1e-6 * (time == lag))), 0.0, lag) for time in times
        )

    def set(self, time: float, *, setting: DriveSetting | None, friction_force: float, sliding_speed: float) -> float:
        """Steady flash rise of a setting, whose heat counts from a time on; NaN where it is unknown. [K]"""
        assumed, heat = self._assumed, friction_force * sliding_speed
        loss = 0.0 if setting is None else assumed.loss_factor * self._capacitive_power(setting)
        partition, flash = self._contact(heat, sliding_speed)
        self._actuator = self._actuator.towards(loss / assumed.actuator_conductance, time=time)
        self._pin = self._pin.towards(partition * heat / assumed.pin_conductance, time=time)
        self._flash = self._flash.towards(0.0 if np.isnan(flash) else flash, time=time)
        return flash

    def _capacitive_power(self, setting: DriveSetting) -> float:
        """Root-mean-square alternating voltage times root-mean-square current of the actuator as a capacitance. [W]"""
        return capacitive_load(
            capacitance=self._capacitance,
            frequency=setting.frequency,
            voltage_peak_to_peak=setting.voltage_peak_to_peak,
            waveform=setting.waveform,
        ).apparent_power

    def reading(self, time: Floats) -> Floats:
        """Temperature that the thermocouple reads. [K]"""
        rise = (1 - self._share) * self._actuator.at(time)
        if self._share:
            rise = rise + self._share * (self._pin.at(time) + self._flash.at(time))
        return np.asarray(self._assumed.ambient_temperature + rise)

    def rises(self, time: float) -> tuple[float, float]:
        """Rise of actuator and of pin at a time, without lag. [K]"""
        at = np.asarray(time)
        return float(self._actuator.source.at(at)), float(self._pin.source.at(at))

    def _contact(self, heat: float, sliding_speed: float) -> tuple[float, float]:
        """Share of heat into the pin, and mean flash rise of the contact."""
        if self._bodies is None:
            return 0.0, float("nan")
        radius = sqrt(self._rig.contact.nominal_area / pi)
        source = EllipticSource(half_length=radius, half_width=radius)
        found = contact_rise(*self._bodies, source, heat_rate=heat, sliding_speed=sliding_speed)
        return float(found.heat_partition), float(found.mean_temperature_rise)


def _bodies(rig: Rig, assumed: HeatingAssumptions) -> tuple[ThermalSolid, ThermalSolid] | None:
    """Pin and disc; None where a material or one of its properties is unknown."""
    pin, disc = assumed.pin_material or rig.pin_material, assumed.disc_material or rig.disc_material
    if pin is None or disc is None:
        return None
    try:
        return thermal_solid(pin), thermal_solid(disc)
    except SonolubeError:
        return None
