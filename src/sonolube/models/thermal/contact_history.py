"""Temperature history of a rubbing contact under frictional heat and heat of vibration, and estimates of that heat."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.facts.metrics import superimposed_speed
from sonolube.models.thermal.bulk import ThermalNetwork, network_rise
from sonolube.models.thermal.flash import MovingRise, contact_rise, flash_rise
from sonolube.models.thermal.source import HeatSource, ThermalSolid


def half_wave_bar_energy(
    *, density: ArrayLike, cross_section: ArrayLike, length: ArrayLike, frequency: ArrayLike, axial_amplitude: ArrayLike
) -> Floats:
    r"""Vibration energy stored in a prismatic half-wave bar in axial resonance. [J]

    Parameters
    ----------
    density : array_like
        Mass density of the bar. [kg/m3]
    cross_section : array_like, broadcast against `density`
        Area of its cross section. [m2]
    length : array_like, broadcast against them
        Length of the bar. [m]
    frequency : array_like, broadcast against them
        Frequency of the vibration. [Hz]
    axial_amplitude : array_like, broadcast against them
        Displacement amplitude of its ends. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an amplitude is negative, another value not positive, or a value not finite.

    See Also
    --------
    vibration_loss_heat_rate : the heat this energy turns into.

    Notes
    -----
    The peak kinetic energy of the mode :math:`A \cos(\pi x/L)`:

    .. math:: E = \tfrac14\, \rho S L\, (2\pi f A)^2 .
    """
    mass = require_positive(density=density) * require_positive(cross_section=cross_section)
    mass = mass * require_positive(length=length)
    velocity = 2 * np.pi * require_positive(frequency=frequency) * require_non_negative(axial_amplitude=axial_amplitude)
    return mass * velocity**2 / 4


def vibration_loss_heat_rate(*, stored_energy: ArrayLike, frequency: ArrayLike, quality_factor: ArrayLike) -> Floats:
    r"""Heat per time dissipated by a vibration of known stored energy and quality factor. [W]

    Parameters
    ----------
    stored_energy : array_like
        Energy stored in the vibration. [J]
    frequency : array_like, broadcast against `stored_energy`
        Frequency of the vibration. [Hz]
    quality_factor : array_like, broadcast against them
        Stored energy over the energy lost per radian. []

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an energy is negative, another value not positive, or a value not finite.

    Notes
    -----
    .. math:: Q_v = \frac{2\pi f E}{Q}
    """
    energy = require_non_negative(stored_energy=stored_energy)
    return 2 * np.pi * require_positive(frequency=frequency) * energy / require_positive(quality_factor=quality_factor)


def adiabatic_heat_rate(*, heat_capacity: ArrayLike, temperature_rise: ArrayLike, duration: ArrayLike) -> Floats:
    r"""Heat per time inferred from the adiabatic temperature rise of a body. [W]

    Parameters
    ----------
    heat_capacity : array_like
        Heat capacity of the body. [J/K]
    temperature_rise : array_like, broadcast against `heat_capacity`
        Rise of its temperature. [K]
    duration : array_like, broadcast against them
        Time over which the temperature rose. [s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a rise is negative, another value not positive, or a value not finite.

    Notes
    -----
    .. math:: Q = \frac{C\,\Delta T}{t}

    The body loses no heat meanwhile, so the result is a lower bound of the heat generated.

    Examples
    --------
    >>> from sonolube.models.thermal import adiabatic_heat_rate
    >>> float(adiabatic_heat_rate(heat_capacity=1.5, temperature_rise=40.0, duration=60.0))  # W
    1.0
    """
    capacity = require_positive(heat_capacity=heat_capacity)
    rise = require_non_negative(temperature_rise=temperature_rise)
    return capacity * rise / require_positive(duration=duration)


def interface_conductance(
    *, temperature_rise: ArrayLike, rise_behind_interface: ArrayLike, convection_coefficient: ArrayLike
) -> Floats:
    r"""Thermal conductance of an interface from the steady rises on both of its sides. [W/(m2 K)]

    Parameters
    ----------
    temperature_rise : array_like
        Rise of the source, as a sensor without the interface shows it. [K]
    rise_behind_interface : array_like, broadcast against `temperature_rise`
        Rise of a sensor behind the interface. [K]
    convection_coefficient : array_like, broadcast against them
        Heat that the sensor loses to its surroundings, per area of the interface and kelvin. [W/(m2 K)]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is not positive and finite, or the rise behind the interface is not the smaller.

    See Also
    --------
    layer_conductance : the conductance of a layer of known conductivity.

    Notes
    -----
    In a steady state the same heat crosses interface and sensor, :math:`h_c (\Delta T - \Delta T') = h\,\Delta T'`:

    .. math:: h_c = \frac{h\,\Delta T'}{\Delta T - \Delta T'} .
    """
    rise = require_positive(temperature_rise=temperature_rise)
    behind = require_positive(rise_behind_interface=rise_behind_interface)
    if np.any(behind >= rise):
        raise InvalidInput("rise_behind_interface must be smaller than temperature_rise")
    return require_positive(convection_coefficient=convection_coefficient) * behind / (rise - behind)


def layer_conductance(*, thermal_conductivity: ArrayLike, thickness: ArrayLike) -> Floats:
    r"""Thermal conductance of a plane layer through its thickness. [W/(m2 K)]

    Parameters
    ----------
    thermal_conductivity : array_like
        Conductivity of the layer. [W/(m K)]
    thickness : array_like, broadcast against `thermal_conductivity`
        Thickness of the layer. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    .. math:: h_c = \frac{k}{t}
    """
    return require_positive(thermal_conductivity=thermal_conductivity) / require_positive(thickness=thickness)


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
