"""Fits, intervals, cross-validation and criteria of variants that are linear, against closed forms."""

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
import pytest
from pytest import approx

from sonolube.errors import OutsideRange
from sonolube.validation.assessment import (
    assess_variant,
    cross_validation_errors,
    error_statistics,
    fit_variant,
    gaussian_criteria,
    information_criteria,
    leave_one_set_out_fits,
    profile_likelihood_interval,
    root_mean_square,
    select_tests,
)
from sonolube.validation.comparison import FittedParameter, fitted_parameters
from sonolube.validation.model_variant import FreeParameter, ModelVariant, SeenSets, per_rig
from sonolube.validation.tables import parameter_text


@dataclass(frozen=True)
class Measured:
    """A test with a setting x and a ratio."""

    label: str
    x: float
    friction_ratio: float

    @property
    def set_name(self) -> str:
        return self.label[0]


TESTS = (Measured("A-1", 1.0, 0.32), Measured("A-2", 2.0, 0.55), Measured("B-1", 3.0, 0.96), Measured("C-1", 4.0, 1.15))


def parameter(name: str = "slope", **changes: object) -> FreeParameter:
    given: dict[str, object] = {"default": 0.5, "initial_values": (0.2, 0.5), "low": -2.0, "high": 2.0, "reason": "any"}
    return FreeParameter(name=name, **(given | changes))  # type: ignore[arg-type]


def variant(ratio: object, *parameters: FreeParameter, **more: object) -> ModelVariant:
    return ModelVariant("made", "by hand", ratio, parameters=parameters, required_inputs=("x",), **more)  # type: ignore[arg-type]


LINEAR = variant(lambda test, slope: slope * test.x, parameter())
LINE = variant(
    lambda test, slope, level: slope * test.x + level, parameter(), parameter("level", initial_values=(0.0,))
)


def slope_of(tests: tuple[Measured, ...]) -> float:
    return sum(one.x * one.friction_ratio for one in tests) / sum(one.x**2 for one in tests)


def test_a_line_through_zero_has_the_slope_of_least_squares() -> None:
    fit = fit_variant(LINEAR, "ABC", tests=TESTS)
    assert fit.values == approx((slope_of(TESTS),), abs=1e-4)
    assert fit.sets == "ABC"
    assert fit_variant(LINEAR, "AC", tests=TESTS).values == approx((slope_of((*TESTS[:2], TESTS[3])),), abs=1e-4)
    found = fit_variant(LINE, "ABC", tests=TESTS).values
    assert found == approx(np.polyfit([one.x for one in TESTS], [one.friction_ratio for one in TESTS], 1), abs=1e-3)
    bounded = variant(LINEAR.ratio, parameter(high=0.25, initial_values=(0.1,)))
    assert fit_variant(bounded, "ABC", tests=TESTS).values == approx((0.25,), abs=1e-3)


def test_without_a_parameter_nothing_is_fitted_and_errors_are_those_of_the_formula() -> None:
    fixed = variant(lambda test: 0.3 * test.x)
    fit = fit_variant(fixed, "ABC", tests=TESTS)
    assert (fit.sets, fit.values) == ("", ())
    found = assess_variant(fixed, "ABC", tests=TESTS)
    errors = np.array([0.3 * one.x - one.friction_ratio for one in TESTS])
    assert found.fit_errors.rms == approx(np.sqrt(np.mean(errors**2)))
    assert found.fit_errors.largest == approx(errors[np.argmax(np.abs(errors))])
    assert found.fit_errors.largest == approx(0.05) or found.fit_errors.largest == approx(-0.06)
    assert found.fit_errors.median_relative == approx(np.median(np.abs(errors) / [0.32, 0.55, 0.96, 1.15]))
    assert found.fit_errors.count == 4
    assert found.cross_validation_errors == found.fit_errors
    assert found.information is not None
    assert found.information.parameter_count == 0


def test_each_set_is_predicted_by_the_slope_of_the_others() -> None:
    fits = leave_one_set_out_fits(LINEAR, "ABC", tests=TESTS)
    others = [tuple(one for one in TESTS if one.set_name != letter) for letter in "ABC"]
    assert [fit.values[0] for fit in fits] == approx([slope_of(each) for each in others], abs=1e-3)
    unseen = cross_validation_errors(LINEAR, "ABC", tests=TESTS)
    slopes = dict(zip("ABC", map(slope_of, others), strict=True))
    errors = [slopes[one.set_name] * one.x - one.friction_ratio for one in TESTS]
    assert unseen.rms == approx(sqrt(np.mean(np.square(errors))), rel=1e-2)


def test_a_constant_that_has_seen_sets_is_fitted_to_the_rest_of_them() -> None:
    # 0.3 was taken from A and B: A is predicted by the slope of B, B by that of A, and C, unseen, by 0.3
    seen = variant(lambda test: 0.3 * test.x, seen=SeenSets("AB", LINEAR))
    assert seen.seen_constants == 1
    unseen = cross_validation_errors(seen, "ABC", tests=TESTS)
    slopes = {"A": 0.96 / 3, "B": slope_of(TESTS[:2]), "C": 0.3}
    errors = [slopes[one.set_name] * one.x - one.friction_ratio for one in TESTS]
    assert unseen.rms == approx(sqrt(np.mean(np.square(errors))), rel=1e-2)
    criteria = information_criteria(fit_variant(seen, "ABC", tests=TESTS), TESTS)
    assert criteria is not None
    assert criteria.parameter_count == 1


def test_parameters_of_one_set_are_fitted_to_it_and_keep_their_default_elsewhere() -> None:
    own = parameter("offset", applicable_sets="B", default=0.07, initial_values=(0.0,))
    model = variant(lambda test, slope, offset=0.0: slope * test.x + offset, parameter(), own)
    fit = fit_variant(model, "ABC", tests=TESTS)
    rest = (*TESTS[:2], TESTS[3])
    assert fit.values[0] == approx(slope_of(rest), abs=2e-3)  # B is free of the others
    assert fit.values[1] == approx(0.96 - 3 * slope_of(rest), abs=5e-3)
    without = fit_variant(model, "AC", tests=TESTS)
    assert without.values[1] == approx(0.07)
    assert fit.predict(TESTS[0]) == approx(fit.values[0] * 1.0)
    assert fit.predict(TESTS[2]) == approx(fit.values[0] * 3 + fit.values[1])
    criteria = information_criteria(without, rest)
    assert criteria is not None
    assert criteria.parameter_count == 1


def test_a_profile_interval_of_a_linear_model_is_that_of_its_sum_of_squares() -> None:
    # n ln(S/S_0) = 3.841: S = S_0 + x.x (p - p_0)^2
    fit = fit_variant(LINEAR, "ABC", tests=TESTS)
    best = slope_of(TESTS)
    squares = sum((best * one.x - one.friction_ratio) ** 2 for one in TESTS)
    reach = sqrt(squares * (np.exp(3.841 / 4) - 1) / 30)
    assert profile_likelihood_interval(fit, 0, tests=TESTS) == approx((best - reach, best + reach), abs=2e-3)
    narrow = profile_likelihood_interval(fit, 0, tests=TESTS, largest_excess=1.0)
    assert narrow[1] - narrow[0] == approx(2 * sqrt(squares * (np.exp(0.25) - 1) / 30), rel=0.02)
    tight = variant(LINEAR.ratio, parameter(low=best - reach / 2, high=best + 2 * reach))
    low, high = profile_likelihood_interval(fit_variant(tight, "ABC", tests=TESTS), 0, tests=TESTS)
    assert low == approx(best - reach / 2)
    assert high == approx(best + reach, abs=2e-3)
    # with a level beside it the other parameter adapts: the slope of a straight line, sum of squares about the mean
    line = fit_variant(LINE, "ABC", tests=TESTS)
    rest = sum((line.values[0] * one.x + line.values[1] - one.friction_ratio) ** 2 for one in TESTS)
    wide = sqrt(rest * (np.exp(3.841 / 4) - 1) / 5)
    low, high = profile_likelihood_interval(line, 0, tests=TESTS)
    assert (low, high) == approx((line.values[0] - wide, line.values[0] + wide), abs=4e-3)


def test_an_angle_is_wrapped_and_its_interval_is_half_a_turn_at_most() -> None:
    angle = parameter("phase", unit="rad", low=-10.0, high=10.0, initial_values=(4.0,), default=0.0)
    turned = variant(lambda test, phase: 0.5 + 0.3 * np.cos(phase - test.x), angle)
    tests = tuple(Measured(f"A-{place}", x, 0.5 + 0.3 * np.cos(4.1 - x)) for place, x in enumerate((0.0, 1.0, 2.5)))
    fit = fit_variant(turned, "A", tests=tests)
    assert fit.values[0] == approx(4.1 - 2 * pi, abs=1e-2)
    flat = variant(lambda test, phase: 0.5, angle)
    assert profile_likelihood_interval(fit_variant(flat, "A", tests=tests), 0, tests=tests) == approx(
        (4.0 - 2 * pi - pi, 4.0 - 2 * pi + pi), abs=1e-3
    )


def test_a_test_outside_the_range_has_no_ratio_and_no_criterion_and_an_error_of_one_in_a_fit() -> None:
    def short(test: Measured, slope: float) -> float:
        if test.x > 3.5:
            raise OutsideRange("too far")
        return slope * test.x

    model = variant(short, parameter())
    found = assess_variant(model, "ABC", tests=TESTS)
    assert found.fit_errors.out_of_range == ("C-1",)
    assert found.fit_errors.count == 3
    assert found.information is None
    assert found.fit.values[0] == approx(slope_of(TESTS[:3]), abs=1e-3)
    assert model.range_violation(TESTS[3], 0.3) == "too far"
    assert model.range_violation(TESTS[0], 0.3) is None
    # in a fit it counts as an error of 1: the first of these avoids it at the price of a smaller one
    avoiding = variant(lambda test, slope: short(test, slope) if slope > 0.4 else 0.0 * test.x + 0.7, parameter())
    assert fit_variant(avoiding, "C", tests=TESTS).values[0] <= 0.4


def test_errors_of_no_test_in_range_are_infinite_and_the_largest_keeps_its_sign() -> None:
    nothing = error_statistics([(TESTS[0], None)])
    assert (nothing.rms, nothing.largest, nothing.median_relative, nothing.count) == (
        float("inf"), float("inf"), float("inf"), 0
    )  # fmt: skip
    some = error_statistics([(TESTS[0], 0.42), (TESTS[1], 0.25), (TESTS[2], None), (TESTS[3], 1.2)])
    assert some.largest == approx(-0.3)
    assert some.rms == approx(sqrt((0.01 + 0.09 + 0.0025) / 3))
    assert some.median_relative == approx(0.1 / 0.32)
    assert some.out_of_range == ("B-1",)
    assert root_mean_square([]) == float("inf")
    assert root_mean_square([3.0, -4.0]) == approx(sqrt(12.5))


@pytest.mark.parametrize(("count", "parameters"), [(10, 2), (7, 0), (6, 4)])
def test_the_criteria_are_those_of_hurvich_and_tsai_and_of_schwarz(count: int, parameters: int) -> None:
    found = gaussian_criteria(0.2, count=count, parameter_count=parameters)
    k, deviance = parameters + 1, 2 * count * log(0.2)
    assert found.bic == approx(deviance + k * log(count))
    assert found.parameter_count == parameters
    if count > k + 1:
        assert found.aicc == approx(deviance + 2 * k + 2 * k * (k + 1) / (count - k - 1))
    else:
        assert found.aicc == float("inf")


def test_tests_are_selected_by_their_letters() -> None:
    assert select_tests("CA", TESTS) == (TESTS[0], TESTS[1], TESTS[3])
    assert {test.set_name for test in select_tests("BL")} == {"B", "L"}


def test_parameters_have_the_range_of_the_fits_that_determine_them_and_intervals_of_two_at_most() -> None:
    own = parameter("offset", applicable_sets="B", default=0.0, initial_values=(0.0,))
    model = variant(lambda test, slope, offset=0.0: slope * test.x + offset, parameter(), own)
    fit = fit_variant(model, "ABC", tests=TESTS)
    left_out = dict(zip("ABC", leave_one_set_out_fits(model, "ABC", tests=TESTS), strict=True))
    slope, offset = fitted_parameters(fit, left_out, TESTS)
    slopes = [each.values[0] for each in left_out.values()]
    assert slope.leave_one_out_range == approx((min(slopes), max(slopes)))
    offsets = [left_out[letter].values[1] for letter in "AC"]  # without B nothing determines it
    assert offset.leave_one_out_range == approx((min(offsets), max(offsets)))
    assert slope.interval is not None
    assert slope.interval[0] < slope.value < slope.interval[1]
    assert all(each.interval is None for each in fitted_parameters(fit, left_out, TESTS, largest_excess=None))
    third = variant(lambda test, **given: 0.5, *(parameter(name) for name in ("one", "two", "three")))
    without = fitted_parameters(fit_variant(third, "A", tests=TESTS), {}, TESTS)
    assert [(each.interval, each.leave_one_out_range) for each in without] == [(None, None)] * 3


@pytest.mark.parametrize(
    ("value", "is_at_bound"), [(-1.997, True), (-1.995, False), (1.997, True), (1.995, False), (0.0, False)]
)
def test_a_value_is_at_its_bound_within_a_thousandth_of_their_distance(value: float, is_at_bound: bool) -> None:
    found = FittedParameter(parameter=parameter(), value=value, interval=None, leave_one_out_range=None)
    assert found.at_bound is is_at_bound
    angle = FittedParameter(parameter=parameter(unit="rad"), value=2.0, interval=None, leave_one_out_range=None)
    assert not angle.at_bound


def test_a_fitted_parameter_is_told_with_its_rig_and_its_interval_or_range() -> None:
    (welder,) = per_rig((parameter("memory_length", unit="m", low=0.0, high=1e-5),), "welder")
    found = FittedParameter(
        parameter=welder, value=1.5e-6, interval=(1e-6, 2.5e-6), leave_one_out_range=(1.2e-6, 1.7e-6)
    )
    assert parameter_text(found) == "memory_length of the welder rig 1.5 um (95 %: 1 um to 2.5 um)"
    plain = FittedParameter(
        parameter=parameter("memory_length", unit="m", low=1.5e-6, high=1e-5), value=1.5e-6, interval=None,
        leave_one_out_range=(1.2e-6, 1.7e-6),
    )  # fmt: skip
    assert parameter_text(plain, left_out="one condition") == (
        "memory_length 1.5 um (one condition left out: 1.2 um to 1.7 um), at its bound"
    )
