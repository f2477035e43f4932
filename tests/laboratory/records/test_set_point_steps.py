"""Set points of a part by notes written by hand: what each note changes, from which sample on, what is not known."""

import json
from typing import Any

import numpy as np
from pytest import approx

from sonolube.laboratory.records.documents import Document, ReadDocuments
from sonolube.laboratory.records.set_point_steps import SET_POINT_CHANNELS, SetPointSteps, set_point_steps

NAN = float("nan")


def note(kind: str, sample: int | None = None, *, time: object = 0.0, **facts: Any) -> tuple[str, Document]:
    return "event", {"time": time, "data": {"kind": kind, "sample": sample, "facts": json.dumps(facts)}}


def part(number: int, uid: str) -> tuple[str, Document]:
    return "descriptor", {"name": f"recording-{number}", "uid": uid}


def ended(uid: str) -> tuple[str, Document]:
    return "stream_datum", {"descriptor": uid}


def read(*documents: tuple[str, Document]) -> ReadDocuments:
    return ReadDocuments(documents=documents, whole_bytes=0, is_whole=True)


def values(steps: SetPointSteps, *numbers: int) -> dict[str, list[float]]:
    return {name: steps.at(name, np.array(numbers)).tolist() for name in steps.names}


def test_set_points_hold_from_their_sample_until_the_next_note_and_end_with_their_part() -> None:
    found = set_point_steps(
        read(
            note("prepared"),
            note("conditions", 0, normal_load=4.0),
            part(1, "a"),
            note("motor", 100, rotation_speed=2.0, sliding_speed=0.3),
            note("drive", 150, voltage_peak_to_peak=20.0, frequency=22e3),
            part(2, "b"),
            ended("b"),
            note("drive", 180, voltage_peak_to_peak=0.0, frequency=9.0),
            ended("a"),
            note("drive", 190, voltage_peak_to_peak=50.0, frequency=1e3),
        ),
        1,
        first_sample=100,
        facts={"normal_load": 3.0},
    )
    assert values(found, 100, 149, 150, 179, 180, 500) == {
        "sliding_speed_set": [0.3] * 6,  # at the first sample itself
        "motor_on": [1.0] * 6,
        "voltage_peak_to_peak_set": [0.0, 0.0, 20.0, 20.0, 0.0, 0.0],
        "frequency_set": [0.0, 0.0, 22e3, 22e3, 0.0, 0.0],  # none without a voltage
        "normal_load_set": [4.0] * 6,  # of the note, not of the facts
        "lubricant_set": [0.0] * 6,
        "recording_part": [1.0] * 6,
    }
    assert found.drives
    assert values(found, 50)["voltage_peak_to_peak_set"] == [0.0]


def test_what_no_note_and_no_fact_tells_is_not_known() -> None:
    bare = set_point_steps(read(part(2, "a")), 2, first_sample=0, facts={})
    assert bare.names == ("lubricant_set", "recording_part")
    assert values(bare, 3) == {"lubricant_set": [0.0], "recording_part": [2.0]}
    assert not bare.drives
    assert bare.at("normal_load_set", np.array([3])) == approx([NAN], nan_ok=True)
    loaded = set_point_steps(read(), 1, first_sample=0, facts={"normal_load": 3})
    assert values(loaded, 0)["normal_load_set"] == [3.0]
    assert SET_POINT_CHANNELS[:4] == ("sliding_speed_set", "motor_on", "voltage_peak_to_peak_set", "frequency_set")


def test_before_the_first_note_of_a_drive_it_was_off() -> None:
    found = set_point_steps(
        read(part(1, "a"), note("drive", 10, voltage_peak_to_peak=5.0, frequency=1e3)), 1, first_sample=0, facts={}
    )
    assert found.at("voltage_peak_to_peak_set", np.array([0, 9, 10])).tolist() == [0.0, 0.0, 5.0]
    assert found.at("frequency_set", np.array([9, 10])).tolist() == [0.0, 1e3]


def test_of_several_notes_at_one_sample_the_last_holds() -> None:
    first = note("drive", 10, voltage_peak_to_peak=5.0, frequency=1e3)
    second = note("drive", 10, voltage_peak_to_peak=7.0, frequency=2e3)
    late = note("drive", 4, voltage_peak_to_peak=9.0, frequency=3e3)  # counted before it, told after it
    found = set_point_steps(read(part(1, "a"), first, second), 1, first_sample=0, facts={})
    assert values(found, 9, 10)["frequency_set"] == [0.0, 2e3]
    found = set_point_steps(read(part(1, "a"), first, second, late), 1, first_sample=0, facts={})
    assert values(found, 9, 10)["frequency_set"] == [0.0, 3e3]
    unplaced = note("drive", None, voltage_peak_to_peak=9.0, frequency=3e3)
    found = set_point_steps(read(part(1, "a"), first, unplaced), 1, first_sample=0, facts={})
    assert values(found, 10)["voltage_peak_to_peak_set"] == [5.0]


def test_a_pause_switches_off_what_is_known_to_be_on_alone() -> None:
    motor = note("motor", 0, rotation_speed=2.0, sliding_speed=0.3)
    found = set_point_steps(read(part(1, "a"), motor, note("pause", 5)), 1, first_sample=0, facts={})
    assert values(found, 4, 5)["sliding_speed_set"] == [0.3, 0.0]
    assert values(found, 4, 5)["motor_on"] == [1.0, 0.0]
    assert "frequency_set" not in found.names


def test_a_motor_is_on_by_its_turns_else_by_its_speed_and_slides_as_far_as_that_is_known() -> None:
    told = [
        ({"rotation_speed": 2.0}, 1.0, NAN),  # the groove is not known
        ({"rotation_speed": 0.0}, 0.0, 0.0),
        ({"sliding_speed": 0.3}, 1.0, 0.3),
        ({"sliding_speed": 0.0}, 0.0, 0.0),
        ({"rotation_speed": 0.0, "sliding_speed": 0.3}, 0.0, 0.3),
        ({"rotation_speed": -1.0, "sliding_speed": 0.2}, 0.0, 0.2),
    ]
    for facts, on, slides in told:
        found = set_point_steps(read(part(1, "a"), note("motor", 0, **facts)), 1, first_sample=0, facts={})
        assert values(found, 0)["motor_on"] == [on]
        assert found.at("sliding_speed_set", np.array([0])) == approx([slides], nan_ok=True)
    nothing = set_point_steps(read(part(1, "a"), note("motor", 0)), 1, first_sample=0, facts={})
    assert nothing.names == ("lubricant_set", "recording_part")


def test_lubricants_are_numbered_in_the_order_in_which_they_came() -> None:
    kinds = [("oil", 0), ("", 1), ("grease", 2), ("oil", 3)]
    notes = [note("conditions", sample, lubricant=name) for name, sample in kinds]
    found = set_point_steps(read(part(1, "a"), *notes), 1, first_sample=0, facts={"normal_load": 2.0})
    assert values(found, 0, 1, 2, 3)["lubricant_set"] == [1.0, 0.0, 2.0, 1.0]
    assert values(found, 3)["normal_load_set"] == [2.0]
    assert found.lubricants == ["oil", "grease"]


def test_notes_that_tell_no_set_point_change_nothing() -> None:
    damaged: tuple[str, Document] = ("event", {"data": {"kind": "drive", "sample": 3, "facts": "{"}})
    listed: tuple[str, Document] = ("event", {"data": {"kind": "drive", "sample": 3, "facts": "[1]"}})
    others = note("gap", 3, missing=2), note("drive", 3, frequency=1e3), note("conditions", 3, normal_load="heavy")
    found = set_point_steps(read(part(1, "a"), damaged, listed, *others), 1, first_sample=0, facts={})
    assert found.names == ("lubricant_set", "recording_part")
    assert not found.drives


def test_notes_are_placed_by_their_time_in_a_part_of_another_clock() -> None:
    # 10 samples a second from sample 40 at 1000 s: 1000.25 s lies within sample 42, so that 43 is the first after it
    notes = [
        note("drive", 7, time=990.0, voltage_peak_to_peak=1.0, frequency=1e3),
        note("drive", 7, time=1000.25, voltage_peak_to_peak=2.0, frequency=1e3),
        note("drive", 7, time=1001.0, voltage_peak_to_peak=3.0, frequency=1e3),
        note("drive", 7, time="noon", voltage_peak_to_peak=4.0, frequency=1e3),
        note("drive", 7, time=2e11, voltage_peak_to_peak=5.0, frequency=1e3),
    ]
    found = set_point_steps(read(part(1, "a"), *notes), 1, first_sample=40, facts={}, own_clock=(1000.0, 10.0))
    assert found.at("voltage_peak_to_peak_set", np.array([40, 42, 43, 49, 50, 99])).tolist() == [1, 1, 2, 2, 3, 3]
