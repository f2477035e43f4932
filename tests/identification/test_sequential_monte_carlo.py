"""Posterior samples against problems whose posterior is known exactly."""

from collections.abc import Mapping

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises
from scipy import stats
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.identification import Fact, posterior

BOUNDS = {"a": (1e-3, 1e3), "b": (1e-3, 1e3), "c": (0.1, 10.0)}
SLOPES = np.array([[1.0, 1.0, 0.0], [1.0, -1.2, 0.0]])
CENTRE = np.array([50.0, 50.0])
TOLERANCES = np.array([0.02, 0.4])


def observe(parameters: Mapping[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    logarithms = np.log(np.stack([parameters[name] for name in BOUNDS]))
    return dict(zip(("sum", "difference"), CENTRE[:, np.newaxis] + SLOPES @ logarithms, strict=True))


def facts() -> list[Fact]:
    return [
        Fact(name="sum", value=50.5, tolerance=TOLERANCES[0], rank=1),
        Fact(name="difference", value=49.0, tolerance=TOLERANCES[1], rank=1),
    ]


def test_the_posterior_of_a_linear_problem_is_the_exact_normal() -> None:
    found = posterior(observe, facts=facts(), bounds=BOUNDS)
    drawn = np.log(np.stack([found.draws["a"], found.draws["b"]]))
    jacobian = SLOPES[:, :2] / TOLERANCES[:, np.newaxis]
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    mean = np.linalg.solve(SLOPES[:, :2], np.array([0.5, -1.0]))
    deviation = np.sqrt(np.diag(covariance))
    assert drawn.mean(axis=1) == approx(mean, abs=0.1 * deviation.max())
    assert np.cov(drawn) / np.outer(deviation, deviation) == approx(
        covariance / np.outer(deviation, deviation), abs=0.08
    )
    assert found.has_converged


def test_a_parameter_that_no_fact_determines_keeps_its_prior() -> None:
    found = posterior(observe, facts=facts(), bounds=BOUNDS, seed=1)
    assert found.unidentified == ("c",)
    shares = np.log(found.draws["c"] / 0.1) / np.log(100)
    assert 0 <= shares.min() < shares.max() <= 1
    assert stats.kstest(shares, "uniform").statistic < 0.08


def test_a_limit_truncates_the_prior_and_leaves_it_unchanged_elsewhere() -> None:
    at_most = Fact(name="sum", value=50.0, tolerance=1e-3, rank=1, relation="<=")
    found = posterior(observe, facts=[at_most], bounds=BOUNDS)
    total = np.log(found.draws["a"] * found.draws["b"])
    assert total.max() < 0.01
    # of a square the lower left half is left: the sum of two uniform numbers, cut off at its middle
    width = np.log(1e6)
    assert total.mean() == approx(-width / 3, rel=0.05)


def test_samples_of_one_index_belong_together() -> None:
    found = posterior(observe, facts=facts(), bounds=BOUNDS)
    total = np.log(found.draws["a"] * found.draws["b"])
    assert total.std() == approx(TOLERANCES[0], rel=0.15)
    assert np.log(found.draws["a"]).std() > 5 * TOLERANCES[0]


def test_the_same_seed_gives_the_same_samples() -> None:
    one, other = (posterior(observe, facts=facts(), bounds=BOUNDS, draws=256, seed=3) for _ in range(2))
    same(one.draws["a"], other.draws["a"])


@pytest.mark.parametrize(("draws", "message"), [(255, "multiple of 4"), (64, "at least 256")])
def test_too_few_or_unequal_draws_are_refused(draws: int, message: str) -> None:
    with raises(InvalidInput, match=message):
        posterior(observe, facts=facts(), bounds=BOUNDS, draws=draws)


def test_no_facts_are_refused() -> None:
    with raises(InvalidInput, match=r"facts must not be empty"):
        posterior(observe, facts=[], bounds=BOUNDS)
