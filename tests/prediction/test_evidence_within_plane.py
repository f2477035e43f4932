"""Own published tests within the plane: the slip length that they tell, by another integral, and where it counts."""

import json
from functools import cache
from math import exp, pi
from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, mark, raises
from tests.prediction.test_evidence_learning import RIG, shipped_alone, source, with_stubborn_rig

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.prediction.evidence_learning import LearnedEvidence, learn_evidence, own_plane_rigs
from sonolube.prediction.evidence_posterior import read_evidence_posterior
from sonolube.prediction.live_prediction import LivePrediction
from sonolube.prediction.published_source import PublishedSource, shipped_sources, source_from
from sonolube.prediction.within_plane import plane_population, plane_posterior, slip_length
from sonolube.rig.vibration_direction import VibrationDirection

ALONG = VibrationDirection(direction="along")
AMPLITUDE, LENGTH, ERROR, ZETA = 1e-6, 0.7e-6, 0.02, 2e-3


def slow_test(title: str, ratio: float) -> PublishedSource:
    """A source with one point of slow sliding, v_r/(omega a) = 0.002, along the vibration."""
    point = {
        "label": title,
        "vibration_amplitude": f"{AMPLITUDE} m",
        "friction_ratio": ratio,
        "uncertainty": ERROR,
        "sliding_speed": f"{ZETA * 2 * pi * 20e3 * AMPLITUDE} m/s",
    }
    rig = {"set": "1", "title": "invented", "direction": "along", "amplitude_known": "measured", "frequency": "20 kHz"}
    content = {"title": title, "citation": f"{title} 2026", "opened": "full text", "rigs": [rig | {"points": [point]}]}
    return source_from(content, file=f"{title}.toml")


OWN = slow_test("Flat", exp(-AMPLITUDE / LENGTH))


@cache
def with_flat_rig() -> LearnedEvidence:
    return learn_evidence([OWN])


def along(**given: Any) -> Any:
    rig = sl.read_rig(RIG, changes=["vibration.direction=along", "friction.model=coulomb"])
    return LivePrediction(rig, seed=1, draws=2000, **given).first


def test_the_slip_length_is_that_of_an_integral_over_all_that_a_rig_has_of_its_own() -> None:
    # Of slow sliding R = exp(-a/s) but for 2 zeta/pi, with ln s ~ N(mu, tau^2), an amplitude within 5 %, and a
    # discrepancy s_r sigma min((1 - R)/0.2, 1), s_r^2 = 4/chi^2_4. Posterior means over the draws by the shipped tests.
    rng = np.random.default_rng(1)
    before = plane_posterior().hyperparameters
    mu, tau, sigma = before[:, 0], np.exp(before[:, 2]), np.exp(before[:, 4])
    logs = mu[:, None] + np.hypot(tau[:, None], 0.05) * rng.standard_normal((len(mu), 400))
    ratio = np.exp(-AMPLITUDE / np.exp(logs))
    scale = np.sqrt(4 / rng.chisquare(4, logs.shape))
    effect = np.minimum(AMPLITUDE / np.exp(logs) / 0.2, 1.0)
    share = np.clip((1 - ratio) / 0.2, 0.25, 1.0) * effect
    deviation = np.hypot(scale * sigma[:, None] * share, ERROR)
    measured = exp(-AMPLITUDE / LENGTH)
    weights = np.mean(np.exp(-0.5 * ((measured - ratio) / deviation) ** 2) / deviation, axis=1)
    expected = np.average(mu, weights=weights)
    spread = np.sqrt(np.average((mu - expected) ** 2, weights=weights))
    found = with_flat_rig().posterior.posterior_within_plane.hyperparameters[:, 0]
    assert abs(expected - mu.mean()) > 0.15  # the test tells
    assert found.mean() == approx(expected, abs=0.05)
    assert found.std() == approx(spread, rel=0.12)


def test_without_own_tests_the_posterior_is_the_shipped_one() -> None:
    found = shipped_alone().posterior
    assert found.plane_hyperparameters is None
    assert found.posterior_within_plane.hyperparameters == approx(plane_posterior().hyperparameters, abs=1e-12)
    alike = plane_population().with_rigs(within_plane=(), along_normal=())
    assert alike.posterior().hyperparameters == approx(plane_posterior().hyperparameters, abs=1e-12)
    assert along(evidence=found)["friction_ratio"].to_numpy() == approx(along()["friction_ratio"].to_numpy(), abs=1e-12)


def test_two_tests_count_as_their_product() -> None:
    one, other = own_plane_rigs([OWN, slow_test("Flatter", 0.3)])
    both = plane_population().with_rigs(within_plane=(one, other), along_normal=())
    in_turn = plane_population().with_rigs(within_plane=(other,), along_normal=())
    in_turn = in_turn.with_rigs(within_plane=(one,), along_normal=())
    assert both.log_likelihoods[:, [-2, -1]] == approx(in_turn.log_likelihoods[:, [-1, -2]])
    alone = plane_population().with_rigs(within_plane=(one,), along_normal=())
    left_out = both.posterior(without=(4,)).hyperparameters
    assert left_out == approx(alone.posterior().hyperparameters)


def test_tests_along_the_normal_tell_the_error_within_the_plane_and_not_the_slip_length() -> None:
    before, after = plane_posterior(), with_stubborn_rig().posterior.posterior_within_plane
    assert slip_length(after)[0] == approx(slip_length(before)[0], rel=0.15)
    assert after.hyperparameters[:, 4].mean() > before.hyperparameters[:, 4].mean() + 0.05


def test_stiff_contacts_lower_the_predicted_friction_along_the_sliding_alone() -> None:
    stiff = learn_evidence([slow_test("Stiff", 0.0)]).posterior
    soft = learn_evidence([slow_test("Soft", 0.9)]).posterior
    assert slip_length(stiff.posterior_within_plane)[0] < slip_length(plane_posterior())[0]
    assert slip_length(soft.posterior_within_plane)[0] > slip_length(plane_posterior())[0]
    low, high = (np.median(along(evidence=each)["friction_ratio"].to_numpy()) for each in (stiff, soft))
    assert low < high
    assert stiff.hyperparameters == approx(soft.hyperparameters)


def test_a_prediction_within_the_plane_says_what_it_was_learned_from() -> None:
    caveats = along(evidence=with_flat_rig().posterior).attrs["caveats"]
    assert "learned from published tests and 1 point within the plane of Flat, in place of the posterior" in caveats
    assert "is that of Mindlin's stiffness, of these points and of 1 point within the plane of Flat; one run" in caveats
    both = with_stubborn_rig().posterior.caveats(ALONG)
    assert both[0].startswith("learned from published tests and 3 points of Stubborn, in place of")
    (none,) = shipped_alone().posterior.caveats(ALONG)
    assert "tells nothing of vibration within the plane, of which the posterior that ships" in none


def test_blind_scores_within_the_plane_stand_beside_those_along_the_normal() -> None:
    scores = {score.name: len(score.found.predictions) for score in with_flat_rig().scores}
    assert scores == {
        "shipped tests, by the other shipped ones": 20,
        "shipped tests within the plane, by the other shipped ones": 7,
        "own tests within the plane, by the shipped ones alone": 1,
        "shipped tests within the plane, by all others": 7,
        "own tests within the plane, by all others": 1,
    }


def test_the_file_holds_both_posteriors_and_one_of_the_first_format_is_read(tmp_path: Path) -> None:
    given = with_flat_rig().posterior
    found = read_evidence_posterior(given.write(tmp_path / "own.json"))
    assert found.plane_hyperparameters == approx(given.plane_hyperparameters, abs=5.1e-5)
    assert found.sources == given.sources
    assert [(one.points, one.points_within_plane) for one in found.own] == [(0, 1)]
    content = json.loads(given.text())
    former = {key: value for key, value in content.items() if key != "draws_within_plane"}
    former |= {"format": "sonolube evidence posterior 1"}
    former["sources"] = [
        {key: value for key, value in entry.items() if key != "points_within_plane"} | {"points": 3}
        for entry in content["sources"]
    ]
    (tmp_path / "former.json").write_text(json.dumps(former), "utf-8")
    old = read_evidence_posterior(tmp_path / "former.json")
    assert old.hyperparameters == approx(found.hyperparameters)
    assert old.posterior_within_plane.hyperparameters == approx(plane_posterior().hyperparameters, abs=1e-12)
    assert "(former.json) tells nothing of vibration within the plane" in old.caveats(ALONG)[0]


def test_draws_within_the_plane_that_are_none_are_refused(tmp_path: Path) -> None:
    content = json.loads(with_flat_rig().posterior.text())
    content["draws_within_plane"] = {"parameter": [0.0] * 200}
    (tmp_path / "own.json").write_text(json.dumps(content), "utf-8")
    with raises(InvalidInput, match=r"draws_within_plane must be of .*, got parameter; write it again by"):
        read_evidence_posterior(tmp_path / "own.json")


@mark.parametrize("title", ["Luo et al.", "Gutowski and Leus"])
def test_a_shipped_test_within_the_plane_is_refused_as_an_own_one(title: str) -> None:
    (one,) = (each for each in shipped_sources() if each.title == title)
    with raises(InvalidInput, match="that ships with sonolube; a test that counts twice"):
        own_plane_rigs([one])


def test_the_same_numbers_in_another_direction_are_another_test() -> None:
    pair = [source("One", (0.5,), direction=word) for word in ("along", "across")]
    assert len(own_plane_rigs([pair[0], source("Two", (0.5,), direction="across")])) == 2
    with raises(InvalidInput, match="has the numbers of set 1 of One"):
        own_plane_rigs([pair[0], source("Two", (0.5,), direction="along")])
