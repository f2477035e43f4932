"""Task `plan` in Python: the numbers of the command, quantities in SI, runs as bytes, and refusals."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from tests.same import same

import sonolube as sl
from sonolube.charts import Points, chart_object, draw_chart
from sonolube.design.test_plan.run_protocols import plan_chart
from sonolube.errors import InvalidInput
from sonolube.tasks.design.plan import plan
from sonolube.tasks.files import NamedBytes

FEW: dict[str, Any] = {"speed": "20:200:4mm/s", "vibration": "0.5,1.4um", "points": 2}
OPTIONS = ("--speed", "20:200:4mm/s", "--vibration", "0.5,1.4um", "--points", "2")
RUNS = b"sliding_speed [mm/s],vibration_amplitude [um],friction_ratio\n30,1,0.7\n30,1,0.72\n60,1,0.8\n"


def test_quantities_as_text_and_in_si_give_the_answer_of_the_command(
    rigs: Path, tmp_path: Path, on_terminal: Callable[..., dict[str, Any]]
) -> None:
    path, table = rigs / "power_map.toml", tmp_path / "runs.csv"
    table.write_bytes(RUNS)
    expected = on_terminal("plan", path, *OPTIONS, "--measuring-time", "10s", "--runs", table)
    by_text = plan(path, **FEW, measuring_time="10 s", runs=table)
    same(by_text.json_object(), expected)
    in_si = plan(sl.read_rig(path), **FEW, measuring_time=10.0, difference=0.1, runs=NamedBytes("runs.csv", RUNS))
    same(in_si.json_object(), expected)


def test_the_figure_has_every_candidate_and_numbers_the_points(rigs: Path) -> None:
    found = plan(rigs / "power_map.toml", **FEW, runs=NamedBytes("runs.csv", RUNS))
    chart = plan_chart(found.plan)
    places, ratios = chart.panels
    candidates, *_, chosen = (part for part in places.parts if isinstance(part, Points))
    assert candidates.x.size == 4 * 2 + 1  # four speeds, two amplitudes, and the rig's own point
    assert candidates.shades is not None
    assert candidates.shades.max() == approx(candidates.scale_ends[1])  # type: ignore[index]
    assert sorted(", ".join(chosen.texts).split(", ")) == ["1", "2"]
    prediction = ratios.parts[0]
    assert isinstance(prediction, Points)
    assert np.all(prediction.y_error >= 0)  # type: ignore[operator]
    assert [word.partition("\n")[0] for word in ratios.x.words] == ["1", "2"]
    assert chart_object(chart)["panels"]
    draw_chart(chart)


def test_arguments_are_refused_by_their_names(rigs: Path) -> None:
    path = rigs / "power_map.toml"
    with raises(InvalidInput, match=r"^speed 20 has no unit; expected a speed"):
        plan(path, speed="20:200")
    with raises(InvalidInput, match=r"^vibration and voltage both set the amplitude"):
        plan(path, vibration="1um", voltage="3V")
    with raises(InvalidInput, match=r"^points must be finite and lie between 1 and inf, got 0"):
        plan(path, points=0)


def test_a_plan_for_a_soft_body_is_refused_in_one_line(rigs: Path) -> None:
    with raises(InvalidInput, match="rests on tests of hard bodies, and friction model soft_layer") as refused:
        plan(rigs / "pom_on_steel.toml", **FEW)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("argument", "value", "line"),
    [
        ("points", "many", "points must be a whole number, got 'many'"),
        ("points", 2.5, "points must be a whole number, got 2.5"),
        ("power", "0.9", "power must be a number, got '0.9'"),
        ("power", True, "power must be a number, got True"),
    ],
)
def test_a_text_for_a_plain_number_and_a_fraction_for_a_whole_one_are_refused(
    argument: str, value: Any, line: str, rigs: Path
) -> None:
    with raises(InvalidInput, match=f"^{re.escape(line)}$"):
        plan(rigs / "tribometer.toml", **{argument: value})


def test_whole_numbers_of_numpy_are_whole_numbers(rigs: Path) -> None:
    plain = plan(rigs / "power_map.toml", **FEW).object()
    numbers = {name: np.int64(value) for name, value in {"points": 2, "seed": 0}.items()}
    same(plan(rigs / "power_map.toml", **(FEW | numbers)).object(), plain)
