"""Speed of predictions: tables of friction ratios beside their computation, changed rigs live beside anew."""

from collections.abc import Callable
from itertools import count
from pathlib import Path

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.checks import Floats
from sonolube.models.friction import (
    SpringContact,
    load_balanced_approach,
    normal_oscillation_ratio,
    sine_stick_slip_ratio,
)
from sonolube.prediction import LivePrediction, predict
from sonolube.prediction.evidence import CLOSURES, Closure, Conditions
from sonolube.rig import Rig, read_rig

DRAWS, POINTS = 4096, 40
RIG = Path(__file__).parents[1] / "examples" / "rigs" / "tribometer.toml"
UNIT = SpringContact(friction_coefficient=1.0, mindlin_ratio=1.0)


def conditions() -> Conditions:
    """Conditions of a curve over amplitude, for draws of the decay length."""
    return Conditions(
        vibration_amplitude=2.5e-6 * np.geomspace(0.1, 3.0, POINTS),
        frequency=np.full(POINTS, 22e3),
        sliding_speed=np.full(POINTS, 0.02),
        decay_length=2e-6 * np.exp(np.random.default_rng(0).normal(0.0, 0.7, (DRAWS, 1))),
    )


def log_lengths() -> Floats:
    return np.asarray(np.log(1.5e-6) + np.random.default_rng(1).normal(0.0, 0.5, (DRAWS, 1)))


def stick_slip(logs: Floats, at: Conditions) -> Floats:
    return sine_stick_slip_ratio(
        decay_length=at.decay_length,
        vibration_amplitude=at.vibration_amplitude,
        frequency=at.frequency,
        sliding_speed=at.sliding_speed,
        memory_length=np.exp(logs),
    )


def spring(logs: Floats, at: Conditions) -> Floats:
    amplitude = at.vibration_amplitude
    return normal_oscillation_ratio(
        UNIT,
        approach=load_balanced_approach(UNIT, approach=at.decay_length, normal_amplitude=amplitude),
        normal_amplitude=amplitude,
        frequency=at.frequency,
        sliding_speed=at.sliding_speed * at.decay_length / np.exp(logs),
    )


@pytest.mark.parametrize("closure", CLOSURES, ids=lambda closure: closure.name)
def test_tabulated_ratios_of_4096_draws_at_40_conditions(benchmark: BenchmarkFixture, closure: Closure) -> None:
    logs, at = log_lengths(), conditions()
    found = benchmark(lambda: closure.ratio(logs, at))  # the first call, outside the rounds, makes the table
    exact = {"asperity_stick_slip": stick_slip, "spring_contact": spring}[closure.name](logs, at)
    assert np.abs(found - exact).max() < 2e-6


@pytest.mark.parametrize("ratio", [stick_slip, spring], ids=["asperity_stick_slip", "spring_contact"])
def test_the_same_ratios_point_by_point(
    benchmark: BenchmarkFixture, ratio: Callable[[Floats, Conditions], Floats]
) -> None:
    logs, at = log_lengths(), conditions()
    ratio(logs, at)  # compiled outside the measurement
    benchmark(lambda: ratio(logs, at))


@pytest.mark.parametrize("way", ["live at 1,000 draws", "fresh at 1,000 draws", "fresh at 4,000 draws"])
@pytest.mark.benchmark(group="prediction of a changed rig")
def test_a_changed_rig_is_predicted_live_and_anew(benchmark: BenchmarkFixture, way: str) -> None:
    rig = read_rig(RIG)
    live, speeds = LivePrediction(rig, draws=1000), count(30)

    def changed() -> tuple[tuple[Rig], dict[str, object]]:
        return (rig.replace("sliding.sliding_speed", f"{next(speeds)} mm/s"),), {}

    ways: dict[str, Callable[[Rig], object]] = {
        "live at 1,000 draws": live.at,
        "fresh at 1,000 draws": lambda one: predict(one, draws=1000),
        "fresh at 4,000 draws": predict,
    }
    benchmark.pedantic(ways[way], setup=changed, rounds=15)  # type: ignore[no-untyped-call]
