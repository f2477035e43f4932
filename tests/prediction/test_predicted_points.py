"""Predicted friction ratios and verdicts at many points: those of single points, limits, closed forms, refusals."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from pytest import approx, fixture, mark, raises

from sonolube.errors import InvalidInput
from sonolube.prediction.applicability import friction_interval
from sonolube.prediction.predicted_points import PredictedRig, predicted_rig
from sonolube.prediction.verdict import VERDICTS, Verdict, point_verdict, verdict_counts, verdicts_text
from sonolube.rig import Rig, read_rig
from sonolube.rig.datasets import PREDICTED_RATIO

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


@fixture(scope="module")
def rig() -> Rig:
    return read_rig(RIGS / "tribometer.toml")


@fixture(scope="module")
def predicted(rig: Rig) -> PredictedRig:
    return predicted_rig(rig, points=100)


def runs(reduction: float, *, count: int = 1) -> Any:
    at = {"vibration_amplitude": ("run", [2.5e-6] * count), "sliding_speed": ("run", [0.02] * count)}
    return xr.Dataset({"friction_reduction": ("run", [reduction] * count), **at})


def test_the_own_point_has_the_interval_that_friction_shows(rig: Rig, predicted: PredictedRig) -> None:
    one = friction_interval(rig)
    found = predicted.columns(vibration_amplitude=[2.5e-6])
    assert [float(found[name][0]) for name in PREDICTED_RATIO] == approx([one.low, one.median, one.high], abs=1e-6)


def test_friction_is_as_without_vibration_where_none_is_and_unknown_where_the_amplitude_is(
    predicted: PredictedRig,
) -> None:
    found = predicted.columns(vibration_amplitude=[0.0, 1e-9, np.nan])
    for name in PREDICTED_RATIO:
        assert found[name][0] == 1.0
        assert found[name][1] == approx(1.0, abs=1e-3)
        assert np.isnan(found[name][2])


def test_ends_and_median_have_their_probability_by_the_distribution_in_closed_form(predicted: PredictedRig) -> None:
    assert predicted.chances is not None
    amplitudes, speeds = np.array([0.5e-6, 2.5e-6, 8e-6]), np.array([0.01, 0.05, 0.2])
    found = predicted.columns(vibration_amplitude=amplitudes, sliding_speed=speeds)
    for name, level in zip(PREDICTED_RATIO, (0.1, 0.5, 0.9), strict=True):
        below = [
            float(predicted.chances.of(1 - ratio, vibration_amplitude=a, sliding_speed=v))
            for ratio, a, v in zip(found[name], amplitudes, speeds, strict=True)
        ]
        assert below == approx([level] * 3, abs=0.015)


def test_the_interval_falls_with_the_amplitude_and_rises_with_the_speed(predicted: PredictedRig) -> None:
    up = predicted.columns(vibration_amplitude=np.geomspace(2e-7, 5e-6, 12))
    along = predicted.columns(vibration_amplitude=np.full(12, 2.5e-6), sliding_speed=np.geomspace(0.02, 1.0, 12))
    for name in PREDICTED_RATIO:
        assert np.all(np.diff(up[name]) < 0)
        assert np.all(np.diff(along[name]) > -1e-3)
    assert np.all(up["lowest_predicted_ratio"] < up["highest_predicted_ratio"])


@mark.parametrize("name", ["bronze_bush", "vibrating_base", "finger_on_glass"])
def test_each_verdict_is_that_of_its_point_alone(name: str) -> None:
    own = read_rig(RIGS / f"{name}.toml")
    assert own.drive is not None
    f0 = own.drive.frequency
    settings = [(a, f, v) for a in (1e-8, 0.42e-6, 5e-6) for f in (f0, 2 * f0) for v in (2e-3, 0.05, 3.0)]
    a, f, v = np.array(settings).T
    one_by_one = []
    for each in settings:
        drive = replace(own.drive, frequency=each[1])
        moved = replace(own, vibration_amplitude=each[0], drive=drive, sliding_speed=each[2])
        one_by_one.append(point_verdict(moved).verdict)
    outside = [each == Verdict.OUTSIDE_MODEL_RANGE for each in one_by_one]
    codes = PredictedRig(rig=own, chances=None).verdicts(
        vibration_amplitude=a, frequency=f, sliding_speed=v, outside_model=outside
    )
    assert [VERDICTS[code] for code in codes] == [str(each) for each in one_by_one]


def test_the_ends_of_the_tested_speeds_are_those_of_the_printed_tables_with_a_twentieth(
    predicted: PredictedRig,
) -> None:
    # D Tables 2.3 and 4.2: 3.5 to 266 mm/s
    speeds = np.array([3.5e-3 / 1.06, 3.5e-3, 0.266, 0.266 * 1.06])
    found = predicted.verdicts(vibration_amplitude=np.full(4, 2.5e-6), sliding_speed=speeds)
    assert [VERDICTS[code] for code in found] == ["extrapolated", "in_range", "in_range", "extrapolated"]
    assert verdict_counts(found) == {"in_range": 2, "extrapolated": 2}
    assert verdicts_text(found).startswith("of 4 points with a result: 2 within the range")
    assert verdicts_text(found[1:3]).startswith("all 2 points with a result are within the range")
    assert "3.5 mm/s to 266 mm/s" in predicted.caveats(found)[-1]
    assert predicted.caveats(found[1:3]) == ()


def test_an_own_run_narrows_the_interval_about_it_and_runs_without_effect_contradict_it(rig: Rig) -> None:
    before = predicted_rig(rig, points=1).columns(vibration_amplitude=[2.5e-6])
    after = predicted_rig(rig, points=1, runs=runs(0.5))
    assert after.runs == 1
    found = after.columns(vibration_amplitude=[2.5e-6])
    width, narrowed = (float(each[PREDICTED_RATIO[2]][0] - each[PREDICTED_RATIO[0]][0]) for each in (before, found))
    assert narrowed < 0.6 * width
    assert found[PREDICTED_RATIO[0]][0] < 0.5 < found[PREDICTED_RATIO[2]][0]
    contradicted = predicted_rig(rig, points=1, runs=runs(-0.2, count=3))
    codes = contradicted.verdicts(vibration_amplitude=[2.5e-6, 1e-8, np.nan])
    assert [VERDICTS[code] for code in codes] == ["contradicted_by_runs", "contradicted_by_runs", "no_result"]
    assert contradicted.caveats(codes)[0].startswith("Your runs contradict every model")


def test_a_rig_that_cannot_be_predicted_and_too_many_points_have_a_reason_and_runs_of_such_a_rig_are_refused() -> None:
    soft = read_rig(RIGS / "pom_on_steel.toml")
    found = predicted_rig(soft, points=3)
    assert "soft or floating contact" in found.reason
    assert set(found.columns(vibration_amplitude=[1e-6])) == {"verdict"}
    with raises(InvalidInput, match="soft or floating contact"):
        predicted_rig(soft, points=3, runs=runs(0.5))
    assert "2001 points are more than the 2000" in predicted_rig(soft, points=2001).reason
