"""Macro-contact of the pin on the disc: a smooth sphere on a flat before wear, a worn flat after it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import require_non_negative, require_positive, require_within

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, slots=True)
class SphereOnFlat:
    """A smooth elastic sphere on a smooth elastic flat, without friction or adhesion.

    Parameters
    ----------
    tip_radius : float
        Radius of the sphere. [m]
    effective_modulus : float
        1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, as `ContactPair` has it. [Pa]

    Notes
    -----
    Hertz's theory: the contact circle is small beside the tip radius, and roughness small beside the approach.

    References
    ----------
    .. [1] K. L. Johnson, Contact Mechanics (1985), chapters 3 and 4. doi:10.1017/CBO9781139171731
    """

    tip_radius: float
    effective_modulus: float

    def __post_init__(self) -> None:
        require_positive(tip_radius=self.tip_radius, effective_modulus=self.effective_modulus)


def contact_radius(sphere: SphereOnFlat, *, normal_load: ArrayLike) -> Floats:
    """Return the radius of the contact circle. [m]

    Parameters
    ----------
    sphere : SphereOnFlat
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is negative or not finite.
    """
    load = require_non_negative(normal_load=normal_load)
    return np.cbrt(3 * load * sphere.tip_radius / (4 * sphere.effective_modulus))  # Johnson 4.22


def approach(sphere: SphereOnFlat, *, normal_load: ArrayLike) -> Floats:
    """Return how far distant points of the two bodies approach. [m]

    Parameters
    ----------
    sphere : SphereOnFlat
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is negative or not finite.
    """
    return contact_radius(sphere, normal_load=normal_load) ** 2 / sphere.tip_radius  # Johnson 4.23


def peak_pressure(sphere: SphereOnFlat, *, normal_load: ArrayLike) -> Floats:
    """Return the pressure in the middle of the contact circle. [Pa]

    Parameters
    ----------
    sphere : SphereOnFlat
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is negative or not finite.

    Notes
    -----
    It is 1.5 times the mean. D 2.4.2 has twice the nominal stress in the middle of the round tip, "according to FEA":
    more than any elastic sphere gives on its own contact circle, so the nominal area there is larger than that circle.
    """
    load = require_non_negative(normal_load=normal_load)
    R, E = sphere.tip_radius, sphere.effective_modulus
    return np.cbrt(6 * load * E**2 / (np.pi**3 * R**2))  # Johnson 4.24


def mean_pressure(sphere: SphereOnFlat, *, normal_load: ArrayLike) -> Floats:
    """Return the load over the area of the contact circle. [Pa]

    Parameters
    ----------
    sphere : SphereOnFlat
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is negative or not finite.
    """
    return peak_pressure(sphere, normal_load=normal_load) / 1.5


def hertz_stiffness(sphere: SphereOnFlat, *, normal_load: ArrayLike) -> Floats:
    """Return the normal stiffness of the macro-contact, change of load over change of approach. [N/m]

    Parameters
    ----------
    sphere : SphereOnFlat
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is negative or not finite.
    """
    return 2 * sphere.effective_modulus * contact_radius(sphere, normal_load=normal_load)


def axial_stresses(
    sphere: SphereOnFlat, *, normal_load: ArrayLike, depth: ArrayLike, poisson_ratio: ArrayLike
) -> tuple[Floats, Floats]:
    """Return the stresses along and across the axis of the contact, tension positive. [Pa]

    Parameters
    ----------
    sphere : SphereOnFlat
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]
    depth : array_like, broadcastable to `normal_load`
        Depth below the surface, on the axis. [m]
    poisson_ratio : array_like, broadcastable to `normal_load`
        Poisson's ratio of the body looked into. []

    Returns
    -------
    tuple of two ndarrays, the broadcast shape
        Normal to the surface, and parallel to it: radial and hoop stress are equal on the axis.

    Raises
    ------
    InvalidInput
        If a load is not positive, a depth negative, or Poisson's ratio outside 0 to 0.5.
    """
    load = require_positive(normal_load=normal_load)
    nu = require_within(0.0, 0.5, poisson_ratio=poisson_ratio)
    zeta = require_non_negative(depth=depth) / contact_radius(sphere, normal_load=load)
    p0 = peak_pressure(sphere, normal_load=load)
    along = -p0 / (1 + zeta**2)  # Johnson 3.45b
    across = -p0 * (1 + nu) * (1 - zeta * np.arctan2(1.0, zeta)) - along / 2  # Johnson 3.45a
    return along, across


def axial_shear_stress(
    sphere: SphereOnFlat, *, normal_load: ArrayLike, depth: ArrayLike, poisson_ratio: ArrayLike
) -> Floats:
    """Return the principal shear stress on the axis of the contact. [Pa]

    Parameters
    ----------
    sphere : SphereOnFlat
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]
    depth : array_like, broadcastable to `normal_load`
        Depth below the surface, on the axis. [m]
    poisson_ratio : array_like, broadcastable to `normal_load`
        Poisson's ratio of the body looked into. []

    Returns
    -------
    ndarray, the broadcast shape

    Raises
    ------
    InvalidInput
        If a load is not positive, a depth negative, or Poisson's ratio outside 0 to 0.5.
    """
    along, across = axial_stresses(sphere, normal_load=normal_load, depth=depth, poisson_ratio=poisson_ratio)
    return np.abs(along - across) / 2


def largest_axial_shear(*, poisson_ratio: ArrayLike) -> tuple[Floats, Floats]:
    """Return the largest shear stress on the axis over the peak pressure, and its depth over the contact radius. []

    Parameters
    ----------
    poisson_ratio : array_like, any shape
        Poisson's ratio of the body looked into. []

    Returns
    -------
    tuple of two ndarrays, shape of `poisson_ratio`
        Near 0.31 and 0.48 for metals.

    Raises
    ------
    InvalidInput
        If Poisson's ratio is outside 0 to 0.5.
    """
    nu = require_within(0.0, 0.5, poisson_ratio=poisson_ratio)
    zeta = np.full(nu.shape, 0.48)
    for _ in range(6):  # Newton's steps on the slope of Johnson's 3.45; the root lies between 0.38 and 0.55
        one = 1 + zeta**2
        slope = (1 + nu) * (np.arctan2(1.0, zeta) - zeta / one) - 3 * zeta / one**2
        curvature = -2 * (1 + nu) / one**2 - 3 * (1 - 3 * zeta**2) / one**3
        zeta = zeta - slope / curvature
    return np.asarray(0.75 / (1 + zeta**2) - (1 + nu) * (1 - zeta * np.arctan2(1.0, zeta)) / 2), zeta


def load_at_first_yield(sphere: SphereOnFlat, *, yield_strength: ArrayLike, poisson_ratio: ArrayLike) -> Floats:
    """Return the load at which a body first yields, below the middle of the contact. [N]

    Parameters
    ----------
    sphere : SphereOnFlat
    yield_strength : array_like, any shape
        Yield strength of the body. [Pa]
    poisson_ratio : array_like, broadcastable to `yield_strength`
        Poisson's ratio of the body. []

    Returns
    -------
    ndarray, the broadcast shape

    Raises
    ------
    InvalidInput
        If a yield strength is not positive, or Poisson's ratio outside 0 to 0.5.

    Notes
    -----
    Tresca and von Mises agree on the axis, where two principal stresses are equal: the shear there reaches Y/2.
    """
    Y = require_positive(yield_strength=yield_strength)
    largest, _ = largest_axial_shear(poisson_ratio=poisson_ratio)
    p0: Floats = Y / (2 * largest)
    R, E = sphere.tip_radius, sphere.effective_modulus
    return np.pi**3 * R**2 * p0**3 / (6 * E**2)  # Johnson 6.9


def tip_radius_for_pressure(
    *, mean_pressure: ArrayLike, normal_load: ArrayLike, effective_modulus: ArrayLike
) -> Floats:
    """Return the tip radius that gives this mean pressure under this load. [m]

    Parameters
    ----------
    mean_pressure : array_like, any shape
        Load over the area of the contact circle, the pressure called nominal. [Pa]
    normal_load : array_like, broadcastable to `mean_pressure`
        Force pressing the bodies together. [N]
    effective_modulus : array_like, broadcastable to `mean_pressure`
        Combined modulus of both bodies. [Pa]

    Returns
    -------
    ndarray, the broadcast shape

    Raises
    ------
    InvalidInput
        If an argument is not positive.

    Notes
    -----
    The 300 MPa of D's Table 2.13 at 3 N is a circle of 0.01 mm2, of 0.113 mm diameter. An M50 pin on M50 would need a
    tip of about 9 mm radius for it, an alumina pin about 12 mm.
    """
    load = require_positive(normal_load=normal_load)
    area = load / require_positive(mean_pressure=mean_pressure)
    a: Floats = np.sqrt(area / np.pi)
    return 4 * require_positive(effective_modulus=effective_modulus) * a**3 / (3 * load)  # Johnson 4.22


def nominal_area_from_groove(*, groove_width: ArrayLike) -> Floats:
    """Return the area of the circle that is as wide as the wear groove, pi w^2/4. [m2]

    Parameters
    ----------
    groove_width : array_like, any shape
        Width of the wear groove. [m]

    Returns
    -------
    ndarray, shape of `groove_width`

    Raises
    ------
    InvalidInput
        If a width is not positive.

    Notes
    -----
    D 4.1.1 and Table 4.1 take the nominal area from the width of the groove: 0.126 mm2 is a circle of 0.40 mm.
    """
    return np.pi * require_positive(groove_width=groove_width) ** 2 / 4


def worn_flat_pressure(*, normal_load: ArrayLike, groove_width: ArrayLike) -> Floats:
    """Return the mean pressure under a pin worn flat to the width of its groove. [Pa]

    Parameters
    ----------
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]
    groove_width : array_like, broadcastable to `normal_load`
        Width of the wear groove. [m]

    Returns
    -------
    ndarray, the broadcast shape

    Raises
    ------
    InvalidInput
        If a load is negative or a width not positive.
    """
    return require_non_negative(normal_load=normal_load) / nominal_area_from_groove(groove_width=groove_width)
