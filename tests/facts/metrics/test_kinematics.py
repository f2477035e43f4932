"""Speeds, distances and spacings of marks against tables of the dissertation."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx

from sonolube.facts.metrics import (
    dot_spacing,
    indentation_spacing,
    linear_speed,
    peak_vibration_velocity,
    sliding_distance,
    superimposed_speed,
)

MM_PER_S = 1e-3


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
