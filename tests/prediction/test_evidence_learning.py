"""Learning from shipped and own published tests: weights by hand, order of files, and the file of a posterior."""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, mark, raises
from tests.prediction.linear_rigs import LINEAR, conditions, measured_rig

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.evidence_learning import (
    LearnedEvidence,
    effective_number,
    expected_time,
    learn_evidence,
    own_rigs,
    read_sources,
)
from sonolube.prediction.evidence_posterior import EvidencePosterior, read_evidence_posterior
from sonolube.prediction.live_prediction import LivePrediction
from sonolube.prediction.posterior import Population, evidence_fingerprint, learned
from sonolube.prediction.published_source import PublishedSource, shipped_sources, source_from
from sonolube.rig.vibration_direction import NORMAL, VibrationDirection

ROOT = Path(__file__).parents[2]
RIG = ROOT / "examples" / "rigs" / "tribometer.toml"


def source(title: str, ratios: tuple[float, ...], *, direction: str = "normal") -> PublishedSource:
    """A source with one rig: ratios at amplitudes of 1, 2, ... um and 20 mm/s."""
    points = [
        {"label": f"{title} {place}", "vibration_amplitude": f"{place} um", "friction_ratio": ratio}
        for place, ratio in enumerate(ratios, 1)
    ]
    rig = {
        "set": "1",
        "title": "invented",
        "direction": direction,
        "amplitude_known": "measured",
        "frequency": "20 kHz",
        "sliding_speed": "20 mm/s",
        "points": points,
    }
    content = {"title": title, "citation": f"{title} 2026", "opened": "full text", "rigs": [rig]}
    return source_from(content, file=f"{title}.toml")


@cache
def shipped_alone() -> LearnedEvidence:
    return learn_evidence()


@cache
def with_stubborn_rig() -> LearnedEvidence:
    """With a rig whose friction hardly falls at amplitudes of 1 to 3 um."""
    return learn_evidence([source("Stubborn", (0.97, 0.95, 0.93))])


def predicted(evidence: EvidencePosterior | None) -> Any:
    return LivePrediction(sl.read_rig(RIG), evidence=evidence, seed=1).first


def test_the_shares_of_draws_are_their_likelihoods_by_hand() -> None:
    at = conditions([2e-6], [0.02])
    rigs = [measured_rig([0.4], at, name="a"), measured_rig([0.9], at, name="b")]
    population = Population.of(LINEAR, rigs)
    for shares, columns in (
        (population.shares(), [0, 1]),
        (population.shares(without=(1,)), [0]),
        (population.of_first(1).shares(), [0]),
    ):
        weights = np.exp(population.log_likelihoods[:, columns]).prod(axis=1)
        assert shares == approx(weights / weights.sum(), rel=1e-9)
    both = Population.of(LINEAR, rigs[:1]).with_rig(rigs[1])
    assert both.log_likelihoods == approx(population.log_likelihoods)


def test_the_posterior_mean_is_that_of_importance_weights() -> None:
    found = with_stubborn_rig()
    own = own_rigs([source("Stubborn", (0.97, 0.95, 0.93))])
    population = Population.of(found.posterior.posterior.closure, (*published_rigs(), *own))
    weights = np.exp(population.log_likelihoods.sum(axis=1) - population.log_likelihoods.sum(axis=1).max())
    weights /= weights.sum()
    means = weights @ population.draws
    deviations = np.sqrt(weights @ (population.draws - means) ** 2)
    # systematic resampling leaves less than the scatter of independent draws, s/sqrt(2048)
    assert np.all(np.abs(found.posterior.hyperparameters.mean(axis=0) - means) < 3 * deviations / np.sqrt(2048))
    assert found.effective_draws == approx(1 / np.sum(weights**2), rel=1e-6)


def test_the_effective_number_of_equal_draws_is_their_number() -> None:
    assert effective_number(np.full(8, 1 / 8)) == approx(8.0)
    assert effective_number(np.array([0.0, 1.0, 0.0])) == approx(1.0)


def test_a_rig_that_vibration_hardly_moves_raises_the_predicted_friction() -> None:
    before, after = shipped_alone().posterior, with_stubborn_rig().posterior
    ratios = [float(np.median(predicted(each)["friction_ratio"].to_numpy())) for each in (before, after)]
    assert ratios[1] > ratios[0] + 0.02
    # by a longer decay length, more scatter between rigs or a larger error of the model
    assert after.posterior.decay_length()[0] > before.posterior.decay_length()[0]
    assert after.posterior.decay_length()[1] > before.posterior.decay_length()[1]


def test_the_posterior_by_the_shipped_tests_alone_predicts_as_the_shipped_one() -> None:
    shipped, by_file = predicted(None), predicted(shipped_alone().posterior)
    for level in (0.1, 0.25, 0.5, 0.75, 0.9):
        one, other = (float(np.quantile(each["friction_ratio"].to_numpy(), level)) for each in (shipped, by_file))
        assert other == approx(one, abs=0.03)
    means = shipped_alone().posterior.hyperparameters.mean(axis=0)
    deviations = learned().friction.hyperparameters.std(axis=0)
    assert means == approx(learned().friction.hyperparameters.mean(axis=0), abs=0.2 * deviations.max())


def test_a_prediction_says_what_it_was_learned_from() -> None:
    found = predicted(with_stubborn_rig().posterior)
    known = "published tests and 3 points of Stubborn"
    assert f"learned from {known}, in place of the posterior that ships with sonolube" in found.attrs["caveats"]
    assert any(known in text for text in found["input_text"].to_numpy().tolist())
    assert found.attrs["evidence_fingerprint"] == with_stubborn_rig().posterior.fingerprint
    assert found.attrs["evidence_sources"].split("\n")[-1] == "Stubborn 2026"
    assert "evidence" not in predicted(None).attrs


def test_the_order_of_files_and_their_names_do_not_matter(tmp_path: Path) -> None:
    example = (ROOT / "examples" / "evidence" / "own_tests.toml").read_text("utf-8")
    other = example.replace("Invented example", "Another").replace("table 1", "table 2").replace("2.7 N", "2.5 N")
    for folder, (one, two) in {"a": (example, other), "b": (other, example)}.items():
        place = tmp_path / folder
        place.mkdir()
        (place / "1.toml").write_text(one, "utf-8")
        (place / "2.toml").write_text(two, "utf-8")
    first, second = (read_sources([tmp_path / folder]) for folder in "ab")
    assert [each.title for each in first] == [each.title for each in second]
    assert len({evidence_fingerprint(own_rigs(each)) for each in (first, second)} - {evidence_fingerprint()}) == 1
    for rig, same in zip(own_rigs(first), own_rigs(second), strict=True):
        assert rig.name == same.name
        assert rig.friction_ratio == approx(same.friction_ratio)


def test_the_blind_scores_of_own_tests_stand_beside_those_of_the_shipped_ones() -> None:
    alone, _ = shipped_alone().scores
    assert (alone.name, len(alone.found.predictions)) == ("shipped tests, by the other shipped ones", 20)
    first, unseen, shipped, own, every, _ = with_stubborn_rig().scores
    assert first.found.crps == approx(alone.found.crps)
    assert [len(each.found.predictions) for each in (unseen, shipped, own, every)] == [3, 20, 3, 23]
    # tests far from all others are predicted worse
    assert unseen.found.crps > alone.found.crps
    assert every.found.crps == approx((20 * shipped.found.crps + 3 * own.found.crps) / 23)


def test_progress_names_each_rig_and_the_time_is_said_before() -> None:
    told: list[tuple[str, int, int]] = []
    learn_evidence(advance=lambda *done: told.append(done))
    assert [name for name, _, _ in told] == [rig.name for rig in published_rigs()]
    assert told[-1][1:] == (8, 9)
    assert re.fullmatch(r"13 rigs, about \d+ s", expected_time([source("Own", (0.5,))]))


def test_a_test_that_counts_twice_is_refused() -> None:
    (dong,) = (each for each in shipped_sources() if each.title == "Dong")
    with raises(InvalidInput, match=r"dong_2015\.toml: set A has the numbers of set A that ships with sonolube"):
        own_rigs([dong])
    with raises(InvalidInput, match=r"Two\.toml: set 1 has the numbers of set 1 of One; a test that counts twice"):
        own_rigs([source("One", (0.5,)), source("Two", (0.5,))])
    with raises(InvalidInput, match=r"set 1 of One is there twice; name each set of its own"):
        own_rigs([source("One", (0.5,)), source("One", (0.6,))])


def test_a_folder_without_files_is_refused(tmp_path: Path) -> None:
    with raises(InvalidInput, match="has no file of published tests, such as"):
        read_sources([tmp_path])
    with raises(InvalidInput, match="no such file"):
        read_sources([tmp_path / "gone"])


def test_a_posterior_comes_back_from_its_file_to_the_digits_that_are_kept(tmp_path: Path) -> None:
    given = with_stubborn_rig().posterior
    found = read_evidence_posterior(given.write(tmp_path / "own.json"))
    assert found.hyperparameters == approx(given.hyperparameters, abs=5.1e-5)
    assert (found.sources, found.fingerprint, found.name) == (given.sources, given.fingerprint, "own.json")
    along = VibrationDirection(direction="along")
    for direction in (VibrationDirection(), along):
        said = given.caveats(direction)
        assert found.caveats(direction) == tuple(each.replace("Stubborn,", "Stubborn (own.json),") for each in said)
    assert predicted(found)["friction_ratio"].to_numpy() == approx(
        predicted(given)["friction_ratio"].to_numpy(), abs=2e-3
    )


@mark.parametrize(
    ("change", "reason"),
    [
        (lambda content: content | {"format": "other"}, r"own\.json: format: Input should be"),
        (lambda content: content | {"friction_model": "kinematic"}, r'friction_model "kinematic" is not that of'),
        (lambda content: content | {"draws": {"mu": [0.0]}}, r"draws must be of .*, got mu; write it again by"),
        (
            lambda content: content | {"draws": {k: v[:50] for k, v in content["draws"].items()}},
            r"100 or more, got .*50",
        ),
        (
            lambda content: content | {"draws": {k: [1e3] * 200 for k in content["draws"]}},
            r"draws are logarithms, of which none is larger than 50",
        ),
        (lambda content: {k: v for k, v in content.items() if k != "sources"}, r"sources: missing"),
        (lambda content: content | {"extra": 1}, r"extra: unknown key"),
        (lambda content: [content], r"is no posterior that sonolube evidence learn wrote"),
    ],
)
def test_a_file_that_is_no_posterior_is_refused(change: Any, reason: str, tmp_path: Path) -> None:
    content = json.loads(shipped_alone().posterior.text())
    path = tmp_path / "own.json"
    path.write_text(json.dumps(change(content)), "utf-8")
    with raises(InvalidInput, match=reason):
        read_evidence_posterior(path)


@mark.parametrize(
    ("text", "reason"),
    [("draws = 1", r"not valid JSON: .* expected a posterior"), ("[" * 100_000, "not valid JSON: nested too deeply")],
)
def test_a_text_that_is_no_json_is_refused(text: str, reason: str, tmp_path: Path) -> None:
    (tmp_path / "own.json").write_text(text, "utf-8")
    with raises(InvalidInput, match=reason):
        read_evidence_posterior(tmp_path / "own.json")


def test_a_number_that_is_not_finite_is_refused(tmp_path: Path) -> None:
    text = re.sub(r"\[-?\d+\.\d+,", "[NaN,", shipped_alone().posterior.text(), count=1)
    (tmp_path / "own.json").write_text(text, "utf-8")
    with raises(InvalidInput, match="finite"):
        read_evidence_posterior(tmp_path / "own.json")


def test_other_shipped_tests_than_those_learned_from_are_said(tmp_path: Path) -> None:
    content = json.loads(shipped_alone().posterior.text()) | {"shipped_fingerprint": "0"}
    (tmp_path / "own.json").write_text(json.dumps(content), "utf-8")
    assert (
        "write it again by sonolube evidence learn" in read_evidence_posterior(tmp_path / "own.json").caveats(NORMAL)[1]
    )
