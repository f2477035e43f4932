"""What runs on some rigs of a laboratory tell of the next, against quadrature in closed form and in two limits."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx
from scipy.stats import norm
from tests.prediction.linear_rigs import LINEAR, conditions

from sonolube.measurement.measured_runs import read_runs
from sonolube.prediction import LivePrediction, interval
from sonolube.prediction.evidence import TestedRig, UncertainConditions
from sonolube.prediction.posterior import Posterior
from sonolube.prediction.predictive import laboratory
from sonolube.rig import read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
SPREAD, AMPLITUDE_SPREAD, NOISE = 0.5, 0.05, 0.02
CLOSURE = replace(
    LINEAR, ratio=lambda logs, at: np.log(at.decay_length / at.vibration_amplitude) + 0.0 * np.asarray(logs)
)
"""Friction ratio that is the logarithm of decay length over amplitude: all is normal."""
POPULATION = Posterior(
    closure=CLOSURE,
    hyperparameters=np.tile([0.0, 1.0, np.log(1e-3), np.log(SPREAD), np.log(1e-3), np.log(0.7)], (512, 1)),
)


def rig(ratios: list[float], *, measured: float | None = None) -> TestedRig:
    known = UncertainConditions(
        conditions=conditions([1e-6] * len(ratios), [0.02] * len(ratios)),
        decay_length_spread=measured,
        amplitude_spread=AMPLITUDE_SPREAD,
    )
    return TestedRig(
        name="rig",
        at=known,
        friction_ratio=np.array(ratios),
        uncertainty=np.full(len(ratios), NOISE * len(ratios) ** 0.5),
    )


def next_rig(posterior: Posterior) -> tuple[float, float]:
    """Mean and variance of ln l over a of a further rig."""
    kappa, scatter = posterior.hyperparameters[:, 1], np.exp(posterior.hyperparameters[:, 3])
    return float(kappa.mean()), float(kappa.var() + np.mean(scatter**2))


def by_quadrature(ratios: list[float]) -> tuple[float, float]:
    """The same over a grid of shares and deviates, by the normal density of one ratio a rig."""
    shares, deviates = np.meshgrid((np.arange(200) + 0.5) / 200, np.linspace(-5, 5, 401))
    kappa, variance = 1.0 + np.sqrt(shares) * SPREAD * deviates, (1 - shares) * SPREAD**2
    weight = norm.pdf(deviates)
    for ratio in ratios:
        weight = weight * norm.pdf(ratio, kappa, np.sqrt(variance + AMPLITUDE_SPREAD**2 + NOISE**2))
    weight /= weight.sum()
    mean = float(np.sum(weight * kappa))
    return mean, float(np.sum(weight * (variance + (kappa - mean) ** 2)))


def test_without_runs_a_further_rig_is_one_of_the_population() -> None:
    mean, variance = next_rig(laboratory(POPULATION, []).posterior)
    assert mean == approx(1.0, abs=0.03)
    assert variance == approx(SPREAD**2, rel=0.06)


@pytest.mark.parametrize("ratios", [[1.5], [1.5, 1.45, 1.55, 1.5], [0.3, 1.7, 1.1]], ids=["one", "alike", "unlike"])
def test_a_further_rig_follows_quadrature_in_closed_form(ratios: list[float]) -> None:
    # three equal runs of each rig, together as sure as one with the noise of the quadrature; of rigs that are alike
    # the next is known much better than one of the population, of unlike ones hardly
    found = laboratory(POPULATION, [rig([ratio] * 3) for ratio in ratios])
    mean, variance = next_rig(found.posterior)
    expected, spread = by_quadrature(ratios)
    assert found.contradicting == ()
    assert mean == approx(expected, abs=0.06)
    assert np.sqrt(variance) == approx(np.sqrt(spread), rel=0.12)


def test_a_rig_with_a_measured_decay_length_tells_nothing_of_that_of_others() -> None:
    mean, variance = next_rig(laboratory(POPULATION, [rig([0.1] * 3, measured=0.2)]).posterior)
    assert mean == approx(1.0, abs=0.05)
    assert variance == approx(SPREAD**2, rel=0.1)


def test_runs_of_other_rigs_move_a_prediction_and_contradicting_ones_are_left_out(tmp_path: Path) -> None:
    known, other = read_rig(RIGS / "tribometer.toml"), read_rig(RIGS / "power_map.toml")
    head = "friction_reduction,sliding_speed [mm/s],vibration_amplitude [um]\n"
    weak, never = tmp_path / "weak.csv", tmp_path / "never.csv"
    weak.write_text(head + "0.25,20,2.5\n0.15,40,2.5\n0.35,20,3.5\n")
    never.write_text(head + "-0.2,20,2.5\n-0.2,40,2.5\n-0.2,20,3.5\n")
    alone = interval(LivePrediction(known).first, "friction_reduction")
    taught = LivePrediction(known, laboratory_runs=[(other, read_runs(weak))] * 3).first
    assert interval(taught, "friction_reduction")[1] < alone[1] - 0.05
    assert "3 rigs of the laboratory" in taught["reason"].to_numpy()[0]
    left_out = LivePrediction(known, laboratory_runs=[(other, read_runs(never))]).first
    assert "contradict every model" in left_out.attrs["caveats"]
    assert interval(left_out, "friction_reduction") == approx(alone, abs=0.03)
