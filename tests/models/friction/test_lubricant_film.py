"""Films by viscosity, speed, load and roughness: a printed example, Reynolds's equation, and both ends of the curve."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import cumulative_trapezoid

from sonolube.errors import InvalidInput
from sonolube.models.contact import normal_force, separation
from sonolube.models.friction import (
    FilmLubricant,
    elastohydrodynamic_thickness,
    inclined_pad,
    mixed_lubrication,
    shared_coefficients,
)
from sonolube.rig import read_rig

CONTACT = read_rig("examples/rigs/tribometer.toml").contact
PAD = FilmLubricant(dynamic_viscosity=0.1)
BALL = FilmLubricant(dynamic_viscosity=0.1, tip_radius=5e-3)
LOAD = 3.0


@pytest.mark.parametrize(("distance", "printed"), [(0.01, 0.059e-6), (1.0, 0.281e-6)])
def test_a_ball_that_rolls_down_a_plate_has_the_printed_film(distance: float, printed: float) -> None:
    # An exercise with its answers (tutorbin.com, "a steel ball starts rolling from rest down a steel plate"): 30 mm, 1
    # cm and 1 m at 45 degrees, 50 cP, 2.2e-8 m2/N, 210 GPa, 0.3, 7800 kg/m3. The answers take 1/R = 1/Rx + 1/Ry, half
    # the radius of the ball, and half its speed.
    speed = np.sqrt(10 / 7 * 9.81 * distance * np.sin(np.pi / 4))
    weight = 7800 * np.pi / 6 * 0.03**3 * 9.81 * np.cos(np.pi / 4)
    least, central = elastohydrodynamic_thickness(
        dynamic_viscosity=0.05,
        sliding_speed=speed,
        normal_load=weight,
        tip_radius=0.015 / 2,
        effective_modulus=210e9 / 2 / (1 - 0.3**2),
        pressure_viscosity=2.2e-8,
    )
    assert least == approx(printed, rel=0.01)
    assert central > least


@pytest.mark.parametrize("ratio", [1.2, 2.2, 4.0])
def test_load_and_friction_of_a_pad_are_those_of_reynolds_equation(ratio: float) -> None:
    x = np.linspace(0, 1, 4001)  # from inlet to outlet, over its length; gap over that at the outlet
    h = ratio - (ratio - 1) * x
    # d/dx(h^3 p') = 6 h', p = 0 at both ends: h^3 p' = 6 h + c
    first, second = (cumulative_trapezoid(integrand, x, initial=0) for integrand in (6 / h**2, 1 / h**3))
    p = first - first[-1] / second[-1] * second
    shear = 1 / h + h / 2 * np.gradient(p, x)  # on the moving face, which the pressure helps at the inlet
    load, friction = inclined_pad(inlet_ratio=ratio)
    assert load == approx(-np.trapezoid(p, x) if p.mean() < 0 else np.trapezoid(p, x), rel=1e-4)
    still = np.trapezoid(1 / h - h / 2 * np.gradient(p, x), x)
    assert friction == approx(max(np.trapezoid(shear, x), still), rel=1e-3)


def test_the_best_inclination_of_a_pad_is_the_known_one() -> None:
    ratios = np.linspace(1.5, 4, 501)
    loads = [inclined_pad(inlet_ratio=float(each))[0] for each in ratios]
    assert ratios[int(np.argmax(loads))] == approx(2.19, abs=0.01)
    assert max(loads) == approx(0.160, abs=5e-4)


@pytest.mark.parametrize("lubricant", [PAD, BALL])
def test_at_rest_asperities_carry_all_and_at_speed_the_film(lubricant: FilmLubricant) -> None:
    found = mixed_lubrication(lubricant, CONTACT, sliding_speed=[0.0, 1e-3, 1.0, 1e4], normal_load=LOAD)
    assert found.asperity_load_fraction[0] == approx(1.0, abs=1e-9)
    assert found.asperity_load_fraction[1] > 0.999
    assert found.asperity_load_fraction[-1] < 1e-6
    assert np.all(np.diff(found.film_thickness) > 0)
    assert found.film_thickness[0] == approx(float(separation(CONTACT, normal_load=LOAD)), rel=1e-9)


def test_film_and_asperities_carry_the_load_at_one_gap() -> None:
    found = mixed_lubrication(PAD, CONTACT, sliding_speed=8.0, normal_load=LOAD)
    asperities = normal_force(CONTACT, separation=found.film_thickness)
    assert asperities == approx(found.asperity_load_fraction * LOAD, rel=1e-6)
    by_pad = inclined_pad(inlet_ratio=2.2)[0] * 0.1 * 8.0 * CONTACT.nominal_area**1.5 / found.film_thickness**2
    assert by_pad == approx((1 - found.asperity_load_fraction) * LOAD, rel=1e-6)


def test_a_full_film_of_a_smooth_ball_is_the_thickest_of_its_regimes() -> None:
    smooth = replace(CONTACT, decay_length=1e-9)
    hard = FilmLubricant(dynamic_viscosity=0.1, tip_radius=5e-3)
    found = mixed_lubrication(hard, smooth, sliding_speed=2.0, normal_load=50.0)
    _, central = elastohydrodynamic_thickness(
        dynamic_viscosity=0.1,
        sliding_speed=2.0,
        normal_load=50.0,
        tip_radius=5e-3,
        effective_modulus=CONTACT.pair.effective_modulus,
        pressure_viscosity=2e-8,
    )
    assert found.film_thickness == approx(float(central), rel=1e-6)
    # a soft ball in a thin oil: isoviscous and elastic, U = eta v/2/(E' R), H = 7.32 (1 - 0.72 e^-0.28k) U^0.64 W^-0.22
    soft = replace(smooth, pair=replace(CONTACT.pair, effective_modulus=1e6))
    thin = FilmLubricant(dynamic_viscosity=1e-3, tip_radius=5e-3)
    U, W = 1e-3 * 1.0 / 2 / (2e6 * 5e-3), 0.5 / (2e6 * 25e-6)
    expected = 5e-3 * 7.32 * (1 - 0.72 * np.exp(-0.28 * 1.03)) * U**0.64 * W**-0.22
    film = mixed_lubrication(thin, soft, sliding_speed=1.0, normal_load=0.5)
    assert film.film_thickness == approx(expected, rel=1e-6)


def test_friction_of_a_film_is_limited_by_its_pressure_and_viscous_at_low_rates() -> None:
    fast = mixed_lubrication(BALL, CONTACT, sliding_speed=[1e-2, 10.0, 1e3], normal_load=LOAD)
    assert np.all(fast.film_coefficient <= 0.05)
    thin = FilmLubricant(dynamic_viscosity=1e-6, tip_radius=5e-3)
    slow = mixed_lubrication(thin, CONTACT, sliding_speed=[0.1, 0.2], normal_load=LOAD)
    assert slow.film_coefficient[1] / slow.film_coefficient[0] < 2.0


def test_friction_over_speed_has_the_minimum_of_stribecks_curve() -> None:
    speeds = np.geomspace(1e-3, 1e3, 61)
    found = mixed_lubrication(PAD, CONTACT, sliding_speed=speeds, normal_load=LOAD)
    curve = shared_coefficients(
        friction_coefficient=0.3,
        friction_ratio=0.4,
        asperity_load_fraction=found.asperity_load_fraction,
        film_coefficient=found.film_coefficient,
    )
    assert curve.lubricant[0] == approx(0.3, rel=1e-3)
    least = int(np.argmin(curve.lubricant))
    assert 0 < least < 60
    assert curve.lubricant[-1] > curve.lubricant[least]
    # vibration acts on the asperities: all of its effect at rest, none under a full film
    assert curve.combined[0] == approx(curve.ultrasonic[0], rel=1e-3)
    assert curve.combined[-1] == approx(curve.lubricant[-1], rel=1e-9)


def test_an_oil_never_leaves_vibration_alone_the_best_as_d_4_2_found_below_90_mm_per_second() -> None:
    # D 4.2.4: below 90 mm/s vibration alone is best at any load, which needs a film of more friction than the vibrated
    # asperities have. No oil between that of water and of honey has one here: Molykote is no such film
    for viscosity in (1e-3, 0.1, 10.0):
        found = mixed_lubrication(
            FilmLubricant(dynamic_viscosity=viscosity, tip_radius=5e-3), CONTACT, sliding_speed=0.06, normal_load=6.0
        )
        curve = shared_coefficients(
            friction_coefficient=0.26,
            friction_ratio=0.35,
            asperity_load_fraction=found.asperity_load_fraction,
            film_coefficient=found.film_coefficient,
        )
        assert curve.combined <= curve.ultrasonic


def test_a_parallel_pad_is_refused() -> None:
    with raises(InvalidInput, match=r"inlet_ratio must exceed 1, got 1\.0: a parallel pad has no film"):
        FilmLubricant(dynamic_viscosity=0.1, inlet_ratio=1.0)
