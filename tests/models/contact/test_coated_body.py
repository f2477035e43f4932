"""A layer on a half-space against an independent solution of the plane-strain equations and first-order theory."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.integrate import quad

from sonolube.errors import OutsideRange
from sonolube.models.contact import CoatedBody, ElasticBody, equivalent_plane_strain_modulus, layer_compliance_ratio

STEEL = ElasticBody(youngs_modulus=200e9, poisson_ratio=0.29)
POWDER = ElasticBody(youngs_modulus=3e9, poisson_ratio=0.35)
PAINTED = CoatedBody(layer=POWDER, substrate=STEEL, thickness=60e-6)
bodies = st.builds(ElasticBody, youngs_modulus=st.floats(1e9, 4e11), poisson_ratio=st.floats(0.05, 0.49))


def plane_modulus(body: ElasticBody) -> float:
    return body.youngs_modulus / (1 - body.poisson_ratio**2)


def deflection_by_airy(layer: ElasticBody, substrate: ElasticBody, q: float) -> float:
    """Deflection under unit pressure cos(q x) on a layer of unit thickness, from Airy's function in both bodies.

    phi = [(A + B z) e^(-q z) + (C + D z) e^(q z)] cos(q x), z downwards; below only A and B.
    Stresses: zz = -q^2 phi, xz from phi_xz, xx = phi_zz; plane-strain displacements follow by integration.
    """

    def terms(body: ElasticBody, z: float) -> np.ndarray:  # rows: zz, xz, u, w; columns: A, B, C, D
        nu, two_mu = body.poisson_ratio, body.youngs_modulus / (1 + body.poisson_ratio)
        rows = []
        for sign in (-1.0, 1.0):
            e = math.exp(sign * q * z)
            for power in (0, 1):
                f = z**power * e
                f1 = (power + sign * q * z**power) * e
                f2 = (2 * sign * q * power + q**2 * z**power) * e
                xx, zz = f2, -(q**2) * f  # times cos
                xz = q * f1  # times sin
                u = ((1 - nu) * xx - nu * zz) / (two_mu * q)  # du/dx = eps_xx, u times sin
                # 2 mu eps_xz = xz = mu (du/dz + dw/dx); w times cos, so dw/dx = -q w sin
                du = derivative_u(body, q, z, sign, power)
                w = (du - 2 * xz / two_mu) / q
                rows.append([zz, xz, u, w])
        return np.array(rows).T

    def derivative_u(body: ElasticBody, q: float, z: float, sign: float, power: int) -> float:
        nu, two_mu = body.poisson_ratio, body.youngs_modulus / (1 + body.poisson_ratio)
        e = math.exp(sign * q * z)
        f1 = (power + sign * q * z**power) * e
        f3 = (3 * q**2 * power + sign * q**3 * z**power) * e
        return ((1 - nu) * f3 + nu * q**2 * f1) / (two_mu * q)

    top, bottom, below = terms(layer, 0.0), terms(layer, 1.0), terms(substrate, 1.0)[:, :2]
    system = np.zeros((6, 6))
    system[:2, :4] = top[:2]
    system[2:, :4], system[2:, 4:] = bottom, -below
    scale = np.abs(system).max(axis=0)
    unknowns = np.linalg.solve(system / scale, np.array([-1.0, 0, 0, 0, 0, 0])) / scale
    return float(top[3] @ unknowns[:4])


@given(layer=bodies, substrate=bodies, q=st.floats(0.05, 6))
def test_the_kernel_solves_the_equations_of_plane_strain(layer: ElasticBody, substrate: ElasticBody, q: float) -> None:
    body = CoatedBody(layer=layer, substrate=substrate, thickness=1.0)
    thick = 2 / (plane_modulus(layer) * q)
    assert layer_compliance_ratio(body, wavenumber=q / (2 * math.pi)) == approx(
        deflection_by_airy(layer, substrate, q) / thick, rel=1e-6
    )


def test_contacts_much_smaller_or_larger_than_the_layer_have_the_modulus_of_one_body() -> None:
    small, large = equivalent_plane_strain_modulus(PAINTED, contact_radius=[60e-6 * 1e-4, 60e-6 * 150])
    assert small == approx(plane_modulus(POWDER), rel=1e-3)
    # a soft layer of unhindered bulk still yields by its thickness over its constrained modulus
    assert 0.8 * plane_modulus(STEEL) < large < plane_modulus(STEEL)


def test_a_layer_of_the_substrate_material_has_no_effect() -> None:
    same = CoatedBody(layer=STEEL, substrate=STEEL, thickness=1e-4)
    assert equivalent_plane_strain_modulus(same, contact_radius=[1e-6, 1e-4, 1e-2]) == approx(
        plane_modulus(STEEL), rel=1e-12
    )


@pytest.mark.parametrize("thickness_ratio", [0.1, 0.5, 1.0, 3.0])
def test_a_slightly_different_layer_has_the_modulus_of_first_order_theory(thickness_ratio: float) -> None:
    # Gao, Chiu and Lee (1992), I_0 for one Poisson's ratio: exact to first order in the difference of moduli
    nu, xi, step = 0.3, thickness_ratio, 1e-4
    weight = 2 / math.pi * math.atan(xi) + ((1 - 2 * nu) * xi * math.log((1 + xi**2) / xi**2) - xi / (1 + xi**2)) / (
        2 * math.pi * (1 - nu)
    )
    substrate = ElasticBody(youngs_modulus=100e9, poisson_ratio=nu)
    layer = ElasticBody(youngs_modulus=100e9 * (1 + step), poisson_ratio=nu)
    modulus = equivalent_plane_strain_modulus(
        CoatedBody(layer=layer, substrate=substrate, thickness=xi), contact_radius=1.0
    )
    assert modulus / plane_modulus(substrate) - 1 == approx(weight * step, rel=1e-3)


@pytest.mark.parametrize("a", [1 / 3, 1.0, 10 / 3])
def test_the_pressure_of_a_uniform_body_bounds_the_stiffness_from_below(a: float) -> None:
    # least complementary energy of a flat punch of radius a, in thicknesses
    def excess(q: float) -> float:
        ratio = float(layer_compliance_ratio(PAINTED, wavenumber=q / (2 * math.pi * PAINTED.thickness)))
        return (math.sin(q * a) / (q * a)) ** 2 * (ratio - 1)

    energy = quad(excess, 1e-9, 30, limit=400)[0]
    bound = 1 / (1 + 2 * a / math.pi * energy)
    modulus = float(equivalent_plane_strain_modulus(PAINTED, contact_radius=a * PAINTED.thickness)) / plane_modulus(
        POWDER
    )
    assert 0.7 * modulus < bound <= modulus * (1 + 1e-9)


def test_sixty_micrometres_of_powder_reduce_the_modulus_of_steel_tenfold_for_a_worn_pin() -> None:
    # D 4.1.3: 0.126 mm2 of nominal area is a circle of 0.2 mm radius; 3 GPa is assumed for the powder
    modulus = float(equivalent_plane_strain_modulus(PAINTED, contact_radius=0.2e-3))
    assert 6 * plane_modulus(POWDER) < modulus < 8 * plane_modulus(POWDER)
    assert 8.5 < plane_modulus(STEEL) / modulus < 10.5


def test_a_contact_much_wider_than_the_layer_is_refused() -> None:
    with raises(OutsideRange, match="use the modulus of the substrate alone"):
        equivalent_plane_strain_modulus(PAINTED, contact_radius=1.0)
