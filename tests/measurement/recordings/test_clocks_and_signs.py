"""Channels that begin apart, clocks that change their rate, sensors of the other sign, and gains with units."""

import re
from pathlib import Path

import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from pytest import approx, raises

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.friction_analysis import analyse_stick_slip, analyse_voltage_steps
from sonolube.measurement.recordings.mapping import mapping_toml, read_mapping
from sonolube.measurement.recordings.reader import read_recording, recording_blocks
from sonolube.measurement.time_series import changes_rate

RATE = 100.0


def tdms(path: Path, *, apart: float, samples: int = 1000) -> Path:
    """Force that falls from 2 N to 1 N as a voltage is switched on at 7 s of its own clock, which begins later."""
    clock = np.arange(samples) / RATE
    begin = np.datetime64("2026-03-05T12:00:00")
    later = begin + np.timedelta64(round(apart * 1e6), "us")
    common = {"wf_increment": 1 / RATE, "wf_start_offset": 0.0}
    force = ChannelObject(
        "g",
        "friction_force",
        np.where(clock < apart + 7, 2.0, 1.0),
        common | {"wf_start_time": begin, "unit_string": "N"},
    )
    voltage = ChannelObject(
        "g",
        "voltage_peak_to_peak",
        np.where(clock < 7, 0.0, 28.0),
        common | {"wf_start_time": later, "unit_string": "V"},
    )
    with TdmsWriter(path) as writer:
        writer.write_segment([force, voltage])
    return path


def test_channels_that_begin_apart_are_read_where_both_are_known(tmp_path: Path) -> None:
    recording = read_recording(tdms(tmp_path / "apart.tdms", apart=2.0))
    time = recording["time"].to_numpy()
    assert (time[0], time[-1], time.size) == (approx(2.0), approx(9.99), 800)
    switched = recording["voltage_peak_to_peak"].to_numpy() > 14
    assert time[np.argmax(switched)] == approx(9.0)
    assert np.array_equal(switched, recording["friction_force"].to_numpy() < 1.5)
    assert "begin at different times, up to 2 s apart: the 8 s" in recording.attrs["caveats"]


def test_channels_that_begin_together_have_no_caveat(tmp_path: Path) -> None:
    recording = read_recording(tdms(tmp_path / "together.tdms", apart=0.0))
    assert recording["time"].size == 1000
    assert "caveats" not in recording.attrs


def test_channels_without_a_common_time_and_blocks_of_channels_apart_are_refused(tmp_path: Path) -> None:
    with raises(InvalidInput, match="begin at times up to 12 s apart and have none in common"):
        read_recording(tdms(tmp_path / "later.tdms", apart=12.0))
    with raises(InvalidInput, match="different time bases"):
        list(recording_blocks(tdms(tmp_path / "apart.tdms", apart=2.0)))


def written(path: Path, time: Floats, force: Floats, *more: tuple[str, Floats]) -> Path:
    """Recording as comma-separated values."""
    heads = ["time (s)", "friction_force (N)", *(name for name, _ in more)]
    rows = np.column_stack([time, force, *(values for _, values in more)])
    path.write_text("\n".join([",".join(heads), *(",".join(f"{each:.9g}" for each in row) for row in rows)]))
    return path


def test_a_clock_that_changes_its_rate_is_a_caveat_and_stick_slip_refuses_it(tmp_path: Path) -> None:
    time = np.concatenate([np.arange(0, 10, 0.01), np.arange(10, 100, 0.5)])
    assert changes_rate(time=time)
    recording = read_recording(written(tmp_path / "uneven.csv", time, np.where(time < 10, 3.0, 1.0)))
    assert "not evenly spaced in time" in recording.attrs["caveats"]
    with raises(InvalidInput, match="not evenly spaced in time, which stick-slip needs"):
        analyse_stick_slip(recording)


@pytest.mark.parametrize(
    "time",
    [
        np.arange(0, 10, 0.01),
        np.concatenate([np.arange(0, 3, 0.01), np.arange(60, 67, 0.01)]),  # a pause
        np.round(np.arange(0, 10, 0.01) + 0.003 * np.sin(np.arange(1000)), 4),  # jitter
    ],
    ids=["even", "with a gap", "jitters"],
)
def test_an_even_clock_with_gaps_or_jitter_keeps_its_rate(time: Floats) -> None:
    assert not changes_rate(time=time)


def test_friction_that_the_sensor_has_negative_is_taken_as_positive(tmp_path: Path) -> None:
    time = np.arange(0, 20, 0.01)
    noise = 0.02 * np.random.default_rng(1).standard_normal(time.size)
    voltage = np.where(time < 10, 0.0, 28.0)
    path = written(
        tmp_path / "neg.csv", time, -np.where(time < 10, 2.0, 1.0) + noise, ("voltage_peak_to_peak (V)", voltage)
    )
    recording = read_recording(path)
    _, on = analyse_voltage_steps(recording)
    assert on.friction_reduction == approx(0.5, abs=0.01)
    assert recording["friction_force"].attrs["calibration_gain"] == -1.0
    assert "friction_force is negative by the sign of the sensor" in recording.attrs["caveats"]


@pytest.mark.parametrize("channel", ["relative_velocity (m/s)", "sliding_speed (m/s)"])
def test_friction_of_a_motion_to_and_fro_keeps_its_signs(channel: str, tmp_path: Path) -> None:
    time = np.arange(0, 20, 0.01)
    velocity = np.sin(time)
    force = 1.5 * np.sign(velocity) - 1.4
    recording = read_recording(written(tmp_path / "loops.csv", time, force, (channel, velocity)))
    assert recording["friction_force"].to_numpy() == approx(force)
    assert "caveats" not in recording.attrs


def test_friction_of_a_stroke_back_keeps_the_sign_of_its_velocity(tmp_path: Path) -> None:
    time = np.arange(0, 2, 0.01)
    force, velocity = -0.3 + 0.01 * np.cos(50 * time), np.full(time.size, -0.02)
    recording = read_recording(written(tmp_path / "back.csv", time, force, ("relative_velocity (m/s)", velocity)))
    assert recording["friction_force"].to_numpy() == approx(force)


def test_a_force_at_the_limit_of_its_sensor_is_a_caveat(tmp_path: Path) -> None:
    time = np.arange(0, 20, 0.01)
    force = 2 + 0.5 * np.random.default_rng(2).standard_normal(time.size)
    recording = read_recording(written(tmp_path / "clipped.csv", time, np.minimum(force, 2.2)))
    assert "friction_force stands at its highest value, 2.2 N, in 3" in recording.attrs["caveats"]
    assert "caveats" not in read_recording(written(tmp_path / "free.csv", time, force)).attrs


MAPPING = '[axis]\ncolumn = "Time"\n[text]\nunits_row = true\n[channels.friction_force]\ncolumn = "Channel A"\n'


def scope(path: Path, unit: str, factor: float) -> Path:
    """Export of an oscilloscope with the units in its second row."""
    rows = [f"{k / 100},{factor * (1 + 0.001 * (k % 7))}" for k in range(100)]
    path.write_text("\n".join(["Time,Channel A", f"(s),({unit})", *rows]))
    return path


def test_a_gain_with_units_gives_the_same_force_whatever_the_unit_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "gain.toml").write_text(MAPPING + 'gain = "2 N/V"\n')
    mapping = read_mapping(tmp_path / "gain.toml")
    volts = read_recording(scope(tmp_path / "v.csv", "V", 1.0), mapping=mapping)
    millivolts = read_recording(scope(tmp_path / "mv.csv", "mV", 1000.0), mapping=mapping)
    assert float(volts["friction_force"][0]) == approx(2.0)
    assert millivolts["friction_force"].to_numpy() == approx(volts["friction_force"].to_numpy())
    (tmp_path / "again.toml").write_text(mapping_toml(mapping))
    assert read_mapping(tmp_path / "again.toml").channels == mapping.channels


def test_a_gain_without_units_is_refused_where_the_file_states_another_unit(tmp_path: Path) -> None:
    (tmp_path / "bare.toml").write_text(MAPPING + 'gain = 2.0\nunit = "N"\n')
    with raises(InvalidInput, match=r"'Channel A' is in mV by the file, and its gain of 2 has no units: .*\"2 N/V\""):
        read_recording(scope(tmp_path / "mv.csv", "mV", 1000.0), mapping=tmp_path / "bare.toml")
    newtons = read_recording(scope(tmp_path / "n.csv", "N", 1.0), mapping=tmp_path / "bare.toml")
    assert float(newtons["friction_force"][0]) == approx(2.0)


@pytest.mark.parametrize(
    ("gain", "words"),
    [
        ('"2 N"', 'needs a number and the units of value and reading, such as "2 N/V"'),
        ('"two N/V"', "needs a number"),
        ('"2.0.0 N/V"', "'2.0.0' is no number"),
        ('"2 N/V"\nunit = "kN"', "gives a value in N, but unit is 'kN'"),
    ],
)
def test_a_gain_that_cannot_be_read_is_refused_by_its_key(gain: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "gain.toml").write_text(f"{MAPPING}gain = {gain}\n")
    with raises(InvalidInput, match=rf"friction_force\.gain.*{re.escape(words)}"):
        read_mapping(tmp_path / "gain.toml")
