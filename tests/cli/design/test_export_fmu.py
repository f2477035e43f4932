"""`sonolube export fmu`: two files, and one line for what makes no sense."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Program = Callable[..., Any]
COLLAR = "examples/rigs/collar.toml"


def test_plant_and_controller_are_written_and_described(sonolube: Program, tmp_path: Path) -> None:
    answer = sonolube("export", "fmu", COLLAR, "--fmi", "2", "--json", "--out", tmp_path).answer
    assert [Path(each).name for each in answer["files"]] == ["collar-plant.fmu", "collar-controller.fmu"]
    assert all((tmp_path / Path(each).name).stat().st_size > 10_000 for each in answer["files"])
    assert answer["model"] == "slow envelope"
    assert answer["relative_error"]["value"] < 1e-6
    speed = answer["plant"]["sliding_speed"]
    assert (speed["causality"], speed["unit"], speed["lowest"], speed["highest"]) == ("input", "m/s", 0.025, 0.1)
    assert any("neither Modelica nor Simulink has been tried" in each for each in answer["caveats"])
    assert any("no temperature" in each for each in answer["caveats"])


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ((COLLAR, "--rate", "0Hz"), "--rate 0Hz must be positive"),
        ((COLLAR, "--fmi", "1"), "--fmi"),
        ((COLLAR, "--over", "contact.nominal_area=1mm2:2mm2"), "contact.nominal_area: no input of the plant"),
        ((COLLAR, "--over", "drive.frequency=24kHz:26kHz"), "holds at 25 kHz only"),
        ((COLLAR, "--over", "sliding.sliding_speed=0m/s:1m/s"), "needs a range from above 0 that rises"),
        ((COLLAR, "--pin", "steel_1045"), "the temperature needs both materials"),
        ((COLLAR, "--conductance", "0.1W/K"), "without the materials of pin and disc"),
        ((COLLAR, "--pin", "steel_1045", "--disc", "steel_1045", "--heat-capacity", "0J/K"), "must be positive"),
        ((COLLAR, "--no-track"), "--track has no meaning"),
        ((COLLAR, "--quality", "80"), "--quality has no meaning"),
        (("examples/rigs/welder_flat.toml", "--coupling", "0.3"), "--coupling has no meaning"),
        (("examples/rigs/poisson_al_steel.toml",), "does not follow the voltage; choose the amplitude computed"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(
    arguments: tuple[str, ...], line: str, sonolube: Program, tmp_path: Path
) -> None:
    assert line in sonolube("export", "fmu", *arguments, "--out", tmp_path / "out").refusal
    assert not (tmp_path / "out").exists()
