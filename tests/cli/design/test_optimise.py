"""Command `optimise`: the rig file of the best design, the front, and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from pytest import approx

from sonolube.rig import read_rig

pytestmark = pytest.mark.usefixtures("compiled_kernels")

Program = Callable[..., Any]


def test_the_rig_file_of_a_design_gives_the_target_friction(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    target = ("--target-friction", "0.45N", "--set", "contact.normal_load=4N", "--over", "drive.frequency=18kHz:24kHz")
    chosen = ("--actuator", "own", "--actuator", "nac2023", "--current-limit", "20A")
    answer = sonolube("optimise", rigs / "tribometer.toml", *target, *chosen, "--json", "--out", tmp_path).answer
    best = answer["designs"][0]
    assert {design["actuator"] for design in answer["designs"]} == {"own", "nac2023"}
    assert best["limits_used"]["current"] <= 1
    simulated = sonolube("simulate", tmp_path / "tribometer-optimum.toml", "--json", "--out", tmp_path).answer
    assert simulated["friction_force"]["value"] == approx(0.45, rel=2e-4)
    for name in ("charging_power", "actuator_power"):
        assert simulated[name]["value"] == approx(best[name]["value"], rel=1e-9)
    assert simulated["power_to_supply"]["value"] == approx(best["power_to_supply"]["value"], rel=1e-4)
    assert simulated["vibration_amplitude"]["value"] == approx(best["vibration_amplitude"]["value"], rel=1e-5)
    with xr.open_dataset(tmp_path / "tribometer-optimum.nc") as designs:
        assert int(designs["feasible"].sum()) == answer["feasible"]
        assert designs.sizes["design"] == answer["screened"]


def test_a_front_of_tolerant_designs_is_drawn(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    target = ("--target-friction", "0.2", "--over", "drive.frequency=21kHz:23kHz", "--robust", "0.02")
    pressed = ("--bolt", "M10x60mm", "--preload", "12kN", "--source-resistance", "50ohm")
    run = sonolube("optimise", rigs / "tribometer.toml", *target, *pressed, "--pareto", "voltage", "--out", tmp_path)
    assert run.code == 0
    assert "at every corner of 2 %" in run.out
    assert "L network" in run.out
    assert (tmp_path / "tribometer-optimum-front.png").is_file()


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("--target-friction", "0.9"), "must lie below friction without vibration, 0.341"),
        (("--target-friction", "2N"), "must lie below friction without vibration, 0.341 or 1.02 N"),
        (("--target-friction", "0.1", "--actuator", "sa0505"), "unknown actuator 'sa0505'; did you mean"),
        (("--target-friction", "0.1", "--over", "contact.normal_load=1N:2N"), "choose over drive.frequency"),
        (("--target-friction", "0.1", "--over", "drive.waveform=saw"), "none of sine, square"),
        (("--target-friction", "0.1", "--bolt", "M6x40mm"), "--bolt and --preload belong together"),
        (("--target-friction", "0.1", "--bolt", "6mm", "--preload", "1kN"), "must look like M6x40mm"),
        (("--target-friction", "0.1", "--horn", "m50"), "--horn and --horn-limit belong together"),
        (("--target-friction", "0.1", "--temperature-limit", "40K"), "needs --conductance"),
        (("--target-friction", "0.1", "--quantile", "0.9"), "--quantile needs --robust"),
        (("--target-friction", "0.1", "--voltage-limit", "1V"), "out of reach: no design"),
    ],
)
def test_a_target_that_makes_no_design_is_refused_in_one_line(
    arguments: tuple[str, ...], line: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    assert line in sonolube("optimise", rigs / "tribometer.toml", *arguments, "--out", tmp_path / "none").refusal
    assert not (tmp_path / "none").exists()


def test_the_rig_file_of_the_optimum_has_the_entries_that_were_replaced(
    sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    options = ("--target-friction", "0.25", "--set", "contact.roughness.rms_height=1um", "--out", tmp_path)
    assert sonolube("optimise", rigs / "tribometer.toml", *options).code == 0
    written = read_rig(tmp_path / "tribometer-optimum.toml")
    assert written.contact.roughness.rms_height == approx(1e-6)
