"""Published contacts and the roughness of each, by hand from what was printed, and how well it is known."""

from math import hypot, log, pi, sqrt

import pytest
from pytest import approx

from sonolube.validation.contacts import (
    RMS_OVER_ARITHMETIC_MEAN,
    efficiency_line,
    poisson_contact,
    printed_rms_height,
    roughness_spread,
    steel_on_steel_contact,
    uncoated_plate_contact,
    wear_contact,
)
from sonolube.validation.published_tests import friction_tests, with_printed_roughness


def test_the_rms_of_a_gaussian_profile_is_its_mean_deviation_times_the_root_of_half_pi() -> None:
    assert approx(sqrt(pi / 2)) == RMS_OVER_ARITHMETIC_MEAN


@pytest.mark.parametrize(
    ("label", "spread"), [("A-1", 0.69), ("H-2", 0.69), ("C-1", 0.98), ("G-1", 0.86), ("G-2", 1.93)]
)
def test_a_roughness_is_known_within_the_factor_that_its_origin_leaves(label: str, spread: float) -> None:
    assert abs(roughness_spread(label)) == approx(spread, abs=0.006)


def test_the_spread_of_set_b_adds_half_a_step_to_the_mean_deviation_and_half_of_that_to_a_second_surface() -> None:
    assert roughness_spread("B-1") == approx(hypot(log(pi / 2) / 4, log(2) / 4), rel=1e-9)
    assert roughness_spread("B-1") == approx(0.21, abs=0.005)


def test_the_contacts_are_those_of_tables_3_1_and_3_2_and_of_section_4_1() -> None:
    steel, aluminium = (1 - 0.29**2) / 200e9, (1 - 0.33**2) / 73e9
    both, mixed = poisson_contact(bodies="steel_steel"), poisson_contact(bodies="aluminium_steel")
    assert (both.pair.effective_modulus, both.pair.yield_strength) == approx((1 / (2 * steel), 250e6))
    assert (mixed.pair.effective_modulus, mixed.pair.yield_strength) == approx((1 / (steel + aluminium), 410e6))
    assert (both.pair.poisson_ratio, mixed.pair.poisson_ratio) == approx((0.29, 0.33))
    assert poisson_contact(bodies="steel_steel", yield_strength=960e6).pair.yield_strength == approx(960e6)
    assert (both.nominal_area, both.roughness.rms_height, both.roughness.summit_radius) == approx((1e-4, 6e-6, 1.7e-6))
    worn = wear_contact()
    assert (worn.pair.effective_modulus, worn.pair.yield_strength, worn.nominal_area) == approx(
        (59.6e9, 410e6, 2.25e-6)
    )
    assert worn.pair.mindlin_ratio == approx(2 * (1 - 0.33) / (2 - 0.33))
    assert (worn.roughness.rms_height, worn.roughness.summit_radius) == approx((6e-6, 1.5e-6))
    assert worn.roughness.summit_density == approx(4.7e10)
    welded = steel_on_steel_contact(nominal_area=3e-6, yield_strength=300e6)
    assert (welded.nominal_area, welded.roughness.summit_radius) == approx((3e-6, 1.5e-6))
    assert (welded.pair.effective_modulus, welded.pair.yield_strength) == approx((1 / (2 * steel), 300e6))
    plate = uncoated_plate_contact(yield_strength=205e6)
    assert (plate.nominal_area, plate.pair.yield_strength) == approx((0.126e-6, 205e6))
    assert plate.roughness.rms_height == approx(sqrt(pi / 2) * 1.69e-6)
    line = efficiency_line()  # mW mm2/(N W), of m/s
    assert (line.slope, line.intercept) == approx((-2.93e-9, 0.672e-9))


def test_the_printed_roughness_takes_the_place_of_that_of_the_record_in_sets_b_c_and_g_alone() -> None:
    tests = friction_tests("ABCGH")
    heights = {test.label: test.contact.roughness.rms_height for test in with_printed_roughness(tests)}
    plate = sqrt(pi / 2) * 1.69e-6
    expected = {test.label: 6e-6 for test in tests} | {f"B-{level}": plate for level in range(1, 6)}
    assert heights == approx(expected | {"C-1": sqrt(pi / 2) * 1.8e-6, "G-1": 2.54e-6, "G-2": 0.87e-6})
    assert [printed_rms_height(label) for label in ("A-1", "H-1")] == [None, None]
    assert printed_rms_height("G-2") == approx(0.87e-6)


def test_tests_have_the_printed_conditions_and_the_flextensional_actuator_half_its_static_stroke() -> None:
    slow, fast = friction_tests("H")  # 52 um at 150 V, driven with 4 V peak to peak
    assert slow.vibration_amplitude == approx(52e-6 / 150 * 4 / 2)
    assert (slow.frequency, slow.normal_load, slow.sliding_speed, fast.sliding_speed) == approx(
        (16e3, 2.6, 3.5e-3, 0.1)
    )
    assert (slow.friction_ratio, fast.friction_ratio) == approx((0.3, 1.0))
    assert (slow.friction_coefficient, slow.contact.nominal_area) == approx((0.26, 50e-6))
    assert (slow.uncertainty, fast.uncertainty, fast.published) == (None, None, None)
    a, welder = friction_tests("A")[0], friction_tests("G")[0]
    assert (a.sliding_speed, a.vibration_amplitude, a.frequency, a.normal_load) == approx((20.3e-3, 2.5e-6, 22e3, 3.0))
    assert a.friction_coefficient == approx(1.024 / 3)
    assert [test.friction_coefficient for test in friction_tests("D")] == approx([0.4, 0.4])
    assert (welder.vibration_amplitude, welder.frequency, welder.normal_load) == approx((11.46e-6, 20e3, 70.0))
    # 5.323 N of 10.73 N to 6.845 N of 13.02 N, of a mean of 11.875 N
    low, high = 5.323 / 10.73, 6.845 / 13.02
    assert (welder.friction_ratio, welder.uncertainty) == approx(((low + high) / 2, (high - low) / 2))
    assert (welder.friction_coefficient, welder.contact.nominal_area) == approx((11.875 / 70, 1.135e-6))
