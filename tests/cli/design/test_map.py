"""Command `map`: figures, datasets, measured runs and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from pytest import approx

Program = Callable[..., Any]
VOLTS = "drive.voltage_peak_to_peak"


def test_measured_runs_are_drawn_and_interpolated_where_they_are_enough(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    runs = tmp_path / "runs.csv"
    rows = [f"{speed},{volts},{60 - speed / 4 + volts}" for speed in (50, 100, 150) for volts in (1, 3, 5)]
    runs.write_text("\n".join(["sliding_speed [mm/s],actuator_power [W],friction_reduction [%]", *rows]))
    over = ("--over", f"{VOLTS}=5V:25V:3", "--over", "contact.normal_load=5N", "--form", "png")
    call = ("map", rigs / "power_map.toml", *over, "--measured", runs, "--json", "--out", tmp_path)
    answer = sonolube(*call).answer
    assert answer["map"] == "velocity-power"
    name = "power_map-velocity-power"
    expected = {"map.html", f"{name}.png", f"{name}.nc", f"{name}-measured.png", f"{name}-measured.nc"}
    assert {Path(path).name for path in answer["files"]} == expected
    with xr.open_dataset(tmp_path / f"{name}-measured.nc") as interpolated:
        middle = interpolated.sel(sliding_speed=0.1, power_to_supply=3.0, method="nearest")
        assert float(middle["friction_reduction"]) == approx(0.38, abs=0.01)


def test_runs_by_voltage_and_load_have_their_place_by_power_and_stress(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    runs = tmp_path / "runs.csv"
    rows = ["10,20,5,0.5", "20,30,5,0.4", "80,30,5,0.2", "20,,5,0.4", "20,30,5,"]
    runs.write_text("\n".join(["voltage_peak_to_peak [V],sliding_speed [mm/s],normal_load [N],friction_ratio", *rows]))
    over = ("--over", f"{VOLTS}=5V:25V:3", "--over", "contact.normal_load=5N,6N", "--form", "png")
    run = sonolube("map", rigs / "power_map.toml", *over, "--runs", runs, "--out", tmp_path)
    assert "1 of 5 runs have no friction yet" in run.out
    assert "2 of 4 runs lack sliding_speed or actuator_power" in run.out  # one is beyond the voltages of the map
    stress = sonolube(
        "map", rigs / "power_map.toml", "--kind", "velocity-stress", *over, "--runs", runs, "--out", tmp_path
    )
    assert "1 of 4 runs lack sliding_speed or nominal_pressure" in stress.out


@pytest.mark.parametrize(
    ("head", "row", "line"),
    [
        ("speed,friction_reduction [%]", "1,2", "column 'speed' has no unit; expected a speed"),
        ("sliding_speed [mm/s],friction_reduction [%]", "x,2", "line 2: sliding_speed 'x' is no number"),
        ("sliding_speed [N],friction_reduction [%]", "1,2", "line 1: sliding_speed"),
        ("sliding_speed [mm/s]", "1", "needs a column friction_reduction"),
        ("sliding_speed [mm/s],friction_reduction [%]", "1,2", "need a column actuator_power"),
    ],
)
def test_runs_that_cannot_be_read_are_refused_by_column(
    head: str, row: str, line: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    runs = tmp_path / "runs.csv"
    runs.write_text(f"{head}\n{row}\n")
    over = ("--over", f"{VOLTS}=5V,25V", "--over", "contact.normal_load=5N")
    run = sonolube("map", rigs / "power_map.toml", *over, "--measured", runs, "--out", tmp_path / "none")
    assert line in run.refusal


def test_an_axis_of_another_map_is_refused(sonolube: Program, rigs: Path) -> None:
    refusal = sonolube("map", rigs / "power_map.toml", "--over", "drive.frequency=1kHz:2kHz:3").refusal
    assert "its axes are sliding.sliding_speed, contact.normal_load, drive.voltage_peak_to_peak" in refusal
