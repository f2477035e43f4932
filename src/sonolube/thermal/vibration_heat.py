"""Heat of vibration: losses in a horn, rubbing of what vibrates, and what an interface lets through."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput


def half_wave_bar_energy(
    *,
    density: ArrayLike,
    cross_section: ArrayLike,
    length: ArrayLike,
    frequency: ArrayLike,
    axial_amplitude: ArrayLike,
) -> Floats:
    """Return the energy in the vibration of a prismatic half-wave bar. [J]

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
        Amplitude of its ends. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an amplitude is negative, another value not positive, or a value not finite.
    """
    mass = require_positive(density=density) * require_positive(cross_section=cross_section)
    mass = mass * require_positive(length=length)
    velocity = 2 * np.pi * require_positive(frequency=frequency) * require_non_negative(axial_amplitude=axial_amplitude)
    return mass * velocity**2 / 4


def vibration_loss_heat_rate(*, stored_energy: ArrayLike, frequency: ArrayLike, quality_factor: ArrayLike) -> Floats:
    """Return the heat that a vibration turns into, omega E/Q. [W]

    Parameters
    ----------
    stored_energy : array_like
        Energy in the vibration. [J]
    frequency : array_like, broadcast against `stored_energy`
        Frequency of the vibration. [Hz]
    quality_factor : array_like, broadcast against them
        Energy stored over that lost per radian. []

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an energy is negative, another value not positive, or a value not finite.
    """
    energy = require_non_negative(stored_energy=stored_energy)
    return 2 * np.pi * require_positive(frequency=frequency) * energy / require_positive(quality_factor=quality_factor)


def adiabatic_heat_rate(*, heat_capacity: ArrayLike, temperature_rise: ArrayLike, duration: ArrayLike) -> Floats:
    """Return the heat that warms a body by so much in so long while it loses none: a loss inferred from a record. [W]

    Parameters
    ----------
    heat_capacity : array_like
        Heat that warms the body by a kelvin. [J/K]
    temperature_rise : array_like, broadcast against `heat_capacity`
        Rise of its temperature. [K]
    duration : array_like, broadcast against them
        How long it took. [s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a rise is negative, another value not positive, or a value not finite.
    """
    capacity = require_positive(heat_capacity=heat_capacity)
    rise = require_non_negative(temperature_rise=temperature_rise)
    return capacity * rise / require_positive(duration=duration)


def interface_conductance(
    *, temperature_rise: ArrayLike, rise_behind_interface: ArrayLike, convection_coefficient: ArrayLike
) -> Floats:
    """Return what an interface conducts if a sensor behind it warms less than one without. [W/(m2 K)]

    Parameters
    ----------
    temperature_rise : array_like
        Rise of the source, which a sensor without the interface shows. [K]
    rise_behind_interface : array_like, broadcast against `temperature_rise`
        Rise shown behind the interface. [K]
    convection_coefficient : array_like, broadcast against them
        Heat that the sensor loses onwards, per area of the interface. [W/(m2 K)]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is not positive and finite, or the sheltered rise is not the smaller.

    Notes
    -----
    In a steady state the same heat crosses interface and sensor: h_c (T - T') = h T'.
    """
    rise = require_positive(temperature_rise=temperature_rise)
    behind = require_positive(rise_behind_interface=rise_behind_interface)
    if np.any(behind >= rise):
        raise InvalidInput("rise_behind_interface must be smaller than temperature_rise")
    return require_positive(convection_coefficient=convection_coefficient) * behind / (rise - behind)


def layer_conductance(*, thermal_conductivity: ArrayLike, thickness: ArrayLike) -> Floats:
    """Return what a layer conducts through its thickness. [W/(m2 K)]

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
    """
    return require_positive(thermal_conductivity=thermal_conductivity) / require_positive(thickness=thickness)
