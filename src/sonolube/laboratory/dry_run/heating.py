"""Temperatures of contact and actuator over the time line of a protocol, by lumped bodies and the flash rise."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from sonolube.checks import Floats
from sonolube.laboratory.heating_assumptions import HeatingAssumptions as HeatingAssumptions
from sonolube.models.thermal import EllipticSource, HeatedContact, ThermalNetwork, ThermalSolid
from sonolube.models.thermal.contact_history import contact_temperature_history
from sonolube.models.thermal.network import network_rise

_POINTS = 400  # of the time line, at least
_MAX_PARTS = 200  # of one interval between set points


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatedInterval:
    """Time between two set points with its heat.

    Parameters
    ----------
    duration : float
        [s]
    sliding_speed : float
        [m/s]
    friction_force : float
        [N]
    actuator_heat_rate : float
        Heat of the actuator, in W.
    """

    duration: float
    sliding_speed: float
    friction_force: float
    actuator_heat_rate: float


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


@dataclass(frozen=True, kw_only=True, slots=True)
class RubbedBodies:
    """Materials of pin and disc, and their nominal contact.

    Parameters
    ----------
    pin, disc : ThermalSolid
    nominal_area : float
        [m2]
    """

    pin: ThermalSolid
    disc: ThermalSolid
    nominal_area: float


def heating_over(
    intervals: Sequence[HeatedInterval], *, bodies: RubbedBodies | None, assumed: HeatingAssumptions
) -> Heating | None:
    """Temperature rises over successive intervals of constant heat, from ambient temperature.

    None where no time passes.
    """
    lasting = [each for each in intervals if each.duration > 0]
    if not lasting:
        return None
    longest = sum(each.duration for each in lasting) / _POINTS
    parts = [min(max(ceil(each.duration / longest), 1), _MAX_PARTS) for each in lasting]
    steps = np.repeat([each.duration / count for each, count in zip(lasting, parts, strict=True)], parts)
    time = np.concatenate([[0.0], np.cumsum(steps)])
    speed, force, heat = (
        np.repeat([getattr(each, name) for each in lasting], parts)
        for name in ("sliding_speed", "friction_force", "actuator_heat_rate")
    )
    actuator = ThermalNetwork(
        heat_capacity=(assumed.actuator_heat_capacity,), links=(), losses=(assumed.actuator_conductance,)
    )
    contact_rise = pin_rise = None
    if bodies is not None:
        history = contact_temperature_history(
            _contact(bodies, assumed), time=time, friction_force=force, sliding_speed=speed
        )
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


def _contact(bodies: RubbedBodies, assumed: HeatingAssumptions) -> HeatedContact:
    """Contact of pin and disc, taken as circular."""
    radius = float(np.sqrt(bodies.nominal_area / np.pi))
    network = ThermalNetwork(heat_capacity=(assumed.pin_heat_capacity,), links=(), losses=(assumed.pin_conductance,))
    source = EllipticSource(half_length=radius, half_width=radius)
    return HeatedContact(pin=bodies.pin, disc=bodies.disc, source=source, network=network)
