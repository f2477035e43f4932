"""Task `plan` in Python: the numbers of the command, quantities in SI, runs as bytes, and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from pytest import raises

import sonolube as sl
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
    assert by_text.json_object() == expected
    in_si = plan(sl.read_rig(path), **FEW, measuring_time=10.0, difference=0.1, runs=NamedBytes("runs.csv", RUNS))
    assert in_si.json_object() == expected


def test_arguments_are_refused_by_their_names(rigs: Path) -> None:
    path = rigs / "power_map.toml"
    with raises(InvalidInput, match=r"^speed 20 has no unit; expected a speed"):
        plan(path, speed="20:200")
    with raises(InvalidInput, match=r"^vibration and voltage both set the amplitude"):
        plan(path, vibration="1um", voltage="3V")
    with raises(InvalidInput, match=r"^points must be finite and lie between 1 and inf, got 0"):
        plan(path, points=0)
