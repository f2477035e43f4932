"""Branches, ramps, slopes and relays of the force gauge, sample by sample."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from pytest import approx, raises

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.measurement.gauge.calibration import (
    BranchCalibration,
    PreisachCalibration,
    _local_slope,
    _ramps,
    dissipated_energy,
    fit_branches,
    fit_preisach,
    force_from_branches,
    force_from_preisach,
    loading_mask,
    major_loop_dissipation,
    require_calibrated_range,
    require_calibration_readings,
)
from sonolube.measurement.gauge.preisach import PreisachPlane, mean_relay_widths, preisach_output, relay_fractions

PLANE = PreisachPlane(lowest=10.0, highest=16.0, levels=3)  # cells of two units


def test_a_reversal_counts_beyond_a_fiftieth_of_the_range() -> None:
    x = np.array([0.0, 50, 49.1, 60, 100, 99, 97, 60, 60.5, 61, 30, 30, 35])
    # up to 100, from which on down: 1.0 and 61 are not 2 back; up again from the last 30 on
    rising = [True] * 4 + [False] * 7 + [True] * 2
    assert loading_mask(x).tolist() == rising
    assert loading_mask(-x).tolist() == [not up for up in rising]  # falling from its first sample on
    small = np.array([0.0, 100, 98.1, 97.9])
    assert loading_mask(small).tolist() == [True, False, False, False]  # from its extremum on
    assert loading_mask(small[:3]).tolist() == [True, True, True]


def test_each_branch_is_a_polynomial_with_the_deviation_of_its_readings() -> None:
    rng = np.random.default_rng(1)
    up, down = np.linspace(0, 1, 60), np.linspace(1, 0, 41)[1:]
    x = np.concatenate([up, down])
    force = np.concatenate(
        [2 + 3 * up + 0.3 * rng.standard_normal(60), 1 + 4 * down**2 + 0.1 * rng.standard_normal(40)]
    )
    found = fit_branches(displacement=x, applied_force=force, degree=2)
    for branch, polynomial, deviation in (
        (slice(0, 59), found.loading, found.loading_deviation),
        (slice(59, 100), found.unloading, found.unloading_deviation),
    ):
        coefficients = np.polyfit(x[branch], force[branch], 2)
        left = force[branch] - np.polyval(coefficients, x[branch])
        assert polynomial(0.3) == approx(np.polyval(coefficients, 0.3))
        assert deviation == approx(np.sqrt(left @ left / (left.size - 3)))
    assert (found.lowest, found.highest) == (0.0, 1.0)


@pytest.mark.parametrize(
    ("degree", "samples", "words"),
    [
        (0, 50, "degree must lie between 1 and 7, got 0"),
        (8, 50, "degree must lie between 1 and 7, got 8"),
        (3, 5, "loading has 4 samples, too few for a polynomial of degree 3"),
    ],
)
def test_a_branch_without_enough_samples_for_its_degree_is_refused(degree: int, samples: int, words: str) -> None:
    up = np.linspace(0, 1, samples)
    x = np.concatenate([up, up[:-1][::-1]])
    with raises(InvalidInput, match=words):
        fit_branches(displacement=x, applied_force=x, degree=degree)


def test_five_samples_of_each_branch_are_enough_for_a_cubic() -> None:
    up = np.linspace(0, 1, 6)
    x = np.concatenate([up, up[:-1][::-1]])
    assert fit_branches(displacement=x, applied_force=x, degree=3).loading(0.5) == approx(0.5)


def test_the_uncertainty_of_a_force_is_of_its_branch_and_of_the_sensor_times_the_slope() -> None:
    calibration = BranchCalibration(
        loading=Polynomial([1.0, 2.0]),
        unloading=Polynomial([0.0, 0.0, 3.0]),
        loading_deviation=0.3,
        unloading_deviation=0.5,
        lowest=0.0,
        highest=2.0,
    )
    found = force_from_branches(calibration, displacement=[0.0, 2.0, 1.0], displacement_uncertainty=0.2)
    assert found.applied_force == approx([1.0, 12.0, 3.0])
    # slopes 2, 12 and 6 times 0.2
    assert found.applied_force_uncertainty == approx([0.5, np.hypot(0.5, 2.4), np.hypot(0.5, 1.2)])
    assert force_from_branches(calibration, displacement=[0.0, 2.0]).applied_force_uncertainty == approx([0.3, 0.3])
    with raises(InvalidInput, match="displacement_uncertainty must not be negative"):
        force_from_branches(calibration, displacement=[1.0], displacement_uncertainty=-0.1)
    for outside in (-1e-3, 2.001):
        with raises(OutsideRange, match="between 0 and 2 m, where it was calibrated"):
            force_from_branches(calibration, displacement=[1.0, outside])


def test_readings_are_checked_for_shape_and_range() -> None:
    assert require_calibrated_range(displacement=3.0, lowest=3.0, highest=4.0).tolist() == [3.0]
    assert require_calibrated_range(displacement=[4 + 0.9e-9], lowest=3.0, highest=4.0).size == 1  # rounding
    with raises(OutsideRange, match="got 4 m"):
        require_calibrated_range(displacement=[4 + 2e-9], lowest=3.0, highest=4.0)
    with raises(InvalidInput, match="one-dimensional"):
        require_calibrated_range(displacement=np.ones((2, 2)), lowest=0.0, highest=2.0)
    with raises(InvalidInput, match="displacement does not vary"):
        require_calibration_readings(displacement=[1.0], applied_force=[1.0])
    assert require_calibration_readings(displacement=[1.0, 2.0], applied_force=[1.0, 1.0])[0].size == 2


def test_a_level_is_filled_in_proportion_to_what_lies_below_the_displacement() -> None:
    assert _ramps(PLANE, np.array([9.0, 11.0, 13.5, 16.0])) == approx(
        np.array([[0, 0, 0], [0.5, 0, 0], [1, 0.75, 0], [1, 1, 1]])
    )


def test_the_local_slope_is_the_mean_of_both_neighbouring_intervals() -> None:
    x, force = np.array([0.0, 1.0, 3.0, 3.0, 2.0]), np.array([0.0, 2.0, 3.0, 5.0, 4.0])
    # slopes 2, 1/2, the mean slope 9 where nothing moved, and 1
    assert _local_slope(x, force, 9.0) == approx([2.0, 1.25, 4.75, 5.0, 1.0])


def test_the_force_is_that_of_the_spring_less_the_relays_that_slipped() -> None:
    weights = np.array([0.5, 0.7, 0.9, 1.1, 1.3, 1.5])
    calibration = PreisachCalibration(
        plane=PLANE, reversible=np.array([4.0, 5.0, 6.0]), weights=weights, resting_force=-2.0, force_deviation=0.3
    )
    found = force_from_preisach(calibration, displacement=[10.0, 14.0, 16.0], displacement_uncertainty=0.1)
    # at 14 the relays that switch up within the first two levels are up: cells (0,0), (1,0), (1,1)
    assert found.applied_force == approx([-2.0, -2 + 9 - 2.1, -2 + 15 - 6.0])
    slopes = [6.9 / 4, (6.9 / 4 + 2.1 / 2) / 2, 2.1 / 2]
    assert found.applied_force_uncertainty == approx(np.hypot(0.3, 0.1 * np.array(slopes)))
    (single,) = force_from_preisach(
        calibration, displacement=[10.0], displacement_uncertainty=0.1
    ).applied_force_uncertainty
    assert single == approx(np.hypot(0.3, 0.1 * (15 - 6) / 6))  # the mean slope over the range
    # widths: a third of a level of two on the diagonal, two and four beside it
    assert mean_relay_widths(PLANE) == approx([2 / 3, 2, 2 / 3, 4, 2, 2 / 3])
    assert major_loop_dissipation(calibration) == approx(2 / 3 * (0.5 + 0.9 + 1.5) + 2 * (0.7 + 1.3) + 4 * 1.1)


def test_the_share_of_the_relays_that_are_up_is_an_area() -> None:
    # up to 13: the first level whole, the second by half; back to 11: relays with beta above 11 are down
    shares = relay_fractions(PLANE, np.array([13.0, 11.0, 12.0]))
    assert shares[0] == approx([1, 0.5, 0.25, 0, 0, 0])  # of a triangle by half its side: a quarter
    # alpha up to 13 and beta from 11: three quarters of the first triangle less (1/2)^2 above; the rest by halves
    assert shares[1] == approx([1 - 0.25, 0.5 * 0.5, 0.0, 0, 0, 0])
    # up again to 12: relays with alpha from 11 to 12 and beta above 11 are up
    assert shares[2] == approx([1.0, 0.25, 0.0, 0, 0, 0])
    assert relay_fractions(PLANE, np.array([99.0])) == approx(np.ones((1, 6)))
    assert relay_fractions(PLANE, np.array([-99.0])) == approx(np.zeros((1, 6)))
    weights = np.arange(1.0, 7.0)
    assert preisach_output(PLANE, weights, np.array([13.0, 11.0, 12.0])) == approx(shares @ weights)


def test_a_plane_has_two_to_sixty_four_levels_and_a_range() -> None:
    assert PreisachPlane(lowest=0.0, highest=1.0, levels=2).cells == 3
    assert PreisachPlane(lowest=0.0, highest=1.0, levels=64).cells == 2080
    with raises(InvalidInput, match="levels must lie between 2 and 64, got 1"):
        PreisachPlane(lowest=0.0, highest=1.0, levels=1)
    with raises(InvalidInput, match=r"highest must exceed lowest, 1\.0, got 1\.0"):
        PreisachPlane(lowest=1.0, highest=1.0, levels=4)


def test_a_calibration_of_a_negative_resting_force_is_recovered_and_its_size_checked() -> None:
    turns = [10, 12, 10, 14, 10, 16, 10, 16, 12, 16, 14, 16, 10, 13, 11, 15, 13, 14]
    x = np.interp(np.arange(0, 17, 0.05), np.arange(18), turns)
    force = -7 + 2 * (x - 10) - 0.5 * preisach_output(PLANE, np.ones(6), x)
    found = fit_preisach(displacement=x, applied_force=force, levels=3)
    assert found.resting_force == approx(-7.0)
    assert found.reversible == approx([4.0, 4.0, 4.0])
    assert found.weights == approx(np.full(6, 0.5))
    assert found.force_deviation == approx(0.0, abs=1e-9)
    with raises(InvalidInput, match="5 samples are too few for 3 levels; give 6 or use fewer levels"):
        fit_preisach(displacement=np.arange(5.0), applied_force=np.arange(5.0), levels=3)
    assert fit_preisach(displacement=np.arange(6.0), applied_force=np.arange(6.0), levels=3).plane.levels == 3


def test_the_energy_of_a_rectangle_has_the_sign_of_its_sense() -> None:
    x, force = [0.0, 2.0, 2.0, 0.0], [5.0, 5.0, 1.0, 1.0]
    assert dissipated_energy(displacement=x, applied_force=force) == approx(8.0)
    assert dissipated_energy(displacement=x[::-1], applied_force=force[::-1]) == approx(-8.0)
