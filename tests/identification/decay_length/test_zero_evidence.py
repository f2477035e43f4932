"""Zero of the force: its evidence and smoothed course by normal distributions in information form."""

import numpy as np
import pytest
from pytest import approx
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from sonolube.identification import SwitchConditions, SwitchTable
from sonolube.identification.decay_length.zero_error import zero_evidence
from sonolube.models.friction.models.asperity_stick_slip_sine import sine_stick_slip_ratio

S = np.arange(6.0, 60.0, 6.0)
FORCE, NOISE = 1.2, 0.04  # more than the differences of neighbours tell
ZERO = np.array([0.01, -0.02, 0.05, 0.04, 0.09, 0.08, 0.13, 0.11, 0.14])


def table(zero: np.ndarray = ZERO, *, ratio: float = 0.55, uncertainty: float | None = NOISE) -> SwitchTable:
    true = np.where(np.isfinite(zero), zero, 0.0)
    stated = None if uncertainty is None else np.full(S.size, uncertainty)
    return SwitchTable(
        sliding_distance=S, friction_force=ratio * FORCE + true, intrinsic_friction_force=FORCE + true,
        force_zero=zero, force_zero_uncertainty=stated,
    )  # fmt: skip


def by_hand() -> tuple[float, np.ndarray]:
    """Logarithm of the evidence ratio, and the smoothed zero of the best model that is off.

    Noise as stated, wander of 0.005, 0.015 or 0.05 of the force over 0.1, 0.3 or 1 of the run; a level, and a
    relaxation over 0.05, 0.2, 0.5 or 2 of it, of 0.35 of the force, times the mean square of both (moment prior).
    """
    gaps = np.abs(S[:, None] - S) / S[-1]
    white = NOISE**2 * np.eye(S.size)
    noises = [
        white + (w * FORCE) ** 2 * np.exp(-gaps / length) for w in (0.005, 0.015, 0.05) for length in (0.1, 0.3, 1.0)
    ]
    level = np.ones((S.size, 1))
    courses = [(1 - np.exp(-S / (r * S[-1]))) / (1 - np.exp(-1 / r)) for r in (0.05, 0.2, 0.5, 2.0)]
    shapes = [level, *(np.column_stack([level, course]) for course in courses)]

    def density(noise: np.ndarray, shape: np.ndarray, deviation: float) -> float:
        return float(multivariate_normal(np.zeros(S.size), noise + deviation**2 * shape @ shape.T).logpdf(ZERO))

    good = [density(noise, level, 0.03 * FORCE) for noise in noises]
    off, means = [], []
    deviation = 0.35 * FORCE
    for shape in shapes:
        for noise in noises:
            precision = np.eye(shape.shape[1]) / deviation**2 + shape.T @ np.linalg.solve(noise, shape)
            mean = np.linalg.solve(precision, shape.T @ np.linalg.solve(noise, ZERO))
            square = mean @ mean + np.trace(np.linalg.inv(precision))
            off.append(density(noise, shape, deviation) + np.log(square / (mean.size * deviation**2)))
            course = shape @ mean
            wander = noise - white
            means.append(course + wander @ np.linalg.solve(noise, ZERO - course))
    ratio = logsumexp(off) - np.log(len(off)) - logsumexp(good) + np.log(len(good))
    return float(ratio), means[int(np.argmax(off))]


def test_the_evidence_of_a_zero_that_is_off_and_its_course_are_those_of_a_linear_model() -> None:
    found = zero_evidence(table(), SwitchConditions())
    ratio, smoothed = by_hand()
    assert found.log_ratio == approx(ratio, abs=1e-6)
    assert found.force_zero == approx(smoothed, abs=1e-9)
    assert found.rows.tolist() == list(range(S.size))


def test_switches_without_a_zero_are_left_out() -> None:
    zero = ZERO.copy()
    zero[4] = np.nan
    found = zero_evidence(table(zero), SwitchConditions())
    assert found.rows.tolist() == [0, 1, 2, 3, 5, 6, 7, 8]
    assert found.force_zero.size == 8


def test_the_noise_of_a_zero_is_that_of_neighbours_or_as_stated_whichever_is_more() -> None:
    # differences of neighbours of +- 0.08 N: median square 0.0064 over twice 0.4549; a stated 0.001 N is less
    rough = np.where(np.arange(S.size) % 2, 0.08, 0.0)
    free, low = (zero_evidence(table(rough, uncertainty=each), SwitchConditions()) for each in (None, 1e-3))
    assert free.log_ratio == approx(low.log_ratio)
    assert free.force_zero == approx(low.force_zero)
    deviation = np.sqrt(0.0064 / (2 * 0.4549))
    same = zero_evidence(table(rough, uncertainty=float(deviation)), SwitchConditions())
    assert same.log_ratio == approx(free.log_ratio, rel=1e-3)
    more = zero_evidence(table(rough, uncertainty=0.3), SwitchConditions())
    assert more.log_ratio != approx(free.log_ratio, abs=0.1)


@pytest.mark.parametrize("zero", [-0.25, 0.2])
def test_a_zero_of_either_sign_makes_the_decay_length_wrong_by_what_the_ratio_without_it_says(zero: float) -> None:
    # a ratio of 0.55 is read as (0.55 F + z)/(F + z)
    found = zero_evidence(table(np.full(S.size, zero), uncertainty=1e-3), SwitchConditions(vibration_amplitude=2e-6))
    lengths = np.geomspace(0.2e-6, 4e-6, 2001)
    ratios = sine_stick_slip_ratio(decay_length=lengths, vibration_amplitude=2e-6, frequency=22e3, sliding_speed=65e-3)
    true, read = (np.interp(each, ratios, np.log(lengths)) for each in (0.55, (0.55 * FORCE + zero) / (FORCE + zero)))
    assert np.median(found.factor) == approx(np.exp(abs(true - read)), rel=0.03)
    assert found.factor.size == 400
    assert found.factor.min() >= 1
