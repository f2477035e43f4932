"""Outcomes under each closure against the prediction of the rig, before and after own runs."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from sonolube.design.test_plan.information import ModelOutcomes, best_batch, closure_outcomes, mutual_information
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.inputs import rig_inputs
from sonolube.prediction.posterior import learned
from sonolube.prediction.predictive import ratio_draws
from sonolube.rig import read_rig

RIG = Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml"
INPUTS = rig_inputs(read_rig(RIG))
AT = INPUTS.at(vibration_amplitude=1e-6 * np.array([0.9, 1.4, 1.9]), sliding_speed=np.array([0.06, 0.1, 0.2]))
OWN = TestedRig(
    name="own",
    at=INPUTS.at(vibration_amplitude=np.array([1.4e-6, 2.3e-6]), sliding_speed=np.array([0.1, 0.07])),
    friction_ratio=np.array([0.45, 0.15]),
    uncertainty=np.array([0.03, 0.03]),
)


def moments(model: ModelOutcomes) -> tuple[np.ndarray, np.ndarray]:
    variances = np.diagonal(model.covariance(np.arange(3)), axis1=1, axis2=2)
    return model.means.mean(axis=0), np.sqrt(model.means.var(axis=0) + variances.mean(axis=0))


@pytest.mark.parametrize("own", [None, OWN], ids=["before", "after own runs"])
def test_the_outcomes_have_the_moments_of_the_prediction(own: TestedRig | None) -> None:
    for posterior in learned().compared:
        model = closure_outcomes([posterior], AT, own=own)[0]
        mean, deviation = moments(model)
        draws = ratio_draws(posterior, AT, count=4000, own=own)
        assert mean == pytest.approx(draws.mean(axis=0), abs=0.02)
        assert deviation == pytest.approx(draws.std(axis=0), rel=0.15)


def test_own_runs_narrow_the_outcomes_where_they_were_made() -> None:
    before, after = (moments(closure_outcomes([learned().friction], AT, own=own)[0])[1] for own in (None, OWN))
    assert after[1] < 0.5 * before[1]
    assert np.all(after[:2] < before[:2])  # the fastest is moved to where vibration has an effect that is less certain


@pytest.mark.parametrize("count", [2, 3])
def test_the_batch_of_the_power_map_rig_is_the_best_of_all_of_its_points(count: int) -> None:
    amplitude, speed = (each.ravel() for each in np.meshgrid([0.46e-6, 1.38e-6, 2.31e-6], [0.02, 0.045, 0.09, 0.2]))
    at = INPUTS.at(vibration_amplitude=amplitude, sliding_speed=speed)
    models = closure_outcomes(learned().compared, at)
    noise = np.full(12, 0.03)
    every = {each: mutual_information(models, np.array(each), noise=noise) for each in combinations(range(12), count)}
    batch = best_batch(models, count=count, noise=noise, allowed=np.arange(12))
    assert every[tuple(sorted(batch.points))] > 0.95 * max(every.values())
