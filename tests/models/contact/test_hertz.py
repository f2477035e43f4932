"""Hertz contact of the pin's tip, held to integrals of point loads on a half-space."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.integrate import quad

from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.models.contact import (
    ContactPair,
    ElasticBody,
    SphereOnFlat,
    contact_pair,
    hertz_axial_shear_stress,
    hertz_axial_stresses,
    hertz_contact_radius,
    hertz_mean_pressure,
    hertz_peak_pressure,
    tip_radius_for_pressure,
)

ACORN_NUT = SphereOnFlat(tip_radius=5e-3, effective_modulus=59.57e9)
LOADS = st.floats(1e-3, 1e3)


def pair_of(pin: str, disc: str) -> ContactPair:
    bodies = (
        ElasticBody(
            youngs_modulus=material(name).value("youngs_modulus"), poisson_ratio=material(name).value("poisson_ratio")
        )
        for name in (pin, disc)
    )
    return contact_pair(softer=next(bodies), harder=next(bodies), yield_strength=1e9)


@given(load=LOADS)
def test_the_pressure_integrated_over_the_circle_is_the_load(load: float) -> None:
    radius = float(hertz_contact_radius(ACORN_NUT, normal_load=load))
    p0 = float(hertz_peak_pressure(ACORN_NUT, normal_load=load))
    carried, _ = quad(lambda r: 2 * np.pi * r * p0 * np.sqrt(1 - (r / radius) ** 2), 0, radius)
    assert carried == approx(load, rel=1e-6)


@given(load=LOADS)
def test_the_peak_is_one_and_a_half_times_the_load_over_the_circle(load: float) -> None:
    over_circle = load / (np.pi * hertz_contact_radius(ACORN_NUT, normal_load=load) ** 2)
    assert hertz_mean_pressure(ACORN_NUT, normal_load=load) == approx(over_circle)
    assert hertz_peak_pressure(ACORN_NUT, normal_load=load) == approx(1.5 * over_circle)


def test_point_loads_integrated_over_the_circle_deform_the_flat_to_the_shape_of_the_sphere() -> None:
    # Boussinesq: a pressure p at distance s sinks the surface by p dA/(pi E* s). Summed about the middle in polar
    # coordinates, s dA = dr dphi; about the edge, along chords through it.
    load = 3.0
    a = float(hertz_contact_radius(ACORN_NUT, normal_load=load))
    p0 = float(hertz_peak_pressure(ACORN_NUT, normal_load=load))
    modulus = ACORN_NUT.effective_modulus
    in_the_middle = 2 / modulus * quad(lambda r: p0 * np.sqrt(1 - (r / a) ** 2), 0, a)[0]
    assert a**2 / ACORN_NUT.tip_radius == approx(in_the_middle, rel=1e-7)

    def along_chord(phi: float) -> float:
        def pressure(s: float) -> float:
            squared = (a - s * np.cos(phi)) ** 2 + (s * np.sin(phi)) ** 2
            return p0 * float(np.sqrt(max(0.0, 1 - squared / a**2)))

        return float(quad(pressure, 0, 2 * a * np.cos(phi))[0])

    at_the_edge = quad(along_chord, -np.pi / 2, np.pi / 2)[0] / (np.pi * modulus)
    assert in_the_middle - at_the_edge == approx(a**2 / (2 * ACORN_NUT.tip_radius), rel=1e-5)


def test_stresses_on_the_axis_are_those_of_point_loads_integrated_over_the_circle() -> None:
    # Boussinesq's point load on a half-space in cylindrical components (Johnson 3.19), tension positive.
    load, nu = 3.0, 0.3
    a = float(hertz_contact_radius(ACORN_NUT, normal_load=load))
    p0 = float(hertz_peak_pressure(ACORN_NUT, normal_load=load))

    def ring(r: float) -> float:
        return 2 * np.pi * r * p0 * float(np.sqrt(1 - (r / a) ** 2))

    for z in (0.1 * a, 0.48 * a, a, 3 * a):

        def along(r: float, z: float = z) -> float:
            return float(-3 * z**3 / (2 * np.pi * np.hypot(r, z) ** 5))

        def across(r: float, z: float = z) -> float:
            R = np.hypot(r, z)
            radial = ((1 - 2 * nu) / (R * (R + z)) - 3 * r**2 * z / R**5) / (2 * np.pi)
            hoop = (1 - 2 * nu) * (z / R**3 - 1 / (R * (R + z))) / (2 * np.pi)
            return float(radial + hoop) / 2  # on the axis, a ring's radial and hoop stresses share evenly

        sigma_z, sigma_r = hertz_axial_stresses(ACORN_NUT, normal_load=load, depth=z, poisson_ratio=nu)
        assert sigma_z == approx(quad(lambda r: along(r) * ring(r), 0, a, epsabs=0)[0], rel=1e-7)
        assert sigma_r == approx(quad(lambda r: across(r) * ring(r), 0, a, epsabs=0)[0], rel=1e-6)


def test_at_the_centre_of_the_surface_the_radial_stress_is_half_plus_poissons_ratio_of_the_peak() -> None:
    # Johnson, section 3.4: sigma_r = -(1 + 2 nu) p0/2, sigma_z = -p0.
    p0 = hertz_peak_pressure(ACORN_NUT, normal_load=3.0)
    sigma_z, sigma_r = hertz_axial_stresses(ACORN_NUT, normal_load=3.0, depth=0.0, poisson_ratio=0.3)
    assert sigma_z == approx(-p0)
    assert sigma_r == approx(-0.8 * p0)


def test_shear_is_largest_at_half_the_contact_radius_with_a_third_of_the_peak() -> None:
    # Johnson, section 4.2: 0.31 p0 at 0.48 a for nu = 0.3.
    places = np.linspace(0, 2, 2001)
    depth = places * hertz_contact_radius(ACORN_NUT, normal_load=1.0)
    shear = hertz_axial_shear_stress(ACORN_NUT, normal_load=1.0, depth=depth, poisson_ratio=0.3)
    assert shear.max() / hertz_peak_pressure(ACORN_NUT, normal_load=1.0) == approx(0.31, abs=0.0005)
    assert places[np.argmax(shear)] == approx(0.48, abs=0.002)


@given(load=LOADS, factor=st.floats(0.1, 10))
def test_pressure_falls_with_the_tip_radius_to_the_power_two_thirds(load: float, factor: float) -> None:
    larger = SphereOnFlat(tip_radius=factor * ACORN_NUT.tip_radius, effective_modulus=ACORN_NUT.effective_modulus)
    ratio = hertz_peak_pressure(larger, normal_load=load) / hertz_peak_pressure(ACORN_NUT, normal_load=load)
    assert ratio == approx(factor ** (-2 / 3))


@given(load=LOADS)
def test_the_tip_radius_is_recovered_from_its_pressure(load: float) -> None:
    pressure = hertz_mean_pressure(ACORN_NUT, normal_load=load)
    radius = tip_radius_for_pressure(
        mean_pressure=pressure, normal_load=load, effective_modulus=ACORN_NUT.effective_modulus
    )
    assert radius == approx(ACORN_NUT.tip_radius)


def test_three_hundred_megapascal_at_three_newton_require_a_tip_radius_of_a_centimetre() -> None:
    # D Table 2.13. 3 N/300 MPa = 0.01 mm2: a = sqrt(0.01/pi) = 0.0564 mm. R = 4 E* a^3/(3 F), a^3 = 1.796e-4 mm3:
    # M50 on M50, E* = 214/(2 (1 - 0.29^2)) = 116.8 GPa: 4 x 116.8e3 x 1.796e-4/9 = 9.32 mm.
    # Alumina on M50, 1/E* = (1 - 0.22^2)/370 + (1 - 0.29^2)/214, E* = 145.9 GPa: 11.65 mm.
    for pin, radius in (("m50", 9.32e-3), ("alumina", 11.65e-3)):
        modulus = pair_of(pin, "m50").effective_modulus
        assert tip_radius_for_pressure(mean_pressure=300e6, normal_load=3.0, effective_modulus=modulus) == approx(
            radius, rel=1e-3
        )
        tip = SphereOnFlat(tip_radius=radius, effective_modulus=modulus)
        assert np.pi * hertz_contact_radius(tip, normal_load=3.0) ** 2 == approx(0.01e-6, rel=1e-3)
        assert hertz_peak_pressure(tip, normal_load=3.0) == approx(450e6, rel=1e-3)


def test_a_load_of_zero_has_no_contact_circle() -> None:
    assert hertz_contact_radius(ACORN_NUT, normal_load=0.0) == 0
    assert hertz_peak_pressure(ACORN_NUT, normal_load=0.0) == 0


def test_results_take_the_shape_of_the_arguments() -> None:
    loads = np.array([[1.0], [2.0]])
    depths = np.array([1e-6, 2e-6, 3e-6])
    assert hertz_axial_shear_stress(ACORN_NUT, normal_load=loads, depth=depths, poisson_ratio=0.3).shape == (2, 3)


def test_meaningless_arguments_are_refused_by_name() -> None:
    with raises(InvalidInput, match=r"tip_radius must be positive, got 0\.0 m"):
        SphereOnFlat(tip_radius=0.0, effective_modulus=1e9)
    with raises(InvalidInput, match=r"normal_load must not be negative, got -3\.0 N"):
        hertz_contact_radius(ACORN_NUT, normal_load=-3.0)
    with raises(InvalidInput, match=r"depth must not be negative"):
        hertz_axial_shear_stress(ACORN_NUT, normal_load=1.0, depth=-1e-6, poisson_ratio=0.3)
    with raises(InvalidInput, match=r"poisson_ratio must lie between 0 and 0\.5, got 0\.6"):
        hertz_axial_shear_stress(ACORN_NUT, normal_load=1.0, depth=1e-6, poisson_ratio=0.6)
