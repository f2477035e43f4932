"""Temperature history of a rubbing contact: flash and bulk rise under frictional heat and heat of vibration."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.facts.metrics import superimposed_speed
from sonolube.models.thermal.flash import MovingRise, contact_rise, flash_rise
from sonolube.models.thermal.network import ThermalNetwork, network_rise
from sonolube.models.thermal.solid import ThermalSolid
from sonolube.models.thermal.source import HeatSource


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatedContact:
    """A pin in contact with a moving body, and the thermal network through which the pin loses its heat.

    Parameters
    ----------
    pin : ThermalSolid
        The body to which the contact is fixed.
    disc : ThermalSolid
        The body over which the contact moves.
    source : HeatSource
        The contact.
    network : ThermalNetwork
        The pin, as its first body, and the bodies joined to it.
    moving_rise : MovingRise
        Model of the flash temperature of the disc.
    """

    pin: ThermalSolid
    disc: ThermalSolid
    source: HeatSource
    network: ThermalNetwork
    moving_rise: MovingRise = flash_rise


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactTemperatureHistory:
    """Temperature of a contact over time, with its heat and heat partition.

    Parameters
    ----------
    time : ndarray, shape (n,)
        The times. [s]
    temperature_rise : ndarray, shape (n,)
        Mean rise of the contact just before each time: bulk and flash. [K]
    bulk_rise : ndarray, shape (n,)
        Rise of the pin's bulk alone, in K.
    heat_rate : ndarray, shape (n - 1,)
        Heat generated in the contact from each time to the next. [W]
    heat_partition : ndarray, shape (n - 1,)
        Fraction of that heat that flows into the pin. []
    """

    time: Floats
    temperature_rise: Floats
    bulk_rise: Floats
    heat_rate: Floats
    heat_partition: Floats


def frictional_heat_rate(*, friction_force: ArrayLike, sliding_speed: ArrayLike) -> Floats:
    r"""Frictional heat per time, the work of friction at the mean sliding speed. [W]

    Parameters
    ----------
    friction_force : array_like
        Mean friction force. [N]
    sliding_speed : array_like, broadcast against `friction_force`
        Mean sliding speed. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is negative or not finite.

    See Also
    --------
    superimposed_heat_rate : the published variant with the superimposed speed.

    Notes
    -----
    .. math:: Q_f = F_t v_r ,

    the power supplied by the drive of the sliding. The power that the actuator supplies comes on top:
    `contact_temperature_history` takes it as `vibration_heat_rate`.

    Examples
    --------
    >>> from sonolube.models.thermal import frictional_heat_rate
    >>> from sonolube.text.units import format_si
    >>> format_si(float(frictional_heat_rate(friction_force=1.0, sliding_speed=20e-3)), "W")
    '20 mW'
    """
    return require_non_negative(friction_force=friction_force) * require_non_negative(sliding_speed=sliding_speed)


def superimposed_heat_rate(
    *, friction_force: ArrayLike, sliding_speed: ArrayLike, vibration_velocity: ArrayLike
) -> Floats:
    r"""Frictional heat per time at the superimposed speed, as published in D 4.3.4. [W]

    Parameters
    ----------
    friction_force : array_like
        Mean friction force with vibration. [N]
    sliding_speed : array_like, broadcast against `friction_force`
        Mean sliding speed. [m/s]
    vibration_velocity : array_like, broadcast against them
        Peak velocity of the vibration. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is negative or not finite.

    See Also
    --------
    frictional_heat_rate

    Notes
    -----
    .. math:: Q = F_t\, v_s , \qquad v_s = \sqrt{v_r^2 + (v_1/\pi)^2}

    As published: vibration lowers the friction force and raises the superimposed speed of D Table 4.5, and the heat is
    their product. A vibration along the surface normal does no work against friction, so the second factor has no basis
    in an energy balance; nor does it outweigh the first where the text states that it does (see the reproduction of
    D 4.3.4).

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
    r"""Temperature history of a contact under stepwise constant frictional heat and heat of vibration.

    Parameters
    ----------
    contact : HeatedContact
    time : array_like, shape (n,)
        Increasing times; at the first, the start, no temperature has risen. [s]
    friction_force : array_like, shape (n - 1,)
        Mean friction force from each time to the next. [N]
    sliding_speed : array_like, broadcast against `friction_force`
        Mean sliding speed. [m/s]
    vibration_heat_rate : array_like, broadcast against them
        Heat of the vibration generated in the contact. [W]

    Returns
    -------
    ContactTemperatureHistory

    Raises
    ------
    InvalidInput
        If times do not increase, the steps do not fit them, a value is negative, or not finite.

    Notes
    -----
    With vibration two factors act on the temperature: the frictional heat falls with the friction force, and the
    vibration adds heat of its own (D 4.3.4). Their sum

    .. math:: Q = F_t v_r + Q_v

    is divided by `contact_rise`. The fraction into the pin warms the network; the flash rise follows the heat without
    delay, since it settles within the square of the contact radius over the diffusivity, which is milliseconds for a
    tenth of a millimetre of steel. The moving body cools fully from turn to turn.

    References
    ----------
    .. [1] D 4.3.4.
    """
    times = np.asarray(time, dtype=np.float64)
    friction = frictional_heat_rate(friction_force=friction_force, sliding_speed=sliding_speed)
    heat = friction + require_non_negative(vibration_heat_rate=vibration_heat_rate)
    if heat.ndim and heat.shape != (times.size - 1,):
        raise InvalidInput(
            f"friction_force must hold one value for each interval of time, {times.size - 1}, got shape {heat.shape}"
        )
    heat = np.broadcast_to(heat, (times.size - 1,))
    flash = contact_rise(
        contact.pin,
        contact.disc,
        contact.source,
        heat_rate=heat,
        sliding_speed=sliding_speed,
        moving_rise=contact.moving_rise,
    )
    into_bodies = np.zeros((heat.size, len(contact.network.heat_capacity)))
    into_bodies[:, 0] = flash.heat_partition * heat
    bulk = network_rise(contact.network, time=times, heat_rate=into_bodies)[:, 0]
    return ContactTemperatureHistory(
        time=times,
        temperature_rise=bulk + np.concatenate([[0.0], flash.mean_temperature_rise]),
        bulk_rise=bulk,
        heat_rate=heat,
        heat_partition=flash.heat_partition,
    )
