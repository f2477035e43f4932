"""Temperatures of contact and actuator over the time line of a protocol, by lumped bodies and the flash rise."""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats
from sonolube.laboratory.heating_assumptions import HeatingAssumptions
from sonolube.models.thermal import EllipticSource, HeatedContact, ThermalNetwork, ThermalSolid
from sonolube.models.thermal.contact_history import contact_temperature_history
from sonolube.models.thermal.network import network_rise

_POINTS = 400  # of the time line, at least
_MAX_PARTS = 200  # of one interval between set points


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


def heating_over(
    *,
    duration: Floats,
    friction_force: Floats,
    sliding_speed: Floats,
    actuator_heat_rate: Floats,
    bodies: HeatedContact | None,
    assumed: HeatingAssumptions,
) -> Heating | None:
    """Temperature rises over successive intervals of constant heat, from ambient temperature.

    None where no time passes.
    """
    lasts = duration > 0
    if not lasts.any():
        return None
    longest = sum(duration[lasts].tolist()) / _POINTS
    parts = np.clip(np.ceil(duration[lasts] / longest), 1, _MAX_PARTS).astype(int)
    steps = np.repeat(duration[lasts] / parts, parts)
    time = np.concatenate([[0.0], np.cumsum(steps)])
    speed, force, heat = (np.repeat(each[lasts], parts) for each in (sliding_speed, friction_force, actuator_heat_rate))
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
