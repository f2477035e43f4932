import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.metrics import (
    EfficiencyLine,
    dot_spacing,
    efficiency_at,
    efficiency_coefficient,
    friction_at_power,
    friction_reduction,
    indentation_spacing,
    linear_speed,
    peak_vibration_velocity,
    power_for_friction,
    sliding_distance,
    superimposed_speed,
    wear_rate,
    wear_reduction,
)

MM_PER_S = 1e-3
MILLIWATT_SQUARE_MILLIMETRES_PER_NEWTON_WATT = 1e-9
LINE = EfficiencyLine(slope=-2.93e-9, intercept=0.672e-9)  # D 4.2
PIN = {"nominal_area": 0.126e-6, "normal_load": 5.0, "sliding_speed": 65.5e-3}  # D Table 4.2


def test_reductions_are_relative_to_the_intrinsic_value() -> None:
    # D 2.5.5: from 0.769 N by 80.1 % to 0.153 N
    assert friction_reduction(intrinsic_friction_force=0.769, reduced_friction_force=0.153) == approx(0.801, abs=5e-4)
    # D Table 3.4: model wear rates, a reduction of 47 %
    assert wear_reduction(intrinsic_wear_rate=2.566e-11, reduced_wear_rate=1.355e-11) == approx(0.472, abs=5e-4)


def test_a_driving_vibration_reduces_friction_by_more_than_one_hundred_percent() -> None:
    assert friction_reduction(intrinsic_friction_force=1.0, reduced_friction_force=-0.1) == approx(1.1)


def test_wear_rate_is_volume_over_distance() -> None:
    # D Table 2.10: 0.013 mm3 over 2.2814 m, 0.0057 mm3/m
    assert wear_rate(wear_volume=0.013e-9, sliding_distance=2.2814) == approx(0.0057e-9, abs=5e-14)


def test_the_peak_vibration_velocity_of_the_tribometer_is_319_millimetres_per_second() -> None:
    # D Tables 4.1 and 4.5: 2.31 um at 22 kHz, 319 mm/s
    assert peak_vibration_velocity(frequency=22e3, vibration_amplitude=2.31e-6) == approx(319 * MM_PER_S, abs=5e-4)


def test_superimposed_speeds_are_those_of_the_table() -> None:
    # D Table 4.5; its peak velocities head the columns, its sliding speeds the rows
    peaks = np.array([63, 127, 191, 255, 319]) * MM_PER_S
    sliding = np.array([36, 67, 110, 145, 182, 220]) * MM_PER_S
    printed = [
        [41, 54, 71, 89, 108],
        [69, 78, 91, 105, 122],
        [110, 117, 126, 137, 150],
        [146, 151, 157, 166, 177],
        [183, 186, 192, 199, 208],
        [221, 223, 228, 235, 242],
    ]
    computed = superimposed_speed(sliding_speed=sliding[:, np.newaxis], vibration_velocity=peaks)
    assert computed == approx(np.array(printed) * MM_PER_S, rel=0.02)


def test_the_average_vibration_velocity_of_the_table_is_the_peak_over_pi() -> None:
    peaks = np.array([63, 127, 191, 255, 319]) * MM_PER_S
    printed = np.array([20, 40, 61, 81, 101]) * MM_PER_S
    assert superimposed_speed(sliding_speed=0.0, vibration_velocity=peaks) == approx(printed, abs=0.6 * MM_PER_S)


def test_mark_spacings_are_sliding_speed_over_frequency() -> None:
    # D 2.3.4: 87 mm/s at 22 kHz, and 20.3, 40.6, 87 mm/s with stick-slip of 10 ms
    assert dot_spacing(sliding_speed=87e-3, frequency=22e3) == approx(3.95e-6, abs=5e-9)
    assert indentation_spacing(sliding_speed=[20.3e-3, 40.6e-3, 87e-3], period=10e-3) == approx(
        np.array([0.203e-3, 0.406e-3, 0.870e-3])
    )


def test_the_groove_of_the_long_tests_is_fifty_eight_millimetres_wide() -> None:
    # D Table 2.2: 292.5 m in 1600 revolutions, and 20.3 mm/s at 6.67 turns a minute
    assert sliding_distance(revolutions=1600, groove_diameter=58.2e-3) == approx(292.5, rel=1e-3)
    assert linear_speed(rotation_speed=6.67 / 60, groove_diameter=58.2e-3) == approx(20.3e-3, rel=2e-3)


@given(turns=st.floats(0.01, 1e4), diameter=st.floats(1e-3, 1), minutes=st.floats(0.1, 600))
def test_distance_is_speed_times_time(turns: float, diameter: float, minutes: float) -> None:
    speed = linear_speed(rotation_speed=turns / (60 * minutes), groove_diameter=diameter)
    assert sliding_distance(revolutions=turns, groove_diameter=diameter) == approx(float(speed) * 60 * minutes)


def test_the_measured_efficiency_lies_near_its_line() -> None:
    # D Table 4.2 at 15.5 V peak to peak: 0.89 to 0.32 N for 1.90 W
    measured = efficiency_coefficient(
        intrinsic_friction_force=0.89, reduced_friction_force=0.32, actuator_power=1.90, **PIN
    )
    assert measured / MILLIWATT_SQUARE_MILLIMETRES_PER_NEWTON_WATT == approx(0.495, abs=5e-4)
    line = efficiency_at(LINE, sliding_speed=PIN["sliding_speed"])
    assert line / MILLIWATT_SQUARE_MILLIMETRES_PER_NEWTON_WATT == approx(0.480, abs=5e-4)


@given(
    reduced=st.floats(0, 0.89),
    speed=st.floats(1e-3, 0.229),
    area=st.floats(1e-8, 1e-4),
    load=st.floats(0.1, 1e3),
)
def test_friction_at_power_inverts_power_for_friction(reduced: float, speed: float, area: float, load: float) -> None:
    rig = {"intrinsic_friction_force": 0.89, "sliding_speed": speed, "nominal_area": area, "normal_load": load}
    power = power_for_friction(LINE, reduced_friction_force=reduced, **rig)
    assert friction_at_power(LINE, actuator_power=power, **rig) == approx(reduced, abs=1e-12)


@given(reduced=st.floats(0, 0.88), speed=st.floats(1e-3, 0.22))
def test_the_efficiency_of_the_power_for_a_friction_is_that_of_the_line(reduced: float, speed: float) -> None:
    rig = PIN | {"intrinsic_friction_force": 0.89, "reduced_friction_force": reduced, "sliding_speed": speed}
    power = power_for_friction(LINE, **rig)
    assert efficiency_coefficient(actuator_power=power, **rig) == approx(
        float(efficiency_at(LINE, sliding_speed=speed)), rel=1e-9
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
    with raises(OutsideRange, match=r"actuator_power of 5\.31 W is more than the 3\.06 W that take all friction away"):
        friction_at_power(LINE, intrinsic_friction_force=0.89, actuator_power=[1.0, 5.31], **PIN)


def test_a_target_friction_above_the_intrinsic_one_is_refused() -> None:
    with raises(
        InvalidInput, match=r"reduced_friction_force must not exceed intrinsic_friction_force, 0\.89 N, got 0\.9 N"
    ):
        power_for_friction(LINE, intrinsic_friction_force=0.89, reduced_friction_force=[0.5, 0.9], **PIN)


def test_an_efficiency_line_without_a_positive_intercept_is_refused() -> None:
    with raises(InvalidInput, match=r"intercept must be positive, got -1\.0 m2/N"):
        EfficiencyLine(slope=0.0, intercept=-1.0)
