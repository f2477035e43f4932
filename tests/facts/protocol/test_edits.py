"""Protocols edited as text: comments stay, every example survives a move there and back, bad keys are one line."""

import tomllib
from typing import Any

import pytest
from hypothesis import given, strategies as st
from pytest import raises

from sonolube.errors import SonolubeError
from sonolube.facts.protocol import (
    STEP_KINDS,
    edited_protocol_text,
    protocol_faults,
    protocol_fields,
    protocol_from,
    protocol_names,
    protocol_path,
    protocol_steps,
)

TEXT = """# A test.
title = "short" # of the test
source = "none"

[limits]
voltage_maximum = "30 V" # of the stack
duration_maximum = "100 s"

# first
[[steps]]
kind = "wait"
duration = "1 s" # to settle

# second
[[steps]]
kind = "repeat"
over = { speed = ["10 mm/s", "20 mm/s"] }

[[steps.steps]]
kind = "motor_speed"
sliding_speed = "{speed}"

[[steps.steps]]
kind = "acquire"
channels = ["friction_force", "temperature"]
sample_rate = "400 Hz"
duration = "2 s"

[[steps.steps]]
kind = "wait"
duration = "2 s"

# third
[[steps]]
kind = "voltage_steps"
voltages = ["5 V", "10 V"]
step_duration = "1 s"
frequency = "22 kHz"
unipolar = true
"""


def content(text: str) -> dict[str, Any]:
    return tomllib.loads(text)


def test_fields_are_the_entries_as_they_are_written_and_those_that_may_be() -> None:
    steps = {step.number: step for step in protocol_steps(content(TEXT))}
    assert list(steps) == ["1", "2", "2.1", "2.2", "2.3", "3"]
    assert [step.depth for step in steps.values()] == [0, 0, 1, 1, 1, 0]
    fields = {field.key: field for step in steps.values() for field in step.fields}
    assert (fields["steps.2.2.channels"].text, fields["steps.2.2.channels"].kind) == (
        "friction_force, temperature",
        "list",
    )
    assert (fields["steps.2.over.speed"].text, fields["steps.2.over.speed"].kind) == ("10 mm/s, 20 mm/s", "list")
    assert (fields["steps.3.unipolar"].text, fields["steps.3.unipolar"].kind) == ("true", "flag")
    assert fields["steps.3.waveform"].choices == ("sine", "square", "triangle", "sawtooth")
    duration = fields["steps.1.duration"]
    assert (duration.text, duration.unit, duration.is_required, duration.kind) == ("1 s", "s", True, "quantity")
    limits = {field.name: field for field in protocol_fields(content(TEXT), "limits")}
    assert (limits["voltage_maximum"].text, limits["temperature_maximum"].text) == ("30 V", "")
    assert limits["temperature_maximum"].unit == "K"


def test_entries_are_replaced_and_comments_stay() -> None:
    changes = {
        "steps.1.duration": "4 s",
        "steps.2.2.channels": "friction_force",
        "steps.2.over.speed": "5 mm/s, 6 mm/s, 7 mm/s",
        "steps.3.unipolar": "false",
        "limits.temperature_maximum": "60 degC",
        "metadata.pin_material": "M50",
        "title": "longer",
    }
    edited = edited_protocol_text(TEXT, changes)
    assert [line for line in TEXT.splitlines() if "#" in line and "=" not in line] == [
        line for line in edited.splitlines() if "#" in line and "=" not in line
    ]
    for comment in ("# of the test", "# of the stack", "# to settle"):
        assert comment in edited
    found = content(edited)
    assert found["title"] == "longer"
    assert found["steps"][0]["duration"] == "4 s"
    assert found["steps"][1]["over"]["speed"] == ["5 mm/s", "6 mm/s", "7 mm/s"]
    assert found["steps"][1]["steps"][1]["channels"] == ["friction_force"]
    assert found["steps"][2]["unipolar"] is False
    assert (found["limits"]["temperature_maximum"], found["metadata"]) == ("60 degC", {"pin_material": "M50"})
    protocol_from(found)
    back = edited_protocol_text(edited, {"limits.temperature_maximum": "", "metadata.pin_material": ""})
    assert "temperature_maximum" not in back


@pytest.mark.parametrize("kind", STEP_KINDS)
@pytest.mark.parametrize("before", ["1", "2.2", "2.4", "4"])
def test_a_step_of_each_kind_is_inserted_where_it_is_wanted_and_removed_again(kind: str, before: str) -> None:
    edited = edited_protocol_text(TEXT, {"insert": {"before": before, "kind": kind}})
    step = next(each for each in protocol_steps(content(edited)) if each.number == before)
    assert step.kind == kind
    if not (kind == "acquire" and before.startswith("2.")):  # of which one would begin within another
        assert protocol_faults(content(edited)) == ()
    assert content(edited_protocol_text(edited, {"remove": before})) == content(TEXT)
    assert edited.count("#") == TEXT.count("#")


@pytest.mark.parametrize(
    ("step", "before", "order"), [("1", "4", [1, 2, 0]), ("3", "1", [2, 0, 1]), ("2", "2", [0, 1, 2])]
)
def test_a_step_is_moved_with_those_within_it(step: str, before: str, order: list[int]) -> None:
    edited = content(edited_protocol_text(TEXT, {"move": {"step": step, "before": before}}))
    assert edited["steps"] == [content(TEXT)["steps"][place] for place in order]


@pytest.mark.parametrize("name", protocol_names())
def test_protocols_of_the_dissertation_have_fields_that_change_nothing_when_written_back(name: str) -> None:
    text = protocol_path(name).read_text(encoding="utf-8")
    fields = [field for step in protocol_steps(content(text)) for field in step.fields]
    fields += [field for table in ("limits", "metadata") for field in protocol_fields(content(text), table)]
    edited = edited_protocol_text(
        text, {field.key: field.text for field in fields if ", " not in field.text or field.kind == "list"}
    )
    assert content(edited) == content(text)
    count = len(content(text)["steps"])
    if count > 1:
        there = edited_protocol_text(text, {"move": {"step": "1", "before": str(count + 1)}})
        back = edited_protocol_text(there, {"move": {"step": str(count), "before": "1"}})
        assert content(back) == content(text)


BAD = (
    {"steps.9.duration": "1 s"},
    {"steps.1.speed": "1 s"},
    {"steps.0.duration": "1 s"},
    {"steps..duration": "1 s"},
    {"steps": "1 s"},
    {"limits": "1 s"},
    {"limits.a.b": "1 s"},
    {"": ""},
    {"steps.1": ""},
    {"title": 3},
    {"insert": "1"},
    {"insert": {"before": "1", "kind": "fly"}},
    {"insert": {"before": "5", "kind": "wait"}},
    {"insert": {"kind": "wait"}},
    {"remove": "7"},
    {"remove": ["1"]},
    {"move": {"step": "1", "before": "2.1"}},
    {"move": "1"},
    {"steps.3.unipolar": "yes"},
    {"steps.1.steps.duration": "1 s"},
    {"steps.1.over.speed": "1 s"},
)


@pytest.mark.parametrize("changes", BAD)
def test_changes_that_make_no_sense_are_one_line(changes: dict[str, Any]) -> None:
    with raises(SonolubeError) as refusal:
        edited_protocol_text(TEXT, changes)
    assert "\n" not in str(refusal.value)
    assert str(refusal.value)


def assert_made_or_refused(text: str, changes: dict[str, Any]) -> None:
    refusals = []
    try:
        content(edited_protocol_text(text, changes))
    except SonolubeError as refusal:
        refusals.append(str(refusal))
    assert not any("\n" in each for each in refusals)


@given(
    st.dictionaries(
        st.one_of(
            st.text(max_size=12), st.sampled_from(["insert", "remove", "move", "steps.2.1.sliding_speed", "steps.1"])
        ),
        st.recursive(
            st.one_of(st.text(max_size=8), st.integers(), st.none()),
            lambda each: st.dictionaries(st.text(max_size=6), each),
        ),
        max_size=3,
    )
)
def test_any_changes_are_made_or_refused(changes: dict[str, Any]) -> None:
    assert_made_or_refused(TEXT, changes)


@pytest.mark.parametrize(
    "text", ["[[", "a = ", "steps = 3", 'steps = [{kind = "wait"}]', "title = 1\ntitle = 2", "\x00"]
)
def test_texts_that_are_no_protocol_are_refused_or_left(text: str) -> None:
    for changes in ({"steps.1.duration": "1 s"}, {"remove": "1"}, {"title": "a"}):
        assert_made_or_refused(text, changes)


def test_faults_have_the_keys_of_their_fields() -> None:
    text = TEXT.replace('"1 s" # to settle', '"1 N"').replace('"{speed}"', '"fast"').replace('"30 V"', '"30"')
    text = text.replace('over = { speed = ["10 mm/s", "20 mm/s"] }', "count = 2")
    assert [key for key, _ in protocol_faults(content(text))] == [
        "limits.voltage_maximum",
        "steps.1.duration",
        "steps.2.1.sliding_speed",
    ]
    assert protocol_faults(content(TEXT.replace('"30 V"', '"4 V"'))) == (
        ("steps.3", "step 3: the drive reaches 5 V; limits.voltage_maximum is 4 V"),
    )
    assert protocol_faults(content(TEXT)) == ()
