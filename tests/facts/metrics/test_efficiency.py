"""Efficiency coefficient against D Table 4.2, and the inverse of power and friction on the efficiency line."""

import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.facts.metrics import (
    EfficiencyLine,
    efficiency_at,
    efficiency_coefficient,
    friction_at_power,
    power_for_friction,
)

MILLIWATT_SQUARE_MILLIMETRES_PER_NEWTON_WATT = 1e-9
LINE = EfficiencyLine(slope=-2.93e-9, intercept=0.672e-9)  # D 4.2
PIN = {"nominal_area": 0.126e-6, "normal_load": 5.0, "sliding_speed": 65.5e-3}  # D Table 4.2


def test_the_measured_efficiency_lies_near_its_line() -> None:
    # D Table 4.2 at 15.5 V peak to peak: 0.89 to 0.32 N for 1.90 W
    measured = efficiency_coefficient(
        intrinsic_friction_force=0.89, reduced_friction_force=0.32, actuator_power=1.90, **PIN
    )
    assert measured / MILLIWATT_SQUARE_MILLIMETRES_PER_NEWTON_WATT == approx(0.495, abs=5e-4)
    line = efficiency_at(LINE, sliding_speed=PIN["sliding_speed"])
    assert line / MILLIWATT_SQUARE_MILLIMETRES_PER_NEWTON_WATT == approx(0.480, abs=5e-4)


@given(reduced=st.floats(0, 0.89), speed=st.floats(1e-3, 0.229), area=st.floats(1e-8, 1e-4), load=st.floats(0.1, 1e3))
def test_friction_at_power_inverts_power_for_friction(reduced: float, speed: float, area: float, load: float) -> None:
    rig = {"intrinsic_friction_force": 0.89, "sliding_speed": speed, "nominal_area": area, "normal_load": load}
    power = power_for_friction(LINE, reduced_friction_force=reduced, **rig)
    assert friction_at_power(LINE, actuator_power=power, **rig) == approx(reduced, abs=1e-12)


@given(reduced=st.floats(0, 0.88), speed=st.floats(1e-3, 0.22))
def test_the_efficiency_of_the_power_for_a_friction_is_that_of_the_line(reduced: float, speed: float) -> None:
    rig = PIN | {"intrinsic_friction_force": 0.89, "reduced_friction_force": reduced, "sliding_speed": speed}
    power = power_for_friction(LINE, **rig)
    assert efficiency_coefficient(actuator_power=power, **rig) == approx(
        float(efficiency_at(LINE, sliding_speed=speed)), rel=1e-9, abs=0
    )


def test_zero_power_leaves_the_intrinsic_friction() -> None:
    assert friction_at_power(LINE, intrinsic_friction_force=0.89, actuator_power=0.0, **PIN) == 0.89


@pytest.mark.parametrize("speed", [0.2294, 0.5])
def test_speeds_beyond_the_zero_of_the_efficiency_line_are_refused(speed: float) -> None:
    rig = PIN | {"intrinsic_friction_force": 0.89, "sliding_speed": speed}
    message = r"sliding_speed must stay below 0\.2294 m/s, where this efficiency line reaches zero, got 0\."
    with raises(OutsideRange, match=message):
        efficiency_at(LINE, sliding_speed=[0.01, speed])
    with raises(OutsideRange, match=message):
        power_for_friction(LINE, reduced_friction_force=0.5, **rig)
    with raises(OutsideRange, match=message):
        friction_at_power(LINE, actuator_power=0.5, **rig)


def test_more_power_than_removes_all_friction_is_refused_with_the_sufficient_power() -> None:
    sufficient = power_for_friction(LINE, intrinsic_friction_force=0.89, reduced_friction_force=0.0, **PIN)
    assert friction_at_power(LINE, intrinsic_friction_force=0.89, actuator_power=sufficient, **PIN) == approx(
        0, abs=1e-12
    )
    with raises(OutsideRange, match=r"actuator_power of 5\.31 W is more than the 3\.06 W that remove all friction"):
        friction_at_power(LINE, intrinsic_friction_force=0.89, actuator_power=[1.0, 5.31], **PIN)


def test_more_power_than_removes_a_micronewton_of_friction_is_refused_as_well() -> None:
    sufficient = power_for_friction(LINE, intrinsic_friction_force=1e-6, reduced_friction_force=0.0, **PIN)
    with raises(OutsideRange, match="that remove all friction"):
        friction_at_power(LINE, intrinsic_friction_force=1e-6, actuator_power=1.01 * sufficient, **PIN)


def test_a_target_friction_above_the_intrinsic_one_is_refused() -> None:
    with raises(
        InvalidInput, match=r"reduced_friction_force must not exceed intrinsic_friction_force, 0\.89 N, got 0\.9 N"
    ):
        power_for_friction(LINE, intrinsic_friction_force=0.89, reduced_friction_force=[0.5, 0.9], **PIN)


def test_an_efficiency_line_without_a_positive_intercept_is_refused() -> None:
    with raises(InvalidInput, match=r"intercept must be positive, got -1\.0 m2/N"):
        EfficiencyLine(slope=0.0, intercept=-1.0)
