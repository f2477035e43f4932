"""Rig files: what is read, and that nothing unreadable gets through with more than one clear line."""

import contextlib
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.rig import (
    Rig,
    contact_point,
    friction_point,
    read_rig,
    rig_content,
    rig_from,
    rig_schema,
    steady_vibration,
    structure_entries,
    wear_point,
)
from sonolube.rig.file.reader import structure_by_stack
from sonolube.rig.file.toml_file import tables_of

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
NAMES = (
    "poisson_al_steel",
    "poisson_steel_al",
    "poisson_steel_steel",
    "flextensional",
    "tribometer",
    "welder_round",
    "welder_flat",
    "power_map",
    "cutter_head",
    "finger_on_glass",
    "pom_on_steel",
    "webbing_on_ring",
    "collar",
    "coated_plate",
    "coated_temperature",
)
TRIBOMETER = (RIGS / "tribometer.toml").read_text(encoding="utf-8")


def changed(old: str, new: str) -> dict[str, Any]:
    assert old in TRIBOMETER
    return tomllib.loads(TRIBOMETER.replace(old, new))


def test_the_rigs_of_the_dissertation_and_others_are_there() -> None:
    others = {"tribometer_uncertain", "contact_resonance", "bronze_bush", "vibrating_base"}
    assert {path.stem for path in RIGS.glob("*.toml")} == {*NAMES, *others}


@pytest.mark.parametrize("name", NAMES)
def test_every_example_rig_has_contact_friction_and_wear(name: str) -> None:
    rig = read_rig(RIGS / f"{name}.toml")
    assert contact_point(rig).separation > 0
    assert 0 < friction_point(rig).friction_ratio < 1
    wear = wear_point(rig)
    assert 0 < wear.wear_rate_ratio < 1 or (wear.reason or "").startswith("outside_model_range")


@pytest.mark.parametrize("source", ["measured", "computed", "per-volt"])
def test_the_tribometer_wears_as_table_3_4_prints_by_every_source_of_its_amplitude(source: str) -> None:
    wear = wear_point(read_rig(RIGS / "tribometer.toml", changes=[f"vibration.amplitude_source={source}"]))
    assert wear.intrinsic_wear_rate * 1e9 == approx(2.566e-2, abs=0.5e-5)  # mm3/m
    assert wear.wear_rate * 1e9 == approx(1.355e-2, rel=1e-3)  # half a digit of 2.5 um moves it by 1 %


def test_wear_about_the_gap_at_rest_states_the_rise_of_a_computed_motion() -> None:
    # l ln I0(a/l) with 2.5 um and 2 um: 0.72 um
    computed, stated = (
        wear_point(read_rig(RIGS / "tribometer.toml", changes=[f"vibration.amplitude_source={source}"])).caveats
        for source in ("computed", "per-volt")
    )
    assert any("has its mean gap 71" in caveat for caveat in computed)
    assert not any("mean gap" in caveat for caveat in stated)


def test_the_tribometer_draws_the_power_of_equation_1_9() -> None:
    # 360 nF, 28 V, 28 V peak to peak, 22 kHz
    power = friction_point(read_rig(RIGS / "tribometer.toml")).power
    assert power is not None
    assert power.charging_power == approx(360e-9 * 28 * 28 * 22e3)


def test_half_the_voltage_gives_half_the_amplitude() -> None:
    rig = read_rig(RIGS / "tribometer.toml", changes=["drive.voltage_peak_to_peak=14V"])
    assert steady_vibration(rig).vibration_amplitude == approx(1.25e-6, rel=1e-3)


def test_units_of_any_size_mean_the_same_rig() -> None:
    def load(text: str) -> float:
        return rig_from(changed('normal_load = "3 N"', f'normal_load = "{text}"')).normal_load

    assert load("3 N") == load("3000 mN") == load("0.003 kN") == 3.0


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("rms_height", "rms_heigth", "contact.roughness.rms_heigth: unknown key; did you mean rms_height?"),
        ('"3 N"', '"40 mm"', "contact.normal_load: 40 mm is a length; expected a force, such as 40N"),
        ('"3 N"', '"-3 N"', "normal_load must be positive, got -3.0 N"),
        ('"3 N"', '"0 N"', "normal_load must be positive, got 0.0 N"),
        ('"3 N"', "3", "contact.normal_load: 3 has no unit; expected a force, such as 40N"),
        ('"3 N"', '"3e-251 N"', "contact.normal_load: 3e-251 N lies beyond any rig"),
        ('"3 N"', "nan", "contact.normal_load: nan has no unit; expected a force, such as 40N"),
        ('"3 N"', "true", "contact.normal_load: True is not a force, such as 40N"),
        ('"6 um"', '"-6 um"', "contact.roughness: rms_height must be positive, got -6e-06 m"),
        ('"22 kHz"', '"0 Hz"', "drive: frequency must be positive, got 0.0 Hz"),
        ("0.341", "nan", "friction.friction_coefficient: Input should be a finite number"),
        ("0.33", "0.7", "contact.pair: poisson_ratio must lie between 0 and 0.5, got 0.7"),
        ('"2.25 mm2"', '"0 mm2"', "contact: nominal_area must be positive, got 0.0 m2"),
        ('normal_load = "3 N"', "", "contact.normal_load: missing"),
    ],
)
def test_a_bad_entry_is_refused_by_key_and_value(old: str, new: str, complaint: str) -> None:
    with pytest.raises(InvalidInput) as refusal:
        rig_from(changed(old, new))
    assert complaint in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_load_that_closes_the_gap_is_refused_with_the_remedy() -> None:
    with pytest.raises(InvalidInput, match=r"contact.normal_load 1e\+08 N leaves no separation .* lower the load"):
        contact_point(rig_from(changed('"3 N"', '"1e8 N"')))


def test_a_rig_without_any_vibration_is_refused() -> None:
    content = tomllib.loads((RIGS / "cutter_head.toml").read_text())
    with pytest.raises(InvalidInput, match=r"no vibration: give vibration\.vibration_amplitude"):
        rig_from({key: value for key, value in content.items() if key not in ("vibration", "assumptions")})


def test_conditions_of_a_measurement_without_its_amplitude_are_refused() -> None:
    with pytest.raises(InvalidInput, match="drive and load of a measurement need vibration_amplitude"):
        read_rig(RIGS / "collar.toml", changes=["vibration.frequency=22kHz"])


def test_an_assumption_about_nothing_is_refused() -> None:
    content = tomllib.loads(TRIBOMETER)
    content["assumptions"] = {"contact.colour": "grey"}
    with pytest.raises(InvalidInput, match=r"assumptions\.contact\.colour: the file has no entry contact\.colour"):
        rig_from(content)


def test_an_unknown_material_is_answered_with_the_closest() -> None:
    text = (RIGS / "poisson_al_steel.toml").read_text(encoding="utf-8").partition("[stack]")[0]
    text = text.replace("aluminium_2024", "aluminium_2042")
    text = text.replace('youngs_modulus = "73 GPa"\n', "")
    with pytest.raises(InvalidInput, match=r"contact\.softer: unknown material 'aluminium_2042'; did you mean"):
        rig_from(tomllib.loads(text))


def test_a_property_without_a_source_is_asked_for_by_name() -> None:
    text = (RIGS / "cutter_head.toml").read_text(encoding="utf-8")
    text = text.replace('youngs_modulus = "1 MPa"\n', 'material = "powder_coating"\n', 1)
    with pytest.raises(InvalidInput, match="powder_coating has no youngs_modulus: no source is known"):
        rig_from(tomllib.loads(text))


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"title = ", "not valid TOML"),
        (b"\xff\xfe\x00", "not UTF-8 text: byte 0xff at 0"),
        (b"a = " + b"[" * 100_000, "not valid TOML"),
        (b"#" * 1_000_001, "larger than a rig file can be"),
    ],
)
def test_an_unreadable_file_is_refused_by_name(tmp_path: Path, content: bytes, complaint: str) -> None:
    path = tmp_path / "rig.toml"
    path.write_bytes(content)
    with pytest.raises(InvalidInput) as refusal:
        read_rig(path)
    assert str(refusal.value).startswith(f"{path}: {complaint}")


def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"none\.toml: no such file"):
        read_rig(tmp_path / "none.toml")
    with pytest.raises(InvalidInput, match="cannot be read"):
        read_rig(tmp_path)


def test_the_schema_knows_every_key_of_every_example() -> None:
    schema = rig_schema()

    def check(content: dict[str, Any], entry: dict[str, Any]) -> None:
        for key, value in content.items():
            assert key in entry["properties"], key
            if isinstance(value, dict) and key not in ("assumptions", "uncertainty"):
                tables = [schema["$defs"][name] for name in tables_of(entry["properties"][key])]
                check(value, max(tables, key=lambda table: len(value.keys() & table["properties"].keys())))

    for name in NAMES:
        check(tomllib.loads((RIGS / f"{name}.toml").read_text(encoding="utf-8")), schema)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=12),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=12), inner, max_size=3),
    max_leaves=12,
)


@given(data=st.data())
@examples(300)
def test_whatever_stands_in_a_rig_file_gives_a_rig_or_one_clear_line(data: st.DataObject) -> None:
    content = tomllib.loads(TRIBOMETER)
    places: list[tuple[dict[str, Any], str]] = []

    def collect(table: dict[str, Any]) -> None:
        for key, value in table.items():
            places.append((table, key))
            if isinstance(value, dict):
                collect(value)

    collect(content)
    table, key = data.draw(st.sampled_from(places))
    action = data.draw(st.sampled_from(["replace", "remove", "add"]))
    if action == "remove":
        del table[key]
    else:
        quantity = st.builds("{} {}".format, st.floats(), st.sampled_from(["N", "um", "mm2", "Pa", "V", "Hz", ""]))
        table[key if action == "replace" else data.draw(st.text(max_size=8))] = data.draw(JSON | quantity)
    with contextlib.suppress(InvalidInput):
        rig = rig_from(content)
        assert isinstance(rig, Rig)
        friction_point(rig)


def test_entries_of_a_pin_on_disc_chain_are_in_si_and_another_structure_has_none() -> None:
    content = rig_content(RIGS / "tribometer.toml")
    entries = structure_entries(content)
    assert entries["tip_mass"] == approx(0.1093)
    assert entries["arm_stiffness"] == approx(4.56e5)
    with raises(InvalidInput, match="structure: missing; give the tables stack and structure"):
        structure_entries(rig_content(RIGS / "cutter_head.toml"))


def test_the_structure_about_a_stack_takes_another_stack() -> None:
    rig = read_rig(RIGS / "tribometer.toml")
    stack, in_structure = structure_by_stack(rig)
    assert rig.stack is not None
    assert rig.structure is not None
    assert stack == rig.stack
    assert in_structure(stack).stiffness_matrix == approx(rig.structure.stiffness_matrix)
    softer = in_structure(replace(stack, stack_stiffness=0.5 * stack.stack_stiffness, coupling_factor=None))
    assert softer.stiffness_matrix[0, 0] == approx(0.5 * rig.structure.stiffness_matrix[0, 0], rel=1e-3)
    with raises(InvalidInput, match="the tables stack and structure are missing"):
        structure_by_stack(read_rig(RIGS / "cutter_head.toml"))


def test_a_rig_is_called_by_its_file_or_by_the_plain_characters_of_its_title() -> None:
    rig = read_rig(RIGS / "tribometer.toml", changes=["drive.frequency=21kHz"])
    assert (rig.name, rig.file, rig.changes) == ("tribometer", RIGS / "tribometer.toml", ("drive.frequency=21kHz",))
    made = rig_from(dict(rig.content()) | {"title": "My Rig: No. 2 (ä)"})
    assert (made.file, made.changes, made.name) == (None, (), "my-rig-no-2-ä")
    assert rig_from(dict(rig.content()) | {"title": "?!"}).name == "rig"
