"""Variables of a repeat: the steps written out by hand, conditions of prompts, and what is refused."""

import re
import tomllib
from pathlib import Path
from typing import get_args

import pytest

from sonolube.errors import InvalidInput
from sonolube.facts.materials import material_names
from sonolube.facts.protocol import (
    Prompt,
    Protocol,
    flattened,
    protocol_at,
    protocol_by_name_or_file,
    protocol_from,
    protocol_text,
)

HEAD = 'title = "t"\nsource = "s"\n[limits]\nvoltage_maximum = "60 V"\nduration_maximum = "1 h"\n'
TABLE = """
[[steps]]
kind = "repeat"
over.speed = ["20 mm/s", "40 mm/s", "60 mm/s"]
over.voltage = ["0 V", "10 V", "20 V", "30 V"]
[[steps.steps]]
kind = "motor_speed"
sliding_speed = "{speed}"
[[steps.steps]]
kind = "drive"
voltage_peak_to_peak = "{voltage}"
frequency = "22 kHz"
[[steps.steps]]
kind = "wait"
duration = "2 s"
reason = "{speed} at {voltage}"
"""


def protocol_of(steps: str) -> Protocol:
    return protocol_from(tomllib.loads(HEAD + steps))


def test_three_speeds_by_four_voltages_are_twelve_settings_the_last_variable_fastest() -> None:
    found = [
        (round(1e3 * (point.sliding_speed or 0)), point.voltage_peak_to_peak)
        for point in flattened(protocol_of(TABLE))
        if point.kind == "wait"
    ]
    assert found == [(speed, volts) for speed in (20, 40, 60) for volts in (0.0, 10.0, 20.0, 30.0)]


def test_a_protocol_with_variables_reads_back_from_its_text() -> None:
    protocol = protocol_of(TABLE)
    assert protocol_from(tomllib.loads(protocol_text(protocol))) == protocol


def test_inner_repeats_take_the_variables_of_outer_ones() -> None:
    nested = TABLE.replace('over.voltage = ["0 V", "10 V", "20 V", "30 V"]\n', "").replace(
        '[[steps.steps]]\nkind = "drive"\nvoltage_peak_to_peak = "{voltage}"',
        '[[steps.steps]]\nkind = "repeat"\ncount = 2\n[[steps.steps.steps]]\nkind = "wait"\nduration = "1 s"\n'
        'reason = "{speed}"\n[[steps.steps]]\nkind = "drive"\nvoltage_peak_to_peak = "5 V"',
    )
    nested = nested.replace("{speed} at {voltage}", "end")
    points = flattened(protocol_of(nested))
    assert [round(1e3 * (point.sliding_speed or 0)) for point in points if point.kind == "wait"] == [
        speed for speed in (20, 40, 60) for _ in range(3)
    ]


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (('over.speed = ["20 mm/s", "40 mm/s", "60 mm/s"]', "over.speed = []"), "over.speed"),
        (('over.speed = ["20 mm/s", "40 mm/s", "60 mm/s"]', "over.speed = [20]"), "over.speed"),
        (('over.speed = ["20 mm/s", "40 mm/s", "60 mm/s"]', 'over.velocity = ["1 m/s"]'), "no step uses {velocity}"),
        (('"40 mm/s"', '"40 V"'), "sliding_speed"),
        (('over.speed = ["20 mm/s", "40 mm/s", "60 mm/s"]\n', ""), "sliding_speed"),
        (("over.", "overs."), "needs count, or over"),
    ],
)
def test_faults_of_variables_are_refused_with_their_place(change: tuple[str, str], reason: str) -> None:
    with pytest.raises(InvalidInput, match="step 1") as refusal:
        protocol_of(TABLE.replace(*change))
    assert reason in str(refusal.value)


def test_more_steps_than_a_protocol_may_have_are_refused() -> None:
    many = ", ".join(f'"{number} mm/s"' for number in range(1, 1000))
    with pytest.raises(InvalidInput, match="at most 10000"):
        protocol_of(TABLE.replace('"20 mm/s", "40 mm/s", "60 mm/s"', many))


def test_prompts_set_load_and_lubricant_for_what_follows() -> None:
    points = flattened(protocol_by_name_or_file("lubrication_comparison"))
    found = [(point.normal_load, point.lubricant) for point in points if point.kind == "acquire"]
    dry, oiled = [(load, "") for load in (3.0, 6.0, 9.0)], [(load, "Molykote") for load in (3.0, 6.0, 9.0)]
    assert found == [*dry, *dry, *oiled, *oiled]


def test_a_protocol_at_another_load_and_speed_keeps_its_times_and_voltages() -> None:
    before = protocol_by_name_or_file("map_test")
    after = protocol_at(before, normal_load=3.0, sliding_speed=0.02)
    old, new = flattened(before), flattened(after)
    assert [point.voltage_peak_to_peak for point in new] == [point.voltage_peak_to_peak for point in old]
    assert [point.time for point in new] == [point.time for point in old]
    assert {point.sliding_speed for point in new} == {0.0, 0.02}
    assert {point.normal_load for point in new[:-1]} == {3.0}
    assert after.title.endswith("3 N and 20 mm/s")


def test_a_recording_may_begin_as_another_ends_whatever_the_rounding_of_their_times() -> None:
    step = '[[steps]]\nkind = "acquire"\nchannels = ["voltage"]\nsample_rate = "1 kHz"\nduration = "{0} s"\n'
    wait = '[[steps]]\nkind = "wait"\nduration = "{0} s"\n'
    part = (step + wait).format("0.1") * 3 + (step + wait).format("76.925") + (step + wait).format("1.05")
    assert flattened(protocol_of(part * 5))[-1].time == pytest.approx(5 * (0.3 + 76.925 + 1.05))


def test_the_protocol_of_the_page_on_writing_one_has_its_settings() -> None:
    page = (Path(__file__).parents[3] / "docs" / "protocols.md").read_text(encoding="utf-8")
    protocol = protocol_from(tomllib.loads(page.split("```toml\n")[1].split("```")[0]))
    settings = {
        (point.normal_load, point.sliding_speed, point.voltage_peak_to_peak)
        for point in flattened(protocol)
        if point.kind == "wait" and point.sliding_speed
    }
    assert len(settings) == 2 * 3 * 4
    assert protocol.metadata.operator == "Ann"
    tasks = re.findall(r"`(\w+)`", page.partition("The `task` of a prompt is")[2].partition(".")[0])
    assert tuple(tasks) == get_args(Prompt.model_fields["task"].annotation)


def test_every_material_of_a_part_in_the_documentation_is_one_of_the_catalogue() -> None:
    pages = sorted((Path(__file__).parents[3] / "docs").rglob("*.md"))
    named = [
        (page.name, name)
        for page in pages
        for name in re.findall(r'(?:pin|disc)_material = "(\w+)"', page.read_text(encoding="utf-8"))
    ]
    assert ("protocols.md", "brass_c36000") in named
    assert [each for each in named if each[1] not in material_names()] == []
