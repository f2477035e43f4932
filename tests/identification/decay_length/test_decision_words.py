"""Verdicts on the decay length by given probabilities and changes, and the prior of every combination of changes."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx, mark

from sonolube.identification import SwitchConditions, SwitchTable
from sonolube.identification.decay_length import decision, posterior
from sonolube.identification.decay_length.decision import DecayLengthDecision, decide_decay_length
from sonolube.identification.decay_length.posterior import COMBINATIONS, HYPOTHESES, Combination, RunPosterior
from sonolube.identification.decay_length.run_model import PARAMETERS, Changes

S = np.arange(5.0, 60.0, 5.0)
TABLE = SwitchTable(
    sliding_distance=S,
    friction_force=np.full(S.size, 0.6),
    intrinsic_friction_force=np.full(S.size, 1.0),
    force_zero=0 * S,
    stack_current=np.full(S.size, 0.4),
)
ALL = dict.fromkeys(HYPOTHESES, 0.0)


def decided(
    monkeypatch: pytest.MonkeyPatch,
    probabilities: dict[str, float],
    *,
    growth: float = 1.0,
    fall: float = 1.0,
    zero: float = 1.0,
    misfit: float = 1.0,
) -> DecayLengthDecision:
    """Decision from the posterior probabilities of hypotheses and even draws of each change about a factor."""
    spread = np.linspace(0.99, 1.01, 101)[:, None]
    length = 1e-6 * np.column_stack([np.ones(101), growth * spread[:, 0]])
    amplitude = 2e-6 * np.column_stack([np.ones(101), spread[:, 0] / fall])
    model = SimpleNamespace(
        channels=(
            SimpleNamespace(name="friction_ratio", values=np.zeros(4)),
            SimpleNamespace(name="stack_current", values=np.zeros(2)),
        ),
        residuals=lambda deviates: np.concatenate([np.zeros(4), np.full(2, misfit)])[None],
        fitted=lambda mode: {"friction_ratio": mode},
    )
    found = SimpleNamespace(
        probabilities=ALL | probabilities,
        best=lambda name: Combination(Changes(True, True, False, False), True),
        fit_of=lambda combination: (model, SimpleNamespace(mode=np.zeros(3))),
        draws=lambda: (length, amplitude),
        effective_draws=321.0,
    )
    evidence = SimpleNamespace(log_ratio=0.0, factor=zero * spread[:, 0])
    monkeypatch.setattr(decision, "run_channels", lambda *given: model.channels)
    monkeypatch.setattr(decision, "zero_evidence", lambda *given, seed: evidence)
    monkeypatch.setattr(decision, "RunPosterior", lambda *given, **named: found)
    return decide_decay_length(TABLE, SwitchConditions())


def test_a_probable_and_large_change_is_decided_with_the_next_hypothesis(monkeypatch: pytest.MonkeyPatch) -> None:
    found = decided(monkeypatch, {"long_sliding": 0.93, "detuning": 0.05, "none": 0.02}, growth=2.0, fall=1.1, zero=1.3)
    assert found.decided
    assert found.leading == "long_sliding"
    assert found.advice == ""
    assert found.verdict == "long sliding (93 %): the decay length grows with the sliding distance; next detuning (5 %)"
    assert (found.growth.lower, found.growth.median, found.growth.upper) == approx((1.984, 2.0, 2.016))
    assert found.fall.median == approx(1.1, rel=1e-3)
    assert found.zero_factor.median == approx(1.3)
    assert found.length_at_start.median == approx(1e-6)
    assert found.length_at_end.upper == approx(2.016e-6)
    assert found.effective_draws == 321.0
    assert set(found.courses) == {"long_sliding", "detuning", "none"}


@mark.parametrize(
    ("probability", "words"), [(0.996, "over 99 %"), (0.994, "99 %"), (0.9, "90 %"), (0.899, "not decided")]
)
def test_nine_tenths_decide_and_certainty_is_never_claimed(
    probability: float, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = decided(monkeypatch, {"detuning": probability, "none": 1 - probability}, fall=2.0)
    assert words in found.verdict
    assert found.decided == (probability >= 0.9)
    if probability > 0.995:
        assert found.verdict.endswith("(below 1 %)")


@mark.parametrize(("factor", "is_decided"), [(1.40, False), (1.44, True)])
@mark.parametrize(("name", "change"), [("long_sliding", "growth"), ("detuning", "fall"), ("zero_error", "zero")])
def test_a_change_explains_the_sets_from_a_third_of_their_difference_on(
    name: str, change: str, factor: float, is_decided: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # (2/0.7)^(1/3) = 1.419
    found = decided(monkeypatch, {name: 0.97, "none": 0.03}, **{change: factor})
    assert found.decided == is_decided
    if not is_decided:
        assert f"{factor:.2f}, too little for the 2.9 between the published sets" in found.verdict
        assert "(a third of it in the logarithm is 1.42)" in found.verdict
        assert found.advice.startswith("slide farther on a fresh track")


@mark.parametrize(("growth", "fall", "words"), [
    (1.12, 1.1, None),
    (1.15, 1.1, "the decay length grows by a factor of up to 1.16 (steady is 1.14)"),
    (1.1, 1.16, "the amplitude falls by a factor of up to 1.17 (steady is 1.14)"),
])  # fmt: skip
def test_nothing_changes_where_length_and_amplitude_stay_within_an_eighth(
    growth: float, fall: float, words: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    # (2/0.7)^(1/8) = 1.140
    found = decided(monkeypatch, {"none": 0.95, "detuning": 0.05}, growth=growth, fall=fall)
    assert found.decided == (words is None)
    assert words is None or words in found.verdict
    assert words is None or found.advice == "read more switches, over a longer distance"


def test_several_changes_and_another_are_said_from_one_half_on(monkeypatch: pytest.MonkeyPatch) -> None:
    several = decided(monkeypatch, {"several": 0.51, "none": 0.49})
    assert several.verdict == (
        "not decided: more than one quantity changes (51 %): long sliding and zero error and detuning"
    )
    assert several.advice.startswith("repeat so that one quantity changes at a time")
    other = decided(monkeypatch, {"other": 0.5, "none": 0.5 - 1e-9})
    assert other.verdict.startswith("not decided: the friction ratio changes (50 %) while decay length, zero and")
    assert "debris removed" in other.advice
    for name in ("several", "other"):
        less = decided(monkeypatch, {name: 0.49, "none": 0.3, "detuning": 0.21})
        assert " or none of them (30 %)" in less.verdict


def test_rivals_are_named_with_what_tells_them_apart_and_what_the_run_lacks(monkeypatch: pytest.MonkeyPatch) -> None:
    found = decided(monkeypatch, {"long_sliding": 0.6, "detuning": 0.3, "none": 0.1})
    assert found.verdict == "not decided: long sliding (60 %) or detuning (30 %)"
    assert found.advice.startswith("read the stack current and the shift at small drive at each switch")
    assert found.advice.endswith("; this run lacks shift at small drive, shift at large drive")
    others = decided(monkeypatch, {"zero_error": 0.6, "detuning": 0.4})
    assert others.advice.startswith("repeat so that one quantity changes at a time")


@mark.parametrize(("misfit", "is_said"), [(2.6, False), (2.65, True)])
def test_readings_that_the_leading_hypothesis_does_not_fit_are_named(
    misfit: float, is_said: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # chi squared of two readings: exp(-x^2) for two residuals x, 1e-3 at 2.628
    found = decided(monkeypatch, {"long_sliding": 0.97, "none": 0.03}, growth=2.0, misfit=misfit)
    assert found.misfits == approx({"friction_ratio": 1.0, "stack_current": np.exp(-(misfit**2))})
    assert found.decided != is_said
    if is_said:
        assert found.verdict == (
            "not decided: the stack current changes in a way that no hypothesis explains together with the other"
            " readings"
        )
        assert found.advice == "check how the stack current is read, then repeat on a fresh track"


def test_two_readings_that_do_not_fit_are_named_together() -> None:
    found = decision.misfit_reason(["friction_ratio", "large_drive_shift"])
    assert "the friction ratio and the shift at large drive change in a way" in found.verdict
    assert "check how the friction ratio and the shift at large drive are read" in found.advice


def test_the_prior_probabilities_of_all_combinations_are_those_that_are_documented() -> None:
    # none and each alone 0.2125, several together 0.1, friction that changes by itself 0.05
    total = dict.fromkeys(HYPOTHESES, 0.0)
    for each in COMBINATIONS:
        total[each.hypothesis] += each.prior
    expected = dict.fromkeys(HYPOTHESES, 0.2125) | {"several": 0.1, "other": 0.05}
    assert total == approx(expected)
    assert len(COMBINATIONS) == len(set(COMBINATIONS)) == 13
    alone = Combination(Changes(True, False, False, True), False)
    assert alone.parts == ("long_sliding",)
    assert Combination(Changes(True, True, False, True), True).parts == ("long_sliding", "zero_error", "detuning")
    assert Combination(Changes(False, False, True, True), False).hypothesis == "other"
    # at large drive the amplitude follows a fall of the vibration or does not, as likely
    both = [each.prior for each in COMBINATIONS if each.hypothesis == "detuning"]
    assert both == approx([0.2125 / 2] * 2)


def known_posterior(
    monkeypatch: pytest.MonkeyPatch, logs: dict[Changes, float], *, zero_log_ratio: float = 0.0
) -> RunPosterior:
    """Posterior whose models have given evidences, two draws each and courses that are their deviates."""
    draws = np.zeros((2, len(PARAMETERS)))
    draws[:, PARAMETERS.index("drift")] = [1.0, 3.0]

    def made(table: Any, conditions: Any, changes: Changes, *, channels: Any) -> Any:
        rate = 2.0 if changes.grows else 1.0
        return SimpleNamespace(
            changes=changes,
            residuals=changes,
            courses=lambda rows: (np.tile([1.0, rate], (len(rows), 1)), np.tile([1.0, 1.0], (len(rows), 1))),
        )

    def found(residuals: Any, *, starts: Any, seed: int) -> Any:
        return SimpleNamespace(
            log_evidence=logs.get(residuals, -50.0),
            draws=draws,
            weights=np.array([0.75, 0.25]),
            effective_draws=200.0 if residuals.grows else 90.0,
        )

    monkeypatch.setattr(posterior, "RunModel", made)
    monkeypatch.setattr(posterior, "evidence", found)
    return RunPosterior(TABLE, SwitchConditions(), channels=(), zero_log_ratio=zero_log_ratio, seed=0)


STEADY, GROWS = Changes(False, False, False, True), Changes(True, False, False, True)
DRIFTS = Changes(False, False, True, True)


def test_probabilities_are_evidence_times_prior_with_that_of_the_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    # growth 3 times as probable as none by the readings, a zero that is off twice a good one; several: 0.1/4 each
    found = known_posterior(monkeypatch, {STEADY: 0.0, GROWS: np.log(3)}, zero_log_ratio=float(np.log(2)))
    parts = {"none": 0.2125, "long_sliding": 3 * 0.2125, "zero_error": 2 * 0.2125, "several": 6 * 0.025}
    expected = ALL | {name: part / sum(parts.values()) for name, part in parts.items()}
    assert found.probabilities == approx(expected, abs=1e-9)
    assert found.best("several").parts == ("long_sliding", "zero_error")


def test_friction_that_changes_by_itself_has_the_mean_square_of_its_change_as_factor(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # 0.75 1 + 0.25 9 = 3
    found = known_posterior(monkeypatch, {STEADY: 0.0, DRIFTS: 0.0}, zero_log_ratio=-50.0)
    assert found.probabilities["other"] / found.probabilities["none"] == approx(3 * 0.05 / 0.2125)


def test_draws_are_of_each_model_in_proportion_and_the_least_sure_model_that_matters_counts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = known_posterior(monkeypatch, {STEADY: 0.0, GROWS: np.log(3)}, zero_log_ratio=-50.0)
    length, amplitude = found.draws()
    assert len(length) == len(amplitude) == approx(4000, abs=2)
    assert np.mean(length[:, 1] == 2) == approx(0.75, abs=1e-3)
    assert found.effective_draws == 90
    for share, effective in ((0.011, 90), (0.009, 200)):
        rare = known_posterior(
            monkeypatch, {STEADY: float(np.log(share / (1 - share))), GROWS: 0.0}, zero_log_ratio=-50.0
        )
        assert rare.effective_draws == effective
