"""Task `efficiency` in Python: the numbers of the command, runs as bytes or dataset, and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from pytest import approx, raises

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.tasks.design.efficiency import efficiency
from sonolube.tasks.files import NamedBytes


def test_runs_as_path_bytes_and_dataset_give_the_answer_of_the_command(
    examples: Path, rigs: Path, on_terminal: Callable[..., dict[str, Any]]
) -> None:
    runs, rig = examples / "efficiency-runs.csv", rigs / "power_map.toml"
    options = ("--rig", rig, "--target-friction", "0.4N", "--speed", "65.5mm/s")
    expected = on_terminal("efficiency", runs, *options)
    by_path = efficiency(runs, rig=rig, target_friction="0.4N", speed="65.5 mm/s")
    assert by_path.json_object() == expected
    content = NamedBytes("efficiency-runs.csv", runs.read_bytes())
    for given in (content, sl.read_runs(runs)):
        found = efficiency(given, rig=sl.read_rig(rig), target_friction=0.08, speed=0.0655)
        assert found.object()["actuator_power"]["value"] == approx(expected["actuator_power"]["value"])
        assert found.object()["slope"] == expected["slope"]


def test_arguments_are_refused_by_their_names(examples: Path, rigs: Path) -> None:
    runs, rig = examples / "efficiency-runs.csv", rigs / "power_map.toml"
    with raises(InvalidInput, match=r"^speed has no meaning without target_friction"):
        efficiency(runs, rig=rig, speed=0.1)
    with raises(InvalidInput, match=r"^target_friction 3mm is a length"):
        efficiency(runs, rig=rig, target_friction="3mm", speed=0.1)
    with raises(InvalidInput, match=r"^level must be finite and lie between 0.5 and 0.9999, got 1"):
        efficiency(runs, rig=rig, level=1)
