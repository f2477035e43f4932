"""A coated body: how stiff a bonded layer on a thick body is to a contact of a given size."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.contact.pair import ElasticBody
from sonolube.errors import OutsideRange

WIDEST_CONTACT = 200.0
"""Contact radius over thickness of the layer up to which the integral equation is solved. []"""

_WAVES = np.polynomial.legendre.leggauss(24)
_DEEPEST = 25.0  # wavenumber times thickness beyond which the body below is not felt


@dataclass(frozen=True, kw_only=True, slots=True)
class CoatedBody:
    """An elastic layer bonded to a thick elastic body.

    Parameters
    ----------
    layer : ElasticBody
    substrate : ElasticBody
    thickness : float
        Thickness of the layer. [m]
    """

    layer: ElasticBody
    substrate: ElasticBody
    thickness: float

    def __post_init__(self) -> None:
        require_positive(thickness=self.thickness)


def layer_compliance_ratio(body: CoatedBody, *, wavenumber: ArrayLike) -> Floats:
    """Return how much a wave of normal pressure deflects the coated body, over the same on a thick layer. []

    Parameters
    ----------
    body : CoatedBody
    wavenumber : array_like, any shape
        Waves per length of the pressure. [1/m]

    Returns
    -------
    ndarray, shape of `wavenumber`
        From the layer's plane-strain modulus over the substrate's, for long waves, to 1 for short ones.

    Raises
    ------
    InvalidInput
        If a wavenumber is negative or not finite.

    Notes
    -----
    Exact. A thick body of modulus E and Poisson's ratio nu under pressure p cos(q x) deflects by
    2 (1 - nu^2)/(E q) p cos(q x).

    References
    ----------
    .. [1] T. C. O'Sullivan and R. B. King, J. Tribol. 110, 235 (1988). doi:10.1115/1.3261591
    .. [2] T. Nogi and T. Kato, J. Tribol. 119, 493 (1997). doi:10.1115/1.2833525
    """
    return _compliance_ratio(body, 2 * math.pi * require_non_negative(wavenumber=wavenumber) * body.thickness)


def coated_modulus(body: CoatedBody, *, contact_radius: ArrayLike) -> Floats:
    """Return the plane-strain modulus E/(1 - nu^2) of the thick body that is as stiff to a contact of this radius. [Pa]

    Parameters
    ----------
    body : CoatedBody
    contact_radius : array_like, any shape
        Radius of the contact circle. [m]

    Returns
    -------
    ndarray, shape of `contact_radius`
        From the layer's, for contacts far smaller than the thickness, to the substrate's for far larger ones.

    Raises
    ------
    InvalidInput
        If a radius is not positive and finite.
    OutsideRange
        If a radius exceeds the thickness by more than `WIDEST_CONTACT`.

    Notes
    -----
    The stiffness of a frictionless contact circle over its diameter. It is the same for every axisymmetric indenter,
    for a small further load adds the pressure of a flat punch. Found by Gauss's rule from an integral equation of
    Fredholm's second kind for that punch, with no approximation of the pressure.
    In contact with a body of modulus E_2' the combined modulus is E' E_2'/(E' + E_2').

    References
    ----------
    .. [1] N. N. Lebedev and I. S. Ufliand, J. Appl. Math. Mech. 22, 442 (1958).
    """
    a = require_positive(contact_radius=contact_radius)
    if a.max() > WIDEST_CONTACT * body.thickness:
        raise OutsideRange(
            f"contact_radius must be at most {WIDEST_CONTACT:g} times the thickness {body.thickness:.3g} m, "
            f"got {a.max():.4g} m: take the substrate alone"
        )
    ratios = [_stiffness_ratio(body, radius / body.thickness) for radius in a.ravel()]
    return _plane_modulus(body.layer) * np.reshape(ratios, a.shape)


def _stiffness_ratio(body: CoatedBody, radius: float) -> float:
    """Return the stiffness of a flat punch of this radius, in thicknesses, over that on a thick layer."""
    node, weight = np.polynomial.legendre.leggauss(24 + math.ceil(4 * radius))
    t, dt = radius * (1 + node) / 2, radius * weight / 2
    # f/2 + (1/pi) integral of f(s) M(t, s) ds = 1/2 over 0 < s < a; the load is the integral of f
    q, dq = _wave_nodes(radius)
    waves = np.cos(np.multiply.outer(t, q))
    M = (waves * (dq * (_compliance_ratio(body, q) - 1))) @ waves.T
    f = np.linalg.solve(np.eye(t.size) + 2 / math.pi * M * dt, np.ones(t.size))
    return float(f @ dt) / radius


def _wave_nodes(radius: float) -> tuple[Floats, Floats]:
    """Return nodes and weights over wavenumbers, close enough for waves as short as the kernel and the circle make."""
    panels = np.linspace(0.0, _DEEPEST, 8 + math.ceil(_DEEPEST * radius / 12))
    half = np.diff(panels)[:, None] / 2
    q = panels[:-1, None] + half * (1 + _WAVES[0])
    return q.ravel(), (half * _WAVES[1]).ravel()


def _compliance_ratio(body: CoatedBody, q: Floats) -> Floats:
    """Return the ratio for angular wavenumbers times thickness."""
    mu = body.layer.shear_modulus / body.substrate.shear_modulus
    a_1, a_2 = 3 - 4 * body.layer.poisson_ratio, 3 - 4 * body.substrate.poisson_ratio
    lam, kappa = (mu * a_2 - a_1) / (1 + mu * a_2), (mu - 1) / (mu + a_1)
    theta = np.exp(-2 * q)
    above = 1 + 4 * q * kappa * theta - lam * kappa * theta**2
    return np.asarray(above / (1 - (lam + kappa + 4 * kappa * q**2) * theta + lam * kappa * theta**2))


def _plane_modulus(body: ElasticBody) -> float:
    return body.youngs_modulus / (1 - body.poisson_ratio**2)
