"""Exports read without a mapping: preambles, time stamps, rounded clocks, no labels, filled lines."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.clocks import stamped_seconds
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, TextLayout
from sonolube.measurement.recordings.reader import read_recording

FORCE = 2.0 + 0.1 * np.sin(np.arange(400) / 7)
TIME = np.arange(400) / 100


def written(path: Path, lines: list[str], encoding: str = "utf-8") -> Path:
    path.write_bytes("\r\n".join(lines).encode(encoding))
    return path


PREAMBLES = {
    "oscilloscope.csv": (
        ["#Digilent WaveForms Oscilloscope Acquisition", "#Device Name: ADP3450", "", "Time (s),Friction force (N)"],
        ",",
    ),
    "tribometer.tsv": (["Compend 2000\tTE53\t05/03/2026", "STEP 1", "Run Time (s)\tFriction (N)"], "\t"),
    "tribox.txt": (
        ["CSM Instruments Tribometer", "Sample : steel", "Normal load : 5.00 [N]", "", "Time [s]\t\u00b5"],
        "\t",
    ),
    "labels-alone.csv": (["Zeit [s];Reibkraft [N]"], ";"),
}


@pytest.mark.parametrize("name", PREAMBLES)
def test_the_labels_are_found_below_a_preamble(name: str, tmp_path: Path) -> None:
    head, separator = PREAMBLES[name]
    rows = [f"{t:.2f}{separator}{f:.4f}" for t, f in zip(TIME, FORCE, strict=True)]
    recording = read_recording(written(tmp_path / name, [*head, *rows], "cp1252"))
    assert read_recording(str(tmp_path / name))["time"].to_numpy() == approx(TIME)
    (channel,) = recording.data_vars
    assert channel == ("friction_coefficient" if name == "tribox.txt" else "friction_force")
    assert recording[channel].to_numpy() == approx(FORCE, abs=1e-4)
    assert recording["time"].to_numpy() == approx(TIME)


def test_a_file_without_labels_has_columns_by_number_and_loses_no_row(tmp_path: Path) -> None:
    rows = [f"{t:.2f}\t{f:.4f}" for t, f in zip(TIME, FORCE, strict=True)]
    path = written(tmp_path / "plain.txt", rows)
    with raises(InvalidInput, match=r"name one with a mapping: axis\.column"):
        read_recording(path)
    (tmp_path / "numbers.toml").write_text(
        '[axis]\ncolumn = "column 1"\nunit = "s"\n[channels.friction_force]\ncolumn = "column 2"\nunit = "N"\n'
    )
    recording = read_recording(path, mapping=tmp_path / "numbers.toml")
    assert recording["friction_force"].to_numpy() == approx(FORCE, abs=1e-4)


def test_time_stamps_are_a_clock(tmp_path: Path) -> None:
    numbers = [f"12:00:{t:06.3f};{f:.4f}".replace(".", ",") for t, f in zip(TIME, FORCE, strict=True)]
    rows = [f"05.03.2026 {each}" for each in numbers]
    recording = read_recording(written(tmp_path / "stamps.csv", ["Datum/Uhrzeit;Reibkraft [N]", *rows]))
    assert recording["time"].to_numpy() == approx(TIME)
    assert recording["friction_force"].to_numpy() == approx(FORCE, abs=1e-4)


def test_stamps_go_on_after_midnight_and_across_days() -> None:
    assert stamped_seconds(["23:59:59.5", "00:00:00.5", "00:00:01"]) == approx([0.0, 1.0, 1.5])
    assert stamped_seconds(["2026-02-28 23:59:59", "2026-03-01T00:00:01Z"]) == approx([0.0, 2.0])
    assert stamped_seconds(["12:00:00", "noon"]) is None
    assert stamped_seconds(["31.02.2026 12:00:00"]) is None
    assert stamped_seconds([]) is None


def test_a_clock_that_was_rounded_is_made_even_and_said(tmp_path: Path) -> None:
    rows = [f"{np.floor(10 * t) / 10:.1f},{f:.4f}" for t, f in zip(TIME, FORCE, strict=True)]
    recording = read_recording(written(tmp_path / "rounded.csv", ["time (s),friction_force (N)", *rows]))
    assert recording.attrs["sample_rate"] == approx(100.0, rel=1e-3)
    assert "the clock repeats itself" in recording.attrs["caveats"]
    rows[200:] = rows[:200]  # it begins anew
    with raises(InvalidInput, match=r"time repeats|time decreases"):
        read_recording(written(tmp_path / "anew.csv", ["time (s),friction_force (N)", *rows]))


def universal_file(values: list[float], stated: int) -> str:
    """Time response, data set 58, of evenly sampled values, six a line."""
    lines = [f"{'-1':>6}", f"{'58':>6}", "friction", "NONE", "05-Mar-26 12:00:00", "NONE", "NONE"]
    lines.append("    1         0    0         0 NONE               1   3 NONE               0   0")
    lines.append(f"         2{stated:10d}         1  0.00000e+00  5.00000e-03  0.00000e+00")
    lines.append("        17    0    0    0                 Time                    s")
    lines.append("         9    0    0    0       friction_force                    N")
    lines += ["         0    0    0    0                 NONE                 NONE"] * 2
    rows = [values[place : place + 6] for place in range(0, len(values), 6)]
    lines += ["".join(f"{value:13.5e}" for value in row) for row in rows]
    return "\n".join([*lines, f"{'-1':>6}", ""])


def test_zeros_that_fill_the_last_line_of_a_universal_file_are_no_samples(tmp_path: Path) -> None:
    (tmp_path / "odd.uff").write_text(universal_file([2.0] * 25 + [0.0] * 5, 25))
    assert read_recording(tmp_path / "odd.uff")["friction_force"].to_numpy() == approx(np.full(25, 2.0))
    (tmp_path / "more.uff").write_text(universal_file([2.0] * 30, 25))
    with raises(InvalidInput, match="a response of 25 values has 30"):
        read_recording(tmp_path / "more.uff")


def test_a_mapping_that_states_a_blank_as_the_separator_keeps_quoted_labels(tmp_path: Path) -> None:
    path = tmp_path / "quoted.txt"
    path.write_text("\n".join(['"Time of day" "Friction force"', *(f"{n / 100:.2f} {1 + n % 2}" for n in range(20))]))
    mapping = RecordingMapping(
        channels={"friction_force": ChannelSource(column="Friction force", unit="N")},
        axis=ChannelSource(column="Time of day", unit="s"),
        text=TextLayout(separator=" "),
    )
    assert float(read_recording(path, mapping=mapping)["friction_force"].mean()) == approx(1.5)
