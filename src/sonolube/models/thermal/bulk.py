r"""Bulk temperature rise in closed form: half-space, lumped body, pin as a fin and disc heated along a circle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erfc, i0e, i1e, k0e, k1e

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.models.thermal.solid import ThermalSolid

_DEEPEST = 40.0  # depth over diffusion length beyond which the rise underflows


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


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatedDisc:
    """A thin disc heated uniformly along a circle and cooled by convection on both faces.

    Parameters
    ----------
    solid : ThermalSolid
    thickness : float
        Thickness of the disc, t. [m]
    track_radius : float
        Radius of the heated circle, R. [m]
    disc_radius : float
        Outer radius of the disc, R_o; its rim is insulated. [m]
    convection_coefficient : float
        Heat transfer coefficient from each face to the air, h. [W/(m2 K)]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite, or the track lies outside the disc.

    Notes
    -----
    The heat of a pin is averaged over the whole circle, which holds where the disc turns often while it warms. The
    temperature is uniform through the thickness, which holds for Biot numbers h t/k well below 0.1.

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
        sizes = ("thickness", "track_radius", "disc_radius", "convection_coefficient")
        require_positive(**{name: getattr(self, name) for name in sizes})
        if self.track_radius > self.disc_radius:
            raise InvalidInput(f"track_radius {self.track_radius!r} m lies outside disc_radius {self.disc_radius!r} m")


def half_space_rise(solid: ThermalSolid, *, heat_flux: ArrayLike, time: ArrayLike, depth: ArrayLike = 0.0) -> Floats:
    r"""Transient temperature rise in a half-space under a constant, uniform surface heat flux. [K]

    Parameters
    ----------
    solid : ThermalSolid
    heat_flux : array_like
        Heat flux into the surface. [W/m2]
    time : array_like, broadcast against `heat_flux`
        Time since the flux was applied. [s]
    depth : array_like, broadcast against them
        Depth below the surface. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is negative or not finite.

    Notes
    -----
    With the diffusion length :math:`\ell = 2\sqrt{\kappa t}`,

    .. math::

        \Delta T = \frac{q\,\ell}{k}
        \left[ \frac{e^{-z^2/\ell^2}}{\sqrt{\pi}} - \frac{z}{\ell} \operatorname{erfc} \frac{z}{\ell} \right] .

    References
    ----------
    .. [1] H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford (1959), section 2.9.

    Examples
    --------
    >>> from sonolube.models.thermal import ThermalSolid, half_space_rise
    >>> steel = ThermalSolid(thermal_conductivity=16.0, density=8000.0, specific_heat_capacity=500.0)
    >>> half_space_rise(steel, heat_flux=1e5, time=[1.0, 4.0]).round(1).tolist()  # with the root of the time
    [14.1, 28.2]
    """
    q = require_non_negative(heat_flux=heat_flux)
    diffusion_length = 2 * np.sqrt(solid.thermal_diffusivity * require_non_negative(time=time))
    z = np.minimum(require_non_negative(depth=depth) / np.maximum(diffusion_length, 1e-200), _DEEPEST)
    profile = np.exp(-(z**2)) / np.sqrt(np.pi) - z * erfc(z)
    return np.asarray(q * diffusion_length / solid.thermal_conductivity * profile)


def lumped_rise(
    *, heat_rate: ArrayLike, thermal_conductance: ArrayLike, heat_capacity: ArrayLike, time: ArrayLike
) -> Floats:
    r"""Transient temperature rise of a body of uniform temperature by the lumped-capacitance method. [K]

    Parameters
    ----------
    heat_rate : array_like
        Heat into the body per time, constant. [W]
    thermal_conductance : array_like, broadcast against `heat_rate`
        Heat lost per time and kelvin of rise. [W/K]
    heat_capacity : array_like, broadcast against them
        Heat capacity of the body. [J/K]
    time : array_like, broadcast against them
        Time since the heat was applied. [s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If conductance or capacity is not positive, the heat or the time negative, or a value not finite.

    Notes
    -----
    For bodies whose internal conductance is far above that to their surroundings (small Biot number):

    .. math:: \Delta T = \frac{Q}{G} \left( 1 - e^{-G t/C} \right) .

    Examples
    --------
    >>> from sonolube.models.thermal import lumped_rise
    >>> rise = lumped_rise(heat_rate=1.0, thermal_conductance=0.05, heat_capacity=1.5, time=[30.0, 3600.0])
    >>> rise.round(2).tolist()  # 1 - 1/e of the final 20 K after one time constant
    [12.64, 20.0]
    """
    q = require_non_negative(heat_rate=heat_rate)
    g = require_positive(thermal_conductance=thermal_conductance)
    t = require_non_negative(time=time)
    return -q / g * np.expm1(-g * t / require_positive(heat_capacity=heat_capacity))


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


def disc_track_rise(disc: HeatedDisc, *, heat_rate: ArrayLike) -> Floats:
    r"""Steady temperature rise of a thin disc on the circle along which it is heated. [K]

    Parameters
    ----------
    disc : HeatedDisc
    heat_rate : array_like, any shape
        Heat into the circle per time. [W]

    Returns
    -------
    ndarray, shape of `heat_rate`

    Raises
    ------
    InvalidInput
        If a heat is negative or not finite.

    Notes
    -----
    An annular fin with insulated rim. With :math:`m = \sqrt{2h/(k t)}` and the modified Bessel functions,

    .. math::

        \Delta T = \frac{Q}{2\pi k t}\, I_0(m R) \left[ K_0(m R) + I_0(m R) \frac{K_1(m R_o)}{I_1(m R_o)} \right] .
    """
    k_t = disc.solid.thermal_conductivity * disc.thickness
    m = np.sqrt(2 * disc.convection_coefficient / k_t)
    track, rim = m * disc.track_radius, m * disc.disc_radius
    rim_term = i0e(track) * k1e(rim) / i1e(rim) * np.exp(2 * (track - rim))
    rise_per_watt = i0e(track) * (k0e(track) + rim_term) / (2 * np.pi * k_t)
    return np.asarray(require_non_negative(heat_rate=heat_rate) * rise_per_watt)
