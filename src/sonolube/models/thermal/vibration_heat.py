"""Heat of vibration from stored energy and quality factor; heat rate and conductance from temperature rises."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput


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
