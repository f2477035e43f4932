"""Power of comparisons: simulated experiments, Cohen's tables, and refusals."""

import numpy as np
import pytest
from scipy import stats

from sonolube.design.test_plan.comparison import COMPARISONS, published_scatter
from sonolube.errors import InvalidInput

EXPERIMENTS = 20_000


@pytest.mark.parametrize(("replicates", "difference"), [(2, 0.2), (3, 0.1), (5, 0.08), (8, 0.03), (12, 0.0)])
def test_the_power_of_a_paired_comparison_is_that_of_simulated_experiments(replicates: int, difference: float) -> None:
    rng = np.random.default_rng(replicates)
    differences = difference + 0.06 * rng.standard_normal((EXPERIMENTS, replicates))
    found = stats.ttest_1samp(differences, 0.0, axis=1).pvalue < 0.05
    power = COMPARISONS["paired"].power(difference=difference, deviation=0.06, replicates=replicates, significance=0.05)
    assert float(power) == pytest.approx(np.mean(found), abs=0.02)


@pytest.mark.parametrize(("replicates", "difference"), [(2, 0.2), (3, 0.15), (5, 0.1), (8, 0.03), (12, 0.0)])
def test_the_power_of_separate_runs_is_that_of_simulated_experiments(replicates: int, difference: float) -> None:
    rng = np.random.default_rng(replicates)
    without = 1.0 + 0.06 * rng.standard_normal((EXPERIMENTS, replicates))
    vibrated = 1.0 - difference + 0.06 * rng.standard_normal((EXPERIMENTS, replicates))
    found = stats.ttest_ind(without, vibrated, axis=1).pvalue < 0.05
    power = COMPARISONS["separate"].power(
        difference=difference, deviation=np.hypot(0.06, 0.06), replicates=replicates, significance=0.05
    )
    assert float(power) == pytest.approx(np.mean(found), abs=0.02)


@pytest.mark.parametrize(("effect", "replicates"), [(0.2, 394), (0.5, 64), (0.8, 26)])
def test_replicates_of_separate_runs_are_those_of_cohens_table(effect: float, replicates: int) -> None:
    # J. Cohen, Psychological Bulletin 112, 155 (1992), table 2: 393, 64, 26 by his approximation
    found = COMPARISONS["separate"].replicates(difference=effect, deviation=np.sqrt(2), power=0.8, significance=0.05)
    assert found == replicates


def test_one_replicate_less_would_not_do() -> None:
    for comparison in COMPARISONS.values():
        count = comparison.replicates(difference=0.05, deviation=0.06, power=0.9, significance=0.01)
        powers = [
            comparison.power(difference=0.05, deviation=0.06, replicates=n, significance=0.01)
            for n in (count - 1, count)
        ]
        assert powers[0] < 0.9 <= powers[1]


def test_an_effect_far_beyond_the_scatter_is_found_for_sure() -> None:
    power = COMPARISONS["paired"].power(difference=0.9, deviation=0.001, replicates=50, significance=0.05)
    assert float(power) == pytest.approx(1.0)


def test_the_published_scatter_is_that_of_table_2_3() -> None:
    # 0.063/1.024, 0.055/1.201, 0.064/1.472 without, 0.041, 0.035, 0.056 over the same with vibration
    scatter = published_scatter()
    assert scatter.intrinsic == pytest.approx(0.05090, abs=1e-5)
    assert scatter.vibrated == pytest.approx(0.03605, abs=1e-5)
    assert scatter.reduction == pytest.approx(np.hypot(0.05090, 0.03605), abs=2e-5)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"power": 1.0}, r"power must lie between 0 and 1, got 1"),
        ({"power": 0.0}, r"power must lie between 0 and 1, got 0"),
        ({"significance": 0.0}, r"significance must lie between 0 and 1"),
        ({"power": 0.04}, r"power 0\.04 must be above the significance 0\.05"),
        ({"difference": -0.1}, r"difference must be positive, got -0\.1"),
        ({"difference": 1e-4}, r"needs more than 1000 replicates"),
    ],
)
def test_impossible_demands_are_refused_by_name(changed: dict[str, float], message: str) -> None:
    demands = {"difference": 0.1, "deviation": 0.06, "power": 0.9, "significance": 0.05} | changed
    with pytest.raises(InvalidInput, match=message):
        COMPARISONS["paired"].replicates(**demands)
