"""Posterior as data, draws for one rig against normal distributions in closed form, and resampling by weight."""

import json
from dataclasses import replace
from math import exp, log, pi, sqrt
from pathlib import Path

import numpy as np
from pytest import approx, mark
from scipy.stats import chi2, multivariate_normal, norm
from tests.prediction.linear_rigs import LINEAR, conditions, measured_rig

from sonolube.prediction.evidence import UncertainConditions, published_rigs
from sonolube.prediction.hierarchy import HYPERPARAMETERS, RigLikelihood
from sonolube.prediction.posterior import (
    Population,
    Posterior,
    RigDraws,
    evidence_fingerprint,
    learned,
    rig_draws,
    systematic_rows,
    write_learned,
)
from sonolube.prediction.wear import WEAR_HYPERPARAMETERS

MU, TAU = 0.4, 0.06
KNOWN = Posterior(closure=LINEAR, hyperparameters=np.tile([MU, 0.0, log(TAU), 0.0, log(2e-4), log(0.7)], (1024, 1)))
AT = UncertainConditions(conditions=conditions([2e-6], [0.02]), decay_length_spread=None, amplitude_spread=0.05)


def test_the_decay_length_of_a_further_rig_has_the_median_and_the_added_variances_of_the_draws() -> None:
    # kappa 0.1, 0.2, 0.6: median 0.2, variance 0.14/3; tau_l^2 of 0.2, 0.4, 0.5: mean 0.45/3 = 0.15
    rows = np.zeros((3, 6))
    rows[:, 1], rows[:, 3] = [0.6, 0.1, 0.2], np.log([0.2, 0.4, 0.5])
    median, spread = Posterior(closure=LINEAR, hyperparameters=rows).decay_length()
    assert median == approx(1.5e-6 * exp(0.2))
    assert spread == approx(sqrt(0.14 / 3 + 0.15))


def test_what_was_learned_is_written_to_four_decimals_with_a_line_a_column(tmp_path: Path) -> None:
    draws = np.arange(12.0).reshape(2, 6) + 0.123456
    write_learned(tmp_path / "learned.json", friction={"linear": draws}, wear=np.array([[1.00004, 2.0, 3.00006]]))
    text = (tmp_path / "learned.json").read_text("utf-8")
    content = json.loads(text)
    assert content["evidence"] == evidence_fingerprint()
    columns = content["friction"]["linear"]["draws"]
    assert list(columns) == list(HYPERPARAMETERS)
    assert columns["length_factor"] == [1.1235, 7.1235]
    assert columns["correlation_length"] == [5.1235, 11.1235]
    assert content["wear"]["draws"] == dict(zip(WEAR_HYPERPARAMETERS, ([1.0], [2.0], [3.0001]), strict=True))
    assert text.endswith("}\n")
    assert len(text.splitlines()) == 8  # nine columns, of which the first of wear begins in the line of another


def test_the_shipped_data_are_of_the_tests_and_priors_of_this_version() -> None:
    # a changed test or prior changes the fingerprint, so that data of another version are recognised
    found = learned()
    assert [each.closure.name for each in found.compared] == ["asperity_stick_slip", "spring_contact"]
    assert found.friction.closure.name == "asperity_stick_slip"
    path = Path(__file__).parents[2] / "src" / "sonolube" / "prediction" / "learned.json"
    assert json.loads(path.read_text("utf-8"))["evidence"] == evidence_fingerprint()


def test_a_population_weighs_draws_of_its_prior_by_the_likelihood_of_each_rig() -> None:
    rigs = [measured_rig([ratio], conditions([1e-6], [0.02])) for ratio in (0.3, 0.6)]
    found = Population.of(LINEAR, rigs)
    assert found.draws.mean(axis=0) == approx([0.4, 0.0, log(0.3), log(0.7), log(0.08), log(0.7)], abs=0.01)
    assert found.draws.std(axis=0) == approx([1.0, 0.7, 0.6, 0.5, 0.5, 0.6], rel=0.01)
    assert found.log_likelihoods.shape == (len(found.draws), 2)
    for place, rig in enumerate(rigs):
        assert found.log_likelihoods[:50, place] == approx(RigLikelihood(LINEAR, rig)(found.draws[:50]))


def test_draws_of_a_rig_keep_between_256_and_2048_the_fewer_the_more_tests_it_has() -> None:
    # 4e6 entries of all covariances: of 1 test 2048 draws, of 100 tests 400, of 130 tests 256; of no weight,
    # so that all draws stay
    assert rig_draws(KNOWN, AT, count=300).rows.size == 300
    for tests, kept in ((1, 2048), (100, 400), (130, 256)):
        own = measured_rig([0.4] * tests, conditions([2e-6] * tests, [0.02] * tests))
        own = replace(own, uncertainty=np.full(tests, 10.0))
        assert rig_draws(KNOWN, AT, count=300, own=own).rows.size == kept


@mark.parametrize("ratios", [[0.5, 0.45], [0.52, 0.56, 0.55, 0.53, 0.54, 0.55]], ids=["weighed", "by steps"])
def test_the_density_of_own_tests_is_the_normal_one_however_they_are_conditioned_on(ratios: list[float]) -> None:
    n, noise = len(ratios), 0.05 if len(ratios) == 2 else 0.01
    own = measured_rig(ratios, conditions([2e-6] * n, [0.02] * n))
    own = replace(own, uncertainty=np.full(n, noise))
    exact = multivariate_normal(np.full(n, MU), TAU**2 + noise**2 * np.eye(n)).logpdf(ratios)
    found = rig_draws(KNOWN, AT, count=300, own=own)
    assert found.log_evidence == approx(exact, abs=0.15)
    variance = 1 / (1 / TAU**2 + n / noise**2)
    mean = variance * (MU / TAU**2 + sum(ratios) / noise**2)
    assert found.parameters.log_parameter.mean() == approx(mean, abs=0.1 * sqrt(variance) + 1e-3)
    assert found.parameters.log_parameter.std() == approx(sqrt(variance), rel=0.1)


def test_the_discrepancy_of_one_draw_follows_own_tests_as_a_gaussian_process_does() -> None:
    # conditional normal distribution by hand: covariance C of the tests, c between them and the asked conditions
    sigma, length, deviates = 0.1, 0.5, np.array([[0.7, 0.0, 0.4]])
    row = np.array([[0.4, 0.0, log(0.1), 0.0, log(sigma), log(length)]])
    draws = RigDraws(
        Posterior(closure=LINEAR, hyperparameters=row), AT, np.zeros(1, int), deviates,
        own=measured_rig([0.55, 0.3], conditions([2e-6, 3e-6], [0.02, 0.05])),
    )  # fmt: skip
    ratio = 0.4 + 0.1 * 0.7  # everywhere, a reduction of more than a fifth: the full discrepancy
    scale = sigma * sqrt(4 / chi2(4).isf(norm.cdf(0.4)))
    tested, asked = np.log([[2e-6, 0.02], [3e-6, 0.05]]), np.log([[2.5e-6, 0.03], [1e-6, 0.02], [2e-6, 0.02]])

    def kernel(one: np.ndarray, other: np.ndarray) -> np.ndarray:
        squares = np.sum((one[:, None] - other[None]) ** 2, axis=2)
        return np.asarray(scale**2 * np.exp(-squares / (2 * length**2)))

    among, across = kernel(tested, tested) + 0.05**2 * np.eye(2), kernel(asked, tested)
    mean = ratio + across @ np.linalg.solve(among, np.array([0.55, 0.3]) - ratio)
    variance = scale**2 - np.sum(across * np.linalg.solve(among, across.T).T, axis=1)
    found_mean, deviation = draws.normals(conditions([2.5e-6, 1e-6, 2e-6], [0.03, 0.02, 0.02]))
    assert found_mean[0] == approx(mean, abs=1e-4)
    assert deviation[0] == approx(np.sqrt(variance), abs=1e-4)
    rest = np.array([0.55, 0.3]) - ratio
    density = -0.5 * (rest @ np.linalg.solve(among, rest) + np.linalg.slogdet(2 * pi * among)[1])
    assert draws.log_density() == approx([density], abs=1e-3)
    alone, side = RigDraws(draws.posterior, AT, draws.rows, deviates).normals(conditions([1e-6], [0.02]))
    assert alone[0] == approx([ratio])
    assert side[0] == approx([scale], abs=1e-4)


def test_systematic_rows_are_as_many_as_the_weights_say_in_their_order() -> None:
    rng = np.random.default_rng(0)
    assert systematic_rows(np.zeros(5), 5, rng).tolist() == [0, 1, 2, 3, 4]
    rows = systematic_rows(np.log([3.0, 1e-30, 1.0]) + 700, 8, rng)
    assert rows.tolist() == [0] * 6 + [2] * 2
    counts = np.bincount(systematic_rows(np.log([0.2, 0.5, 0.3]), 7, rng), minlength=3)
    assert np.all(np.abs(counts - np.array([1.4, 3.5, 2.1])) < 1)


def test_every_published_rig_enters_the_fingerprint() -> None:
    assert len(evidence_fingerprint()) == 16
    assert {rig.name for rig in published_rigs()} == set("ABCDEFGHP")
