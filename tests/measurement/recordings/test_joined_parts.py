"""Parts of a test on one time axis, choice of channels, and MATLAB files of every version, by hand."""

from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io
import xarray as xr
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.channels_and_parts import (
    ChannelEntry,
    begun_at,
    chosen_channels,
    join_recordings,
    listed_channels,
    name_and_unit,
    require_common_length,
    time_shifts,
)
from sonolube.measurement.recordings.dataset import damaged_sample_caveats, missing_sample_caveat
from sonolube.measurement.recordings.mapping import Selection
from sonolube.measurement.recordings.matlab import matlab_arrays
from sonolube.measurement.recordings.reader import read_recording

PATH = Path("test.tdms")


@pytest.mark.parametrize(
    ("label", "name", "unit"),
    [
        ("Friction Force [mN]", "friction_force", "mN"),
        ("load (N)", "load", "N"),
        ("load (N) #2", "load", "N"),
        ("a/b-c", "a_b_c", None),
        ("µ", "µ", None),
        ("  (V)", "channel", "V"),
        ("x () ", "x", ""),
    ],
)
def test_a_label_holds_a_name_and_perhaps_a_unit(label: str, name: str, unit: str | None) -> None:
    assert name_and_unit(label) == (name, unit)


@pytest.mark.parametrize(
    ("text", "begun"),
    [
        ("2016/03/04 14:10:11.5", datetime(2016, 3, 4, 14, 10, 11, 500_000)),
        ("2016-3-4T4:5:6", datetime(2016, 3, 4, 4, 5, 6)),
        ("2016-03-04 14:10:11,25 more", datetime(2016, 3, 4, 14, 10, 11, 250_000)),
        ("2016-13-04 14:10:11", None),
        ("4 March", None),
    ],
)
def test_a_start_is_read_in_its_usual_spellings(text: str, begun: datetime | None) -> None:
    assert begun_at(text) == begun


def test_parts_follow_each_other_by_their_times_their_starts_or_one_interval() -> None:
    first, restarted = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0])
    assert time_shifts([first, first + 3], [None, None]) == ([0.0, 0.0], False)
    starts: list[datetime | None] = [datetime(2020, 1, 1, 0, 0, 0), datetime(2020, 1, 1, 0, 0, 7)]
    assert time_shifts([first, restarted], starts) == ([0.0, 7.0], False)
    overlapping: list[datetime | None] = [datetime(2020, 1, 1, 0, 0, 0), datetime(2020, 1, 1, 0, 0, 2)]
    assert time_shifts([first, restarted], overlapping) == ([0.0, 3.0], True)  # one interval of 1 s after 2 s
    shifts, assumed = time_shifts([first, restarted + 5, restarted], [None] * 3)
    assert (shifts, assumed) == ([0.0, -2.0, 5.0], True)
    assert time_shifts([np.zeros(1), np.zeros(1)], [None, None]) == ([0.0, 1.0], True)  # no interval is known


def part(time: list[float], *, unit: str = "N", **attributes: Any) -> xr.Dataset:
    values = np.array(time) + 100
    return xr.Dataset(
        {"friction_force": ("time", values, {"units": unit}), attributes.pop("other", "load"): ("time", values)},
        coords={"time": np.array(time)},
        attrs=attributes,
    )


def test_joined_parts_have_a_missing_sample_in_each_gap_and_their_common_channels() -> None:
    parts = [
        part([0.0, 1.0, 2.0], file_name="a.csv", dropped_samples=1, caveats="one\ntwo", file_format="CSV"),
        part([3.0, 4.0], file_name="b.csv", other="speed", caveats="two"),
        part([9.0, 10.0], file_name="c.csv", dropped_samples=2),
    ]
    joined = join_recordings(parts)
    assert joined["time"].values == approx([0, 1, 2, 3, 4, 6.5, 9, 10])
    assert joined["friction_force"].values == approx([100, 101, 102, 103, 104, np.nan, 109, 110], nan_ok=True)
    assert list(joined.data_vars) == ["friction_force"]
    assert joined.attrs["part_starts"] == [0.0, 3.0, 9.0]
    assert joined.attrs["dropped_samples"] == 3
    assert joined.attrs["sample_rate"] == approx(1.0)
    assert joined.attrs["title"] == "3 files as one test"
    assert joined.attrs["file_name"] == "a.csv to c.csv"
    assert joined.attrs["caveats"].splitlines() == [
        "one",
        "two",
        "channels that not all files have were left out: load, speed",
    ]
    again = join_recordings([parts[0], parts[0]])
    assert again["time"].values == approx([0, 1, 2, 3, 4, 5])
    assert "each was placed one sample interval after" in again.attrs["caveats"]
    near = join_recordings([part([0.0, 1.0]), part([2.4, 3.4])])
    assert near.sizes["time"] == 4  # 1.4 intervals are no gap
    assert join_recordings([part([0.0, 1.0]), part([2.6, 3.6])]).sizes["time"] == 5


def test_parts_that_cannot_be_joined_are_refused() -> None:
    with raises(InvalidInput, match="there are no recordings to join"):
        join_recordings([])
    with raises(InvalidInput, match="channel 'friction_force' is in N and V in the files to join"):
        join_recordings([part([0.0]), part([1.0], unit="V")])
    with raises(InvalidInput, match=r"a\.csv has no channel in common with the files after it"):
        join_recordings([part([0.0], file_name="a.csv"), xr.Dataset({"x": ("time", [1.0])}, coords={"time": [1.0]})])
    with raises(InvalidInput, match="the recording has no time along which it could be joined"):
        join_recordings([xr.Dataset({"x": ("revolutions", [1.0])})])


ENTRIES = [
    ChannelEntry("g/time", "g", 10),
    ChannelEntry("g/force", "g", 10),
    ChannelEntry("h/time", "h", 5),
    ChannelEntry("h/force", "h", 5),
    ChannelEntry("h/load", "h", 5),
]


def test_channels_are_chosen_by_group_and_name_with_the_time_beside_them() -> None:
    assert chosen_channels(ENTRIES, Selection(), PATH)[1] == (1, "g/force")
    assert chosen_channels(ENTRIES, Selection(group="h"), PATH) == [(2, "time"), (3, "force"), (4, "load")]
    assert chosen_channels(ENTRIES, Selection(channels=("load",)), PATH) == [(2, "time"), (4, "load")]
    assert chosen_channels(ENTRIES, Selection(channels=("g/force",)), PATH) == [(0, "time"), (1, "force")]
    both = chosen_channels(ENTRIES, Selection(channels=("g/force", "h/force")), PATH)
    assert both == [(0, "g/time"), (1, "g/force"), (2, "h/time"), (3, "h/force")]
    for selection, words in (
        (Selection(channels=("force",)), "'force' is in g and h; choose one with --group"),
        (Selection(channels=("loat",)), "has no channel 'loat'; did you mean load"),
        (Selection(group="k"), "has no group 'k'; it has g, h"),
    ):
        with raises(InvalidInput, match=words):
            chosen_channels(ENTRIES, selection, PATH)
    with raises(InvalidInput, match="has no groups of channels, so that none is 'g'"):
        chosen_channels([ChannelEntry("force", "", 3)], Selection(group="g"), PATH)


def test_channels_of_different_lengths_are_listed_by_group() -> None:
    assert require_common_length(ENTRIES[:2], PATH) == 10
    assert require_common_length([], PATH) == 0
    with raises(InvalidInput, match=r"\(g: time 10, force 10; h: time 5, force 5, load 5\); choose with --group"):
        require_common_length(ENTRIES, PATH)
    many = [ChannelEntry(f"c{k}", "", 3 if k < 10 else 4) for k in range(17)]
    assert listed_channels(many) == "c0 3, c10 4 and 15 more"
    assert listed_channels(many[:16]).count(",") == 15


def test_a_sample_twenty_times_beyond_all_others_is_damaged_and_four_are_a_signal() -> None:
    rng = np.random.default_rng(1)
    values = 5 + rng.uniform(-1, 1, 40)
    values[10] = 5 + 1.05 * 20 * np.max(np.abs(values - np.median(values)))
    axis = 0.5 * np.arange(40.0)
    (said,) = damaged_sample_caveats("load", values, unit="N", axis=axis, axis_label="time [s]")
    assert f"load is {values[10]:.3g} N at time [s] = 5, 20 times or more" in said
    for changed in (np.where(np.arange(40) == 10, 5 + 15, values), np.where(np.arange(40) == 10, 1e3, 5.0)):
        assert damaged_sample_caveats("load", changed, unit="N", axis=axis, axis_label="t") == ()
    for count, caveats in ((3, 3), (4, 0)):
        several = 5 + rng.uniform(-1, 1, 40)
        several[:count] = 1e4
        assert len(damaged_sample_caveats("load", several, unit="N", axis=axis, axis_label="t")) == caveats
    assert damaged_sample_caveats("load", values[:19], unit="N", axis=axis, axis_label="t") == ()
    values[10] = 500.0
    assert len(damaged_sample_caveats("load", values[:20], unit="N", axis=axis, axis_label="t")) == 1


def test_missing_samples_are_said_with_the_first_or_the_end_of_the_column() -> None:
    axis = np.array([0.0, 0.5, 1.0, 1.5])
    nan = np.nan

    def said(values: list[float], name: str = "load") -> tuple[str, ...]:
        return missing_sample_caveat(name, np.array(values), axis=axis, axis_label="time [s]")

    assert said([1, nan, 3, nan]) == (
        "load misses 2 of 4 samples, the first at time [s] = 0.5: numbers are of the others",
    )
    assert said([1, 2, nan, nan]) == ("load ends at time [s] = 0.5, before the recording: numbers are of the others",)
    assert said([nan] * 4) == ("load holds no value",)
    assert said([1, 2, 3, 4]) == ()
    assert said([1, nan, 3, 4], "sliding_speed_set") == ()


@pytest.mark.parametrize("form", ["4", "5", "compressed"])
def test_a_matlab_file_of_any_version_holds_the_vectors_that_scipy_wrote(form: str, tmp_path: Path) -> None:
    path = tmp_path / "test.mat"
    written: dict[str, Any] = {
        "friction_force": np.array([[1.0, 2.5, -3.0]]),
        "column": np.array([[1.5], [2.5]]),
        "table": np.ones((2, 2)),
        "complex": np.array([[1j, 2.0]]),
        "text": "abc",
        "fs": np.array([[400.0]]),
    }
    if form != "4":
        written |= {"short": np.array([[7, -8]], dtype=np.int16), "test": {"load": np.array([[3.0, 4.0]]), "note": "x"}}
    scipy.io.savemat(path, written, format="4" if form == "4" else "5", do_compression=form == "compressed")
    found = {name: values.tolist() for name, values in matlab_arrays(path)}
    expected = {"friction_force": [1.0, 2.5, -3.0], "column": [1.5, 2.5], "fs": [400.0]}
    if form != "4":
        expected |= {"short": [7.0, -8.0], "test.load": [3.0, 4.0]}
    assert found == expected


def test_a_damaged_matlab_file_of_version_four_is_refused_with_its_byte(tmp_path: Path) -> None:
    path = tmp_path / "test.mat"
    scipy.io.savemat(path, {"first": np.arange(3.0), "friction_force": np.arange(4.0)}, format="4")
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])
    with raises(InvalidInput, match="a variable of 1 x 4 values exceeds the file"):
        list(matlab_arrays(path))
    path.write_bytes(whole[:50] + b"\xff" * 20 + whole[70:])
    with raises(InvalidInput, match="byte 50: no variable of a MATLAB file of version 4 begins here"):
        list(matlab_arrays(path))
    scipy.io.savemat(path, {"friction_force": np.arange(4.0), "fs": 2.0}, format="4")
    recording = read_recording(path)
    assert recording["time"].values == approx([0, 0.5, 1.0, 1.5])
    assert recording["friction_force"].values.tolist() == [0, 1, 2, 3]
