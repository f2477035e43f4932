"""Chances of a target over a map: those of each point, words, contours, and refusals."""

from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, fixture, raises

import sonolube as sl
from sonolube.charts import Field
from sonolube.design.map_chances import CHANCE, chance_chart, chance_facts
from sonolube.errors import InvalidInput
from sonolube.prediction.chances import reduction_chances
from sonolube.tasks.design.map import map as map_of

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
OVER = {
    "sliding.sliding_speed": "20mm/s:200mm/s:4",
    "contact.normal_load": "5N",
    "drive.voltage_peak_to_peak": "5V,15V,25V",
}


@fixture(scope="module")
def mapped() -> Any:
    return map_of(sl.read_rig(RIGS / "power_map.toml"), over=OVER, target_reduction="60 %", confidence="40%")


def test_each_point_has_the_chance_of_its_amplitude_and_speed(mapped: Any) -> None:
    found = mapped.dataset()
    chances = reduction_chances(sl.read_rig(RIGS / "power_map.toml"))
    assert found[CHANCE].dims == found["vibration_amplitude"].dims
    speed = found["sliding_speed"].broadcast_like(found[CHANCE]).transpose(*found[CHANCE].dims)
    exact = chances.of(0.6, vibration_amplitude=found["vibration_amplitude"].values, sliding_speed=speed.values)
    assert found[CHANCE].values == approx(exact, abs=0.01)
    assert found.attrs["target_reduction"] == approx(0.6)
    along = found[CHANCE].isel(normal_load=0)
    assert np.all(along.diff("voltage_peak_to_peak") > 0)
    assert np.all(along.diff("sliding_speed") < 0)


def test_where_the_chance_is_reached_first_is_said(mapped: Any) -> None:
    found = mapped.dataset()
    (name, most), (wanted, first) = chance_facts(found, confidence=0.4)
    assert (name, wanted) == ("chance", "wanted")
    assert most.startswith("of 60 % less friction, at most ")
    assert "25 V" in most
    assert "20 mm/s" in most
    assert first.startswith("4 chances in 10 first at ")
    nowhere = chance_facts(found, confidence=0.99)[1][1]
    assert nowhere == "99 chances in 100 are reached nowhere on this map; one run of your own would tell"
    assert len(chance_facts(found)) == 1
    answered = mapped.json_object()
    assert answered["confidence"] == approx(0.4)
    assert answered["highest_chance"] == approx(float(found[CHANCE].max()))


def test_the_figure_has_a_line_at_the_chance_that_is_wanted(mapped: Any) -> None:
    assert list(mapped.figures()) == ["power_map-velocity-power", "power_map-velocity-power-chance"]
    (panel,) = chance_chart(mapped.dataset(), confidence=0.35).panels
    (field,) = panel.parts
    assert isinstance(field, Field)
    assert field.lines is not None
    assert 35.0 in field.lines.tolist()
    assert "60 % less friction" in field.scale_text


def test_a_chance_without_its_target_and_shares_out_of_range_are_refused() -> None:
    rig = sl.read_rig(RIGS / "power_map.toml")
    with raises(InvalidInput, match="confidence needs target_reduction, the reduction that it is of"):
        map_of(rig, over=OVER, confidence=0.9)
    with raises(InvalidInput, match="target_reduction must lie between 0 and 100 %, got 120 %"):
        map_of(rig, over=OVER, target_reduction=1.2)
