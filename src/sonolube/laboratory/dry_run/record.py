"""Records of a dry run, with the load of the drive on its amplifier and the temperatures of contact and actuator.

Temperatures follow by lumped bodies and the flash rise.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.facts.protocol import Protocol, SetPoint
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.heating_assumptions import HeatingAssumptions, capacitive_load
from sonolube.models.actuator import linear_amplifier_power
from sonolube.models.thermal import EllipticSource, HeatedContact, ThermalNetwork, ThermalSolid
from sonolube.models.thermal.bulk import network_rise
from sonolube.models.thermal.contact_history import contact_temperature_history
from sonolube.rig import PowerToSupply, power_to_supply


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveLoad:
    """Electrical load of a drive setting on the amplifier.

    Parameters
    ----------
    peak_current : float
        Greatest magnitude of the current of the capacitance; `power` has it with that of the motion. [A]
    slew_rate : float
        Greatest rate of change of the voltage. [V/s]
    power : PowerToSupply
        Power that the amplifier has to supply.
    capacitive_power : float
        Root-mean-square alternating voltage times root-mean-square current of the capacitance, in W.
    """

    peak_current: float
    slew_rate: float
    power: PowerToSupply
    capacitive_power: float


def _power(charging_power: float, dissipated_power: float | None, peak_current: float | None = None) -> PowerToSupply:
    """Power to supply where the charge of the capacitance is known."""
    found = power_to_supply(charging_power=charging_power, dissipated_power=dissipated_power, peak_current=peak_current)
    assert found is not None
    return found


def drive_load(
    setting: DriveSetting | None,
    *,
    capacitance: float,
    dissipated_power: float | None = None,
    peak_current: float | None = None,
) -> DriveLoad:
    r"""Load of a drive setting on the amplifier.

    Parameters
    ----------
    setting : DriveSetting or None
        None for off.
    capacitance : float
        Capacitance of the actuator. [F]
    dissipated_power : float or None
        Heat of the motion; None where it is not known. [W]
    peak_current : float or None
        Greatest magnitude of the current with that of the motion; None where it is not known. [A]

    Returns
    -------
    DriveLoad

    Raises
    ------
    InvalidInput
        If the capacitance is not positive.

    Notes
    -----
    A sine of the peak-to-peak voltage :math:`U` on the capacitance :math:`C` has the current amplitude and the steepest
    slope

    .. math:: \hat I = \pi f C U, \qquad \dot U_{max} = \pi f U

    Other waveforms are summed over 64 harmonics: the current of a square or sawtooth is limited by the amplifier alone,
    and that of a triangle comes out 18 % too high, by the overshoot of a truncated series.
    The current of the motion, largest at resonance, comes on top.
    """
    require_positive(capacitance=capacitance)
    if setting is None:
        return DriveLoad(peak_current=0.0, slew_rate=0.0, power=_power(0.0, 0.0), capacitive_power=0.0)
    need = capacitive_load(setting, capacitance=capacitance)
    charge = linear_amplifier_power(
        capacitance=capacitance,
        voltage_maximum=setting.voltage_maximum,
        voltage_peak_to_peak=setting.voltage_peak_to_peak,
        frequency=setting.frequency,
    )
    return DriveLoad(
        peak_current=need.peak_current,
        slew_rate=need.slew_rate,
        power=_power(float(charge), dissipated_power, peak_current),
        capacitive_power=need.apparent_power,
    )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Heating:
    """Temperature rises over the time line of a protocol, prompts left out.

    Parameters
    ----------
    time : ndarray, shape (n,)
        [s]
    contact_rise : ndarray or None, shape (n,)
        Mean rise of the contact, flash included, just before each time, in K; None where materials are unknown.
    pin_rise : ndarray or None, shape (n,)
        Rise of the pin, in K.
    actuator_rise : ndarray, shape (n,)
        In K.
    frictional_heat : float
        Work of friction over the whole test, in J.
    actuator_heat : float
        Heat of the actuator over the whole test, in J.
    ambient_temperature : float
        [K]
    """

    time: Floats
    contact_rise: Floats | None
    pin_rise: Floats | None
    actuator_rise: Floats
    frictional_heat: float
    actuator_heat: float
    ambient_temperature: float


SAMPLE_SIZE: Final = 8
"""Bytes of one sample of a raw block."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PlannedPoint:
    """Set point of a protocol with amplitude, friction and current of a rig; None where unknown.

    Parameters
    ----------
    setting : SetPoint
    duration : float
        Until the next set point. [s]
    content : str
        What a prompt asks, a check looks at, or a wait is for.
    sliding_speed : float or None
        [m/s]
    vibration_amplitude : float or None
        Vibration of the contact, zero to peak. [m]
    friction_force : float or None
        Mean friction force. [N]
    load : DriveLoad or None
    dissipated_power : float or None
        Heat of the motion. [W]
    peak_current : float or None
        Greatest magnitude of the current with that of the motion. [A]
    """

    setting: SetPoint
    duration: float
    content: str = ""
    sliding_speed: float | None = None
    vibration_amplitude: float | None = None
    friction_force: float | None = None
    load: DriveLoad | None = None
    dissipated_power: float | None = None
    peak_current: float | None = None

    @property
    def recorded(self) -> float:
        """Time that is recorded from here on. [s]"""
        return (self.setting.recorded_until or self.setting.time) - self.setting.time


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DryRun:
    """Planned course of a protocol.

    Parameters
    ----------
    protocol : Protocol
    rig_title : str
        Empty without a rig.
    points : tuple of PlannedPoint
        One a set point, the end included.
    duration : float
        Time without prompts. [s]
    prompt_time : float
        Time that prompts are taken to need, in s.
    heating : Heating or None
        Temperatures over the time line.
    refusals : tuple of str
        What makes the test impossible or ends it early, each in one line.
    caveats : tuple of str
        What else to know before it, each in one line.
    assumptions : mapping of str to str
    """

    protocol: Protocol
    rig_title: str
    points: tuple[PlannedPoint, ...]
    duration: float
    prompt_time: float
    heating: Heating | None = None
    refusals: tuple[str, ...] = ()
    caveats: tuple[str, ...] = ()
    assumptions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def recordings(self) -> list[PlannedPoint]:
        """Points at which a recording begins."""
        return [point for point in self.points if point.setting.begins_recording]

    @property
    def samples(self) -> int:
        """Number of samples of all recordings and channels."""
        begins = ((point.recorded, point.setting) for point in self.recordings)
        return sum(round(lasts * (at.sample_rate or 0.0)) * len(at.channels) for lasts, at in begins)

    @property
    def bytes(self) -> int:
        """Size of the raw blocks."""
        return SAMPLE_SIZE * self.samples

    @property
    def amplifier_energy(self) -> float | None:
        """Energy that the amplifier has to supply; None where it is not known. [J]"""
        loads = [(point.load, point.duration) for point in self.points]
        if any(load is None for load, _ in loads):
            return None
        return sum(load.power.power_to_supply * lasts for load, lasts in loads if load is not None)


_POINTS = 400  # of the time line, at least
_MAX_PARTS = 200  # of one interval between set points


def heating_over(
    points: Sequence[PlannedPoint], *, bodies: HeatedContact | None, assumed: HeatingAssumptions
) -> Heating | None:
    """Temperature rises over successive points of constant heat, from ambient temperature.

    None where no time passes.
    """
    lasting = [point for point in points if point.duration > 0]
    if not lasting:
        return None
    duration = np.array([point.duration for point in lasting])
    parts = np.clip(np.ceil(duration / (sum(duration.tolist()) / _POINTS)), 1, _MAX_PARTS).astype(int)
    steps = np.repeat(duration / parts, parts)
    time = np.concatenate([[0.0], np.cumsum(steps)])
    powers = [point.load.capacitive_power if point.load else 0.0 for point in lasting]
    heat = np.repeat(assumed.loss_factor * np.array(powers), parts)
    speed, force = (
        np.repeat([getattr(point, name) or 0.0 for point in lasting], parts)
        for name in ("sliding_speed", "friction_force")
    )
    actuator = ThermalNetwork(
        heat_capacity=(assumed.actuator_heat_capacity,), links=(), losses=(assumed.actuator_conductance,)
    )
    contact_rise = pin_rise = None
    if bodies is not None:
        history = contact_temperature_history(bodies, time=time, friction_force=force, sliding_speed=speed)
        contact_rise, pin_rise = history.temperature_rise, history.bulk_rise
    return Heating(
        time=time,
        contact_rise=contact_rise,
        pin_rise=pin_rise,
        actuator_rise=network_rise(actuator, time=time, heat_rate=heat[:, np.newaxis])[:, 0],
        frictional_heat=float(np.sum(force * speed * steps)),
        actuator_heat=float(np.sum(heat * steps)),
        ambient_temperature=assumed.ambient_temperature,
    )


def rubbed_contact(
    pin: ThermalSolid, disc: ThermalSolid, *, nominal_area: float, assumed: HeatingAssumptions
) -> HeatedContact:
    """Contact of pin and disc, taken as circular."""
    radius = float(np.sqrt(nominal_area / np.pi))
    network = ThermalNetwork(heat_capacity=(assumed.pin_heat_capacity,), links=(), losses=(assumed.pin_conductance,))
    source = EllipticSource(half_length=radius, half_width=radius)
    return HeatedContact(pin=pin, disc=disc, source=source, network=network)
