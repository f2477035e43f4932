"""Efficiency line of measured runs: normal equations, coverage of its bands, and refusals."""

import numpy as np
import pytest
from pytest import approx, raises
from scipy.stats import t as student

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.facts.metrics import (
    EfficiencyFit,
    EfficiencyLine,
    efficiency_coefficient,
    efficiency_confidence_band,
    efficiency_prediction_band,
    fit_efficiency,
    friction_at_power,
    power_estimate,
    require_fitted_speed,
)

SPEEDS = np.array([0.04, 0.065, 0.08, 0.1, 0.12, 0.15, 0.18])
SCATTER = np.array([0.03, -0.02, 0.015, -0.04, 0.01, 0.02, -0.015]) * 1e-9
RIG = {"nominal_area": 0.126e-6, "normal_load": 5.0}
D_LINE = EfficiencyLine(slope=-2.93e-9, intercept=0.672e-9)


def measured() -> EfficiencyFit:
    return fit_efficiency(sliding_speed=SPEEDS, efficiency_coefficient=0.672e-9 - 2.93e-9 * SPEEDS + SCATTER)


def test_runs_on_a_line_are_fitted_by_that_line_without_scatter() -> None:
    fit = fit_efficiency(sliding_speed=SPEEDS, efficiency_coefficient=0.672e-9 - 2.93e-9 * SPEEDS)
    assert fit.line.slope == approx(-2.93e-9, rel=1e-9, abs=0)
    assert fit.line.intercept == approx(0.672e-9, rel=1e-9, abs=0)
    assert fit.efficiency_deviation == approx(0, abs=1e-22)


def test_line_and_bands_agree_with_the_normal_equations() -> None:
    eta = 0.672e-9 - 2.93e-9 * SPEEDS + SCATTER
    design = np.stack([np.ones_like(SPEEDS), SPEEDS], axis=1)
    inverse = np.linalg.inv(design.T @ design)
    coefficients = inverse @ design.T @ eta
    variance = np.sum((eta - design @ coefficients) ** 2) / (SPEEDS.size - 2)
    covariance = variance * inverse
    fit = measured()
    assert [fit.line.intercept, fit.line.slope] == approx(coefficients, rel=1e-9, abs=0)
    errors = [fit.intercept_uncertainty, fit.slope_uncertainty]
    assert errors == approx(np.sqrt(np.diag(covariance)), rel=1e-9, abs=0)
    at = np.array([1.0, 0.17])
    reach = student.ppf(0.975, SPEEDS.size - 2) * np.sqrt(at @ covariance @ at)
    low, high = efficiency_confidence_band(fit, sliding_speed=0.17)
    assert [low, high] == approx([at @ coefficients - reach, at @ coefficients + reach], rel=1e-9, abs=0)
    wide = student.ppf(0.975, SPEEDS.size - 2) * np.sqrt(variance + at @ covariance @ at)
    low, high = efficiency_prediction_band(fit, sliding_speed=0.17)
    assert [low, high] == approx([at @ coefficients - wide, at @ coefficients + wide], rel=1e-9, abs=0)


def test_the_confidence_and_prediction_bands_have_their_nominal_coverage() -> None:
    rng = np.random.default_rng(5)
    held = np.zeros(2)
    for _ in range(2000):
        eta = 1e-9 - 3e-9 * SPEEDS + 0.05e-9 * rng.standard_normal(SPEEDS.size)
        fit = fit_efficiency(sliding_speed=SPEEDS, efficiency_coefficient=eta)
        truth, run = 1e-9 - 3e-9 * 0.1, 1e-9 - 3e-9 * 0.1 + 0.05e-9 * rng.standard_normal()
        for place, (band, value) in enumerate(((efficiency_confidence_band, truth), (efficiency_prediction_band, run))):
            low, high = band(fit, sliding_speed=0.1, confidence_level=0.9)
            held[place] += low <= value <= high
    assert held / 2000 == approx([0.9, 0.9], abs=0.02)


def test_the_estimated_power_gives_the_target_friction_and_its_interval_follows_from_the_band() -> None:
    fit = measured()
    wanted = {"intrinsic_friction_force": 0.89, "sliding_speed": 0.0655, **RIG}
    found = power_estimate(fit, reduced_friction_force=0.4, **wanted)
    assert friction_at_power(fit.line, actuator_power=found.actuator_power, **wanted) == approx(0.4)
    low, high = efficiency_prediction_band(fit, sliding_speed=0.0655)
    for power, efficiency in ((found.lowest_power, high), (found.highest_power, low)):
        assert power is not None
        back = efficiency_coefficient(reduced_friction_force=0.4, actuator_power=power, **wanted)
        assert back == approx(float(efficiency), rel=1e-9, abs=0)


def test_a_band_that_reaches_zero_efficiency_leaves_the_power_without_an_upper_limit() -> None:
    noisy = 0.672e-9 - 2.93e-9 * SPEEDS + 20 * SCATTER
    fit = fit_efficiency(sliding_speed=SPEEDS, efficiency_coefficient=noisy)
    found = power_estimate(fit, intrinsic_friction_force=0.89, reduced_friction_force=0.4, sliding_speed=0.1, **RIG)
    assert found.highest_power is None
    assert found.lowest_power < found.actuator_power


def test_the_slowest_and_the_fastest_run_are_within_the_runs() -> None:
    require_fitted_speed(measured(), sliding_speed=[0.04, 0.18])


def test_creeping_runs_have_the_line_of_runs_as_much_faster() -> None:
    eta = 0.672e-9 - 2.93e-9 * SPEEDS + SCATTER
    creeping = fit_efficiency(sliding_speed=1e-6 * SPEEDS, efficiency_coefficient=eta)
    assert creeping.line.slope == approx(1e6 * measured().line.slope, rel=1e-9, abs=0)


@pytest.mark.parametrize("speed", [0.02, 0.3])
def test_a_speed_outside_the_runs_is_refused_with_their_range(speed: float) -> None:
    with raises(OutsideRange, match=r"must lie within the runs, 0\.04 to 0\.18 m/s"):
        require_fitted_speed(measured(), sliding_speed=speed)
    with raises(OutsideRange, match="measure there"):
        power_estimate(
            measured(), intrinsic_friction_force=0.89, reduced_friction_force=0.4, sliding_speed=speed, **RIG
        )


@pytest.mark.parametrize(
    ("speeds", "said"), [([0.1, 0.2], "at least 3 runs"), ([0.1, 0.1, 0.1], "at least two speeds")]
)
def test_too_few_runs_or_a_single_speed_are_refused(speeds: list[float], said: str) -> None:
    with raises(InvalidInput, match=said):
        fit_efficiency(sliding_speed=speeds, efficiency_coefficient=np.full(len(speeds), 1e-9))
