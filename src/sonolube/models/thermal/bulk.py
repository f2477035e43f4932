r"""Bulk temperature rise of a pin as a fin, in closed form."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.models.thermal.solid import ThermalSolid


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatedPin:
    """A cylindrical pin heated uniformly at its end face and cooled by convection along its side: a fin.

    Parameters
    ----------
    solid : ThermalSolid
    pin_radius : float
        Radius of the pin, r. [m]
    length : float
        Length of the pin, L. [m]
    convection_coefficient : float
        Heat transfer coefficient from the side to the air, h. [W/(m2 K)]

    Raises
    ------
    InvalidInput
        If a length is not positive, the convection negative, or a value not finite.

    Notes
    -----
    The temperature is uniform over the cross section, which holds for Biot numbers h r/k well below 0.1.

    References
    ----------
    .. [1] H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford (1959), section 4.5.
    """

    solid: ThermalSolid
    pin_radius: float
    length: float
    convection_coefficient: float

    def __post_init__(self) -> None:
        require_positive(pin_radius=self.pin_radius, length=self.length)
        require_non_negative(convection_coefficient=self.convection_coefficient)

    @property
    def cross_section(self) -> float:
        """Area of the heated face. [m2]"""
        return float(np.pi * self.pin_radius**2)

    @property
    def heat_capacity(self) -> float:
        """Heat that raises the temperature of the whole pin by one kelvin. [J/K]"""
        return self.cross_section * self.length * self.solid.density * self.solid.specific_heat_capacity

    @property
    def fin_parameter(self) -> float:
        """Dimensionless fin parameter m L with m = sqrt(2 h/(k r)). []"""
        h, k = self.convection_coefficient, self.solid.thermal_conductivity
        return float(np.sqrt(2 * h / (k * self.pin_radius)) * self.length)


def pin_rise(pin: HeatedPin, *, heat_rate: ArrayLike, depth: ArrayLike = 0.0) -> Floats:
    r"""Steady temperature rise along a pin, a fin whose far end is held at the temperature of the air. [K]

    Parameters
    ----------
    pin : HeatedPin
    heat_rate : array_like
        Heat into the end face per time. [W]
    depth : array_like, broadcast against `heat_rate`
        Distance from the heated face. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a heat is negative, a depth lies outside the pin, or a value is not finite.

    Notes
    -----
    With :math:`m = \sqrt{2h/(k r)}`,

    .. math:: \Delta T = \frac{Q}{k \pi r^2 m} \frac{\sinh m(L - z)}{\cosh m L} .
    """
    x = require_within(0.0, pin.length, depth=depth) / pin.length
    m = max(pin.fin_parameter, 1e-8)  # below this value convection is negligible and the profile linear
    profile = -np.expm1(-2 * m * (1 - x)) * np.exp(-m * x) / (1 + np.exp(-2 * m))  # sinh m(1-x) over cosh m
    gradient = require_non_negative(heat_rate=heat_rate) / (pin.solid.thermal_conductivity * pin.cross_section)
    return np.asarray(gradient * pin.length / m * profile)


def pin_conductance(pin: HeatedPin) -> float:
    """Steady thermal conductance of a pin: heat into its face per kelvin of rise of that face. [W/K]

    Parameters
    ----------
    pin : HeatedPin
        Its far end is held at the temperature of the air, as in `pin_rise`.

    Returns
    -------
    float
    """
    return 1 / float(pin_rise(pin, heat_rate=1.0))
