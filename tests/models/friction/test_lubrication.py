"""Lubricated friction: limits of the Stribeck curve, and consequences of load sharing."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.friction import (
    BoundaryLubricant,
    LubricationMethod,
    StribeckCurve,
    asperity_load_fraction,
    best_lubrication_method,
    hersey_number,
    lubrication_coefficients,
    stribeck_coefficient,
)

CURVE = StribeckCurve(boundary_coefficient=0.12, transition_hersey_number=2e-9, film_slope=1e6)
LUBRICANT = BoundaryLubricant(film_coefficient=0.1, full_asperity_pressure=200e6)
ratios = st.floats(0.01, 1.0)
pressures = st.floats(1e6, 199e6)


def test_the_stribeck_curve_has_the_limits_of_boundary_and_film_friction() -> None:
    assert stribeck_coefficient(CURVE, hersey_number=0.0) == approx(0.12)
    assert stribeck_coefficient(CURVE, hersey_number=1e-7) == approx(1e6 * 1e-7)


def test_the_hersey_number_is_hand_computed() -> None:
    assert hersey_number(dynamic_viscosity=0.1, sliding_speed=0.02, nominal_pressure=1e6) == approx(2e-9)


def test_a_curve_without_a_minimum_is_refused() -> None:
    with raises(InvalidInput, match="film_slope times transition_hersey_number"):
        StribeckCurve(boundary_coefficient=0.1, transition_hersey_number=1e-6, film_slope=1e6)


@given(ratio=ratios, pressure=pressures)
def test_vibration_alone_is_best_where_its_friction_is_below_that_of_the_film_at_every_pressure(
    ratio: float, pressure: float
) -> None:
    found = lubrication_coefficients(
        LUBRICANT, friction_coefficient=0.2, friction_ratio=ratio, nominal_pressure=pressure
    )
    if abs(ratio * 0.2 - 0.1) > 1e-9:
        assert (best_lubrication_method(found) == LubricationMethod.ULTRASONIC) == (ratio * 0.2 < 0.1)


@given(ratio=ratios, pressure=pressures)
def test_vibration_never_makes_a_lubricated_contact_worse(ratio: float, pressure: float) -> None:
    found = lubrication_coefficients(
        LUBRICANT, friction_coefficient=0.2, friction_ratio=ratio, nominal_pressure=pressure
    )
    assert found.combined <= found.lubricant * (1 + 1e-12)
    assert found.ultrasonic <= found.dry


def test_friction_with_a_lubricant_depends_on_the_stress_and_dry_friction_does_not() -> None:
    # D 4.2.4: the reduction by the lubricant falls with the stress and not with the speed, that by vibration vice versa
    low, high = (
        lubrication_coefficients(LUBRICANT, friction_coefficient=0.2, friction_ratio=[0.5, 0.8], nominal_pressure=p)
        for p in (24e6, 71e6)
    )
    assert np.all(high.lubricant > low.lubricant)
    assert np.ptp(low.lubricant) == 0
    assert np.all(high.ultrasonic == low.ultrasonic)
    # and both together depend less on the speed than vibration alone
    assert np.ptp(high.combined) < np.ptp(high.ultrasonic)


@pytest.mark.parametrize(
    ("pressure", "gain", "method"),
    [
        (5e6, 0.02, LubricationMethod.LUBRICANT),
        (100e6, 0.02, LubricationMethod.COMBINED),
        (100e6, 0.5, LubricationMethod.LUBRICANT),
    ],
)
def test_vibration_beside_a_lubricant_must_exceed_the_smallest_gain(
    pressure: float, gain: float, method: LubricationMethod
) -> None:
    found = lubrication_coefficients(LUBRICANT, friction_coefficient=0.2, friction_ratio=0.8, nominal_pressure=pressure)
    assert best_lubrication_method(found, smallest_gain=gain) == method


def test_a_lubricant_with_more_friction_than_the_dry_contact_is_not_chosen() -> None:
    poor = BoundaryLubricant(film_coefficient=0.3, full_asperity_pressure=200e6)
    found = lubrication_coefficients(poor, friction_coefficient=0.2, friction_ratio=1.0, nominal_pressure=1e6)
    assert best_lubrication_method(found) == LubricationMethod.DRY


def test_asperities_carry_at_most_the_load() -> None:
    assert asperity_load_fraction(LUBRICANT, nominal_pressure=[50e6, 900e6]) == approx([0.25, 1.0])
