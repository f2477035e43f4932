"""Requests of runs before anything is connected: what is asked for, in which bounds, and what a run is of."""

from typing import Any

import pytest
from pytest import raises
from tests.browser.laboratory import HEAD, RIG, SHORT

from sonolube.browser.lab.plan_view import devices, plan
from sonolube.browser.requests import Places
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.facts.protocol import protocol_names
from sonolube.laboratory.virtual_tribometer.simulation import CHANNELS

NOWHERE = Places(rigs={})


def asked(**more: Any) -> dict[str, Any]:
    return {"protocol": {"name": "short", "text": SHORT}, "rig": RIG, **more}


def test_the_virtual_tribometer_has_its_channels_with_units_and_the_protocols_of_the_dissertation() -> None:
    found = devices({}, NOWHERE)
    assert [each["name"] for each in found["protocols"]] == list(protocol_names())
    assert (found["devices"]["kind"], found["devices"]["title"]) == ("virtual", "virtual tribometer")
    channels = {each["name"]: each for each in found["devices"]["channels"]}
    assert set(channels) == set(CHANNELS)
    assert channels["friction_force"] == {"name": "friction_force", "label": "friction force", "unit": "N"}


def test_a_run_that_can_be_started_has_what_it_is_of_and_what_was_asked() -> None:
    found = plan(asked(seed=3, tags=[" a ", "", "b" * 90], facts={"operator": "Ann", "humidity": 40}), NOWHERE)
    about = found["about"]
    assert (about["protocol"], about["title"], about["seed"], about["is_virtual"]) == ("short", "Short", 3, True)
    assert (about["steps"], about["voltage_maximum"]) == (4, 30.0)
    assert about["total"] == pytest.approx(1.5)  # of the recording, which lasts longest
    assert about["rig"].startswith("Modified pin-on-disc tribometer")
    assert found["tags"] == ["a", "b" * 80]
    assert set(found["facts"]) == {"operator", "humidity"}
    assert (found["seed"], found["anyway"], found["rig"]) == (3, False, RIG)
    assert found["protocol"] == {"name": "short", "text": SHORT}
    assert plan(asked(), NOWHERE)["seed"] == 0
    assert plan(asked(seed=2**32 - 1), NOWHERE)["seed"] == 2**32 - 1


@pytest.mark.parametrize(
    ("more", "key", "words"),
    [
        ({"seed": -1}, "seed", "must be a whole number from 0"),
        ({"seed": 2**32}, "seed", "must be a whole number from 0"),
        ({"seed": True}, "seed", "must be a whole number"),
        ({"seed": 1.5}, "seed", "must be a whole number"),
        ({"anyway": 1}, "anyway", "say true or false"),
        ({"tags": "a"}, "tags", "give up to 50 texts"),
        ({"tags": [1]}, "tags", "give up to 50 texts"),
        ({"tags": ["a"] * 51}, "tags", "give up to 50 texts"),
        ({"facts": [1]}, "facts", "give up to 50 texts by name"),
        ({"facts": {str(number): "a" for number in range(51)}}, "facts", "give up to 50 texts by name"),
        ({"facts": {"a": True}}, "facts", "give texts or numbers by name"),
        ({"facts": {"a": [1]}}, "facts", "give texts or numbers by name"),
        ({"rig": None}, "rig", "needs a rig"),
    ],
)
def test_what_is_amiss_is_refused_by_its_name(more: dict[str, Any], key: str, words: str) -> None:
    with raises(InvalidInput, match=words) as refused:
        plan(asked(**more), NOWHERE)
    assert refused.value.key == key


def test_fifty_tags_and_facts_are_taken() -> None:
    found = plan(asked(tags=["a"] * 50, facts={f"fact_{number}": "a" for number in range(50)}), NOWHERE)
    assert (len(found["tags"]), len(found["facts"])) == (50, 50)


FAST = HEAD + '\n[[steps]]\nkind = "drive"\nvoltage_peak_to_peak = "500 V"\nfrequency = "22 kHz"\n'


def test_a_protocol_beyond_its_limits_is_not_started() -> None:
    with raises(SonolubeError):
        plan(asked(protocol={"name": "fast", "text": FAST}), NOWHERE)


def test_what_a_dry_run_refuses_may_be_started_anyway(monkeypatch: pytest.MonkeyPatch) -> None:
    class Dry:
        refusals = ("too hot",)

    monkeypatch.setattr("sonolube.laboratory.dry_run.dry_run", lambda protocol, *, rig: Dry())
    with raises(InvalidInput, match=r"^too hot; start it anyway, or change it$") as refused:
        plan(asked(), NOWHERE)
    assert refused.value.key == "protocol"
    assert plan(asked(anyway=True), NOWHERE)["anyway"] is True
    Dry.refusals = ("too hot", "too fast")  # type: ignore[assignment]
    with raises(SonolubeError) as both:
        plan(asked(), NOWHERE)
    assert "too fast; start it anyway, or change it" in str(getattr(both.value, "faults", ""))
