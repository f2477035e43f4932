"""Command `sweep --over`: dataset, report and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from pytest import approx

Program = Callable[..., Any]
VOLTS = "drive.voltage_peak_to_peak"


def test_a_sweep_finds_its_least_friction_and_continues_in_its_folder(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    call = ("sweep", rigs / "tribometer.toml", "--over")
    ending = ("--json", "--out", tmp_path)
    run = sonolube(*call, f"{VOLTS}=14V,28V", *ending)
    answer = run.answer
    assert answer["points"] == 2
    assert answer["statuses"] == {"periodic": 2}
    assert answer["least_friction"][VOLTS] == 28
    assert answer["least_friction"]["vibration_amplitude"]["value"] == approx(2.5e-6, rel=0.01)
    with xr.open_dataset(tmp_path / "sweep.nc") as swept:
        assert swept["friction_ratio"].shape == (2,)
    assert sonolube(*call, f"{VOLTS}=14V,28V", *ending).out == run.out
    assert "holds another sweep" in sonolube(*call, f"{VOLTS}=5V", "--out", tmp_path).refusal


def test_a_sweep_says_which_power_is_which_as_the_simulation_of_its_best_point_does(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    path = rigs / "tribometer.toml"
    alone = sonolube("simulate", path, "--set", f"{VOLTS}=28V", "--json", "--out", tmp_path).answer
    call = ("sweep", path, "--over", f"{VOLTS}=14V,28V", "--out", tmp_path / "sweep")
    told = sonolube(*call, "--json").answer["least_friction"]["energy_balance"]
    assert told == alone["energy_balance"]
    assert f"energy  {told}" in " ".join(sonolube(*call).out.split()).replace("energy ", "energy  ")
    assert "capacitance alone" in (tmp_path / "sweep" / "sweep.html").read_text(encoding="utf-8")
    ends = ("--from", "14V", "--to", "28V", "--points", "2", "--json", "--out", tmp_path / "study")
    assert sonolube("sweep", path, "--of", "voltage", *ends).answer["least_friction"][0]["energy_balance"] == told


def test_a_latin_hypercube_has_as_many_points_as_asked_for(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    over = ("--over", f"{VOLTS}=2V:28V", "--over", "sliding.sliding_speed=5mm/s:0.2m/s")
    drawn = ("--sample", "lhs", "--points", "7", "--out", tmp_path)
    run = sonolube("sweep", rigs / "tribometer.toml", *over, *drawn)
    assert run.code == 0
    assert "7 points" in run.out


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("--over", f"{VOLTS}=2mm:28V:3"), "2mm is a length; expected a voltage"),
        (("--over", f"{VOLTS}=2V:28V"), "must look like drive.voltage_peak_to_peak=first:last:count"),
        (("--over", f"{VOLTS}=28V:2V:5"), "at least 2 values that rise"),
        (("--over", f"{VOLTS}=0V:2V:5:log"), "the first above 0"),
        (("--over", VOLTS), "must look like KEY=VALUES"),
        (("--over", f"{VOLTS}=1V", "--over", f"{VOLTS}=2V"), "was given twice"),
        (("--over", "drive.voltag=1,2"), "drive.voltag: unknown key"),
        (("--over", "friction.model=a:b:3"), "list its values"),
        (("--over", f"{VOLTS}=2V:28V", "--sample", "lhs"), "needs --points"),
        (("--over", f"{VOLTS}=2V:28V:3", "--points", "3"), "--points has no meaning for --sample grid"),
        (("--over", f"{VOLTS}=2V:28V:3", "--to", "3V"), "--to has no meaning for --over"),
        (("--over", f"{VOLTS}=2V:28V:3", "--of", "voltage"), "needs either --over"),
        ((), "needs either --over, keys with their values, or --of"),
    ],
)
def test_a_sweep_without_meaning_is_refused_in_one_line(
    arguments: tuple[str, ...], line: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    assert line in sonolube("sweep", rigs / "tribometer.toml", *arguments, "--out", tmp_path / "none").refusal
    assert not (tmp_path / "none").exists()


def test_the_page_of_a_sweep_lists_its_options_and_the_points_that_failed(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    over = ("--over", "contact.roughness.rms_height=6um,-6um", "--over", "friction.model=asperity_stick_slip,kinematic")
    run = sonolube("sweep", rigs / "tribometer.toml", *over, "--set", f"{VOLTS}=20V", "--out", tmp_path)
    page = (tmp_path / "sweep.html").read_text(encoding="utf-8")
    assert run.code == 0
    for text in (
        "contact.roughness.rms_height=6um,-6um",
        f"{VOLTS}=20V",
        "0 (default)",
        "Points without a result",
        "periodic",
        "4, 2 with a result",
    ):
        assert text in page


@pytest.mark.parametrize(
    "over", [(f"{VOLTS}=5V:28V:9",), (f"{VOLTS}=5V:28V:9", "sliding.sliding_speed=5mm/s:0.1m/s:9")]
)
def test_a_sweep_draws_friction_over_its_keys(
    over: tuple[str, ...], tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    options = [word for key in over for word in ("--over", key)]
    answer = sonolube("sweep", rigs / "tribometer.toml", *options, "--json", "--out", tmp_path).answer
    assert [Path(path).name for path in answer["files"]] == [
        f"sweep.{kind}" for kind in ("html", "png", "svg", "pdf", "nc")
    ]
    drawing = (tmp_path / "sweep.svg").read_text(encoding="utf-8")
    assert "Drive voltage, peak to peak [V]" in drawing
    assert ("Sliding speed [mm/s]" in drawing) == (len(over) == 2)
