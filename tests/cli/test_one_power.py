"""Terminal and Python give one power to supply, with both parts, through every command that shows it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from pytest import approx, mark

import sonolube as sl

NAMES = ("power_to_supply", "charging_power", "dissipated_power", "apparent_power", "peak_current")
Program = Callable[..., Any]


@mark.parametrize("command", ["friction", "simulate"])
def test_a_point_has_the_power_of_its_parts_in_the_terminal_and_in_python(
    command: str, sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    rig = rigs / "tribometer.toml"
    printed = sonolube(command, rig, "--json", *(("--out", tmp_path) if command == "simulate" else ())).answer
    answer = getattr(sl, command)(rig).object()
    for name in NAMES:
        assert printed[name]["value"] == approx(answer[name]["value"], rel=1e-12)
    assert printed["charging_power"]["value"] == approx(360e-9 * 28.0 * 28.0 * 22e3)  # D 1.9
    assert printed["power_to_supply"]["value"] == approx(printed["dissipated_power"]["value"], rel=1e-12)
    assert printed["power_to_supply"]["value"] == approx(43.9, rel=2e-3)
    assert "at_least" not in printed


def test_sweep_and_predict_have_the_power_of_friction(sonolube: Program, rigs: Path, tmp_path: Path) -> None:
    rig = rigs / "tribometer.toml"
    alone = sl.friction(rig).object()
    ends = ("--from", "14V", "--to", "28V", "--points", "2")
    swept = sonolube("sweep", rig, "--of", "voltage", *ends, "--json", "--out", tmp_path).answer["least_friction"][0]
    predicted = sl.predict(rig, draws=200).object()
    for name in NAMES:
        assert swept[name]["value"] == approx(alone[name]["value"], rel=1e-5)
        assert predicted[name] == approx(alone[name]["value"], rel=1e-12)


def test_a_rig_without_a_structure_says_at_least(sonolube: Program, rigs: Path) -> None:
    run = sonolube("friction", rigs / "collar.toml")
    assert "at least 823 mW" in run.out
    printed = sonolube("friction", rigs / "collar.toml", "--json").answer
    assert printed["at_least"] == ["power_to_supply"]
    assert sl.friction(rigs / "collar.toml").object()["at_least"] == ["power_to_supply"]
