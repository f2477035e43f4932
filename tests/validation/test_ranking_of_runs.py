"""Ranking of models by own runs: errors, ties, doubts, next condition, and predictions of published fits, by hand."""

from dataclasses import dataclass, replace
from math import hypot, log1p, sqrt
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx
from scipy.stats import t

from sonolube.errors import OutsideRange
from sonolube.validation.assessment import Fit
from sonolube.validation.comparison import ComparedFit, predict_runs
from sonolube.validation.model_variant import FreeParameter, ModelVariant, SeenSets
from sonolube.validation.run_conditions import RunConditions, RunsTable
from sonolube.validation.runs_fit import (
    RankedModel,
    RunsFit,
    fit_runs,
    next_conditions,
    own_rig_variants,
    ranked_model,
    with_probabilities,
)


def condition(strength: float, speed: float, ratio: float, *, letter: str = "a") -> RunConditions:
    return RunConditions(
        label="", set_name=letter, friction_ratio=ratio, uncertainty=None, repeats=1,
        vibration_amplitude=strength, sliding_speed=speed,
    )  # fmt: skip


SLOPE = FreeParameter(name="slope", default=0.5, initial_values=(0.3,), low=-5.0, high=5.0, reason="any")
ROWS = tuple(
    condition(x * 1e-6, 0.1, ratio, letter=letter)
    for x, ratio, letter in ((1.0, 0.32, "a"), (2.0, 0.55, "b"), (3.0, 0.96, "c"), (4.0, 1.15, "d"), (5.0, 1.52, "e"))
)


def made(name: str, ratio: Any, *parameters: FreeParameter, **more: Any) -> ModelVariant:
    return ModelVariant(name, "by hand", ratio, parameters=parameters, required_inputs=("vibration_amplitude",), **more)


def linear(test: RunConditions, slope: float) -> float:
    assert test.vibration_amplitude is not None
    return slope * test.vibration_amplitude * 1e6


LINEAR = made("linear", linear, SLOPE)


def test_a_fit_to_own_runs_has_the_exact_interval_of_a_linear_model_and_its_unseen_errors() -> None:
    x, y = np.arange(1.0, 6.0), np.array([one.friction_ratio for one in ROWS])
    best = float(x @ y / (x @ x))
    found = ranked_model(LINEAR, ROWS)
    assert found.name == "linear"
    assert found.fitted == approx(tuple(best * x), abs=1e-3)
    unseen = [(x @ y - a * b) / (x @ x - a * a) * a for a, b in zip(x, y, strict=True)]
    assert found.unseen == approx(tuple(unseen), abs=2e-3)
    assert found.rms_fit == approx(sqrt(np.mean((best * x - y) ** 2)), rel=1e-3)
    assert found.rms_unseen == approx(sqrt(np.mean((np.array(unseen) - y) ** 2)), rel=1e-2)
    assert found.reached == 5
    # Student's interval of the slope, of 4 degrees of freedom
    (slope,) = found.parameters
    error = sqrt(np.sum((best * x - y) ** 2) / 4 / (x @ x))
    assert slope.interval == approx((best - t.ppf(0.975, 4) * error, best + t.ppf(0.975, 4) * error), abs=2e-3)
    assert log1p(t.ppf(0.975, 4) ** 2 / 4) > 0
    assert found.information is not None
    assert found.information.parameter_count == 1
    assert found.aicc == approx(10 * np.log(found.rms_fit) + 4 + 2 * 2 * 3 / 2, rel=1e-6)


def test_a_model_out_of_range_somewhere_has_no_criterion_and_reaches_fewer_conditions() -> None:
    def short(test: RunConditions, slope: float) -> float:
        if (test.vibration_amplitude or 0) > 4.5e-6:
            raise OutsideRange("too far")
        return linear(test, slope)

    found = ranked_model(made("short", short, SLOPE), ROWS)
    assert found.fitted[4] is None
    assert found.unseen[4] is None
    assert found.reached == 4
    assert found.information is None
    assert found.aicc is None
    assert found.parameters[0].interval is None


def model(
    name: str, unseen: list[float | None], *, ratio: Any = linear, values: tuple[float, ...] = (0.3,)
) -> RankedModel:
    errors = [value - one.friction_ratio for value, one in zip(unseen, ROWS, strict=True) if value is not None]
    return RankedModel(
        fit=Fit(variant=made(name, ratio, *[SLOPE][: len(values)]), sets="abcde", values=values),
        parameters=(), fitted=tuple(unseen), unseen=tuple(unseen), rms_fit=0.01,
        rms_unseen=sqrt(np.mean(np.square(errors))), information=None,
    )  # fmt: skip


def off(*errors: float) -> list[float | None]:
    return [one.friction_ratio + error for one, error in zip(ROWS, errors, strict=True)]


def test_paired_errors_are_compared_by_the_test_of_morgan_granger_and_newbold() -> None:
    first, second = np.array([0.02, -0.03, 0.01, 0.02, -0.02]), np.array([0.08, -0.05, 0.06, -0.04, 0.09])
    best, other = with_probabilities([model("best", off(*first)), model("other", off(*second))], ROWS)
    assert best.probability is None
    assert not best.tied
    sums, differences = first + second, second - first
    r = sums @ differences / sqrt(sums @ sums * (differences @ differences))
    assert other.probability == approx(2 * t(4).sf(abs(r / sqrt((1 - r * r) / 4))))
    assert other.tied == (other.probability is not None and other.probability > 0.05)
    # one that errs ten times as much in a like way is told apart, with its opposite as well
    for sign in (1, -1):
        worse = with_probabilities([model("best", off(*first)), model("worse", off(*(sign * 10 * second)))], ROWS)[1]
        assert worse.probability is not None
        assert worse.probability < 0.05
        assert not worse.tied
    same = with_probabilities([model("best", off(*first)), model("same", off(*first))], ROWS)[1]
    assert same.probability == approx(1.0)
    assert same.tied
    threefold = with_probabilities([model("best", off(*first)), model("three", off(*(3 * first)))], ROWS)[1]
    assert threefold.probability == approx(0.0, abs=1e-12)
    assert not threefold.tied


def test_errors_below_a_thousandth_count_as_equal() -> None:
    exact = model("exact", off(1e-7, -2e-7, 1e-7, 0.0, 0.0))
    for size, tied in ((9e-4, True), (1.2e-3, False)):
        errors = size * np.array([1.0, -1.0, 1.0, 1.0, -1.0])
        found = with_probabilities([exact, model("near", off(*errors))], ROWS)[1]
        assert found.tied is tied
    assert with_probabilities([], ROWS) == ()


def test_models_that_do_not_reach_every_condition_are_not_compared() -> None:
    part = model("part", [*off(0.0, 0.01, 0.0, 0.01, 0.0)[:4], None])
    full = model("full", off(0.1, 0.1, -0.1, 0.1, -0.1))
    for pair in ([full, part], [part, full]):
        second = with_probabilities(pair, ROWS)[1]
        assert second.probability is None
        assert not second.tied


@dataclass(frozen=True)
class Table:
    """Only what a verdict asks of a table."""

    conditions: tuple[RunConditions, ...] = ROWS


def result(*models: RankedModel, count: int = 5, rms_of_mean: float = 0.3) -> RunsFit:
    table: Any = Table(ROWS[:count])
    return RunsFit(table=table, models=models, inapplicable={}, rms_of_mean=rms_of_mean, next_conditions=())


GOOD = model("good", off(0.01, -0.01, 0.01, -0.01, 0.01))
BAD = model("bad", off(0.1, -0.1, 0.1, -0.1, 0.1))


def test_a_verdict_says_what_decides_or_every_doubt() -> None:
    assert result().verdict == "no model applies to these runs"
    assert not result().is_decided
    decided = result(GOOD, BAD)
    assert decided.is_decided
    assert decided.verdict == "decided: good predicts unseen conditions better than every other, by paired errors"
    assert (
        result(GOOD).verdict == "only good applies, and predicts unseen conditions better than the mean of the others"
    )
    few = result(GOOD, BAD, count=4)
    assert few.verdict == "not decided: 4 conditions are too few to rank models; good leads"
    assert not few.is_decided
    tied = result(GOOD, replace(BAD, tied=True))
    assert tied.verdict == "not decided: 5 conditions do not tell good from bad"
    level = result(GOOD, BAD, rms_of_mean=GOOD.rms_unseen)  # no better than the mean
    assert level.verdict == (
        "not decided: no model predicts better than the mean of the other conditions; good, the best, errs by 0.010,"
        " the mean by 0.010"
    )
    worse = result(BAD, rms_of_mean=0.05)
    assert "bad, the best, errs by 0.100, the mean by 0.050" in worse.verdict
    part = model("part", [*off(0.0, 0.01, 0.0, 0.01, 0.0)[:4], None])
    assert result(part).verdict == "not decided: no model reaches every condition; part reaches 4 of 5"


@pytest.mark.parametrize(
    ("count", "listed"), [(1, "m0"), (2, "m0 and m1"), (4, "m0, m1, m2 and m3"), (5, "m0, m1, m2 and 2 others")]
)
def test_up_to_four_tied_models_are_named(count: int, listed: str) -> None:
    tied = [replace(model(f"m{place}", off(0.1, -0.1, 0.1, -0.1, 0.1)), tied=True) for place in range(count)]
    assert result(GOOD, *tied).verdict == f"not decided: 5 conditions do not tell good from {listed}"


def flat(level: float) -> Any:
    return lambda test, slope: level


def test_the_next_condition_is_where_two_leaders_differ_most_for_their_errors() -> None:
    # 0.3 x against 0.9: apart by 0.9 - 0.3 at the least amplitude and by 1.5 - 0.9 at the largest within the runs;
    # beyond, up to twice as far: by 3 - 0.9 = 2.1, more than 1.5 times as much
    one = model("line", off(0.02, -0.02, 0.02, -0.02, 0.02))
    other = replace(model("level", off(0.03, -0.03, 0.03, -0.03, 0.03), ratio=flat(0.9)), tied=True)
    within, beyond = next_conditions((one, other), ROWS)
    errors = hypot(0.02, 0.03)
    assert within.contrast == approx(0.6 / errors)
    assert not within.is_beyond
    assert beyond.contrast == approx(2.1 / errors)
    assert beyond.is_beyond
    assert beyond.condition.vibration_amplitude == approx(10e-6)
    assert (beyond.first, beyond.second) == ("line", "level")
    assert (beyond.first_ratio, beyond.second_ratio) == approx((3.0, 0.9))
    # with a level of 0.1 the largest is best: 1.4 within, 2.9 beyond; with -3 both are alike, 4.5 and 6
    assert (
        len(
            next_conditions(
                (one, replace(model("low", off(0.03, -0.03, 0.03, -0.03, 0.03), ratio=flat(-3.0)), tied=True)), ROWS
            )
        )
        == 1
    )
    assert next_conditions((one,), ROWS) == ()


def test_only_tied_models_lead_where_there_are_some_and_sure_models_differ_by_a_thousandth_at_most() -> None:
    sure = [replace(model(name, off(0, 0, 0, 0, 0), ratio=flat(level)), tied=tied)
            for name, level, tied in (("a", 0.5, False), ("b", 0.6, True), ("c", 0.9, False))]  # fmt: skip
    (found,) = next_conditions(tuple(sure), ROWS)
    assert (found.first, found.second) == ("a", "b")
    assert found.contrast == approx(0.1 / 1e-3)
    (all_of_them,) = next_conditions(tuple(replace(each, tied=False) for each in sure), ROWS)
    assert (all_of_them.first, all_of_them.second) == ("a", "c")
    many = [replace(sure[0], fit=replace(sure[0].fit, variant=made(f"m{i}", flat(0.1 * i), SLOPE))) for i in range(6)]
    (five,) = next_conditions(tuple(many), ROWS)
    assert (five.first, five.second) == ("m0", "m4")  # the first five lead


def test_runs_at_one_speed_and_without_an_amplitude_are_widened_where_something_is_known() -> None:
    speeds = tuple(
        replace(one, vibration_amplitude=None, sliding_speed=0.1 * (place + 1)) for place, one in enumerate(ROWS)
    )

    def falling(test: RunConditions, slope: float) -> float:
        assert test.sliding_speed is not None
        return test.sliding_speed

    one, other = (
        replace(model(name, off(0.01, -0.01, 0.01, -0.01, 0.01), ratio=ratio), tied=True)
        for name, ratio in (("speed", falling), ("level", flat(0.1)))
    )
    within, beyond = next_conditions((one, other), speeds)
    assert within.condition.sliding_speed == approx(0.5)
    assert beyond.condition.sliding_speed == approx(1.0)
    assert beyond.condition.vibration_amplitude is None


def test_variants_of_own_runs_have_each_parameter_once_and_have_seen_nothing() -> None:
    doubled = made("doubled", linear, replace(SLOPE, applicable_sets="A"), replace(SLOPE, applicable_sets="B"))
    seen = made("seen", linear, SLOPE, seen=SeenSets("A", LINEAR))
    other = made("other", flat(0.5), SLOPE)
    found = own_rig_variants([doubled, seen, other])
    assert [each.name for each in found] == ["doubled", "other"]
    assert [len(each.parameters) for each in found] == [1, 1]
    assert all(parameter.applicable_sets == "" for each in found for parameter in each.parameters)
    assert all(each.seen is None for each in found)


def runs(ratios: list[float], amplitudes: list[float]) -> xr.Dataset:
    return xr.Dataset(
        {
            "friction_reduction": ("run", 1 - np.array(ratios)),
            "vibration_amplitude": ("run", 1e-6 * np.array(amplitudes)),
        },
        attrs={"title": "own"},
    )


def test_models_are_ranked_by_reach_and_unseen_error_and_what_does_not_apply_has_its_reason() -> None:
    def never(test: RunConditions) -> float:
        raise OutsideRange("never")

    def short(test: RunConditions) -> float:
        if (test.vibration_amplitude or 0) > 2.5e-6:
            raise OutsideRange("too far")
        return 0.5

    calls: list[tuple[str, int, int]] = []
    three = made("three", lambda test, **given: 0.5, *(replace(SLOPE, name=each) for each in ("a", "b", "c")))
    contact = ModelVariant("contact", "a line", linear, required_inputs=("contact", "normal_load"))
    models = [made("never", never), made("short", short), LINEAR, made("flat", lambda test: 0.9), three, contact]
    found = fit_runs(
        runs([0.32, 0.55, 0.96, 1.15], [1, 2, 3, 4]), models=models, advance=lambda *each: calls.append(each)
    )
    assert [each.name for each in found.models] == ["linear", "flat", "short"]
    assert found.inapplicable["never"] == "every condition is outside its range"
    assert found.inapplicable["three"] == "fits 3 parameters: needs 5 conditions, has 4"
    assert found.inapplicable["contact"].startswith("needs ")
    assert calls == [(each.name, place + 1, 6) for place, each in enumerate(models)]
    y = np.array([0.32, 0.55, 0.96, 1.15])
    assert found.rms_of_mean == approx(sqrt(np.mean(((y.sum() - y) / 3 - y) ** 2)))
    two = fit_runs(runs([0.32, 0.55], [1, 2]), models=[LINEAR, made("flat", lambda test: 0.9)])
    assert two.inapplicable == {"linear": "fits 1 parameters: needs 3 conditions, has 2"}


def test_published_fits_predict_own_conditions_those_that_reach_most_first() -> None:
    def short(test: RunConditions) -> float:
        if (test.vibration_amplitude or 0) > 3.5e-6:
            raise OutsideRange("too far")
        return 0.5

    def fits(variant: ModelVariant) -> ComparedFit:
        return ComparedFit(model=variant, sets="", assessment=None, parameters=(), predictions=())

    contact = ModelVariant("contact", "a line", linear, required_inputs=("contact",))
    variants = [made("short", short), made("high", lambda test: 1.0), made("near", lambda test: 0.9), contact]
    table = RunsTable(title="own", conditions=ROWS, runs=5, scatter=None, caveats=())
    near, high, part, none = predict_runs(tuple(map(fits, variants)), table)
    y = np.array([one.friction_ratio for one in ROWS])
    assert [each.model.name for each in (near, high, part, none)] == ["near", "high", "short", "contact"]
    assert near.rms == approx(sqrt(np.mean((0.9 - y) ** 2)))
    assert near.mean == approx(float(np.mean(0.9 - y)))
    assert (near.reached, part.reached, none.reached) == (5, 3, 0)
    assert part.ratios == (0.5, 0.5, 0.5, None, None)
    assert part.rms == approx(sqrt(np.mean((0.5 - y[:3]) ** 2)))
    assert (near.reason, part.reason) == (None, "too far")
    assert (none.rms, none.mean, none.ratios) == (None, None, (None,) * 5)
    assert none.reason is not None
    assert near.cross_validated_rms is None
