"""Commands that answer with one record of a rig: quantities of the vocabulary, in SI."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest import approx
from tests.same import same

from sonolube.vocabulary import quantity

Program = Callable[..., Any]


@pytest.mark.parametrize(
    ("command", "names"),
    [
        ("contact", ["separation", "real_contact_area", "contact_count", "normal_stiffness", "tangential_stiffness"]),
        (
            "friction",
            [
                "friction_force",
                "friction_coefficient",
                "friction_ratio",
                "friction_reduction",
                "vibration_amplitude",
                "actuator_power",
            ],
        ),
        ("wear", ["wear_rate", "vibration_amplitude"]),
    ],
)
def test_a_command_answers_in_words_of_the_vocabulary_and_si(
    command: str, names: list[str], sonolube: Program, rigs: Path
) -> None:
    result = sonolube(command, rigs / "tribometer.toml", "--json").answer
    for name in names:
        assert result[name]["unit"] == quantity(name).unit
        assert result[name]["value"] > 0


def test_the_published_separation_of_18_um_is_one_command_away(sonolube: Program, rigs: Path) -> None:
    result = sonolube("contact", rigs / "poisson_al_steel.toml", "--load", "40N", "--json").answer
    assert result["separation"]["value"] == approx(18.11e-6, abs=0.005e-6)
    assert result["normal_load"] == {"value": 40.0, "unit": "N"}


def test_the_tangential_stiffness_is_that_of_sticking_asperities(sonolube: Program, rigs: Path) -> None:
    # 3 N over the decay length of 2 um are 1.5 MN/m, and for glass on aluminium Mindlin's ratio is below 1
    result = sonolube("contact", rigs / "tribometer.toml", "--json").answer
    ratio = result["mindlin_ratio"]["value"]
    assert 2 / 3 < ratio < 1
    assert result["tangential_stiffness"]["value"] == approx(ratio * 1.5e6)
    assert result["tangential_stiffness_model"] == "mindlin"


def test_the_dissertations_tangential_stiffness_has_its_name_and_a_caveat(sonolube: Program, rigs: Path) -> None:
    # D 3.9 with D Table 3.2: 59.6 GPa (4981 um2)^2/(15.453 um)^3
    result = sonolube("contact", rigs / "tribometer.toml", "--tangential-stiffness", "dong_2015", "--json").answer
    expected = 59.6e9 * 4981e-12**2 / 15.453e-6**3
    assert result["tangential_stiffness"]["value"] == approx(expected, rel=1e-3)
    assert any("267 times the normal one" in caveat for caveat in result["caveats"])


def test_an_unknown_tangential_stiffness_is_refused_with_the_names(sonolube: Program, rigs: Path) -> None:
    refused = sonolube("contact", rigs / "tribometer.toml", "--tangential-stiffness", "mindlyn")
    assert refused.code == 2
    assert "mindlyn" in refused.err
    assert "mindlin" in refused.err.replace("mindlyn", "")


@pytest.mark.parametrize("source", [(), ("--amplitude", "per-volt")])
def test_wear_is_printed_as_the_dissertation_prints_it(source: tuple[str, ...], sonolube: Program, rigs: Path) -> None:
    # D Table 3.4: 2.566e-2 and 1.355e-2 mm3/m
    text = sonolube("wear", rigs / "tribometer.toml", *source).out
    assert re.search(r"Wear rate without vibration +0\.0257 mm3/m", text)
    assert re.search(r"Wear volume per sliding distance +0\.0135 mm3/m", text)
    assert "um2" not in text


def test_friction_force_and_coefficient_belong_together(sonolube: Program, rigs: Path) -> None:
    changes = ("--set", "contact.normal_load=7N")
    result = sonolube("friction", rigs / "power_map.toml", *changes, "--json").answer
    assert result["friction_force"]["value"] == approx(7 * result["friction_coefficient"]["value"])
    assert result["friction_reduction"]["value"] == approx(1 - result["friction_ratio"]["value"])


def test_another_friction_model_is_taken_by_name(sonolube: Program, rigs: Path) -> None:
    from sonolube.rig import friction_point, read_rig

    result = sonolube("friction", rigs / "tribometer.toml", "--model", "kinematic", "--json").answer
    expected = friction_point(read_rig(rigs / "tribometer.toml"), model="kinematic").friction_ratio
    same(result["friction_ratio"]["value"], expected)


@pytest.mark.parametrize("command", ["simulate", "response", "transient"])
def test_a_command_on_motion_answers_with_status_or_files_and_writes_them_whole(
    command: str, tmp_path: Path, sonolube: Program, rigs: Path
) -> None:
    extra = ["--out", tmp_path, *(["--duration", "0.01s"] if command == "transient" else [])]
    result = sonolube(command, rigs / "tribometer.toml", *extra, "--json").answer
    files = [Path(name) for name in result["files"]]
    assert sorted(files) == sorted(tmp_path.iterdir())
    assert all(path.stat().st_size > 1000 for path in files)
    assert sorted(path.suffix for path in files) == [".nc", ".pdf", ".png", ".svg"]


def test_heat_and_regime_answer_with_the_figure_they_wrote(tmp_path: Path, sonolube: Program, rigs: Path) -> None:
    rig = rigs / "tribometer.toml"
    solids = ["--pin", "stainless_steel_316", "--disc", "aluminium_2024", "--out", tmp_path, "--json"]
    heat = sonolube("thermal", rig, *solids).answer
    assert heat["temperature_rise_ratio"]["value"] == approx(heat["friction_ratio"]["value"])
    lubricant = ["--film-coefficient", "0.25", "--asperity-pressure", "10MPa"]
    regime = sonolube("regime", rig, *lubricant, *solids).answer
    assert regime["best"] == "ultrasonic"
    assert regime["wear"]["kind"] == "abrasive"
    assert sorted(map(Path, [*heat["files"], *regime["files"]])) == sorted(tmp_path.iterdir())


def test_friction_says_what_it_leaves_out_as_compare_has_it(sonolube: Program, rigs: Path, tmp_path: Path) -> None:
    rig = rigs / "tribometer.toml"
    error = sonolube("friction", rig, "--json").answer["model_error"]
    models = sonolube("compare", "--model", "asperity-stick-slip", "--json", "--out", tmp_path).answer["models"]
    assert error == {"rms": approx(models[0]["errors"]["rms_cross_validated"]), "tests": 15}
    assert f"the error of the model: +-{error['rms']:.2g} in the ratio on 15" in sonolube("friction", rig).out
    other = sonolube("friction", rig, "--set", "friction.memory_length=1um")
    assert "which with these parameters is not known" in other.out


def test_an_amplitude_beyond_all_tests_is_said_before_the_table(sonolube: Program, rigs: Path) -> None:
    # R_q 0.84 um: the decay length is 0.28 um, and 2.5 um are 9 of them; the welder's 11.5 um on 6 um are 5.7
    rough = ("--set", "contact.roughness.rms_height=0.84um")
    run = sonolube("friction", rigs / "tribometer.toml", *rough)
    assert run.code == 0, run.err
    title, caveat, *table = run.out.splitlines()
    assert "3 N" in title
    assert caveat.startswith("  caveat: the amplitude is 8.9")
    assert "5.7" in caveat
    assert not any("decay lengths" in line for line in table)
    said = sonolube("friction", rigs / "tribometer.toml", *rough, "--json").answer["caveats"]
    assert "decay lengths" in said[0]
    within = sonolube("friction", rigs / "tribometer.toml", "--json").answer["caveats"]
    assert not any("decay lengths" in each for each in within)


@pytest.mark.parametrize("command", ["friction", "simulate", "sweep", "map"])
def test_a_vibration_that_drives_the_slider_is_said_to(
    command: str, sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    options: dict[str, tuple[str, ...]] = {
        "friction": (),
        "simulate": ("--out", str(tmp_path)),
        "sweep": ("--over", "sliding.sliding_speed=20.3mm/s", "--out", str(tmp_path)),
        "map": (
            *("--over", "sliding.sliding_speed=15mm/s,20.3mm/s", "--over", "drive.voltage_peak_to_peak=20V,28V"),
            *("--out", str(tmp_path), "--form", "png"),
        ),
    }
    changes = ("--set", "friction.in_plane_fraction=0.5")
    answer = sonolube(command, rigs / "tribometer.toml", *changes, *options[command], "--json").answer
    assert any("drives the sliding" in caveat for caveat in answer["caveats"])


@pytest.mark.parametrize(
    ("command", "options"),
    [
        ("thermal", ("--pin", "stainless_steel_316", "--disc", "aluminium_2024")),
        ("regime", ("--film-coefficient", "0.25", "--asperity-pressure", "10MPa")),
    ],
)
def test_heat_and_lubrication_are_refused_where_the_vibration_drives(
    command: str, options: tuple[str, ...], sonolube: Program, rigs: Path
) -> None:
    refused = sonolube(command, rigs / "tribometer.toml", *options, "--set", "friction.in_plane_fraction=0.5")
    assert "the vibration drives the sliding" in refused.refusal
    assert "lower the vibration or friction.in_plane_fraction" in refused.refusal


@pytest.mark.parametrize("rig", ["collar", "flextensional", "poisson_al_steel"])
def test_a_stated_sine_says_why_it_has_no_dissipated_power(
    rig: str, sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    path, changes = rigs / f"{rig}.toml", ("--over", "sliding.sliding_speed=20mm/s")
    alone = sonolube("simulate", path, "--out", tmp_path / "one", "--json").answer
    swept = sonolube("sweep", path, *changes, "--out", tmp_path / "swept", "--json").answer
    assert "no dissipated power: the vibration is a sine" in alone["energy_balance"]
    assert swept["least_friction"]["energy_balance"] == alone["energy_balance"]
