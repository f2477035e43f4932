"""Protocols: the map test of the dissertation, time lines by hand, faults with places, bounds, round trips."""

import json
import math
import random
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, strategies as st
from reliability.hostile_text import HOSTILE
from tests.tiers import examples
from tests.work import calls

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import (
    duration,
    flattened,
    protocol_from,
    protocol_path,
    protocol_schema,
    protocol_text,
    read_protocol,
)
from sonolube.facts.published import column_numbers, si_value

ROOT = Path(__file__).parents[3]
MAP_TEST = protocol_path("map_test")
LIMITS = {"voltage_maximum": "100 V", "duration_maximum": "2000 h"}


def content(*steps: dict[str, Any], **limits: str) -> dict[str, Any]:
    return {"title": "a test", "source": "nobody", "limits": LIMITS | limits, "steps": list(steps)}


def wait(text: str) -> dict[str, Any]:
    return {"kind": "wait", "duration": text}


def drive(volts: float) -> dict[str, Any]:
    return {"kind": "drive", "voltage_peak_to_peak": f"{volts} V", "frequency": "22 kHz"}


def test_the_map_test_lasts_as_long_as_the_dissertation_says() -> None:
    assert duration(read_protocol(MAP_TEST)) == pytest.approx(32.5)


def test_the_motor_of_the_map_test_starts_after_half_a_second_and_the_vibration_twelve_later() -> None:
    points = flattened(read_protocol(MAP_TEST))
    moving = [point for point in points if point.sliding_speed]
    driven = [point for point in points if point.voltage_peak_to_peak]
    assert moving[0].time == pytest.approx(0.5)
    assert driven[0].time == pytest.approx(12.5)


def test_the_map_test_steps_through_the_voltages_of_table_4_1_for_four_seconds_each() -> None:
    driven = [point for point in flattened(read_protocol(MAP_TEST)) if point.voltage_peak_to_peak]
    assert [point.time for point in driven] == pytest.approx([12.5, 16.5, 20.5, 24.5, 28.5])
    assert [point.voltage_peak_to_peak for point in driven] == [5.1, 10.3, 15.5, 20.7, 25.9]
    assert {point.frequency for point in driven} == {si_value("4.1.1-frequency")}


def test_the_sliding_speed_of_the_map_test_is_that_of_its_turns() -> None:
    # D 4.1.2: 1.34 s between two peaks of the gaussmeter on a diameter of 1.1 in
    speed = max(point.sliding_speed or 0.0 for point in flattened(read_protocol(MAP_TEST)))
    assert speed == pytest.approx(math.pi * 1.1 * 25.4e-3 / 1.34, rel=2e-3)


def test_the_map_test_records_throughout() -> None:
    points = flattened(read_protocol(MAP_TEST))
    recorded = [point for point in points if point.channels]
    assert recorded[0].time == 0.0
    assert recorded[-1] == points[-2]


def test_steps_of_a_repeat_are_written_out_in_order() -> None:
    inner = {"kind": "repeat", "count": 2, "steps": [drive(5), wait("1 s"), drive(0), wait("2 s")]}
    points = flattened(protocol_from(content(wait("1 s"), {"kind": "repeat", "count": 3, "steps": [inner]})))
    on = [point.time for point in points if point.voltage_peak_to_peak == 5.0 and point.kind == "drive"]
    assert on == pytest.approx([1.0, 4.0, 7.0, 10.0, 13.0, 16.0])
    assert points[-1].time == pytest.approx(19.0)
    assert points[1].step == "2.1.1"


def test_a_recording_that_lasts_longer_than_the_steps_ends_the_test() -> None:
    record = {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "400 Hz", "duration": "10 s"}
    assert duration(protocol_from(content(record, wait("3 s")))) == pytest.approx(10.0)


def test_two_recordings_at_once_are_refused() -> None:
    record = {"kind": "acquire", "channels": ["friction_force"], "sample_rate": "400 Hz", "duration": "10 s"}
    with pytest.raises(InvalidInput, match=r"^step 3: starts to record at 3 s, while another lasts until 10 s$"):
        protocol_from(content(record, wait("3 s"), record))


def test_a_logarithmic_sweep_has_equal_ratios() -> None:
    sweep = {
        "kind": "sweep",
        "first_frequency": "1 kHz",
        "last_frequency": "100 kHz",
        "points": 3,
        "duration": "6 s",
        "scale": "log",
        "voltage_peak_to_peak": "4 V",
    }
    points = flattened(protocol_from(content(sweep)))
    assert [point.frequency for point in points[:-1]] == pytest.approx([1e3, 1e4, 1e5])
    assert [point.time for point in points] == pytest.approx([0.0, 2.0, 4.0, 6.0])


def test_a_drive_beyond_the_limit_counts_its_offset() -> None:
    high = drive(10) | {"voltage_offset": "6 V"}
    with pytest.raises(InvalidInput, match=r"^step 1: the drive reaches 11 V; limits.voltage_maximum is 10 V$"):
        protocol_from(content(high, voltage_maximum="10 V"))


def test_a_test_beyond_the_limit_of_time_is_refused() -> None:
    with pytest.raises(InvalidInput, match=r"^steps: the test lasts 61 s; limits.duration_maximum is 60 s$"):
        protocol_from(content(wait("61 s"), duration_maximum="60 s"))


def test_everything_ends_switched_off() -> None:
    end = flattened(protocol_from(content({"kind": "motor_speed", "sliding_speed": "1 m/s"}, drive(5), wait("1 s"))))[
        -1
    ]
    assert (end.sliding_speed, end.voltage_peak_to_peak, end.channels) == (0.0, 0.0, ())


def test_all_faults_are_told_with_their_places() -> None:
    nested = {"kind": "repeat", "count": 2, "steps": [wait("1 s"), {"kind": "wait", "duration": "3 N", "colour": 1}]}
    with pytest.raises(InvalidInput) as refusal:
        protocol_from(content({"kind": "motor_speed"}, nested, {"kind": "dance"}, drive(5) | {"frequency": 22}))
    text = str(refusal.value)
    assert "\n" not in text
    assert "step 1: needs either sliding_speed or rotation_speed" in text
    assert "step 2.2: duration: 3 N is a force; expected a time" in text
    assert "step 2.2: colour: unknown key" in text
    assert "step 3: kind must be one of wait, motor_speed, drive" in text
    assert "step 4: frequency: 22 has no unit; expected a frequency, such as 22kHz" in text


@pytest.mark.parametrize(
    ("step", "reason"),
    [
        ({"kind": "check", "quantity": "temperature"}, "needs lowest or highest"),
        ({"kind": "check", "quantity": "temperature", "highest": "3 N"}, "highest 3 N is a force"),
        ({"kind": "check", "quantity": "temperature", "lowest": "60 degC", "highest": "300 K"}, "must be below"),
        ({"kind": "drive", "voltage_peak_to_peak": "3 V"}, "needs a frequency for a voltage above 0 V"),
        ({"kind": "acquire", "channels": ["a b"], "sample_rate": "1 Hz", "duration": "1 s"}, "no name of a channel"),
        (
            {"kind": "acquire", "channels": ["a", "a"], "sample_rate": "1 Hz", "duration": "1 s"},
            "names a channel twice",
        ),
        ({"kind": "acquire", "channels": [], "sample_rate": "1 Hz", "duration": "1 s"}, "needs at least one entry"),
        ({"kind": "wait", "duration": "-1 s"}, "lies beyond any test"),
        ({"kind": "repeat", "count": 2, "steps": []}, "needs at least one entry"),
    ],
)
def test_a_faulty_step_is_told_with_its_reason(step: dict[str, Any], reason: str) -> None:
    with pytest.raises(InvalidInput, match=reason):
        protocol_from(content(step))


def test_repeats_that_multiply_are_refused_before_they_are_written_out() -> None:
    step: dict[str, Any] = wait("1 ms")
    for _ in range(8):
        step = {"kind": "repeat", "count": 9999, "steps": [step]}
    assert calls(lambda: refused_as_too_long(content(step))) < 9999  # fewer than one repeat has steps


def refused_as_too_long(content: dict[str, Any]) -> None:
    with pytest.raises(InvalidInput, match="at most 10000"):
        protocol_from(content)


def test_repeats_nested_too_deeply_are_refused() -> None:
    step: dict[str, Any] = wait("1 s")
    for _ in range(10):
        step = {"kind": "repeat", "count": 1, "steps": [step]}
    with pytest.raises(InvalidInput, match="nested"):
        protocol_from(content(step))


def test_the_example_reads_back_from_its_own_text() -> None:
    protocol = read_protocol(MAP_TEST)
    assert protocol_from(tomllib.loads(protocol_text(protocol))) == protocol


TIMES = st.floats(1e-3, 1e3).map(lambda value: f"{value!r} s")
STEPS = st.recursive(
    st.one_of(
        st.builds(wait, TIMES),
        st.builds(drive, st.floats(0, 90)),
        st.builds(lambda v: {"kind": "motor_speed", "rotation_speed": f"{v!r} / s"}, st.floats(0, 10)),
        st.builds(
            lambda t: {"kind": "prompt", "task": "mounting", "text": t}, st.text('aé"\\\U0001f600 =[', min_size=1)
        ),
        st.builds(
            lambda v, t: {
                "kind": "voltage_steps",
                "voltages": [f"{x!r} V" for x in v],
                "step_duration": t,
                "frequency": "1Hz",
            },
            st.lists(st.floats(0, 90), min_size=1, max_size=4),
            TIMES,
        ),
    ),
    lambda inner: st.builds(
        lambda n, s: {"kind": "repeat", "count": n, "steps": s},
        st.integers(1, 4),
        st.lists(inner, min_size=1, max_size=3),
    ),
    max_leaves=12,
)


@given(steps=st.lists(STEPS, min_size=1, max_size=4))
@examples(60)
def test_any_protocol_reads_back_from_its_own_text(steps: list[dict[str, Any]]) -> None:
    protocol = protocol_from(content(*steps))
    again = protocol_from(tomllib.loads(protocol_text(protocol)))
    assert again == protocol
    assert flattened(again) == flattened(protocol)


@given(steps=st.lists(STEPS, min_size=1, max_size=4), count=st.integers(1, 5))
@examples(30)
def test_a_repeat_lasts_as_many_times_as_its_steps(steps: list[dict[str, Any]], count: int) -> None:
    once, often = (
        duration(protocol_from(content(step)))
        for step in ({"kind": "repeat", "count": 1, "steps": steps}, {"kind": "repeat", "count": count, "steps": steps})
    )
    assert often == pytest.approx(count * once)


@pytest.mark.parametrize("seed", range(60))
def test_hostile_text_is_read_or_refused_in_one_line(seed: int, tmp_path: Path) -> None:
    rng = random.Random(seed)
    lines = MAP_TEST.read_text(encoding="utf-8").splitlines()
    place = rng.randrange(len(lines))
    key, _, value = lines[place].partition("=")
    hostile = rng.choice([*HOSTILE, "9" * 5000, "[[steps]]", "steps = 3", "a." * 40 + "b = 1", "= = ="])
    lines[place] = rng.choice([hostile, f"{key}= {json.dumps(hostile, ensure_ascii=False)}", f"{hostile} = {value}"])
    path = tmp_path / "protocol.toml"
    path.write_bytes("\n".join(lines).encode(errors="surrogatepass"))
    told: list[str] = []
    work = calls(lambda: told.append(refusal_of(path)))
    assert "\n" not in told[0]
    assert len(told[0]) < 5000
    assert work < 100_000  # some 3000 where nothing is wrong


def refusal_of(path: Path) -> str:
    """What a protocol is refused with; empty where it is read."""
    try:
        flattened(read_protocol(path))
    except InvalidInput as refusal:
        return str(refusal)
    return ""


def test_the_schema_in_the_docs_is_that_of_the_product() -> None:
    text = (ROOT / "docs" / "protocol.schema.json").read_text(encoding="utf-8")
    assert json.loads(text) == protocol_schema(), "run: sonolube schema protocol > docs/protocol.schema.json"


def test_the_schema_describes_quantities_as_text_with_a_unit() -> None:
    waiting = protocol_schema()["$defs"]["Wait"]["properties"]
    assert waiting["duration"]["type"] == "string"
    assert waiting["duration"]["x-si-unit"] == "s"


def test_the_voltages_of_table_4_1_are_those_of_the_example() -> None:
    voltages = {number.value for number in column_numbers("4.1", "voltage_peak_to_peak").values()}
    assert {5.1, 10.3, 15.5, 20.7, 25.9} <= voltages
