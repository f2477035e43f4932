"""The two factors of a contact's temperature under vibration: less heat of friction, more heat of vibration."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.metrics import superimposed_speed
from sonolube.thermal.flash import contact_rise
from sonolube.thermal.network import ThermalNetwork, network_rise
from sonolube.thermal.solid import ThermalSolid
from sonolube.thermal.source import HeatSource


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatedContact:
    """A pin and a moving body that rub, and what carries the pin's heat away.

    Parameters
    ----------
    pin : ThermalSolid
        The body that carries the contact with it.
    disc : ThermalSolid
        The body that the contact passes over.
    source : HeatSource
        The contact.
    network : ThermalNetwork
        The pin, its first body, and what it is joined to.
    """

    pin: ThermalSolid
    disc: ThermalSolid
    source: HeatSource
    network: ThermalNetwork


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactTemperatureHistory:
    """Temperature of a contact in time.

    Parameters
    ----------
    time : ndarray, shape (n,)
        The times. [s]
    temperature_rise : ndarray, shape (n,)
        Mean rise of the contact just before each time: bulk and flash. [K]
    bulk_rise : ndarray, shape (n,)
        What of it is the pin's bulk, in K.
    heat_rate : ndarray, shape (n - 1,)
        Heat of the contact from each time to the next. [W]
    heat_partition : ndarray, shape (n - 1,)
        Share of that heat that flows into the pin. []
    """

    time: Floats
    temperature_rise: Floats
    bulk_rise: Floats
    heat_rate: Floats
    heat_partition: Floats


def frictional_heat_rate(*, friction_force: ArrayLike, sliding_speed: ArrayLike) -> Floats:
    """Return the work that friction turns into heat. [W]

    Parameters
    ----------
    friction_force : array_like
        Mean friction force. [N]
    sliding_speed : array_like, broadcast against `friction_force`
        Mean speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is negative or not finite.

    Notes
    -----
    What the drive of the sliding supplies. What the actuator supplies comes on top: `contact_temperature_history` takes it as
    `vibration_heat_rate`.
    """
    return require_non_negative(friction_force=friction_force) * require_non_negative(sliding_speed=sliding_speed)


def superimposed_heat_rate(
    *, friction_force: ArrayLike, sliding_speed: ArrayLike, vibration_velocity: ArrayLike
) -> Floats:
    """Return the heat of friction at the superimposed speed, the picture of D 4.3. [W]

    Parameters
    ----------
    friction_force : array_like
        Mean friction force with vibration. [N]
    sliding_speed : array_like, broadcast against `friction_force`
        Mean speed of the sliding. [m/s]
    vibration_velocity : array_like, broadcast against them
        Peak velocity of the vibration. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is negative or not finite.

    Notes
    -----
    As published: friction falls, the speed of D Table 4.5 rises, and the heat is their product. A vibration along the
    surface normal does no work against friction, so that the second factor has no basis in energy; nor can it win over
    the first where the text says it does (see the reproduction of D 4.3.4).

    References
    ----------
    .. [1] D 4.3.4 and Table 4.5.
    """
    speed = superimposed_speed(sliding_speed=sliding_speed, vibration_velocity=vibration_velocity)
    return require_non_negative(friction_force=friction_force) * speed


def contact_temperature_history(
    contact: HeatedContact,
    *,
    time: ArrayLike,
    friction_force: ArrayLike,
    sliding_speed: ArrayLike,
    vibration_heat_rate: ArrayLike = 0.0,
) -> ContactTemperatureHistory:
    """Return the temperature of a contact in time, as heat of friction and of vibration come and go by steps.

    Parameters
    ----------
    contact : HeatedContact
    time : array_like, shape (n,)
        Rising times; the first is the start, all of it cold. [s]
    friction_force : array_like, shape (n - 1,)
        Mean friction force from each time to the next. [N]
    sliding_speed : array_like, broadcast against `friction_force`
        Mean speed of the sliding. [m/s]
    vibration_heat_rate : array_like, broadcast against them
        Heat of the vibration in the contact. [W]

    Returns
    -------
    ContactTemperatureHistory

    Raises
    ------
    InvalidInput
        If times do not rise, the steps do not fit them, a value is negative, or not finite.

    Notes
    -----
    The flash follows the heat at once: it settles within the square of the contact's radius over the diffusivity,
    milliseconds for a tenth of a millimetre of steel. The moving body keeps no heat from turn to turn.

    References
    ----------
    .. [1] D 4.3.4.
    """
    moments = np.asarray(time, dtype=np.float64)
    friction = frictional_heat_rate(friction_force=friction_force, sliding_speed=sliding_speed)
    heat = friction + require_non_negative(vibration_heat_rate=vibration_heat_rate)
    if heat.ndim and heat.shape != (moments.size - 1,):
        raise InvalidInput(f"friction_force must hold one step to an interval of time, {moments.size - 1}")
    heat = np.broadcast_to(heat, (moments.size - 1,))
    shared = contact_rise(contact.pin, contact.disc, contact.source, heat_rate=heat, sliding_speed=sliding_speed)
    into_bodies = np.zeros((heat.size, len(contact.network.heat_capacity)))
    into_bodies[:, 0] = shared.heat_partition * heat
    bulk = network_rise(contact.network, time=moments, heat_rate=into_bodies)[:, 0]
    return ContactTemperatureHistory(
        time=moments,
        temperature_rise=bulk + np.concatenate([[0.0], shared.mean_temperature_rise]),
        bulk_rise=bulk,
        heat_rate=heat,
        heat_partition=shared.heat_partition,
    )
