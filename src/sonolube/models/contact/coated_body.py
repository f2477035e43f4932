"""Contact stiffness of a coated body: a bonded elastic layer on a half-space under an axisymmetric contact."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import OutsideRange
from sonolube.models.contact.pair import ElasticBody

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
