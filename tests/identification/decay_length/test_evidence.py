"""Evidence by sampling against closed forms, and zeros of the force that are off or good."""

from dataclasses import dataclass

import numpy as np
import pytest

from sonolube.checks import Floats
from sonolube.identification import SwitchConditions, SwitchTable
from sonolube.identification.decay_length.posterior import evidence
from sonolube.identification.decay_length.zero_error import zero_evidence

S = np.arange(5.0, 300.0, 5.0)


@dataclass(frozen=True)
class Linear:
    """Readings that are a linear function of the deviates."""

    design: Floats
    readings: Floats

    def residuals(self, deviates: Floats) -> Floats:
        return np.asarray(self.readings - deviates @ self.design.T)


@dataclass(frozen=True)
class TwoSigns:
    """One reading of the square of the only deviate."""

    def residuals(self, deviates: Floats) -> Floats:
        return np.asarray((deviates**2 - 1.0) / 0.1)


def test_the_evidence_of_a_linear_model_is_its_normal_density() -> None:
    rng = np.random.default_rng(1)
    design, readings = rng.standard_normal((12, 5)), 2 * rng.standard_normal(12)
    found = evidence(Linear(design, readings).residuals, starts=np.zeros((1, 5)))
    covariance = np.eye(12) + design @ design.T
    exact = -0.5 * (readings @ np.linalg.solve(covariance, readings) + np.linalg.slogdet(covariance)[1])
    assert found.log_evidence == pytest.approx(exact, abs=0.05)
    mean = design.T @ np.linalg.solve(covariance, readings)
    np.testing.assert_allclose(found.weights @ found.draws, mean, atol=0.1)


def test_both_modes_count_where_the_sign_is_open() -> None:
    found = evidence(TwoSigns().residuals, starts=np.array([[0.8], [-0.9]]))
    x = np.linspace(-5, 5, 20001)
    density = np.exp(-0.5 * ((x**2 - 1) / 0.1) ** 2 - 0.5 * x**2) / np.sqrt(2 * np.pi)
    assert found.log_evidence == pytest.approx(np.log(np.trapezoid(density, x)), abs=0.05)
    assert found.weights @ (found.draws[:, 0] > 0) == pytest.approx(0.5, abs=0.1)


def with_zero(zero: Floats, *, ratio: float = 0.6) -> SwitchTable:
    read = zero + 0.01 * np.random.default_rng(2).standard_normal(S.size)
    return SwitchTable(
        sliding_distance=S, friction_force=ratio + zero, intrinsic_friction_force=1.0 + zero, force_zero=read
    )


def test_a_zero_that_goes_off_by_a_third_of_the_friction_is_told_from_a_good_one() -> None:
    off = zero_evidence(with_zero(-0.35 * (1 - np.exp(-S / 60))), SwitchConditions())
    good = zero_evidence(with_zero(np.full(S.size, 0.01)), SwitchConditions())
    assert off.log_ratio > 10
    assert good.log_ratio < -3
    assert off.force_zero[-1] == pytest.approx(-0.35, abs=0.02)
    assert np.median(good.factor) < 1.1


def test_the_bias_of_a_zero_is_that_of_decay_lengths_with_and_without_it() -> None:
    # ratio 0.6 read as (0.6 - 0.3)/(1 - 0.3) = 0.429; sonolube friction gives both at 1.82 and 1.23 um
    from sonolube.models.friction.models.asperity_stick_slip_sine import sine_stick_slip_ratio

    lengths = 1e-6 * np.linspace(0.8, 2.5, 3401)
    ratios = sine_stick_slip_ratio(
        decay_length=lengths, vibration_amplitude=2.3e-6, frequency=22e3, sliding_speed=65e-3
    )
    true, read = (np.interp(value, ratios, lengths) for value in (0.6, 0.3 / 0.7))
    found = zero_evidence(with_zero(np.full(S.size, -0.3)), SwitchConditions())
    assert np.median(found.factor) == pytest.approx(true / read, rel=0.03)
