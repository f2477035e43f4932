"""Chances of a reduction: shares of draws, monotony, own runs, words, and refusals."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr
from pytest import approx, fixture, mark, raises
from scipy.stats import truncnorm

from sonolube.errors import InvalidInput
from sonolube.prediction.chances import ReductionChances, odds_text, reduction_chances
from sonolube.prediction.hierarchy import bounded_share
from sonolube.rig import Rig, read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


@fixture(scope="module")
def rig() -> Rig:
    return read_rig(RIGS / "tribometer.toml")


@fixture(scope="module")
def chances(rig: Rig) -> ReductionChances:
    return reduction_chances(rig)


@mark.parametrize(
    ("mean", "deviation", "low", "high", "value"),
    [(0.3, 0.2, 0.0, 1.0, 0.4), (0.95, 0.4, 0.2, 1.0, 0.5), (0.5, 0.1, 0.0, np.inf, 0.55), (0.5, 0.1, 0.4, 1.0, 0.3)],
)
def test_a_share_is_that_of_a_truncated_normal_distribution(
    mean: float, deviation: float, low: float, high: float, value: float
) -> None:
    found = bounded_share(np.array(mean), np.array(deviation), value, low=low, high=high)
    ends = (low - mean) / deviation, (high - mean) / deviation
    assert found == approx(truncnorm(*ends, loc=mean, scale=deviation).cdf(value), abs=1e-5)


def test_what_is_certain_is_reached_or_is_not() -> None:
    mean, none = np.array([0.2, 0.6, 1.7]), np.zeros(3)
    assert bounded_share(mean, none, 0.5, low=0.0, high=1.0).tolist() == [1.0, 0.0, 0.0]
    assert bounded_share(mean, none, 1.0, low=0.0, high=1.0).tolist() == [1.0, 1.0, 1.0]


@mark.parametrize("amplitude", [0.5e-6, 2.5e-6, 10e-6])
def test_a_chance_is_the_share_of_the_draws_of_a_prediction(chances: ReductionChances, amplitude: float) -> None:
    ratios = chances.prediction.ratios(chances.inputs.at(vibration_amplitude=amplitude).conditions)[:, 0]
    for reduction in (0.2, 0.5, 0.8):
        found = chances.of(reduction, vibration_amplitude=amplitude)
        assert found == approx(np.mean(1 - ratios >= reduction), abs=0.03)


def test_chances_rise_with_the_amplitude_and_fall_with_the_target_and_with_the_speed(chances: ReductionChances) -> None:
    amplitudes = np.geomspace(1e-8, 1e-5, 30)
    found = chances.of(0.5, vibration_amplitude=amplitudes)
    assert np.all(np.diff(found) > -0.01)
    assert found[0] < 1e-3
    assert np.all(chances.of(0.7, vibration_amplitude=amplitudes) <= found + 1e-9)
    fast = chances.of(0.5, vibration_amplitude=2.5e-6, sliding_speed=[0.02, 0.2, 20.0])
    assert np.all(np.diff(fast) < 0)
    assert fast[-1] < 1e-3


def test_no_vibration_has_no_chance_and_an_unknown_amplitude_none_known(chances: ReductionChances) -> None:
    found = chances.of(0.5, vibration_amplitude=[0.0, np.nan])
    assert found[0] == 0
    assert np.isnan(found[1])


def test_the_least_amplitude_has_the_chance_that_is_asked_for(chances: ReductionChances) -> None:
    found = chances.least_amplitude(0.5, confidence=0.8, highest=1e-4, frequency=22e3)
    assert found is not None
    assert chances.of(0.5, vibration_amplitude=found) == approx(0.8, abs=0.005)
    assert chances.least_amplitude(0.99, confidence=0.99, highest=1e-4, frequency=22e3) is None


@mark.parametrize(("name", "values"), [("sliding_speed", (0.01, 0.3)), ("frequency", (18e3, 26e3))])
def test_a_grid_gives_each_point_to_a_hundredth(
    chances: ReductionChances, name: str, values: tuple[float, float]
) -> None:
    rng = np.random.default_rng(3)
    amplitudes, other = np.exp(rng.uniform(np.log(0.2e-6), np.log(6e-6), 40)), rng.uniform(*values, 40)
    found = chances.over_grid(0.5, amplitudes, other, name=name)
    assert found == approx(chances.of(0.5, vibration_amplitude=amplitudes, **{name: other}), abs=0.01)
    still = chances.over_grid(0.5, np.array([0.0, np.nan]), np.array([0.1, 0.1]), name="sliding_speed")
    assert still[0] == 0
    assert np.isnan(still[1])


def test_an_own_run_moves_the_chances_to_where_it_lies(rig: Rig, chances: ReductionChances) -> None:
    def after(reduction: float) -> float:
        run = xr.Dataset({"friction_reduction": ("run", [reduction]), "vibration_amplitude": ("run", [2.5e-6])})
        found = reduction_chances(rig, runs=run)
        assert found.runs == 1
        return float(found.of(0.5, vibration_amplitude=2.5e-6))

    before = float(chances.of(0.5, vibration_amplitude=2.5e-6))
    assert after(0.2) < 0.1 < before < 0.9 < after(0.8)


def test_contacts_of_which_nothing_is_known_are_refused(rig: Rig) -> None:
    with raises(InvalidInput, match="need a dry contact, or runs of your own"):
        reduction_chances(replace(rig, friction_coefficient=0.05))


@mark.parametrize(
    ("chance", "text"),
    [
        (0.9, "9 chances in 10"), (0.1, "1 chance in 10"), (0.797, "8 chances in 10"), (0.75, "75 chances in 100"),
        (0.01, "1 chance in 100"), (0.001, "less than 1 chance in 100"), (0.999, "more than 99 chances in 100"),
    ],
)  # fmt: skip
def test_odds_are_said_in_tenths_or_hundredths(chance: float, text: str) -> None:
    assert odds_text(chance) == text
