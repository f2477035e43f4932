"""Protocols of the package: times, speeds and voltages of the dissertation, schema, round trips, names."""

import subprocess
import sys
import tomllib
from math import pi
from pathlib import Path

import pytest
from tests.facts.protocol.schema_faults import schema_faults

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.protocol import (
    Acquire,
    Repeat,
    SetPoint,
    duration,
    flattened,
    protocol_by_name_or_file,
    protocol_from,
    protocol_names,
    protocol_path,
    protocol_schema,
    protocol_text,
)
from sonolube.facts.protocol.record import STEP_KINDS, Step
from sonolube.facts.published import si_value

HOUR = 3600.0
NAMES = protocol_names()

# Motor on from, motor off at, drive on from, drive off at, each of one test after its recording has begun; s
TIMES: dict[str, list[tuple[float | None, ...]]] = {
    "map_test": [(0.5, 32.5, 12.5, 32.5)],  # D 4.1.2: motor from 0.5 s, vibration from 12.5 s, 32.5 s in all
    "temperature_test": [(2.0, 32.0, 12.0, 32.0)],  # D 4.3.3: 2 s, 10 s, five times 4 s
    "appendix_a": [
        *((0.0, hours * HOUR, 0.0, hours * HOUR) for hours in (4, 2, 0.94)),  # A 3.1.7, 3.1.10
        *((0.0, hours * HOUR, None, None) for hours in (4, 2, 0.94)),  # A 3.2.2
    ],
    "study_1": [
        (0.0, hours * HOUR, on, None if on is None else hours * HOUR)
        for hours in (4, 2, 0.93)  # Table 2.2
        for on in (None, 0.0)
    ],
    "study_2": [
        (0.0, hours * HOUR, on, None if on is None else hours * HOUR)
        for hours in (1, 1.68, 2)  # Table 2.6
        for on in (None, 0.0)
    ],
}

# Time of the whole without prompts, s
TOTALS = {
    "appendix_a": 10 * 90 + 6 * 90 + 2 * (4 + 2 + 0.94) * HOUR,  # A 2.1.9, 2.6.5, 3.1.7, 3.1.10, 3.2.2
    "study_1": 2 * (4 + 2 + 0.93) * HOUR + 6 * 10,  # Table 2.2
    "study_2": 2 * (1 + 1.68 + 2) * HOUR + 6 * 10,  # Table 2.6
    "map_test": 32.5,  # D 4.1.2
    "temperature_test": 2 + 10 + 5 * 4 + 18,  # D 4.3.3, "about 50 seconds"
    "waveguide_calibration": 5 * 30 + 11 / (54.9 / 60),  # Table 2.8: 11 rounds at 54.9 rpm; loops assumed
    "lubrication_comparison": 4 * 3 * (1 + 9 * 5),  # D 4.2.2: four methods, three loads; times assumed
    "resonance_sweep": 81 * 0.5,  # assumed
    "both_directions": 76.5 + 9 * (1 + 12 + 6 * 6),  # run-in of 5 m; three speeds thrice, six voltages; assumed
    "decay_length_run": 60 * (5 / 0.065 + 21 * 0.05 + 5),  # 300 m switched every 5 m; sweep and zero assumed
}


def recorded_tests(name: str) -> list[list[SetPoint]]:
    """Set points from one recording of friction at a turning disc to the next, the one behind included."""
    points = flattened(protocol_by_name_or_file(name))
    starts = [i for i, point in enumerate(points) if point.kind == "acquire" and "friction_force" in point.channels]
    return [list(points[a:b]) for a, b in zip(starts, [*starts[1:], len(points)], strict=True)]


def first_time(points: list[SetPoint], *, moving: bool, start: float) -> tuple[float | None, float | None]:
    """When motor or drive is switched on and off, since the recording began."""

    def is_on(point: SetPoint) -> bool:
        return bool((point.sliding_speed or point.rotation_speed) if moving else point.voltage_peak_to_peak)

    on = next((point.time for point in points if is_on(point)), None)
    if on is None:
        return None, None
    off = next(point.time for point in points if point.time > on and not is_on(point))
    return on - start, off - start


def steps_of(steps: tuple[Step, ...]) -> list[Step]:
    """All steps, those of repeats included."""
    return [each for step in steps for each in [step, *(steps_of(step.steps) if isinstance(step, Repeat) else [])]]


@pytest.mark.parametrize("name", TIMES)
def test_motor_and_drive_are_switched_when_the_dissertation_says(name: str) -> None:
    tests = recorded_tests(name)
    assert len(tests) == len(TIMES[name])
    for points, expected in zip(tests, TIMES[name], strict=True):
        start = points[0].time
        found = first_time(points, moving=True, start=start) + first_time(points, moving=False, start=start)
        assert found == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_a_protocol_lasts_as_long_as_its_parts_by_the_dissertation(name: str) -> None:
    assert duration(protocol_by_name_or_file(name)) == pytest.approx(TOTALS[name], rel=2e-3)


@pytest.mark.parametrize(
    ("name", "speeds"),
    [
        ("appendix_a", (20.3, 40.6, 87.0)),  # A 3.1.6, 3.1.10
        ("study_1", (20.3, 40.6, 87.0)),  # Table 2.2
        ("study_2", (75.2e3 / HOUR,)),  # Table 2.6, 75.2 m in 1 h
        ("temperature_test", (220.0,)),  # Figure 4.34
        ("lubrication_comparison", tuple(range(60, 141, 10))),  # Table 4.3, first and last
        ("waveguide_calibration", (172.5,)),  # Table 2.8
    ],
)
def test_the_disc_turns_at_the_printed_sliding_speeds(name: str, speeds: tuple[float, ...]) -> None:
    protocol = protocol_by_name_or_file(name)
    around = pi * (protocol.metadata.groove_diameter or 0.0)
    found = {
        round(1e3 * (point.sliding_speed or (point.rotation_speed or 0.0) * around), 2)
        for point in flattened(protocol)
        if "friction_force" in point.channels
    } - {0.0}
    assert sorted(found) == pytest.approx(speeds, rel=6e-3)


@pytest.mark.parametrize("hours", [4, 2, 0.93])
def test_every_speed_of_study_one_covers_the_same_distance_in_as_many_turns(hours: float) -> None:
    protocol = protocol_by_name_or_file("study_1")
    lasts = {point.recorded_until - point.time: point for point in flattened(protocol) if point.recorded_until}
    assert any(abs(each - hours * HOUR) < 1e-6 for each in lasts)
    speed = {4: 20.3e-3, 2: 40.6e-3, 0.93: 87e-3}[hours]
    assert speed * hours * HOUR == pytest.approx(292.5, rel=6e-3)  # Table 2.2
    around = pi * (protocol.metadata.groove_diameter or 0.0)
    assert speed * hours * HOUR / around == pytest.approx(1600, rel=6e-3)  # Table 2.2


@pytest.mark.parametrize("name", ["appendix_a", "study_1", "study_2"])
def test_the_drive_is_that_of_generator_times_gain(name: str) -> None:
    driven = [point for point in flattened(protocol_by_name_or_file(name)) if point.voltage_peak_to_peak]
    assert {point.voltage_peak_to_peak for point in driven} == {28.0}
    assert pytest.approx(28.0, rel=2e-3) == 2 * 3.0 * 4.67  # A 3.1.3, 3.1.5
    assert {point.voltage_offset for point in driven} == {14.0}
    assert {point.frequency for point in driven} == {si_value("4.1.1-frequency")}


def test_the_temperature_test_steps_through_the_voltages_of_its_table() -> None:
    driven = [point for point in flattened(protocol_by_name_or_file("temperature_test")) if point.voltage_peak_to_peak]
    voltages = list(dict.fromkeys(point.voltage_peak_to_peak for point in driven))
    assert voltages == [5.1, 10.3, 15.5, 20.7, 25.9]  # Table 4.4


def test_the_ladder_for_both_directions_has_six_voltages_at_three_speeds_behind_five_metres_of_run_in() -> None:
    protocol = protocol_by_name_or_file("both_directions")
    points = flattened(protocol)
    rungs = {(point.sliding_speed, point.voltage_peak_to_peak) for point in points if point.voltage_peak_to_peak}
    voltages = [2.6, 5.2, 10.4, 15.6, 20.8, 25.9]
    assert rungs == {(speed, voltage) for speed in (5e-3, 20e-3, 65.5e-3) for voltage in voltages}
    assert all(point.voltage_offset == pytest.approx(point.voltage_peak_to_peak / 2) for point in points)
    on, off, *_ = (point.time for point in points if point.kind == "motor_speed")
    assert 65.5e-3 * (off - on) == pytest.approx(5.0, rel=3e-3)  # m


def test_appendix_a_scans_eight_marks_of_six_discs_and_calibrates_ten_speeds() -> None:
    points = flattened(protocol_by_name_or_file("appendix_a"))
    steps = steps_of(protocol_by_name_or_file("appendix_a").steps)
    assert [step.count for step in steps if isinstance(step, Repeat)] == [10, 6, 8]  # A 2.1.9, 4.5, 4.1.2
    assert sum("gaussmeter" in point.channels and point.kind == "acquire" for point in points) == 10
    runout = [point for point in points if point.channels == ("displacement",) and point.rotation_speed]
    assert runout[0].rotation_speed == pytest.approx(10 / 90, rel=2e-3)  # A 2.6.5: ten revolutions


@pytest.mark.parametrize("name", ["study_1", "study_2", "appendix_a"])
def test_friction_is_sampled_at_the_rate_of_table_2_2(name: str) -> None:
    steps = steps_of(protocol_by_name_or_file(name).steps)
    assert {step.sample_rate for step in steps if isinstance(step, Acquire)} == {400.0}


@pytest.mark.parametrize("name", NAMES)
def test_a_protocol_reads_back_as_written(name: str) -> None:
    protocol = protocol_by_name_or_file(name)
    assert protocol_from(tomllib.loads(protocol_text(protocol))) == protocol


@pytest.mark.parametrize("name", NAMES)
def test_a_protocol_follows_the_schema(name: str) -> None:
    schema = protocol_schema()
    content = tomllib.loads(protocol_path(name).read_text(encoding="utf-8"))
    assert list(schema_faults(schema, content, schema)) == []
    content["steps"][0]["colour"] = "red"
    assert list(schema_faults(schema, content, schema)) != []


@pytest.mark.parametrize("name", NAMES)
def test_a_protocol_says_where_it_comes_from_and_what_is_assumed(name: str) -> None:
    source = protocol_by_name_or_file(name).source
    assert source.startswith("D ")
    assert "ssumed" in source or "not printed" in source


def test_every_kind_of_step_is_used_somewhere() -> None:
    used = {step.kind for name in NAMES for step in steps_of(protocol_by_name_or_file(name).steps)}
    assert used == set(STEP_KINDS)


def test_a_misspelt_name_is_answered_with_the_closest() -> None:
    with pytest.raises(UnknownName, match=r"unknown protocol 'map_tst'; did you mean map_test\?"):
        protocol_by_name_or_file("map_tst")


def test_a_file_is_read_by_its_path_and_one_that_is_missing_is_named(tmp_path: Path) -> None:
    copy = tmp_path / "mine.toml"
    copy.write_text(protocol_path("map_test").read_text(encoding="utf-8"), encoding="utf-8")
    assert protocol_by_name_or_file(str(copy)) == protocol_by_name_or_file("map_test")
    with pytest.raises(InvalidInput, match=r"absent\.toml: no such file"):
        protocol_by_name_or_file(str(tmp_path / "absent.toml"))


def test_the_name_of_a_protocol_wins_over_a_folder_of_that_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "map_test").mkdir()
    monkeypatch.chdir(tmp_path)
    assert duration(protocol_by_name_or_file("map_test")) == pytest.approx(32.5)


def test_names_are_found_from_any_folder(tmp_path: Path) -> None:
    call = "from sonolube.facts.protocol import protocol_by_name_or_file as find; print(find('map_test').title)"
    done = subprocess.run([sys.executable, "-c", call], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "65.5 mm/s" in done.stdout
