"""Own runs against a prediction and each other, and rigs of a laboratory: normal distributions in closed form."""

from dataclasses import replace
from math import exp, log, sqrt

import numpy as np
from pytest import approx, mark
from scipy.stats import norm, t
from tests.prediction.linear_rigs import LINEAR, conditions, measured_rig

from sonolube.checks import Floats
from sonolube.prediction.evidence import TestedRig, UncertainConditions
from sonolube.prediction.posterior import Posterior, rig_draws
from sonolube.prediction.predictive import Laboratory, RunCheck, laboratory, rig_prediction, student_weights

MU, TAU, NOISE = 0.4, 0.06, 0.05
KNOWN = Posterior(closure=LINEAR, hyperparameters=np.tile([MU, 0.0, log(TAU), 0.0, log(2e-4), log(0.7)], (1024, 1)))
AT = UncertainConditions(conditions=conditions([2e-6], [0.02]), decay_length_spread=None, amplitude_spread=0.05)


def runs(ratios: list[float], *, noise: float | list[float] = NOISE) -> TestedRig:
    own = measured_rig(ratios, conditions([2e-6] * len(ratios), [0.02] * len(ratios)))
    return replace(own, uncertainty=np.broadcast_to(np.asarray(noise, float), (len(ratios),)))


def check_of(own: TestedRig) -> RunCheck:
    found = rig_prediction(KNOWN, AT, count=1000, own=own).check
    assert found is not None
    return found


def by_others(ratios: list[float]) -> tuple[Floats, Floats]:
    """Mean and deviation of each run by the others: normal about a normal parameter."""
    values = np.array(ratios)
    others = values.size - 1
    variance = 1 / (1 / TAU**2 + others / NOISE**2)
    mean = variance * (MU / TAU**2 + (values.sum() - values) / NOISE**2)
    return mean, np.full(values.size, sqrt(variance + NOISE**2))


def test_runs_as_predicted_before_any_lie_between_the_quantiles_of_scatter_and_noise() -> None:
    check = check_of(runs([0.42, 0.38], noise=[0.05, 0.2]))
    deviations = np.hypot(TAU, [0.05, 0.2])
    assert check.highs == approx(MU + 1.96 * deviations, abs=0.02)
    assert check.lows == approx([MU - 1.96 * deviations[0], 0.0], abs=0.02)  # -0.009 is no ratio


@mark.parametrize("count", [5, 14])
def test_each_run_is_judged_by_the_normal_distribution_that_the_others_give(count: int) -> None:
    # 14 runs are more than draws before them tell apart: then draws after all are taken, weighed by each left out
    ratios = list(0.42 + 0.06 * norm.ppf((np.arange(count) + 0.5) / count))
    check = check_of(runs(ratios))
    mean, deviation = by_others(ratios)
    assert check.left_out == approx(mean, abs=0.01)
    z = np.abs(np.array(ratios) - mean) / deviation
    assert check.outlier_probability == approx(2 * t(count - 1).sf(z), abs=0.06)
    assert check.outliers == ()


def test_fewer_than_four_runs_are_not_judged_by_each_other() -> None:
    check = check_of(runs([0.4, 0.42, 0.1]))
    assert np.isnan(check.left_out).all()
    assert check.outlier_probability == approx([1, 1, 1])
    assert np.isfinite(check_of(runs([0.4, 0.42, 0.41, 0.39])).left_out).all()


def test_a_run_counts_by_students_weight_of_what_exceeds_its_prediction() -> None:
    # z^2 = (deviation^2 - variance of the others' mean) over squared noise; weight (2 + 1)/(2 + z^2), 1 at most
    ratios = [0.4, 0.42, 0.38, 0.41, 0.62]
    own = runs(ratios)
    before = rig_draws(KNOWN, AT, count=4096)
    weights = student_weights(before, rig_draws(KNOWN, AT, count=1000, own=own), own)
    mean, deviation = by_others(ratios)
    excess = np.maximum((np.array(ratios) - mean) ** 2 - (deviation**2 - NOISE**2), 0) / NOISE**2
    assert weights == approx(np.minimum(3 / (2 + excess), 1), abs=0.05)
    assert weights[[0, 1, 3]] == approx([1, 1, 1])
    assert weights[4] < 0.25
    few = runs(ratios[2:])
    assert student_weights(before, rig_draws(KNOWN, AT, count=1000, own=few), few) == approx([1, 1, 1])


@mark.parametrize("ratio", [0.45, 0.6, 0.98, 0.1])
def test_one_run_contradicts_as_often_as_runs_of_the_prediction_speak_as_much_for_anything_else(ratio: float) -> None:
    # anything else: no effect, N(1, u^2); one ratio even over 0 to 1.4; any ratio, 1/1.4; each with a third
    def odds(y: Floats) -> Floats:
        levels = np.linspace(0, 1.4, 281)
        one = norm.pdf(y[:, None], levels, NOISE).mean(axis=1)
        return np.asarray((norm.pdf(y, 1, NOISE) + one + 1 / 1.4) / norm.pdf(y, MU, np.hypot(TAU, NOISE)))

    y = np.linspace(-0.2, 1.2, 14001)
    share = norm.pdf(y, MU, np.hypot(TAU, NOISE)) * 1e-4
    exact = float(share[odds(y) >= odds(np.array([ratio]))].sum())
    assert check_of(runs([ratio])).probability == approx(exact, abs=0.04)


@mark.parametrize(("probability", "is_said"), [(0.049, True), (0.051, False)])
def test_runs_contradict_below_a_probability_of_a_twentieth(probability: float, is_said: bool) -> None:
    check = check_of(runs([0.4]))
    check.probability = probability
    assert check.contradicted is is_said


def test_a_run_is_an_outlier_below_a_twentieth_over_the_number_of_runs() -> None:
    check = check_of(runs([0.4, 0.41, 0.42, 0.39]))
    check.outlier_probability = np.array([0.0126, 0.0124, 1.0, 0.001])  # 0.05/4 = 0.0125
    assert check.outliers == (1, 3)


def test_a_prediction_with_fewer_draws_than_asked_for_repeats_them_with_other_discrepancies() -> None:
    wide = replace(KNOWN, hyperparameters=KNOWN.hyperparameters + np.array([0, 0, 0, 0, log(0.05 / 2e-4), 0]))
    found = rig_prediction(wide, AT, count=5000, own=runs([0.35]))
    ratios = found.ratios(conditions([2e-6, 9e-6], [0.02, 0.2]))
    assert ratios.shape == (5000, 2)
    assert np.unique(np.round(ratios[:, 0], 12)).size > 4000
    assert len(found.draws.rows) == 2048
    assert ratios.min() >= 0
    low = replace(KNOWN, hyperparameters=KNOWN.hyperparameters - np.array([0.4, 0, 0, 0, 0, 0]))
    assert np.mean(rig_prediction(low, AT, count=4000).ratios(AT.conditions) == 0) == approx(0.5, abs=0.02)


def test_the_rigs_of_a_laboratory_are_counted_and_those_that_contradict_named() -> None:
    one = Laboratory(posterior=KNOWN, taught_by=("a",), contradicting=("b", "c"))
    assert one.known_from == "published tests and 1 rig of the laboratory"
    assert replace(one, taught_by=("a", "d")).known_from == "published tests and 2 rigs of the laboratory"
    first, second = one.caveats
    assert first.startswith("b: its runs contradict every model")
    assert second.startswith("c: ")
    assert replace(one, contradicting=()).caveats == ()


def test_a_rig_that_contradicts_leaves_the_laboratory_as_the_population_is() -> None:
    rows = np.tile([MU, 0.2, log(TAU), log(0.5), log(2e-4), log(0.7)], (512, 1))
    population = Posterior(closure=LINEAR, hyperparameters=rows)
    rig = TestedRig(name="odd", at=AT, friction_ratio=np.array([1.0]), uncertainty=np.array([0.02]))
    found = laboratory(population, [rig])
    assert found.contradicting == ("odd",)
    assert found.taught_by == ()
    kappa, scatter = found.posterior.hyperparameters[:, 1], np.exp(found.posterior.hyperparameters[:, 3])
    assert kappa.mean() == approx(0.2, abs=0.04)
    # rho even over 0 to 1: kappa has half of the variance, and (1 - rho) of it is left between rigs
    assert kappa.var() == approx(0.5 * 0.25, rel=0.12)
    assert np.mean(scatter**2) == approx(0.5 * 0.25, rel=0.08)
    assert exp(float(np.median(found.posterior.hyperparameters[:, 2]))) == approx(TAU)
