"""What a drawing or data sheet states in place of a number: Ra, Rz, finish, hardness and the roles of the bodies."""

import tomllib
from math import pi, sqrt
from pathlib import Path
from typing import Any

import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.facts.materials import yield_strength_from_hardness
from sonolube.rig import Rig, read_rig, rig_content, rig_from
from sonolube.text.units import to_si

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
STATED = """
title = "a"
source = "b"
[contact]
normal_load = "5 N"
nominal_area = "7 mm2"
[contact.roughness]
roughness_average = "0.8 um"
[contact.softer]
material = "aluminium_2024"
hardness = "137 HV"
role = "pin"
[contact.harder]
material = "ss304"
[friction]
friction_coefficient = 0.4
[sliding]
sliding_speed = "0.2 m/s"
[drive]
frequency = "20 kHz"
[vibration]
vibration_amplitude = "3 um"
"""


def rig(old: str = "", new: str = "", more: str = "") -> Rig:
    assert old in STATED
    return rig_from(tomllib.loads(STATED.replace(old, new) + more))


def test_gaussian_heights_have_the_rms_height_of_their_average() -> None:
    assert rig().contact.roughness.rms_height == approx(sqrt(pi / 2) * 0.8e-6)


def test_a_grade_lies_between_the_average_of_its_range() -> None:
    height = rig('roughness_average = "0.8 um"', 'finish = "ground N6"').contact.roughness.rms_height
    assert sqrt(pi / 2) * 0.4e-6 < height < sqrt(pi / 2) * 0.8e-6


@pytest.mark.parametrize("finish", ["Ra 0.8", "Ra 0.8um", "0.8um", "turned Ra 0.8"])
def test_a_finish_may_be_stated_by_its_number(finish: str) -> None:
    by_number = rig('roughness_average = "0.8 um"', f'finish = "{finish}"')
    assert by_number.contact.roughness == rig().contact.roughness
    assert f"stated as '{finish}'" in by_number.assumptions["contact.roughness.rms_height"]


def test_the_maximum_height_is_several_times_the_rms_height() -> None:
    height = rig('roughness_average = "0.8 um"', 'maximum_height = "4 um"').contact.roughness.rms_height
    assert 4e-6 / 8 < height < 4e-6 / 3


def test_a_vickers_number_is_kilograms_force_per_square_millimetre() -> None:
    assert to_si("137 HV", unit="Pa", name="hardness") == approx(137 * 9.80665 / 1e-6)


def test_hardness_gives_the_yield_strength_by_tabor() -> None:
    expected = yield_strength_from_hardness(hardness=137 * 9.80665e6).yield_strength
    assert rig().contact.pair.yield_strength == approx(expected)


def test_what_is_derived_carries_its_relation_and_its_spread() -> None:
    keys = {
        *(f"contact.roughness.{name}" for name in ("rms_height", "summit_radius", "summit_density")),
        "contact.softer.yield_strength",
    }
    assert set(rig().assumptions) == set(rig().uncertainty) == keys
    assert "Ra 800 nm" in rig().assumptions["contact.roughness.rms_height"]


def test_the_file_s_own_distribution_and_reason_stay() -> None:
    own = rig(more='[uncertainty]\n"contact.roughness.rms_height" = "normal 1 %"\n')
    assert own.uncertainty["contact.roughness.rms_height"].text.startswith("normal")
    reasoned = rig(more='[assumptions]\n"contact.roughness.roughness_average" = "of the drawing"\n')
    assert reasoned.assumptions["contact.roughness.rms_height"].startswith("of the drawing; from Ra")


def test_summits_that_the_file_gives_stay_and_are_certain() -> None:
    given = rig("[contact.softer]", 'summit_radius = "3 um"\n[contact.softer]')
    assert given.contact.roughness.summit_radius == 3e-6
    assert "contact.roughness.summit_radius" not in given.uncertainty


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[contact.softer]", 'finish = "N6"\n[contact.softer]', "give one of rms_height, .* got roughness_average and"),
        ("[contact.softer]", 'rms_height = "1 um"\n[contact.softer]', "got rms_height and roughness_average"),
        ('roughness_average = "0.8 um"', 'finish = "0.8"', "neither a unit nor Ra, Rz or Rq; write a process"),
        ('roughness_average = "0.8 um"', 'finish = "N66"', "contact.roughness: unknown surface finish 'n66'"),
        ('"0.8 um"', '"-0.8 um"', "contact.roughness: roughness_average must be positive"),
        ('"137 HV"', '"0 HV"', "contact.softer: hardness must be positive"),
        ('hardness = "137 HV"', 'yield_strength = "137 HV"', "yield_strength: 137 HV is a hardness"),
        ('role = "pin"', 'role = "pin"\nyield_strength = "1 GPa"', "give either yield_strength or hardness, got both"),
        ('"ss304"', '"ss304"\nrole = "pin"', 'softer.role and harder.role are both "pin"'),
    ],
)
def test_what_contradicts_itself_is_refused(old: str, new: str, message: str) -> None:
    with raises(InvalidInput, match=message):
        rig(old, new)


def test_a_distribution_of_what_is_stated_is_refused_with_the_number_to_give_it_to() -> None:
    with raises(InvalidInput, match=r"give the distribution of contact\.roughness\.rms_height"):
        rig(more='[uncertainty]\n"contact.roughness.roughness_average" = "normal 1 %"\n')


def test_either_body_may_say_which_one_it_is() -> None:
    assert (rig().pin_material, rig().disc_material) == ("aluminium_2024", "stainless_steel_304")
    turned = rig('role = "pin"\n[contact.harder]', '[contact.harder]\nrole = "pin"')
    assert (turned.pin_material, turned.disc_material) == ("stainless_steel_304", "aluminium_2024")
    untold = rig('role = "pin"\n', "")
    assert (untold.pin_material, untold.disc_material) == (None, None)


@pytest.mark.parametrize(
    ("change", "height"),
    [("contact.roughness.rms_height=2um", 2e-6), ("contact.roughness.roughness_average=2um", sqrt(pi / 2) * 2e-6)],
)
def test_a_change_takes_the_place_of_what_is_stated(tmp_path: Path, change: str, height: float) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(STATED)
    assert read_rig(path, changes=[change]).contact.roughness.rms_height == approx(height)


def test_a_file_of_numbers_is_read_as_it_stands() -> None:
    path = Path(__file__).parents[3] / "examples" / "rigs" / "tribometer_uncertain.toml"
    content: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
    assert dict(read_rig(path).assumptions) == content["assumptions"]
    assert set(read_rig(path).uncertainty) == set(content["uncertainty"])


def test_a_contact_has_either_both_bodies_or_their_pair() -> None:
    bodies = rig_content(RIGS / "cutter_head.toml")
    pair = rig_content(RIGS / "tribometer.toml")["contact"]["pair"]
    softer, harder = (bodies["contact"][name] for name in ("softer", "harder"))
    others = {key: value for key, value in bodies["contact"].items() if key not in ("softer", "harder", "pair")}
    rig_from(bodies | {"contact": others | {"softer": softer, "harder": harder}})
    for tables in (
        {},
        {"softer": softer},
        {"harder": harder},
        {"softer": softer, "pair": pair},
        {"harder": harder, "pair": pair},
        {"softer": softer, "harder": harder, "pair": pair},
    ):
        with raises(InvalidInput, match=r"give either both tables contact\.softer and contact\.harder, or the table"):
            rig_from(bodies | {"contact": others | tables})
    named = [dict(body) | {"role": "pin"} for body in (softer, harder)]
    with raises(InvalidInput, match=r'softer\.role and harder\.role are both "pin"; give one of them'):
        rig_from(bodies | {"contact": others | {"softer": named[0], "harder": named[1]}})
