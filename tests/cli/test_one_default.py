"""Every command takes the amplitude of one source and says which; caveats and assumptions travel into its files."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from pytest import approx

pytestmark = pytest.mark.usefixtures("compiled_kernels")

Program = Callable[..., Any]
SPEED, LOAD = 20.3e-3, 3.0
OVER = ("--over", "sliding.sliding_speed=20.3mm/s")
AXES = (
    "--over",
    "sliding.sliding_speed=20.3mm/s,30mm/s",
    "--over",
    "drive.voltage_peak_to_peak=14V,28V",
    "--over",
    "contact.normal_load=3N",
)
COMMANDS: dict[str, tuple[str, ...]] = {
    "simulate": (),
    "thermal": ("--pin", "stainless_steel_316", "--disc", "aluminium_2024", "--duration", "1s"),
    "regime": ("--film-coefficient", "0.25", "--asperity-pressure", "10MPa"),
    "sweep": OVER,
    "map": (*AXES, "--form", "png"),
    "control": ("--duration", "0.05s"),
    "compare": ("--model", "kinematic"),
}


def ratio_in(command: str, answer: dict[str, Any]) -> float:
    """Friction ratio of the rig's own operating point in the answer of a command."""
    match command:
        case "regime":
            friction = answer["friction_coefficient"]
            return float(friction["ultrasonic"]["value"] / friction["dry"]["value"])
        case "sweep":
            return float(answer["least_friction"]["friction_ratio"]["value"])
        case "map":
            return 1 - float(answer["most_reduction"]["friction_reduction"]["value"])
        case "compare":
            return float(answer["rig"]["own_model"]["friction_ratio"])
        case _:
            return float(answer["friction_ratio"]["value"])


@pytest.mark.parametrize("source", ["measured", "computed", "per-volt"])
@pytest.mark.parametrize("command", [name for name in COMMANDS if name != "control"])
def test_a_command_has_the_friction_of_friction_by_the_same_source(
    command: str, source: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    rig, chosen = rigs / "tribometer.toml", ("--amplitude", source)
    expected = sonolube("friction", rig, *chosen, "--json").answer
    answer = sonolube(command, rig, *chosen, *COMMANDS[command], "--out", tmp_path, "--json").answer
    told = answer["rig"]["own_model"] if command == "compare" else answer
    assert ratio_in(command, answer) == approx(expected["friction_ratio"]["value"], rel=1e-6)
    assert told["amplitude_source"] == expected["amplitude_source"] == source
    assert told["amplitude_origin"] == expected["amplitude_origin"]


@pytest.mark.parametrize("command", COMMANDS)
def test_caveats_and_assumptions_of_the_rig_travel_into_every_answer_and_dataset(
    command: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    rig = rigs / "tribometer.toml"
    friction = sonolube("friction", rig, "--json").answer
    answer = sonolube(command, rig, *COMMANDS[command], "--out", tmp_path, "--json").answer
    assert set(friction["caveats"]) <= set(answer["caveats"])
    assert friction["assumptions"].items() <= answer["assumptions"].items()
    for path in (Path(name) for name in answer["files"]):
        if path.suffix == ".nc":
            with xr.open_dataset(path) as data:
                assert set(friction["caveats"]) <= set(data.attrs["caveats"].split("\n"))
                assert "structure: not printed; identified" in data.attrs["assumptions"]
        if path.suffix == ".html":
            page = path.read_text()
            assert "roughness parameter" in page
            assert "not printed; identified" in page


def test_uncertainty_carries_the_caveats_of_its_rig_and_says_its_source(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    rig = rigs / "tribometer_uncertain.toml"
    answer = sonolube("uncertainty", rig, "--samples", "32", "--out", tmp_path, "--json").answer
    assert answer["amplitude_source"] == "computed"
    assert any("roughness parameter" in caveat for caveat in answer["caveats"])
    with xr.open_dataset(next(tmp_path.glob("*.nc"))) as data:
        assert "roughness parameter" in data.attrs["caveats"]


def test_a_published_test_under_the_conditions_of_the_rig_stands_beside_its_prediction(
    sonolube: Program, rigs: Path
) -> None:
    (measured,) = sonolube("friction", rigs / "tribometer.toml", "--json").answer["measured"]
    assert measured["test"] == "A-1"
    assert measured["friction_ratio"] == approx(0.37, abs=0.005)  # 0.378 N of 1.022 N, D Table 2.3
    faster = sonolube("friction", rigs / "tribometer.toml", "--set", "sliding.sliding_speed=60mm/s", "--json").answer
    assert "measured" not in faster


def test_outside_its_range_a_model_prints_no_number_of_its_formula_but_the_range_of_the_others(
    sonolube: Program, rigs: Path
) -> None:
    run = sonolube("friction", rigs / "tribometer.toml", "--model", "dong_2015_full_period", "--amplitude", "per-volt")
    assert run.code == 0, run.err
    assert "the friction models that hold give ratios from" in run.out
    assert "formula" not in run.out.replace("by the formula", "")


def test_a_map_that_is_the_same_at_every_load_has_one_panel_and_says_so(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    axes = (*AXES[:4], "--over", "contact.normal_load=2N,3N,4N")
    run = sonolube("map", rigs / "tribometer.toml", *axes, "--form", "png", "--out", tmp_path)
    assert run.code == 0, run.err
    assert "the same at each normal load from 2 N to 4 N" in run.out
    assert "the same at each normal load" in (tmp_path / "map.html").read_text()


def test_models_that_differ_by_more_than_their_errors_are_told_in_one_line(
    tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    models = ("--model", "kinematic", "--model", "dahl", "--set", "sliding.sliding_speed=5mm/s")
    run = sonolube("compare", rigs / "tribometer.toml", *models, "--out", tmp_path)
    assert run.code == 0, run.err
    assert run.out.count("models differ by more than their errors: ") == 1


def test_an_amplitude_without_a_rig_is_refused(sonolube: Program) -> None:
    assert "--amplitude needs a rig; name its file" in sonolube("compare", "--amplitude", "computed").refusal
