"""Protocols as page Lab shows them: starts and times of steps within repeats, fields with labels, and refusals."""

from typing import Any

import pytest
from pytest import approx, raises
from tests.browser.laboratory import HEAD, LONG, RIG

from sonolube.browser.lab.protocol_view import edited_protocol, protocol_view, read_text, requested_protocol
from sonolube.browser.requests import Places
from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.facts.protocol import STEP_KINDS, protocol_names, protocol_path

NOWHERE = Places(rigs={})
REPEATED = (
    HEAD
    + """
[[steps]]
kind = "motor_speed"
sliding_speed = "20 mm/s"

[[steps]]
kind = "wait"
duration = "2 s"

[[steps]]
kind = "repeat"
count = 3

  [[steps.steps]]
  kind = "acquire"
  channels = ["friction_force"]
  sample_rate = "100 Hz"
  duration = "1 s"

  [[steps.steps]]
  kind = "wait"
  duration = "4 s"
"""
)


def view(text: str = REPEATED, **more: Any) -> dict[str, Any]:
    return protocol_view({"protocol": {"name": "own", "text": text}, "rig": RIG, **more}, NOWHERE)


def test_steps_have_every_start_and_the_time_of_all_their_repeats() -> None:
    # 2 s of waiting, then three times 4 s, each with a recording of 1 s at its begin
    steps = {step["number"]: step for step in view()["steps"]}
    assert list(steps) == ["1", "2", "3", "3.1", "3.2"]
    assert [steps[number]["depth"] for number in steps] == [0, 0, 0, 1, 1]
    assert (steps["2"]["start"], steps["2"]["duration"]) == approx((0.0, 2.0))
    assert (steps["3"]["start"], steps["3"]["duration"]) == approx((2.0, 12.0))
    assert steps["3"]["starts"] == approx([2.0])
    assert steps["3.1"]["starts"] == approx([2.0, 6.0, 10.0])
    assert steps["3.1"]["duration"] == approx(3.0)  # of what it records
    assert steps["3.2"]["duration"] == approx(12.0)
    assert steps["3.2"]["starts"] == approx([2.0, 6.0, 10.0])
    assert (steps["1"]["kind"], steps["1"]["label"]) == ("motor_speed", "motor speed")


def test_a_view_has_the_total_time_its_prompts_and_limits_with_their_values() -> None:
    found = view()
    assert (found["name"], found["title"], found["source"], found["text"]) == ("own", "Short", "a test", REPEATED)
    assert found["total"] == approx(14.0)
    assert found["prompts"] == 0
    assert found["kinds"] == list(STEP_KINDS)
    limits = {each["key"].removeprefix("limits."): each for each in found["limits"]}
    assert (limits["voltage_maximum"]["upper"], limits["voltage_maximum"]["lower"]) == (approx(30.0), None)
    assert limits["voltage_maximum"]["label"] == "voltage maximum"
    assert limits["current_maximum"]["upper"] is None
    assert found["dry_run"]["answer"]["title"] == "Short"
    assert found["refusals"] == found["dry_run"]["answer"]["refusals"]
    assert view(LONG)["prompts"] == 1
    assert all(each["label"] == each["key"].removeprefix("metadata.").replace("_", " ") for each in found["metadata"])


def test_an_edit_is_seen_and_must_be_texts_by_keys() -> None:
    payload = {"protocol": {"name": "own", "text": REPEATED}}
    found = edited_protocol(payload | {"changes": {"steps.2.duration": "5 s"}}, NOWHERE)
    assert found["total"] == approx(17.0)
    assert 'duration = "5 s"' in found["text"]
    with raises(InvalidInput, match="give texts by keys") as refused:
        edited_protocol(payload | {"changes": [1]}, NOWHERE)
    assert refused.value.key == "changes"


def test_a_protocol_is_asked_for_by_name_or_with_its_text() -> None:
    name = protocol_names()[0]
    assert requested_protocol({"protocol": {"name": name}}) == (name, protocol_path(name).read_text(encoding="utf-8"))
    assert requested_protocol({"protocol": {"name": name, "text": ""}})[1] == protocol_path(name).read_text("utf-8")
    assert requested_protocol({"protocol": {"name": "own.toml", "text": "a"}}) == ("own", "a")
    assert requested_protocol({"text": "a"}) == ("protocol", "a")
    assert requested_protocol({"protocol": {"name": "n" * 80, "text": "a" * 200_000}})[0] == "n" * 80


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ([1], "give its name, or a name and its text"),
        ({"name": "../x", "text": "a"}, "is no name"),
        ({"name": ".x", "text": "a"}, "is no name"),
        ({"name": "n" * 81, "text": "a"}, "is no name"),
        ({"name": 3, "text": "a"}, "is no name"),
        ({"name": "x", "text": "a" * 200_001}, "must have up to 200000 characters"),
        ({"name": "x", "text": 3}, "must have up to 200000 characters"),
    ],
)
def test_names_and_texts_that_are_none_are_refused(asked: Any, words: str) -> None:
    with raises(InvalidInput, match=words) as refused:
        requested_protocol({"protocol": asked})
    assert refused.value.key == "protocol"


def test_one_fault_is_said_with_its_key_and_several_each_with_its_own() -> None:
    with raises(InvalidInput) as one:
        read_text(REPEATED.replace('"4 s"', '"4 N"'))
    assert "duration" in one.value.key
    with raises(SeveralFaults) as both:
        read_text(REPEATED.replace('"4 s"', '"4 N"').replace('"2 s"', '"2 N"'))
    assert len(both.value.faults) == len(both.value.keys) == 2
    protocol, content = read_text(REPEATED)
    assert (protocol.title, content["title"]) == ("Short", "Short")
