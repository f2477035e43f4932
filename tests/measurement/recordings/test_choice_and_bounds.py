"""Choice of groups and channels, and bounds on what damaged or absurd recordings may take."""

import struct
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
from nptdms import ChannelObject, TdmsWriter
from pytest import approx, raises
from tests.work import calls

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import MAX_CHANNELS
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, Selection
from sonolube.measurement.recordings.reader import read_recording, recording_blocks
from sonolube.measurement.recordings.tdms import MAX_SEGMENTS


def selecting(group: str = "", *channels: str) -> RecordingMapping:
    return RecordingMapping(channels={}, selection=Selection(group=group, channels=channels))


@pytest.fixture
def two_rates(tmp_path: Path) -> Path:
    """Group `fast` with a time column, and group `slow` with a stated interval; both hold a `force`."""
    path = tmp_path / "rates.tdms"
    fast = [
        ChannelObject("fast", "Time", 0.01 * np.arange(100), {"unit_string": "s"}),
        ChannelObject("fast", "force", np.arange(100.0), {"unit_string": "mN"}),
    ]
    slow = [
        ChannelObject("slow", name, np.arange(10.0) + 1, {"wf_increment": 0.1, "unit_string": unit})
        for name, unit in (("force", "N"), ("temperature", "degC"))
    ]
    with TdmsWriter(path) as writer:
        writer.write_segment([*fast, *slow])
    return path


def test_channels_of_different_lengths_are_listed_by_group_with_the_remedy(two_rates: Path) -> None:
    with raises(InvalidInput) as caught:
        read_recording(two_rates)
    assert "(fast: Time 100, force 100; slow: force 10, temperature 10)" in str(caught.value)
    assert "--group or --channel" in str(caught.value)


def test_a_group_of_a_tdms_file_has_its_own_time_and_names(two_rates: Path) -> None:
    fast = read_recording(two_rates, mapping=selecting("fast"))
    assert list(fast.data_vars) == ["force"]
    assert fast.attrs["sample_rate"] == approx(100)
    slow = read_recording(two_rates, mapping=selecting("slow"))
    assert slow["temperature"].to_numpy()[0] == approx(274.15)
    assert slow["time"].to_numpy() == approx(0.1 * np.arange(10))
    blocks = list(recording_blocks(two_rates, mapping=selecting("slow"), block_samples=4))
    assert [block.sizes["time"] for block in blocks] == [4, 4, 2]


def test_a_channel_is_chosen_by_name_where_one_group_has_it(two_rates: Path) -> None:
    assert read_recording(two_rates, mapping=selecting("", "temperature")).sizes["time"] == 10
    assert read_recording(two_rates, mapping=selecting("", "fast/force")).sizes["time"] == 100
    with raises(InvalidInput, match="'force' is in fast and slow; choose one with --group"):
        read_recording(two_rates, mapping=selecting("", "force"))
    assert read_recording(two_rates, mapping=selecting("slow", "force"))["force"].attrs["units"] == "N"


def test_unknown_groups_and_channels_are_refused_with_the_closest(two_rates: Path) -> None:
    with raises(InvalidInput, match="has no group 'slw'; did you mean slow"):
        read_recording(two_rates, mapping=selecting("slw"))
    with raises(InvalidInput, match="has no channel 'temperatur'; did you mean temperature"):
        read_recording(two_rates, mapping=selecting("", "temperatur"))


def test_a_group_of_hdf5_and_a_structure_of_matlab_are_chosen_likewise(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "groups.h5", "w") as file:
        for group, samples in (("fast", 100), ("slow", 10)):
            file[f"{group}/time"], file[f"{group}/friction_force"] = np.arange(samples) / samples, np.ones(samples)
    both = {name: {"time": np.arange(n) / n, "friction_force": np.ones(n)} for name, n in (("fast", 100), ("slow", 10))}
    scipy.io.savemat(tmp_path / "groups.mat", both)
    for name in ("groups.h5", "groups.mat"):
        with raises(InvalidInput, match="different numbers of samples"):
            read_recording(tmp_path / name)
        with raises(InvalidInput, match="has no group 'fst'; did you mean fast"):
            read_recording(tmp_path / name, mapping=selecting("fst"))
        for group, samples in (("fast", 100), ("slow", 10)):
            recording = read_recording(tmp_path / name, mapping=selecting(group))
            assert recording["friction_force"].sizes == {"time": samples}


def test_an_axis_of_another_length_is_refused_in_one_line(tmp_path: Path) -> None:
    scipy.io.savemat(tmp_path / "axis.mat", {"clock": np.arange(5.0), "force": np.ones(8)})
    mapping = RecordingMapping(
        channels={"friction_force": ChannelSource(column="force")}, axis=ChannelSource(column="clock")
    )
    with raises(InvalidInput, match=r"different numbers of samples \(clock 5, force 8\)"):
        read_recording(tmp_path / "axis.mat", mapping=mapping)


def segment(samples: int, data: bytes, *, length: int | None = None) -> bytes:
    """A TDMS segment with a double channel, whose index states a number of samples."""

    def text(value: str) -> bytes:
        return struct.pack("<I", len(value)) + value.encode()

    index = text("/'g'/'friction_force'") + struct.pack("<IIIQ", 20, 10, 1, samples)
    interval = struct.pack("<I", 1) + text("wf_increment") + struct.pack("<Id", 10, 0.5)
    meta = struct.pack("<I", 1) + index + interval
    stated = len(meta) + len(data) if length is None else length
    return b"TDSm" + struct.pack("<IIQQ", 14, 4713, stated, len(meta)) + meta + data


@pytest.mark.parametrize("length", [None, 2**43 + 1000], ids=["whole", "cut"])
def test_a_tdms_file_that_states_more_samples_than_it_holds_is_refused_without_a_warning(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], length: int | None
) -> None:
    path = tmp_path / "huge.tdms"
    path.write_bytes(segment(2**40, np.arange(10.0).tobytes(), length=length))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with raises(InvalidInput, match=r"80 bytes of data announces chunks of 8796093022208 bytes"):
            read_recording(path)
    assert capfd.readouterr() == ("", "")


def refused(path: Path, reason: str) -> None:
    with raises(InvalidInput, match=reason):
        read_recording(path)


def test_a_tdms_file_of_a_million_segments_is_refused_at_once(tmp_path: Path) -> None:
    path = tmp_path / "many.tdms"
    path.write_bytes(segment(1, bytes(8)) * (MAX_SEGMENTS + 1))
    work = calls(lambda: refused(path, "more than 100000 segments; defragment it"))
    assert work < 20 * MAX_SEGMENTS  # their headers are counted; to read them takes ten times as many


@pytest.mark.parametrize("columns", [MAX_CHANNELS + 1, 200_000])
def test_a_table_of_very_many_columns_is_refused_at_once(tmp_path: Path, columns: int) -> None:
    path = tmp_path / "wide.csv"
    path.write_text("time," + ",".join(map(str, range(columns))) + "\n" + "1," * columns + "1\n")
    work = calls(lambda: refused(path, "columns or more, but at most 10000 are read"))
    assert work < 10 * columns  # they are counted; to read them takes twenty times as many


def test_the_work_to_read_columns_grows_no_faster_than_their_number(tmp_path: Path) -> None:
    work = []
    for columns in (1000, 8000):
        path = tmp_path / f"{columns}.csv"
        names = ",".join(f"c{index}" for index in range(columns))
        path.write_text(f"time,{names}\n" + "".join(f"{row}{',1' * columns}\n" for row in range(3)))
        read_recording(path)
        work.append(calls(partial(read_recording, path)))
    assert work[1] < 9 * work[0]  # eight times the columns; quadratic growth would take 64 times as many calls


def test_a_variable_that_is_stored_twice_is_a_caveat(tmp_path: Path) -> None:
    path = tmp_path / "twice.mat"
    scipy.io.savemat(path, {"friction_force": np.ones(4), "fs": 10.0})
    content = path.read_bytes()
    path.write_bytes(content + content[128:])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        recording = read_recording(path)
    assert "friction_force" in recording.attrs["caveats"]


@pytest.mark.parametrize(
    ("unit", "quantity", "value"),
    [("g", "friction_force", 9.80665e-3), ("kg", "normal_load", 9.80665), ("g", "magnetic_flux_density", 1e-4),
     ("C", "temperature", 274.15), ("1/min", "rotation_speed", 1 / 60)],
)  # fmt: skip
def test_units_with_a_second_meaning_take_the_one_of_the_quantity(
    tmp_path: Path, unit: str, quantity: str, value: float
) -> None:
    path = tmp_path / "unit.csv"
    path.write_text(f"time [s],{quantity} [{unit}]\n0,1\n1,1\n")
    assert read_recording(path)[quantity].to_numpy()[0] == approx(value)


def test_among_many_channels_one_of_each_length_is_listed(tmp_path: Path) -> None:
    content = {f"c{index}": np.ones(5) for index in range(40)} | {"odd": np.ones(6), "fs": 1.0}
    scipy.io.savemat(tmp_path / "many.mat", content)
    with raises(InvalidInput, match=r"\(c0 5, odd 6 and 39 more\)"):
        read_recording(tmp_path / "many.mat")


@pytest.mark.parametrize(
    ("given", "reason"),
    [({"gain": float("nan")}, "gain must be finite"), ({"gain": float("inf")}, "gain must be finite"),
     ({"offset": float("nan")}, "offset must be finite"), ({"gain": 0.0}, "gain of column 'F' must not be zero"),
     ({"unit": 3}, "unit must be text, got 3")],
)  # fmt: skip
def test_a_column_without_a_finite_gain_and_offset_is_refused(given: dict[str, Any], reason: str) -> None:
    with pytest.raises(InvalidInput, match=reason):
        ChannelSource(column="F", **given)
    whole = ChannelSource(column="F", gain=-2.0, offset=0.5, other_columns=("G",))
    assert whole.labels == ("F", "G")
