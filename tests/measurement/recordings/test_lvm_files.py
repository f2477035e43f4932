"""LVM files of LabVIEW against the values, units and times they were written with, by NI's specification."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping, Selection
from sonolube.measurement.recordings.reader import read_recording

FILE_HEADER = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t{sign}\n"
    "Multi_Headings\t{headings}\nX_Columns\t{columns}\nTime_Pref\tRelative\nDate\t2016/03/04\nTime\t14:10:11\n"
    "***End_of_Header***\t\n\t\n"
)


def file_header(*, columns: str, sign: str = ".", headings: str = "Yes") -> str:
    return FILE_HEADER.format(columns=columns, sign=sign, headings=headings)


def segment_header(keys: Mapping[str, Sequence[str]], *, gap: str = "\t") -> str:
    """Keys with one cell a channel; in files with several time columns `gap` is two tabs."""
    lines = [key + "\t" + gap.join(cells) + "\t\n" for key, cells in keys.items()]
    return f"Channels\t{len(next(iter(keys.values())))}\n" + "".join(lines) + "***End_of_Header***\t\n"


TWO = {
    "Samples": ("3", "3"),
    "Y_Unit_Label": ("mN", "V"),
    "X_Dimension": ("Time", "Time"),
    "X0": ("0.0", "0.0"),
    "Delta_X": ("0.5", "0.5"),
}
MULTI = "X_Value\tfriction_force\tX_Value\tdrive\tComment\n"


def write(path: Path, text: str, encoding: str = "utf-8") -> Path:
    path.write_bytes(text.encode(encoding))
    return path


def test_each_channel_beside_its_own_time_column_has_its_own_unit(tmp_path: Path) -> None:
    text = file_header(columns="Multi") + segment_header(TWO, gap="\t\t") + MULTI
    path = write(tmp_path / "multi.lvm", text + "0\t100\t0\t1\n0.5\t200\t0.5\t2\n1\t300\t1\t3\n")
    recording = read_recording(path)
    assert recording["friction_force"].to_numpy() == approx([0.1, 0.2, 0.3])
    assert recording["drive"].attrs["units"] == "V"
    assert recording["time"].to_numpy().tolist() == [0, 0.5, 1]


def test_an_empty_unit_does_not_move_those_after_it(tmp_path: Path) -> None:
    units = {**TWO, "Y_Unit_Label": ("", "V")}
    text = file_header(columns="Multi") + segment_header(units, gap="\t\t") + MULTI
    recording = read_recording(write(tmp_path / "unit.lvm", text + "0\t1\t0\t1\n0.5\t2\t0.5\t2\n"))
    assert recording["friction_force"].attrs["source_unit"] == "not stated, taken as SI"
    assert recording["drive"].attrs["units"] == "V"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
def test_micro_and_degree_signs_of_windows_are_understood(tmp_path: Path, encoding: str) -> None:
    keys = {**TWO, "Y_Unit_Label": ("µm", "°C")}
    text = file_header(columns="One") + segment_header(keys) + "X_Value\tdisplacement\ttemperature\tComment\n"
    path = write(tmp_path / "signs.lvm", text + "0\t5\t20\tÜberlast\n0.5\t6\t21\n", encoding)
    recording = read_recording(path)
    assert recording["displacement"].to_numpy() == approx([5e-6, 6e-6])
    assert recording["temperature"].to_numpy() == approx([293.15, 294.15])
    assert ("Windows-1252" in recording.attrs.get("caveats", "")) == (encoding == "cp1252")


def test_a_channel_without_samples_is_left_out_and_said(tmp_path: Path) -> None:
    keys = {**TWO, "Samples": ("2", "0"), "Delta_X": ("0.5", "1.0")}
    text = file_header(columns="One") + segment_header(keys) + "X_Value\tfriction_force\tUntitled\tComment\n"
    recording = read_recording(write(tmp_path / "empty.lvm", text + "0\t1\t\n0.5\t2\t\n"))
    assert list(recording.data_vars) == ["friction_force"]
    assert recording.attrs["caveats"] == "channels without values were left out: Untitled"


def test_a_file_without_a_stated_decimal_sign_is_read_by_its_numbers(tmp_path: Path) -> None:
    header = file_header(columns="One").replace("Decimal_Separator\t.\n", "")
    keys = {**TWO, "X0": ("0,0", "0,0"), "Delta_X": ("0,5", "0,5")}
    text = header + segment_header(keys) + "X_Value\tfriction_force\tdrive\tComment\n0,0\t100,5\t1\n0,5\t200,5\t2\n"
    recording = read_recording(write(tmp_path / "old.lvm", text))
    assert recording["friction_force"].to_numpy() == approx([0.1005, 0.2005])
    assert recording["time"].to_numpy().tolist() == [0, 0.5]


@pytest.mark.parametrize(
    "repeated", ["", "X_Value\tfriction_force\tdrive\tComment\n", None], ids=["rows", "labels", "all"]
)
def test_rows_appended_after_blank_lines_or_repeated_headers_continue_the_recording(
    tmp_path: Path, repeated: str | None
) -> None:
    header, labels = file_header(columns="One", headings="No"), "X_Value\tfriction_force\tdrive\tComment\n"
    first = header + segment_header(TWO) + labels + "0\t100\t1\n0.5\t200\t2\n"
    second = header + segment_header(TWO) + labels if repeated is None else repeated
    if repeated:  # labels alone are no header: they are repeated within a header of the segment
        second = segment_header(TWO) + repeated
    recording = read_recording(write(tmp_path / "appended.lvm", first + "\n\n" + second + "1\t300\t3\n1.5\t400\t4\n"))
    assert recording["friction_force"].to_numpy() == approx([0.1, 0.2, 0.3, 0.4])
    assert recording["time"].to_numpy().tolist() == [0, 0.5, 1, 1.5]


def test_segments_that_restart_without_another_start_follow_each_other_with_a_caveat(tmp_path: Path) -> None:
    one = segment_header(TWO) + "X_Value\tfriction_force\tdrive\tComment\n0\t100\t1\n0.5\t200\t2\n\n"
    recording = read_recording(write(tmp_path / "restart.lvm", file_header(columns="One") + one + one))
    assert recording["time"].to_numpy().tolist() == [0, 0.5, 1, 1.5]
    assert "each follows the one before" in recording.attrs["caveats"]


def test_channels_of_different_rates_are_read_one_at_a_time(tmp_path: Path) -> None:
    keys = {**TWO, "Samples": ("4", "2"), "Delta_X": ("0.5", "1.0")}
    text = file_header(columns="Multi") + segment_header(keys, gap="\t\t") + MULTI
    path = write(tmp_path / "rates.lvm", text + "0\t1\t0\t10\n0.5\t2\t1\t20\n1\t3\t\t\n1.5\t4\t\t\n")
    with raises(InvalidInput, match=r"different times, such as 'friction_force' .*'drive'.*--channel"):
        read_recording(path)
    for name, time in (("friction_force", [0, 0.5, 1, 1.5]), ("drive", [0, 1])):
        one = RecordingMapping(channels={}, selection=Selection(channels=(name,)))
        recording = read_recording(path, mapping=one)
        assert list(recording.data_vars) == [name]
        assert recording["time"].to_numpy().tolist() == time


def test_one_time_column_is_not_taken_for_channels_of_another_step(tmp_path: Path) -> None:
    keys = {**TWO, "Samples": ("3", "2"), "Delta_X": ("0.5", "1.0")}
    text = file_header(columns="One") + segment_header(keys) + "X_Value\tfriction_force\tdrive\tComment\n"
    path = write(tmp_path / "one.lvm", text + "0\t1\t10\n0.5\t2\t20\n1\t3\t\n")
    with raises(InvalidInput, match="different times"):
        read_recording(path)
    slow = read_recording(path, mapping=RecordingMapping(channels={}, selection=Selection(channels=("drive",))))
    assert slow["time"].to_numpy().tolist() == [0, 1]
    assert slow["drive"].to_numpy().tolist() == [10, 20]


def test_milliseconds_of_the_abscissa_become_seconds(tmp_path: Path) -> None:
    keys = {**TWO, "X_Unit_Label": ("ms", "ms")}
    text = file_header(columns="One") + segment_header(keys) + "X_Value\tfriction_force\tdrive\tComment\n"
    recording = read_recording(write(tmp_path / "ms.lvm", text + "0\t1\t1\n500\t2\t2\n"))
    assert recording["time"].to_numpy() == approx([0, 0.5])


def test_a_spectrum_is_no_recording_over_time(tmp_path: Path) -> None:
    keys = {**TWO, "X_Dimension": ("Frequency", "Frequency")}
    text = file_header(columns="One") + segment_header(keys) + "X_Value\tfriction_force\tdrive\tComment\n0\t1\t1\n"
    with raises(InvalidInput, match=r"line \d+: X_Dimension is 'Frequency', not Time"):
        read_recording(write(tmp_path / "spectrum.lvm", text))


def test_a_comment_without_values_is_no_sample(tmp_path: Path) -> None:
    text = file_header(columns="One") + segment_header(TWO) + "X_Value\tfriction_force\tdrive\tComment\n"
    recording = read_recording(
        write(tmp_path / "comment.lvm", text + "0\t1\t1\tstart\n\t\t\tpaused\n0.5\t2\t2\n\t\t\tstopped\n")
    )
    assert np.array_equal(recording["drive"], [1, 2])


def test_a_sample_without_values_keeps_its_place_in_time(tmp_path: Path) -> None:
    keys = {**TWO, "Samples": ("4", "4")}
    text = file_header(columns="No") + segment_header(keys) + "X_Value\tfriction_force\tdrive\tComment\n"
    recording = read_recording(write(tmp_path / "gap.lvm", text + "\t1\t1\n\t\t\n\t3\t3\n\t\t\n\n"))
    assert recording["drive"].to_numpy() == approx([1, np.nan, 3, np.nan], nan_ok=True)
    assert recording["time"].to_numpy().tolist() == [0, 0.5, 1, 1.5]
