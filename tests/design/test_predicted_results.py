"""Predictions beside the friction model in studies, sweeps and maps: single predictions, files, figures, words."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from tests.same import same

import sonolube as sl
from sonolube.charts import Band, Line
from sonolube.design.sweep_figures import sweep_chart
from sonolube.errors import InvalidInput
from sonolube.prediction.verdict import VERDICTS, point_verdict
from sonolube.rig.datasets import PREDICTED_RATIO
from sonolube.rig.figures import STUDY_CHARTS
from sonolube.tasks.design.map import map as map_of
from sonolube.tasks.design.sweep import sweep

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "examples" / "rigs"
VOLTAGE, SPEED = "drive.voltage_peak_to_peak", "sliding.sliding_speed"


@pytest.fixture(scope="module")
def rig() -> sl.Rig:
    return sl.read_rig(RIGS / "tribometer.toml")


@pytest.fixture(scope="module")
def study(rig: sl.Rig) -> Any:
    return sweep(rig, of="voltage", lowest="7V", highest="28V", points=3)


def test_each_point_of_a_study_and_of_a_sweep_has_the_prediction_of_its_rig_alone(rig: sl.Rig, study: Any) -> None:
    swept = sweep(rig, over={VOLTAGE: "7V,17.5V,28V"})
    for place, volts in enumerate((7.0, 17.5, 28.0)):
        one = sl.predict(rig.replace(VOLTAGE, f"{volts} V"))["friction_ratio"]
        expected = one.quantile([0.1, 0.5, 0.9]).values
        for found in (study.dataset(), swept.dataset()):
            assert [float(found[name][place]) for name in PREDICTED_RATIO] == approx(expected, abs=0.01)
    assert study.dataset()["predicted_friction_ratio"].attrs["long_name"] == "Predicted friction ratio, median"
    assert study.dataset()["verdict"].attrs["flag_meanings"].split() == list(VERDICTS)


def test_a_grid_has_each_prediction_and_verdict_at_its_place_in_memory_and_in_chunks_on_disk(
    rig: sl.Rig, tmp_path: Path
) -> None:
    over = {VOLTAGE: "7V,28V", SPEED: "20mm/s,100mm/s,1m/s"}
    whole = sweep(rig, over=over).dataset()
    chunked = sweep(rig, over=over, chunk=2, keep=tmp_path).dataset()
    for name in (*PREDICTED_RATIO, "verdict"):
        assert whole[name].dims == whole["friction_ratio"].dims
        same(chunked[name].values, whole[name].values)
    assert np.all(whole["predicted_friction_ratio"].diff("sliding_speed") > 0)
    assert np.all(whole["predicted_friction_ratio"].diff("voltage_peak_to_peak") <= 0)
    fast = whole["verdict"].sel(sliding_speed=1.0)
    assert [VERDICTS[code] for code in fast.values] == ["extrapolated"] * 2


def test_terminal_and_json_show_model_prediction_and_verdict_side_by_side(study: Any) -> None:
    text, found = study.text(line_length=None), study.json_object()
    assert text.index("points with a result are within the range") < text.index("least friction")
    assert "asperity_stick_slip" in text
    (best,) = found["least_friction"]
    low, high = best["predicted_friction_ratio"]["interval_80"]
    assert low < best["friction_ratio"]["value"] < high
    assert best["verdict"] == "in_range"
    assert found["verdicts"] == {"in_range": 3}
    assert found["prediction"] == {"runs": 0, "reason": None}


def test_figures_have_the_interval_beside_the_named_line_of_the_model(rig: sl.Rig, study: Any) -> None:
    parts = STUDY_CHARTS["voltage"](study.dataset()).panels[2].parts
    (band,) = [each for each in parts if isinstance(each, Band)]
    assert band.label == "predicted, 80 %"
    same(band.low, study.dataset()["lowest_predicted_ratio"].values)
    assert [each.label for each in parts if isinstance(each, Line)] == ["predicted median", "asperity_stick_slip"]
    curves = sweep(rig, of="speed", points=3, voltage=["7V", "14V", "28V"]).dataset()
    panel = STUDY_CHARTS["speed"](curves).panels[0]
    labels = [each.label for each in panel.parts if isinstance(each, Band)]
    assert labels == ["predicted, 80 %, 7 V peak to peak", "predicted, 80 %, 28 V peak to peak"]
    swept = sweep(rig, over={VOLTAGE: "7V,28V"}).dataset()
    assert any(isinstance(each, Band) for each in sweep_chart(swept).panels[0].parts)
    load = STUDY_CHARTS["load"](sweep(rig, of="load", points=2).dataset()).panels[0].parts[0]
    assert isinstance(load, Band)
    assert np.all(load.low < load.high)


def test_own_runs_move_a_study_and_a_sweep_and_have_no_meaning_where_the_rig_changes(rig: sl.Rig) -> None:
    runs = str(ROOT / "examples" / "tribometer-runs.csv")
    for answer in (
        sweep(rig, of="voltage", lowest="14V", highest="28V", points=2, runs=runs),
        sweep(rig, over={VOLTAGE: "14V,28V"}, runs=runs),
    ):
        assert answer.json_object()["prediction"]["runs"] > 0
        found = answer.dataset()
        width = found["highest_predicted_ratio"] - found["lowest_predicted_ratio"]
        assert np.all(width < 0.4)
    roughness = {"contact.roughness.rms_height": "1um,2um"}
    with raises(InvalidInput, match=r"runs has no meaning here: contact\.roughness\.rms_height changes the rig"):
        sweep(rig, over=roughness, runs=runs)
    alone = sweep(rig, over=roughness)
    assert "rms_height changes the rig" in alone.json_object()["prediction"]["reason"]
    assert "predicted_friction_ratio" not in alone.dataset()


def test_a_rig_that_cannot_be_predicted_keeps_the_line_of_its_model_and_a_reason() -> None:
    found = sweep(sl.read_rig(RIGS / "pom_on_steel.toml"), of="speed", points=3)
    assert "not predicted: friction model soft_layer" in found.text(line_length=None)
    assert "predicted_friction_ratio" not in found.dataset()
    assert set(found.json_object()["verdicts"]) == {"extrapolated"}
    assert found.plot().axes


def test_each_point_of_a_map_has_the_verdict_of_its_rig_alone() -> None:
    rig = sl.read_rig(RIGS / "power_map.toml")
    over = {SPEED: "20mm/s,1m/s", "contact.normal_load": "5N", VOLTAGE: "1V,25V"}
    answer = map_of(rig, over=over)
    found = answer.dataset()["verdict"]
    for volts in (1.0, 25.0):
        for speed in (0.02, 1.0):
            one = point_verdict(rig.replace(VOLTAGE, f"{volts} V").replace(SPEED, f"{speed} m/s"))
            code = int(found.sel(voltage_peak_to_peak=volts, sliding_speed=speed, normal_load=5.0))
            assert VERDICTS[code] == one.verdict
    assert answer.json_object()["verdicts"] == {"in_range": 1, "extrapolated": 3}
    assert any("460 nm to 11.5 um" in line for line in answer.caveats())
