"""Bulk temperature: how heat leaves through a half-space, a pin and a disc, in closed form."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erfc, i0e, i1e, k0e, k1e

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.thermal.solid import ThermalSolid

_FARTHEST = 40.0  # depth over reach of the heat beyond which a float holds no rise


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatedPin:
    """A round pin heated at its end face, cooled along its side by the air.

    Parameters
    ----------
    solid : ThermalSolid
    pin_radius : float
        Radius of the pin. [m]
    length : float
        Length of the pin. [m]
    convection_coefficient : float
        Heat lost from the side to the air. [W/(m2 K)]

    Raises
    ------
    InvalidInput
        If a length is not positive, the convection negative, or a value not finite.

    Notes
    -----
    A fin: even over its cross section, for Biot numbers h r/k well below 0.1.

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
        """Heat that warms the whole pin by a kelvin. [J/K]"""
        return self.cross_section * self.length * self.solid.density * self.solid.specific_heat_capacity

    @property
    def fin_parameter(self) -> float:
        """Square root of the heat lost to the air over that conducted, times the length. []"""
        h, k = self.convection_coefficient, self.solid.thermal_conductivity
        return float(np.sqrt(2 * h / (k * self.pin_radius)) * self.length)


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatedDisc:
    """A thin disc heated along a circle, as by a pin that turns round often while it warms; cooled on both faces.

    Parameters
    ----------
    solid : ThermalSolid
    thickness : float
        Thickness of the disc. [m]
    track_radius : float
        Radius of the heated circle. [m]
    disc_radius : float
        Outer radius of the disc, its rim insulated. [m]
    convection_coefficient : float
        Heat lost from each face to the air. [W/(m2 K)]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite, or the track lies outside the disc.

    Notes
    -----
    Even through its thickness, for Biot numbers h t/k well below 0.1.

    References
    ----------
    .. [1] H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford (1959), section 5.4.
    """

    solid: ThermalSolid
    thickness: float
    track_radius: float
    disc_radius: float
    convection_coefficient: float

    def __post_init__(self) -> None:
        require_positive(
            thickness=self.thickness,
            track_radius=self.track_radius,
            disc_radius=self.disc_radius,
            convection_coefficient=self.convection_coefficient,
        )
        if self.track_radius > self.disc_radius:
            raise InvalidInput(f"track_radius {self.track_radius!r} m lies outside disc_radius {self.disc_radius!r} m")


def half_space_rise(solid: ThermalSolid, *, heat_flux: ArrayLike, time: ArrayLike, depth: ArrayLike = 0.0) -> Floats:
    """Return the rise in a half-space after heat has entered all its surface for some time. [K]

    Parameters
    ----------
    solid : ThermalSolid
    heat_flux : array_like
        Heat that enters. [W/m2]
    time : array_like, broadcast against `heat_flux`
        Time since it set in. [s]
    depth : array_like, broadcast against them
        Depth below the surface. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is negative or not finite.

    References
    ----------
    .. [1] H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford (1959), section 2.9.
    """
    q = require_non_negative(heat_flux=heat_flux)
    reach = 2 * np.sqrt(solid.thermal_diffusivity * require_non_negative(time=time))
    z = np.minimum(require_non_negative(depth=depth) / np.maximum(reach, 1e-200), _FARTHEST)
    below = np.exp(-(z**2)) / np.sqrt(np.pi) - z * erfc(z)
    return np.asarray(q * reach / solid.thermal_conductivity * below)


def lumped_rise(
    *, heat_rate: ArrayLike, thermal_conductance: ArrayLike, heat_capacity: ArrayLike, time: ArrayLike
) -> Floats:
    """Return the rise of a body of one temperature that is heated and loses heat in proportion to its rise. [K]

    Parameters
    ----------
    heat_rate : array_like
        Heat that enters. [W]
    thermal_conductance : array_like, broadcast against `heat_rate`
        Heat lost per kelvin. [W/K]
    heat_capacity : array_like, broadcast against them
        Heat that warms the body by a kelvin. [J/K]
    time : array_like, broadcast against them
        Time since the heat set in. [s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If conductance or capacity is not positive, the heat or the time negative, or a value not finite.

    Notes
    -----
    For bodies that conduct within far better than they lose.
    """
    q = require_non_negative(heat_rate=heat_rate)
    g = require_positive(thermal_conductance=thermal_conductance)
    t = require_non_negative(time=time)
    return -q / g * np.expm1(-g * t / require_positive(heat_capacity=heat_capacity))


def pin_rise(pin: HeatedPin, *, heat_rate: ArrayLike, depth: ArrayLike = 0.0) -> Floats:
    """Return the steady rise in a pin whose far end is held at the temperature of the air. [K]

    Parameters
    ----------
    pin : HeatedPin
    heat_rate : array_like
        Heat that enters the face. [W]
    depth : array_like, broadcast against `heat_rate`
        Distance from the heated face. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a heat is negative, a depth lies outside the pin, or a value is not finite.
    """
    x = require_within(0.0, pin.length, depth=depth) / pin.length
    m = max(pin.fin_parameter, 1e-8)  # below, the air counts for nothing and the profile is straight
    falls = -np.expm1(-2 * m * (1 - x)) * np.exp(-m * x) / (1 + np.exp(-2 * m))  # sinh m(1-x) over cosh m
    gradient = require_non_negative(heat_rate=heat_rate) / (pin.solid.thermal_conductivity * pin.cross_section)
    return np.asarray(gradient * pin.length / m * falls)


def pin_conductance(pin: HeatedPin) -> float:
    """Return heat into the face per kelvin of its rise, the far end held at the temperature of the air. [W/K]

    Parameters
    ----------
    pin : HeatedPin

    Returns
    -------
    float
    """
    return 1 / float(pin_rise(pin, heat_rate=1.0))


def disc_track_rise(disc: HeatedDisc, *, heat_rate: ArrayLike) -> Floats:
    """Return the steady rise along the heated circle, averaged over a turn. [K]

    Parameters
    ----------
    disc : HeatedDisc
    heat_rate : array_like, any shape
        Heat that enters along the circle. [W]

    Returns
    -------
    ndarray, shape of `heat_rate`

    Raises
    ------
    InvalidInput
        If a heat is negative or not finite.
    """
    k_t = disc.solid.thermal_conductivity * disc.thickness
    m = np.sqrt(2 * disc.convection_coefficient / k_t)
    track, rim = m * disc.track_radius, m * disc.disc_radius
    from_rim = i0e(track) * k1e(rim) / i1e(rim) * np.exp(2 * (track - rim))
    of_one_watt = i0e(track) * (k0e(track) + from_rim) / (2 * np.pi * k_t)
    return np.asarray(require_non_negative(heat_rate=heat_rate) * of_one_watt)
