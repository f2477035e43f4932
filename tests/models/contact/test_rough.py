"""Rough contact: closed forms, special functions, adaptive quadrature and proportionalities."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import mpmath
import numpy as np
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from pytest import approx, fixture, mark, raises
from scipy.integrate import quad
from tests.tiers import examples

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import (
    ASPERITY_LAWS,
    AsperityLaw,
    ContactPair,
    ExponentialHeights,
    GaussianHeights,
    HeightDistribution,
    RoughContact,
    asperity_area,
    asperity_force,
    contact_count,
    critical_interference,
    decay_length,
    normal_force,
    normal_stiffness,
    real_contact_area,
    separation,
)
from sonolube.models.surfaces import Roughness

STEEL = ContactPair(effective_modulus=110e9, poisson_ratio=0.3, yield_strength=2e9, mindlin_ratio=0.8)
FINE = Roughness(rms_height=0.2e-6, summit_radius=20e-6, summit_density=1.25e10)
CONTACT = RoughContact(roughness=FINE, pair=STEEL, nominal_area=1e-4, asperity=ASPERITY_LAWS["dong_2015"])
Floats = NDArray[np.float64]

LAWS = list(ASPERITY_LAWS.values())
HEIGHTS: list[HeightDistribution] = [
    ExponentialHeights(),
    GaussianHeights(),
    GaussianHeights(summit_deviation_ratio=0.6),
]


@fixture(params=LAWS, ids=lambda law: law.name)
def asperity(request: object) -> AsperityLaw:
    law: AsperityLaw = request.param  # type: ignore[attr-defined]
    return law


@fixture(params=HEIGHTS, ids=["exponential", "gaussian", "narrow_gaussian"])
def contact(request: object, asperity: AsperityLaw) -> RoughContact:
    heights: HeightDistribution = request.param  # type: ignore[attr-defined]
    return replace(CONTACT, heights=heights, asperity=asperity)


def adaptive_quadrature(contact: RoughContact, h: float, law: Callable[..., Floats]) -> float:
    """Return the integral over the asperities by adaptive quadrature, split at the breakpoints of the law."""
    roughness = contact.roughness
    Rq, Rs = roughness.rms_height, roughness.summit_radius
    w_c = critical_interference(contact.asperity, contact.pair, summit_radius=Rs) / Rq
    bounds = {0.0, 0.05, 0.3, 1.0, 2.0, 4.0, 12.0}
    bounds |= {each * w_c for each in contact.asperity.breakpoints if each * w_c < 12}

    def integrand(w: float) -> float:
        one = law(contact.asperity, contact.pair, summit_radius=Rs, interference=w * Rq)
        return float(one * np.exp(contact.heights.log_density(np.asarray(h + w))))

    edges = sorted(bounds)
    parts = (float(quad(integrand, a, b, epsabs=0, epsrel=1e-10)[0]) for a, b in pairwise(edges))
    return roughness.summit_density * contact.nominal_area * sum(parts)


@mark.parametrize("h", [-0.5, 1.0, 2.5])
def test_force_and_area_are_the_integrals_over_all_summits(contact: RoughContact, h: float) -> None:
    d = h * FINE.rms_height
    assert normal_force(contact, separation=d) == approx(
        adaptive_quadrature(contact, h, asperity_force), rel=1e-8, abs=0
    )
    assert real_contact_area(contact, separation=d) == approx(
        adaptive_quadrature(contact, h, asperity_area), rel=1e-8, abs=0
    )


@mark.parametrize("h", [-5.93, -1.0, 0.0, 0.511, 3.0, 7.77, 20.02, 35.9])
def test_integrals_over_gaussian_heights_are_parabolic_cylinder_functions(h: float) -> None:
    contact = replace(CONTACT, heights=GaussianHeights(), asperity=ASPERITY_LAWS["elastic"])
    d = h * FINE.rms_height

    def moment(n: float) -> float:
        with mpmath.workdps(30):
            weight = mpmath.gamma(n + 1) / mpmath.sqrt(2 * mpmath.pi) * mpmath.exp(-(mpmath.mpf(h) ** 2) / 4)
            return float(weight * mpmath.pcfd(-n - 1, h))

    summits = FINE.summit_density * 1e-4
    hertz = 4 / 3 * 110e9 * math.sqrt(FINE.summit_radius) * FINE.rms_height**1.5
    assert normal_force(contact, separation=d) == approx(summits * hertz * moment(1.5), rel=1e-10, abs=0)
    section = math.pi * FINE.summit_radius * FINE.rms_height
    assert real_contact_area(contact, separation=d) == approx(summits * section * moment(1), rel=1e-10, abs=0)
    assert contact_count(contact, separation=d) == approx(summits * moment(0), rel=1e-10, abs=0)


@mark.parametrize("yield_strength", [1e6, 30e6, 400e6, 2e9, 40e9])
@mark.parametrize("name", ["dong_2015", "chang_etsion_bogy", "chang_etsion_bogy_1987"])
def test_integrals_over_exponential_heights_are_the_closed_forms(yield_strength: float, name: str) -> None:
    contact = replace(CONTACT, pair=replace(STEEL, yield_strength=yield_strength), asperity=ASPERITY_LAWS[name])
    c, lam, Rq, Rs, E, An = 17, 3, FINE.rms_height, FINE.summit_radius, 110e9, 1e-4
    beta, d = FINE.summit_density * Rq * Rs, 0.3e-6
    coefficient = 0.6 * 2.8 if name == "chang_etsion_bogy_1987" else 1.234 + 1.256 * 0.3
    pressure = coefficient * yield_strength * (1 - 0.3**2 if name == "dong_2015" else 1)
    a = lam * (math.pi * pressure / (2 * E)) ** 2 * Rs / Rq
    fall = math.exp(-lam * d / Rq)

    with mpmath.workdps(30):  # the bracket cancels to sixteen digits for early yielding
        a_ = mpmath.mpf(a)
        bracket = float(
            3 * mpmath.sqrt(mpmath.pi) / 4 * mpmath.erf(mpmath.sqrt(a_))
            - (a_**1.5 + 1.5 * mpmath.sqrt(a_)) * mpmath.exp(-a_)
        )
        elastic_part = float(1 - (1 + a_) * mpmath.exp(-a_))
    elastic_force = An * E * 4 * c * beta / (3 * lam**2.5) * math.sqrt(Rq / Rs) * bracket * fall
    plastic_force = An * c * math.pi * beta * pressure / lam**2 * (2 + a) * math.exp(-a) * fall
    whole = An * c * math.pi * beta / lam**2 * fall

    assert normal_force(contact, separation=d) == approx(elastic_force + plastic_force, rel=1e-11, abs=0)
    assert real_contact_area(contact, separation=d) == approx(
        whole * (elastic_part + (2 + a) * math.exp(-a)), rel=1e-11, abs=0
    )


def test_bodies_without_yielding_have_the_contact_of_greenwood_and_williamson(asperity: AsperityLaw) -> None:
    contact = replace(CONTACT, pair=replace(STEEL, yield_strength=math.inf), asperity=asperity)
    Rq, Rs, d = FINE.rms_height, FINE.summit_radius, 0.4e-6
    beta = FINE.summit_density * Rq * Rs
    force = 1e-4 * 110e9 * 4 * 17 * beta / (3 * 3**2.5) * math.sqrt(Rq / Rs) * 0.75 * math.sqrt(math.pi) * math.exp(-6)
    assert normal_force(contact, separation=d) == approx(force)
    assert real_contact_area(contact, separation=d) == approx(
        1e-4 * 17 * math.pi * beta / 9 * math.exp(-6), rel=1e-9, abs=0
    )
    assert contact_count(contact, separation=d) == approx(FINE.summit_density * 1e-4 * 17 / 3 * math.exp(-6))


@examples(25)
@given(load=st.floats(1e-6, 1e3))
def test_the_separation_at_a_load_carries_that_load(load: float) -> None:
    for law in LAWS:
        for heights in HEIGHTS:
            contact = replace(CONTACT, heights=heights, asperity=law)
            d = separation(contact, normal_load=load)
            assert normal_force(contact, separation=d) == approx(load, rel=1e-10, abs=0)


def test_the_stiffness_is_the_slope_of_the_load(contact: RoughContact) -> None:
    Rq = FINE.rms_height
    d = np.array([0.2, 1.0, 3.0, 5.0]) * Rq
    step = 1e-3 * Rq
    # central difference of fourth order
    near = normal_force(contact, separation=d - step) - normal_force(contact, separation=d + step)
    far = normal_force(contact, separation=d - 2 * step) - normal_force(contact, separation=d + 2 * step)
    assert normal_stiffness(contact, separation=d) == approx((8 * near - far) / (12 * step), rel=1e-8, abs=0)


@given(load=st.floats(1e-3, 1e3), factor=st.floats(0.01, 100))
def test_under_exponential_heights_area_count_and_stiffness_are_proportional_to_load(
    load: float, factor: float
) -> None:
    for law in LAWS:
        contact = replace(CONTACT, asperity=law)
        one, other = (separation(contact, normal_load=each) for each in (load, factor * load))
        for quantity in (real_contact_area, contact_count, normal_stiffness):
            assert quantity(contact, separation=other) == approx(
                factor * quantity(contact, separation=one), rel=1e-9, abs=0
            )


@given(nominal_area=st.floats(1e-8, 1e-2), pressure=st.floats(1e3, 1e8))
def test_the_separation_depends_on_the_nominal_pressure_only(nominal_area: float, pressure: float) -> None:
    contact = replace(CONTACT, nominal_area=nominal_area)
    one_square_metre = replace(CONTACT, nominal_area=1.0)
    assert separation(contact, normal_load=pressure * nominal_area) == approx(
        separation(one_square_metre, normal_load=pressure), abs=1e-18
    )


def test_separations_fall_as_loads_rise(contact: RoughContact) -> None:
    d = separation(contact, normal_load=np.geomspace(1e-3, 1e3, 50))
    assert (np.diff(d) < 0).all()


def test_results_have_the_shape_of_the_arguments(contact: RoughContact) -> None:
    d = separation(contact, normal_load=np.full((2, 3), 10.0))
    for quantity in (normal_force, real_contact_area, contact_count, normal_stiffness):
        assert quantity(contact, separation=d).shape == (2, 3)
        assert np.ndim(quantity(contact, separation=1e-7)) == 0


def test_under_exponential_heights_the_load_decays_over_rq_over_lambda() -> None:
    assert decay_length(CONTACT) == approx(0.2e-6 / 3, rel=1e-9, abs=0)
    assert decay_length(CONTACT, separation=[1e-7, 9e-7]) == approx([0.2e-6 / 3] * 2, rel=1e-9, abs=0)


def test_under_gaussian_heights_the_decay_length_is_load_over_stiffness() -> None:
    contact, d = replace(CONTACT, heights=GaussianHeights()), 0.5e-6
    expected = normal_force(contact, separation=d) / normal_stiffness(contact, separation=d)
    assert decay_length(contact, separation=d) == approx(expected, rel=1e-9, abs=0)


def test_the_decay_length_of_gaussian_heights_needs_a_separation() -> None:
    with raises(InvalidInput, match="decay_length of gaussian heights varies: give a separation"):
        decay_length(replace(CONTACT, heights=GaussianHeights()))


def test_a_contact_without_nominal_area_is_refused() -> None:
    with raises(InvalidInput, match=r"nominal_area must be positive, got 0\.0 m2"):
        replace(CONTACT, nominal_area=0.0)


def test_a_tensile_load_is_refused() -> None:
    with raises(InvalidInput, match=r"normal_load must be positive, got -3\.0 N"):
        separation(CONTACT, normal_load=[40.0, -3.0])


def test_an_unknown_separation_is_refused() -> None:
    with raises(InvalidInput, match=r"separation must be finite, got nan m"):
        normal_force(CONTACT, separation=math.nan)


def test_a_load_beyond_the_table_of_gaussian_heights_is_refused_with_its_range() -> None:
    with raises(OutsideRange, match=r"normal_load must lie between \S+ and \S+ N for gaussian heights .* got 1e\+12 N"):
        separation(replace(CONTACT, heights=GaussianHeights()), normal_load=1e12)


def test_a_separation_beyond_the_table_of_gaussian_heights_is_refused_with_its_range() -> None:
    with raises(OutsideRange, match=r"separation must lie between -1\.2e-06 and 7\.2e-06 m .* got 1e-05 m"):
        normal_force(replace(CONTACT, heights=GaussianHeights()), separation=[0.0, 1e-5])


def test_a_separation_at_which_exponential_heights_overflow_is_refused() -> None:
    with raises(OutsideRange, match=r"separation must lie between -4e-05 and inf m for exponential heights"):
        normal_force(CONTACT, separation=-1.0)


WORN = replace(CONTACT, decay_length=1.5e-6)  # of a surface whose rms height was 0.2 um before wear


@mark.parametrize("d", [-0.3e-6, 1e-6, 9e-6])
def test_with_a_decay_length_of_its_own_the_summits_are_the_exponential_population_of_that_length(d: float) -> None:
    # phi = c exp(-z/l) over heights z, per lambda l: the tail of D 3.2 on a length of its own
    length, density = 1.5e-6, 17 * FINE.summit_density * 1e-4
    w_c = critical_interference(WORN.asperity, STEEL, summit_radius=FINE.summit_radius)

    def over_all_summits(law: Callable[..., Floats]) -> float:
        def integrand(w: float) -> float:
            one = float(law(WORN.asperity, STEEL, summit_radius=FINE.summit_radius, interference=w))
            return one * math.exp(-(d + w) / length) / (3 * length)

        edges = [0.0, *sorted({w_c, 0.1 * length, length, 4 * length, 12 * length, 40 * length})]
        return density * sum(float(quad(integrand, a, b, epsabs=0, epsrel=1e-11)[0]) for a, b in pairwise(edges))

    assert normal_force(WORN, separation=d) == approx(over_all_summits(asperity_force), rel=1e-8, abs=0)
    assert real_contact_area(WORN, separation=d) == approx(over_all_summits(asperity_area), rel=1e-8, abs=0)
    assert contact_count(WORN, separation=d) == approx(density * math.exp(-d / length) / 3, rel=1e-9, abs=0)


@mark.parametrize("load", [0.1, 5.0, 80.0])
def test_load_over_the_slope_of_its_curve_is_the_decay_length_at_any_load(load: float) -> None:
    d, step = float(separation(WORN, normal_load=load)), 1e-10
    below, above = (float(normal_force(WORN, separation=d + sign * step)) for sign in (-1, 1))
    slope = (below - above) / (2 * step)
    assert load / slope == approx(1.5e-6, rel=1e-6)
    assert float(normal_stiffness(WORN, separation=d)) == approx(slope, rel=1e-6)
    assert float(decay_length(WORN)) == 1.5e-6
    assert float(separation(WORN, normal_load=math.e * load)) == approx(d - 1.5e-6, rel=1e-9)


@mark.parametrize("name", list(ASPERITY_LAWS))
def test_a_decay_length_of_a_third_of_the_rms_height_changes_nothing(name: str) -> None:
    measured = replace(CONTACT, asperity=ASPERITY_LAWS[name])
    stated = replace(measured, decay_length=FINE.rms_height / 3)
    d = np.linspace(0.1e-6, 1e-6, 7)
    for quantity in (normal_force, real_contact_area, contact_count, normal_stiffness):
        assert quantity(stated, separation=d) == approx(quantity(measured, separation=d), rel=1e-12, abs=0)
    assert separation(stated, normal_load=3.0) == approx(separation(measured, normal_load=3.0), rel=1e-12)


def test_the_roughness_of_a_contact_stays_what_was_measured() -> None:
    assert WORN.roughness == FINE
    assert WORN.height_scale == approx(4.5e-6)
    assert CONTACT.height_scale == FINE.rms_height


def test_contacts_of_two_decay_lengths_are_two_contacts() -> None:
    assert WORN != CONTACT
    assert len({WORN, CONTACT, replace(CONTACT, decay_length=1.5e-6)}) == 2
    assert float(normal_force(WORN, separation=3e-6)) > 10 * float(normal_force(CONTACT, separation=3e-6))


def test_a_decay_length_of_heights_that_have_none_is_refused() -> None:
    with raises(InvalidInput, match="decay_length is for exponential heights, got gaussian heights"):
        replace(CONTACT, heights=GaussianHeights(), decay_length=1e-6)
    with raises(InvalidInput, match="decay_length must be positive"):
        replace(CONTACT, decay_length=0.0)
