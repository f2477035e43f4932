"""Hertzian contact of a pin on a disc: a smooth sphere on a flat before wear, and the worn flat afterwards."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive, require_within


@dataclass(frozen=True, kw_only=True, slots=True)
class SphereOnFlat:
    """Smooth elastic sphere on a smooth elastic flat, without friction or adhesion.

    Parameters
    ----------
    tip_radius : float
        Radius of the sphere. [m]
    effective_modulus : float
        Effective contact modulus, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, as in `ContactPair`. [Pa]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    Hertz's theory holds for a contact circle much smaller than the tip radius, and a roughness much smaller than the
    approach.

    References
    ----------
    .. [1] K. L. Johnson, Contact Mechanics (1985), chapters 3 and 4. doi:10.1017/CBO9781139171731
    """

    tip_radius: float
    effective_modulus: float

    def __post_init__(self) -> None:
        require_positive(tip_radius=self.tip_radius, effective_modulus=self.effective_modulus)


def hertz_contact_radius(sphere: SphereOnFlat, *, normal_load: ArrayLike) -> Floats:
    r"""Radius of the contact circle. [m]

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
    .. math:: a = \left( \frac{3 F_N R}{4 E^*} \right)^{1/3}
    """
    load = require_non_negative(normal_load=normal_load)
    return np.cbrt(3 * load * sphere.tip_radius / (4 * sphere.effective_modulus))  # Johnson 4.22


def hertz_peak_pressure(sphere: SphereOnFlat, *, normal_load: ArrayLike) -> Floats:
    r"""Peak contact pressure, at the centre of the contact circle. [Pa]

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
    .. math:: p_0 = \left( \frac{6 F_N E^{*2}}{\pi^3 R^2} \right)^{1/3}

    1.5 times the mean pressure. D 2.4.2 states twice the nominal stress at the centre of the round tip, by finite
    elements: more than an elastic sphere gives on its own contact circle; the nominal area there must be larger.

    Examples
    --------
    >>> from sonolube.models.contact import SphereOnFlat, hertz_peak_pressure
    >>> ball = SphereOnFlat(tip_radius=5e-3, effective_modulus=60e9)
    >>> round(1e-6 * float(hertz_peak_pressure(ball, normal_load=10.0)))  # MPa
    653
    """
    load = require_non_negative(normal_load=normal_load)
    R, E = sphere.tip_radius, sphere.effective_modulus
    return np.cbrt(6 * load * E**2 / (np.pi**3 * R**2))  # Johnson 4.24


def hertz_mean_pressure(sphere: SphereOnFlat, *, normal_load: ArrayLike) -> Floats:
    r"""Mean contact pressure, load over area of the contact circle. [Pa]

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
    .. math:: p_m = \tfrac23 p_0
    """
    return hertz_peak_pressure(sphere, normal_load=normal_load) / 1.5


def hertz_axial_stresses(
    sphere: SphereOnFlat, *, normal_load: ArrayLike, depth: ArrayLike, poisson_ratio: ArrayLike
) -> tuple[Floats, Floats]:
    r"""Normal stresses along and across the axis of the contact, tension positive. [Pa]

    Parameters
    ----------
    sphere : SphereOnFlat
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]
    depth : array_like, broadcastable to `normal_load`
        Depth below the surface, on the axis. [m]
    poisson_ratio : array_like, broadcastable to `normal_load`
        Poisson's ratio of the body in which the stress is computed. []

    Returns
    -------
    tuple of two ndarrays, the broadcast shape
        Normal to the surface, and parallel to it: radial and hoop stress are equal on the axis.

    Raises
    ------
    InvalidInput
        If a load is not positive, a depth negative, or Poisson's ratio outside 0 to 0.5.

    Notes
    -----
    With the depth over the contact radius, :math:`\zeta = z/a`,

    .. math::

        \frac{\sigma_z}{p_0} = -\frac{1}{1 + \zeta^2}, \qquad
        \frac{\sigma_r}{p_0} = -(1 + \nu) \left( 1 - \zeta \arctan\frac1\zeta \right) + \frac{1}{2 (1 + \zeta^2)}
    """
    load = require_positive(normal_load=normal_load)
    nu = require_within(0.0, 0.5, poisson_ratio=poisson_ratio)
    zeta = require_non_negative(depth=depth) / hertz_contact_radius(sphere, normal_load=load)
    p0 = hertz_peak_pressure(sphere, normal_load=load)
    along = -p0 / (1 + zeta**2)  # Johnson 3.45b
    across = -p0 * (1 + nu) * (1 - zeta * np.arctan2(1.0, zeta)) - along / 2  # Johnson 3.45a
    return along, across


def hertz_axial_shear_stress(
    sphere: SphereOnFlat, *, normal_load: ArrayLike, depth: ArrayLike, poisson_ratio: ArrayLike
) -> Floats:
    r"""Maximum shear stress at a point of the axis of the contact. [Pa]

    Parameters
    ----------
    sphere : SphereOnFlat
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]
    depth : array_like, broadcastable to `normal_load`
        Depth below the surface, on the axis. [m]
    poisson_ratio : array_like, broadcastable to `normal_load`
        Poisson's ratio of the body in which the stress is computed. []

    Returns
    -------
    ndarray, the broadcast shape

    Raises
    ------
    InvalidInput
        If a load is not positive, a depth negative, or Poisson's ratio outside 0 to 0.5.

    Notes
    -----
    .. math:: \tau = \tfrac12 |\sigma_z - \sigma_r|
    """
    along, across = hertz_axial_stresses(sphere, normal_load=normal_load, depth=depth, poisson_ratio=poisson_ratio)
    return np.abs(along - across) / 2


def tip_radius_for_pressure(
    *, mean_pressure: ArrayLike, normal_load: ArrayLike, effective_modulus: ArrayLike
) -> Floats:
    r"""Tip radius for a mean contact pressure under a load. [m]

    Parameters
    ----------
    mean_pressure : array_like, any shape
        Load over the area of the contact circle, the pressure called nominal. [Pa]
    normal_load : array_like, broadcastable to `hertz_mean_pressure`
        Force pressing the bodies together. [N]
    effective_modulus : array_like, broadcastable to `hertz_mean_pressure`
        Effective contact modulus of both bodies. [Pa]

    Returns
    -------
    ndarray, the broadcast shape

    Raises
    ------
    InvalidInput
        If an argument is not positive.

    Notes
    -----
    .. math:: R = \frac{4 E^* a^3}{3 F_N}, \qquad a = \sqrt{\frac{F_N}{\pi p_m}}

    The 300 MPa of D's Table 2.13 at 3 N is a circle of 0.01 mm2, of 0.113 mm diameter. An M50 pin on M50 would need a
    tip of about 9 mm radius for it, an alumina pin about 12 mm.
    """
    load = require_positive(normal_load=normal_load)
    area = load / require_positive(mean_pressure=mean_pressure)
    a: Floats = np.sqrt(area / np.pi)
    return 4 * require_positive(effective_modulus=effective_modulus) * a**3 / (3 * load)  # Johnson 4.22
