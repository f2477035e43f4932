"""Fields of a rig: labels, numbers in units of axes, and round ends of sliders a decade about the value of the file."""

from typing import Any

import pytest
from pytest import approx

import sonolube as sl
from sonolube.browser.requests import Places
from sonolube.browser.rig_view import rig_fields, rig_view
from sonolube.example_files import example_files

NOWHERE = Places(rigs={})


def field(text: Any, *, original: Any = None, key: str = "drive.frequency", **assumed: str) -> dict[str, Any]:
    """Field of one entry, whose file may have another value."""
    table, _, name = key.partition(".")
    before = {table: {name: text if original is None else original}}
    (found,) = rig_fields({table: {name: text}}, before, assumed)
    return found


def test_a_field_has_its_label_number_and_unit_as_written() -> None:
    found = field("22 kHz", **{"drive.frequency": "of the sheet"})
    assert {name: found[name] for name in ("key", "label", "text", "unit", "assumed", "is_first")} == {
        "key": "drive.frequency", "label": "Frequency", "text": "22 kHz", "unit": "kHz", "assumed": "of the sheet",
        "is_first": True,
    }  # fmt: skip
    word = field("sine", key="drive.own_word")
    assert (word["label"], word["unit"], word["lowest"], word["highest"]) == ("Own word", "", None, None)
    assert (word["numbers"], word["assumed"], word["is_first"]) == ({}, "", False)


@pytest.mark.parametrize(
    ("text", "original", "ends"),
    [
        ("22 kHz", "22 kHz", (2.0, 200.0)),  # 2.2 and 220, rounded to steps of a decade
        ("3 N", "3 N", (0.3, 30.0)),
        ("0.47 m", "0.47 m", (0.05, 5.0)),
        ("1.12 s", "1.12 s", (0.12, 12.0)),  # by ratio: 1.12/1 is more than 1.2/1.12
        ("9.1 V", "9.1 V", (1.0, 100.0)),
        ("21 kHz", "22 kHz", (2.0, 200.0)),  # of the file, also where the value was changed
        ("21 kHz", "22000 Hz", (2.0, 200.0)),  # in the unit of the value
        ("21 kHz", "22 N", None),
        ("0 V", "0 V", None),
        ("-3 V", "-3 V", None),
        ("nan V", "nan V", None),
        ("sine", "sine", None),
    ],
)
def test_a_slider_runs_over_a_decade_either_way_between_round_numbers(
    text: str, original: str, ends: tuple[float, float] | None
) -> None:
    found = field(text, original=original)
    assert (found["lowest"], found["highest"]) == ((None, None) if ends is None else approx(ends))


@pytest.mark.parametrize(
    ("key", "text", "numbers"),
    [
        # 22 kHz: no prefix below 1 Hz, for which the number is beyond ten million, and none above 1 GHz
        ("drive.frequency", "22 kHz", {"Hz": 22e3, "kHz": 22.0, "MHz": 0.022, "GHz": 2.2e-5}),
        ("contact.normal_load", "3 N", {"uN": 3e6, "mN": 3e3, "N": 3.0, "kN": 3e-3}),
        ("drive.voltage_peak_to_peak", "28 V", {"mV": 28e3, "V": 28.0, "kV": 0.028, "MV": 2.8e-5}),
        ("structure.tip_mass", "50 g", {"kg": 0.05}),
        ("friction.friction_coefficient", "0.2", {"": 0.2}),
        ("drive.frequency", "22 N", {}),
    ],
)
def test_a_value_has_its_number_with_each_prefix_that_leaves_it_readable(
    key: str, text: str, numbers: dict[str, float]
) -> None:
    assert field(text, key=key)["numbers"] == approx(numbers)


def test_entries_of_nested_tables_are_fields_and_remarks_are_none() -> None:
    content = {
        "title": "Own", "source": "a", "assumptions": {"x": "y"}, "uncertainty": {"x": "y"}, "notes": "n",
        "contact": {"roughness": {"rms_height": "1 um"}, "is_dry": True, "list": [1.0], "normal_load": 3.25},
    }  # fmt: skip
    found = {each["key"]: each["text"] for each in rig_fields(content, content, {})}
    assert found == {"contact.roughness.rms_height": "1 um", "contact.normal_load": "3.25"}


def test_the_view_of_a_rig_has_the_operating_point_first_and_what_its_drawing_shows() -> None:
    found = rig_view({"rig": {"name": "tribometer", "changes": {"contact.normal_load": "4 N"}}}, NOWHERE)
    first = [each["key"] for each in found["fields"] if each["is_first"]]
    assert [place for place, each in enumerate(found["fields"]) if each["is_first"]] == list(range(len(first)))
    assert first == [
        "drive.voltage_peak_to_peak", "vibration.vibration_amplitude", "drive.frequency", "sliding.sliding_speed",
        "contact.normal_load", "friction.friction_coefficient",
    ]  # fmt: skip
    load = next(each for each in found["fields"] if each["key"] == "contact.normal_load")
    assert (load["text"], load["lowest"], load["highest"]) == ("4 N", approx(0.3), approx(30.0))
    assert found["title"].startswith("Modified pin-on-disc tribometer")
    assert (found["drawing"]["has_drive"], found["drawing"]["has_structure"]) == (True, True)
    assert found["drawing"]["direction"] == "normal"
    assert "tribometer" in found["rigs"]
    assert {"voltage", "speed", "frequency", "power", "waveform", "load"} <= set(found["studies"])
    assert "velocity-power" in found["maps"]
    assert rig_view({"rig": {"name": "tribometer"}}, Places(rigs={"own": "own.toml"}))["rigs"][0] == "own"


def test_a_calibration_is_one_text_and_offered_where_nothing_scales_the_amplitude() -> None:
    known: dict[str, Any] = {"pin": "brass", "disc": "304", "load": 5.0, "speed": 0.2, "frequency": 20e3}
    plain, scaled = (sl.new(**known, amplitude=2e-6, **more) for more in ({}, {"calibration": "25V = 2um"}))

    def calibration(content: str) -> dict[str, Any]:
        rig = {"name": "own", "text": content, "changes": {}}
        found = rig_view({"rig": rig}, NOWHERE)["fields"]
        (one,) = [each for each in found if each["key"] == "vibration.calibration"]
        return dict(one)

    assert calibration(plain.rig_text)["text"] == ""
    stated = calibration(scaled.rig_text)
    assert (stated["text"], stated["unit"], stated["lowest"]) == ("25 V = 2 um", "", None)
    tribometer = rig_view({"rig": {"name": "tribometer", "changes": {}}}, NOWHERE)
    assert not [each for each in tribometer["fields"] if each["key"] == "vibration.calibration"]


@pytest.mark.parametrize("name", [name for name, each in example_files().items() if each.is_rig])
def test_the_sentence_on_a_rig_states_each_first_entry_once(name: str) -> None:
    found = rig_view({"rig": {"name": name, "changes": {}}}, NOWHERE)
    stated = [piece["key"] for piece in found["sentence"] if "key" in piece]
    assert not {*stated} ^ {each["key"] for each in found["fields"] if each["is_first"]}
    assert not [key for key in stated if stated.count(key) > 1]


def test_the_sentence_on_a_new_rig_has_the_end_of_its_pin_and_the_body_that_moves() -> None:
    known: dict[str, Any] = {"pin": "brass", "disc": "steel", "load": 3.0, "speed": 0.05, "frequency": 22e3}
    answer = sl.new(**known, amplitude=2.5e-6, shape="ball 2.5mm")
    text = answer.rig_text.replace("[vibration]", '[vibration]\nvibrating_body = "disc"')

    def stated(content: str) -> str:
        found = rig_view({"rig": {"name": "own", "text": content, "changes": {}}}, NOWHERE)
        texts = {each["key"]: each["text"] for each in found["fields"]}
        return "".join(piece.get("text") or texts[piece["key"]] for piece in found["sentence"])

    begin = "A brass pin of 2.5 mm radius on a steel disc, pressed with 3 N, sliding at 50 mm/s"
    assert stated(answer.rig_text).startswith(f"{begin}, vibrates along the normal at 22 kHz with 2.5 um.")
    assert stated(text).startswith(f"{begin}; the disc vibrates along the normal at 22 kHz")
