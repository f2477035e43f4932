"""Calibration on the published rigs, each left out in turn, and the scores against closed forms."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from pytest import MonkeyPatch, approx
from scipy.stats import norm
from tests.prediction.linear_rigs import LINEAR, conditions, measured_rig

from sonolube.prediction.calibration import (
    _STICK_SLIP,
    BLIND,
    BY_RECORDS,
    MEAN_RATIO,
    SAME_TRIBOMETER,
    Calibration,
    UnseenPrediction,
    _fitted,
    blind_calibration,
    calibrations,
    mean_ratio_calibration,
    plane_calibration,
    population_calibration,
)
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.figures import blind_caption, plane_caption
from sonolube.prediction.hierarchy import (
    PROBABILITIES,
    binomial_interval,
    central_interval,
    continuous_ranked_probability_score,
    interval_score,
)
from sonolube.prediction.posterior import Population


def by_name() -> dict[str, Calibration]:
    return {one.name: one for one in calibrations()}


def test_blind_intervals_hold_about_as_many_tests_as_they_promise() -> None:
    for found in (by_name()[BLIND], blind_calibration(SAME_TRIBOMETER)):
        for probability, (low, high) in zip(PROBABILITIES, ((6, 14), (12, 19), (17, 20)), strict=True):
            assert low <= found.covered(probability) <= high


def test_the_blind_score_is_below_that_of_the_mean_ratio_but_not_shown_to_be() -> None:
    blind, mean = by_name()[BLIND], by_name()[MEAN_RATIO]
    assert blind.crps < 0.157
    gain, low, high = blind.gain_over(mean)
    assert low < 0 < gain < high
    assert "not shown to be better than the mean of published tests" in blind_caption()
    assert "all of each rig within 80 % but of B (2 of 5)" in blind_caption()


def test_the_readme_quotes_how_many_blind_intervals_hold() -> None:
    text = " ".join((Path(__file__).parents[2] / "README.md").read_text("utf-8").split())
    counts = re.search(r"have: (\d+) of (\d+) lie within the interval of 8 chances in 10\.", text)
    assert counts
    blind = by_name()[BLIND]
    assert [int(each) for each in counts.groups()] == approx(
        [blind.covered(0.8), len(blind.predictions)], abs=1
    )  # an end


def test_records_that_no_user_has_make_the_score_look_better_than_it_is() -> None:
    assert by_name()[BY_RECORDS].crps < 0.7 * by_name()[BLIND].crps


def test_within_the_plane_each_point_is_predicted_by_the_other_rigs_and_how_far_is_said_first() -> None:
    found = plane_calibration()
    littmann, gutowski, *luo = found.predictions
    assert (littmann.friction_ratio, gutowski.friction_ratio) == approx((1.0, 0.1))  # D 2.2.5 and 1.3.1
    assert [one.rig for one in luo] == ["M of Luo et al."] * 5
    assert found.covered(0.8) == found.covered(0.95) == 7
    assert found.median_width < 0.7  # and does not hold everything
    assert found.rigs == 3
    assert 0.03 < found.crps_by_rig < 0.09
    assert plane_caption().startswith("Within the plane of contact it was tested with 7 published points along")


def test_the_gain_over_a_rival_has_the_mean_and_the_bootstrap_of_two_sets() -> None:
    def way(name: str, offsets: dict[str, float]) -> Calibration:
        return Calibration(
            name=name,
            predictions=tuple(
                UnseenPrediction(rig=rig, friction_ratio=0.0, uncertainty=0.05, draws=np.full(10, offset))
                for rig, offset in offsets.items()
            ),
        )

    # certain predictions have their distance as score: gains of 0.1 and 0.3, and resamples (a,a), (a,b), (b,b)
    gain = way("good", {"a": 0.1, "b": 0.1}).gain_over(way("bad", {"a": 0.2, "b": 0.4}))
    assert gain == approx((0.2, 0.1, 0.3))


def test_every_test_is_predicted_once_by_each_way() -> None:
    sizes = {one.name: len(one.predictions) for one in calibrations()}
    assert sizes[BLIND] == sizes[MEAN_RATIO] == 20
    assert sizes[BY_RECORDS] == 17  # of set P there are none


def test_the_crps_of_normal_draws_is_that_of_the_closed_form() -> None:
    draws, measured = 0.3 + 0.1 * norm.ppf((np.arange(20_000) + 0.5) / 20_000), 0.42
    z = (measured - 0.3) / 0.1
    closed = 0.1 * (z * (2 * norm.cdf(z) - 1) + 2 * norm.pdf(z) - 1 / np.sqrt(np.pi))
    assert continuous_ranked_probability_score(draws, measured) == approx(closed, rel=1e-3)


def test_the_interval_score_is_the_width_within_and_ten_times_the_distance_more_outside() -> None:
    draws = np.linspace(0, 1, 10_001)
    assert interval_score(draws, 0.5) == approx(0.8)
    assert interval_score(draws, 0.95) == approx(0.8 + 10 * 0.05)


def test_the_central_interval_of_uniform_draws_leaves_equal_tails() -> None:
    assert central_interval(np.linspace(0, 1, 10_001), 0.5) == approx((0.25, 0.75))


def test_the_binomial_interval_of_no_success_in_n_is_that_of_clopper_and_pearson() -> None:
    low, high = binomial_interval(0, 10)
    assert (low, high) == approx((0.0, 1 - 0.025 ** (1 / 10)))


def scored() -> Calibration:
    """Three predictions with even draws of widths 1, 2 and 4 about 0.5: the first two hold what was measured."""
    draws = [0.5 + width * (np.arange(10_001) / 10_000 - 0.5) for width in (1.0, 2.0, 4.0)]
    return Calibration(
        name="by hand",
        predictions=tuple(
            UnseenPrediction(rig=rig, friction_ratio=measured, uncertainty=0.05, draws=each)
            for rig, measured, each in zip("aab", (0.6, 0.1, 2.2), draws, strict=True)
        ),
    )


def test_coverage_widths_and_scores_are_those_of_even_draws() -> None:
    found = scored()
    # central 80 %: 0.1 to 0.9, -0.3 to 1.3, -1.1 to 2.1; central 50 %: 0.25 to 0.75, 0 to 1, -0.5 to 1.5
    assert found.covered(0.8) == 2
    assert found.covered(0.5) == 2
    assert found.covered(0.1) == 0  # 0.45 to 0.55
    assert found.covered(0.95) == 3  # -1.4 to 2.4
    assert found.covered_by_rig(0.8) == {"a": (2, 2), "b": (0, 1)}
    assert found.rigs_covered(0.8) == 1
    assert found.rigs_covered(0.95) == found.rigs == 2
    assert found.median_width == approx(1.6)
    assert found.interval_score == approx((0.8 + 1.6 + 3.2 + 10 * 0.1) / 3)
    # of even draws of the width w about m: w (1/12 + z^2) within, z from the middle in widths
    assert found.scores[:2] == approx([1 / 12 + 0.01, 2 * (1 / 12 + 0.04)], rel=1e-3)
    assert found.crps == approx(float(np.mean(found.scores)))


def test_the_mean_ratio_is_predicted_with_the_scatter_of_the_tests_on_other_rigs() -> None:
    ratios = {rig.name: rig.friction_ratio for rig in published_rigs()}
    found = mean_ratio_calibration()
    assert [one.rig for one in found.predictions] == [name for name, values in ratios.items() for _ in values]
    last = [one for one in found.predictions if one.rig == "H"][-1]
    others = np.concatenate([values for name, values in ratios.items() if name != "H"])
    assert last.friction_ratio == approx(1.0)
    assert last.draws.mean() == approx(others.mean(), abs=0.02)
    assert last.draws.std() == approx(np.hypot(others.std(ddof=1), 0.05), rel=0.05)
    grouped = mean_ratio_calibration((("A", "P"), ("B", "C", "D", "E", "F", "G", "H"))).predictions
    seen = np.concatenate([values for name, values in ratios.items() if name not in ("A", "P")])
    assert [one.rig for one in grouped] == [one.rig for one in found.predictions]
    assert grouped[-1].draws.mean() == approx(seen.mean(), abs=0.02)


def test_a_population_predicts_each_rig_by_the_others_alone_and_each_group_by_the_other_groups() -> None:
    # three rigs of one test each, ratios equal to the logarithm of their parameter, hardly any prior but the tests
    rigs = [
        measured_rig([ratio], conditions([2e-6], [0.02]), name=name)
        for name, ratio in (("a", 0.1), ("b", 0.5), ("c", 0.6))
    ]
    rows = np.zeros((3, 6)) + np.array([0.0, 0.0, -6.0, 0.0, -6.0, 0.0])
    rows[:, 0] = [0.1, 0.5, 0.6]
    sure = Population(closure=LINEAR, draws=rows, log_likelihoods=np.where(np.eye(3) > 0, 0.0, -60.0))
    found = population_calibration("sure", sure, rigs)
    assert [one.rig for one in found.predictions] == ["a", "b", "c"]
    assert found.name == "sure"
    # left out a: draws with the parameters of b and of c, as likely; noise of 0.05
    first = found.predictions[0]
    assert first.friction_ratio == approx(0.1)
    assert 0.45 < first.draws.mean() < 0.65
    grouped = population_calibration("grouped", sure, rigs, groups=(("a", "b"), ("c",)))
    assert [one.rig for one in grouped.predictions] == ["a", "b", "c"]
    for one in grouped.predictions[:2]:
        assert one.draws.mean() == approx(0.6, abs=0.01)
        assert one.draws.std() == approx(0.05, rel=0.05)


def test_one_memory_length_for_several_rigs_is_that_of_the_least_sum_of_squares(monkeypatch: MonkeyPatch) -> None:
    # ratios of log(length) plus a rig's own offset: of two tests at 0.1 and one at 0.7 the mean is 0.3
    middle = float(np.log(_STICK_SLIP.median))
    monkeypatch.setattr(
        "sonolube.prediction.calibration._stick_slip",
        lambda rig, log_length: np.full(rig.friction_ratio.size, log_length - middle),
    )
    rigs: Any = [SimpleNamespace(friction_ratio=np.array([0.1, 0.1])), SimpleNamespace(friction_ratio=np.array([0.7]))]
    assert _fitted(rigs) - middle == approx(0.3, abs=1e-4)
    far: Any = [SimpleNamespace(friction_ratio=np.array([9.0]))]
    assert _fitted(far) - middle == approx(2.0, abs=1e-4)  # the end of the range
