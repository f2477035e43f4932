"""Elastic bodies in contact: constants of a pair, and the stiffness of a coated body under an axisymmetric contact."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput, OutsideRange


@dataclass(frozen=True, kw_only=True, slots=True)
class ElasticBody:
    """Elastic constants of one linearly elastic, isotropic body.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus. [Pa]
    poisson_ratio : float
        Poisson's ratio, from 0 to 0.5. []

    Raises
    ------
    InvalidInput
        If the modulus is not positive, or Poisson's ratio outside 0 to 0.5.
    """

    youngs_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        require_positive(youngs_modulus=self.youngs_modulus)
        require_within(0.0, 0.5, poisson_ratio=self.poisson_ratio)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus, E/(2 (1 + nu)). [Pa]"""
        return self.youngs_modulus / (2 * (1 + self.poisson_ratio))


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactPair:
    r"""Combined elastic constants of two bodies in contact, and the plastic constants of the softer one.

    Parameters
    ----------
    effective_modulus : float
        Effective contact modulus E*. [Pa]
    poisson_ratio : float
        Poisson's ratio of the softer body. []
    yield_strength : float
        Yield strength of the softer body; infinite for bodies without yielding. [Pa]
    mindlin_ratio : float
        Tangential over normal stiffness of a sticking elastic contact, 4 G*/E*. []

    Raises
    ------
    InvalidInput
        If a modulus, strength or ratio is not positive, or Poisson's ratio outside 0 to 0.5.

    Notes
    -----
    .. math::

        \frac1{E^*} = \frac{1 - \nu_1^2}{E_1} + \frac{1 - \nu_2^2}{E_2}, \qquad
        \frac1{G^*} = \frac{2 - \nu_1}{G_1} + \frac{2 - \nu_2}{G_2}, \qquad
        \frac{k_t}{k_n} = \frac{4 G^*}{E^*}

    See Also
    --------
    contact_pair : The pair of two bodies.

    References
    ----------
    .. [1] K. L. Johnson, Contact Mechanics (1985), sections 4.2 and 7.2. doi:10.1017/CBO9781139171731
    """

    effective_modulus: float
    poisson_ratio: float
    yield_strength: float
    mindlin_ratio: float

    def __post_init__(self) -> None:
        require_positive(effective_modulus=self.effective_modulus, mindlin_ratio=self.mindlin_ratio)
        require_within(0.0, 0.5, poisson_ratio=self.poisson_ratio)
        if not self.yield_strength > 0:
            raise InvalidInput(f"yield_strength must be positive, got {self.yield_strength!r} Pa")


def identical_materials_mindlin_ratio(*, poisson_ratio: float) -> float:
    r"""Mindlin's ratio of tangential to normal contact stiffness for two bodies of one material. []

    Parameters
    ----------
    poisson_ratio : float
        Poisson's ratio of both bodies, from 0 to 0.5. []

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If Poisson's ratio is outside 0 to 0.5.

    Notes
    -----
    .. math:: \frac{k_t}{k_n} = \frac{2 (1 - \nu)}{2 - \nu}

    References
    ----------
    .. [1] R. D. Mindlin, J. Appl. Mech. 16, 259 (1949).
    """
    require_within(0.0, 0.5, poisson_ratio=poisson_ratio)
    return 2 * (1 - poisson_ratio) / (2 - poisson_ratio)


def contact_pair(*, softer: ElasticBody, harder: ElasticBody, yield_strength: float) -> ContactPair:
    """Combined constants of two bodies in contact.

    Parameters
    ----------
    softer, harder : ElasticBody
    yield_strength : float
        Yield strength of the softer body. [Pa]

    Returns
    -------
    ContactPair

    Raises
    ------
    InvalidInput
        If the yield strength is not positive.

    Examples
    --------
    >>> from sonolube.models.contact import ElasticBody, contact_pair
    >>> from sonolube.text.units import format_si
    >>> aluminium = ElasticBody(youngs_modulus=73e9, poisson_ratio=0.33)
    >>> steel = ElasticBody(youngs_modulus=193e9, poisson_ratio=0.29)
    >>> pair = contact_pair(softer=aluminium, harder=steel, yield_strength=410e6)
    >>> format_si(pair.effective_modulus, "Pa")
    '59 GPa'
    """
    effective_modulus = 1 / sum((1 - body.poisson_ratio**2) / body.youngs_modulus for body in (softer, harder))
    effective_shear_modulus = 1 / sum((2 - body.poisson_ratio) / body.shear_modulus for body in (softer, harder))
    return ContactPair(
        effective_modulus=effective_modulus,
        poisson_ratio=softer.poisson_ratio,
        yield_strength=yield_strength,
        mindlin_ratio=4 * effective_shear_modulus / effective_modulus,
    )


MAXIMUM_RADIUS_RATIO = 200.0
"""Largest contact radius over layer thickness for which the integral equation is solved. []"""

_WAVES = np.polynomial.legendre.leggauss(24)
_LARGEST_WAVENUMBER = 25.0  # times the thickness, beyond which the substrate has no effect


@dataclass(frozen=True, kw_only=True, slots=True)
class CoatedBody:
    """Elastic layer of constant thickness bonded to an elastic half-space.

    Parameters
    ----------
    layer : ElasticBody
    substrate : ElasticBody
    thickness : float
        Thickness of the layer. [m]

    Raises
    ------
    InvalidInput
        If the thickness is not positive and finite.
    """

    layer: ElasticBody
    substrate: ElasticBody
    thickness: float

    def __post_init__(self) -> None:
        require_positive(thickness=self.thickness)


def layer_compliance_ratio(body: CoatedBody, *, wavenumber: ArrayLike) -> Floats:
    r"""Normal compliance of the coated body to a harmonic pressure over that of the layer material alone. []

    Parameters
    ----------
    body : CoatedBody
    wavenumber : array_like, any shape
        Waves per length of the pressure, q/(2 pi). [1/m]

    Returns
    -------
    ndarray, shape of `wavenumber`
        From the plane-strain modulus of the layer over that of the substrate, for long waves, to 1 for short ones.

    Raises
    ------
    InvalidInput
        If a wavenumber is negative or not finite.

    Notes
    -----
    Exact. A half-space under the pressure p cos(q x) deflects by 2 (1 - nu^2)/(E q) p cos(q x). On a layer of thickness
    t that is multiplied by

    .. math::

        \frac{1 + 4 s \kappa\, e^{-2s} - \lambda\kappa\, e^{-4s}}
             {1 - (\lambda + \kappa + 4 \kappa s^2)\, e^{-2s} + \lambda\kappa\, e^{-4s}}, \qquad s = q t,

        \kappa = \frac{\mu - 1}{\mu + 3 - 4\nu_1}, \quad
        \lambda = \frac{\mu (3 - 4\nu_2) - (3 - 4\nu_1)}{1 + \mu (3 - 4\nu_2)}, \quad \mu = \frac{G_1}{G_2}

    with the constants of the layer, 1, and of the substrate, 2.

    References
    ----------
    .. [1] T. C. O'Sullivan and R. B. King, J. Tribol. 110, 235 (1988). doi:10.1115/1.3261591
    .. [2] T. Nogi and T. Kato, J. Tribol. 119, 493 (1997). doi:10.1115/1.2833525
    """
    return _compliance_ratio(body, 2 * math.pi * require_non_negative(wavenumber=wavenumber) * body.thickness)


def equivalent_plane_strain_modulus(body: CoatedBody, *, contact_radius: ArrayLike) -> Floats:
    r"""Plane-strain modulus of the homogeneous half-space with the same stiffness at a contact radius. [Pa]

    Parameters
    ----------
    body : CoatedBody
    contact_radius : array_like, any shape
        Radius of the contact circle. [m]

    Returns
    -------
    ndarray, shape of `contact_radius`
        E/(1 - nu^2): that of the layer for contacts much smaller than the thickness, of the substrate for much larger.

    Raises
    ------
    InvalidInput
        If a radius is not positive and finite.
    OutsideRange
        If a radius exceeds `MAXIMUM_RADIUS_RATIO` times the thickness.

    Notes
    -----
    The normal stiffness of a frictionless contact circle over its diameter. It is the same for every axisymmetric
    indenter, since an increment of the load adds the pressure of a flat punch. For that punch the integral equation of
    the second kind

    .. math:: \frac{f(t)}{2} + \frac1\pi \int_0^a f(s)\, M(t, s)\, \mathrm{d}s = \frac12, \qquad
              M = \int_0^\infty (r(q) - 1) \cos qt \cos qs\, \mathrm{d}q

    with the compliance ratio r of `layer_compliance_ratio` is solved by Gauss-Legendre quadrature; the load is the
    integral of f. In contact with a body of plane-strain modulus E_2' the effective modulus is E' E_2'/(E' + E_2').

    References
    ----------
    .. [1] N. N. Lebedev and I. S. Ufliand, J. Appl. Math. Mech. 22, 442 (1958).
    """
    a = require_positive(contact_radius=contact_radius)
    if a.max() > MAXIMUM_RADIUS_RATIO * body.thickness:
        raise OutsideRange(
            f"contact_radius must be at most {MAXIMUM_RADIUS_RATIO:g} times the thickness {body.thickness:.3g} m, "
            f"got {a.max():.4g} m: use the modulus of the substrate alone"
        )
    ratios = [_stiffness_ratio(body, radius / body.thickness) for radius in a.ravel()]
    layer_modulus = body.layer.youngs_modulus / (1 - body.layer.poisson_ratio**2)
    return layer_modulus * np.reshape(ratios, a.shape)


def _stiffness_ratio(body: CoatedBody, radius: float) -> float:
    """Stiffness under a flat punch over that of the layer material alone; its radius is in thicknesses."""
    node, weight = np.polynomial.legendre.leggauss(24 + math.ceil(4 * radius))
    t, dt = radius * (1 + node) / 2, radius * weight / 2
    # f/2 + (1/pi) integral of f(s) M(t, s) ds = 1/2 over 0 < s < a; the load is the integral of f
    q, dq = _wave_nodes(radius)
    waves = np.cos(np.multiply.outer(t, q))
    M = (waves * (dq * (_compliance_ratio(body, q) - 1))) @ waves.T
    f = np.linalg.solve(np.eye(t.size) + 2 / math.pi * M * dt, np.ones(t.size))
    return float(f @ dt) / radius


def _wave_nodes(radius: float) -> tuple[Floats, Floats]:
    """Quadrature nodes and weights over wavenumbers, dense enough for the kernel and the contact radius."""
    panels = np.linspace(0.0, _LARGEST_WAVENUMBER, 8 + math.ceil(_LARGEST_WAVENUMBER * radius / 12))
    half = np.diff(panels)[:, None] / 2
    q = panels[:-1, None] + half * (1 + _WAVES[0])
    return q.ravel(), (half * _WAVES[1]).ravel()


def _compliance_ratio(body: CoatedBody, q: Floats) -> Floats:
    """Compliance ratio for angular wavenumbers times the thickness."""
    mu = body.layer.shear_modulus / body.substrate.shear_modulus
    a_1, a_2 = 3 - 4 * body.layer.poisson_ratio, 3 - 4 * body.substrate.poisson_ratio
    lam, kappa = (mu * a_2 - a_1) / (1 + mu * a_2), (mu - 1) / (mu + a_1)
    theta = np.exp(-2 * q)
    above = 1 + 4 * q * kappa * theta - lam * kappa * theta**2
    return np.asarray(above / (1 - (lam + kappa + 4 * kappa * q**2) * theta + lam * kappa * theta**2))
