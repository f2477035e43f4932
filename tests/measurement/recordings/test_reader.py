"""Recordings of every format against the data they were written from, in SI with provenance."""

import hashlib
import os
import struct
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import pyuff
import scipy.io
from nptdms import ChannelObject, TdmsWriter
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping, read_mapping
from sonolube.measurement.recordings.reader import read_recording, recording_blocks, recording_format, write_recording

CORPUS = Path(__file__).parent / "corpus"
ROOT = Path(__file__).parents[3]
COF = ROOT.parent / "shared" / "data" / "friction" / "CoF-Measurements.csv"


def test_a_csv_file_is_read_in_si_with_its_provenance() -> None:
    path = CORPUS / "quoted.csv"
    recording = read_recording(path)
    assert recording["time"].to_numpy().tolist() == [0.0, 0.5, 1.0]
    assert recording["friction_force"].to_numpy() == approx([0.1, 0.125, np.nan], nan_ok=True)
    assert recording["friction_force"].attrs["units"] == "N"
    assert recording["friction_force"].attrs["source_unit"] == "mN"
    assert recording.attrs["file_name"] == "quoted.csv"
    assert recording.attrs["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert recording.attrs["sample_rate"] == 2.0
    assert "note" not in recording


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pipes among its paths")
@pytest.mark.parametrize(
    ("content", "is_text"), [(b"time [s],friction force [N]\n0,1\n1,2\n2,3\n", True), (b"\x89HDF\r\n\x1a\n" * 9, False)]
)
def test_only_text_is_read_from_a_pipe_since_readers_of_other_formats_go_back(content: bytes, is_text: bool) -> None:
    reading, writing = os.pipe()
    try:
        os.write(writing, content)
        os.close(writing)
        path = Path(f"/dev/fd/{reading}")
        if is_text:
            assert recording_format(path).name == "delimited text"
        else:
            with raises(InvalidInput, match="is a pipe, which this format cannot be read from"):
                recording_format(path)
    finally:
        os.close(reading)


def test_a_mapping_gives_names_units_and_calibration(tmp_path: Path) -> None:
    path = CORPUS / "semicolons.txt"
    recording = read_recording(path, mapping=ROOT / "examples" / "mappings" / "calibrated-load-cell.toml")
    assert recording["time"].to_numpy() == approx([0.0, 1e-3, 2e-3])
    assert recording["friction_force"].to_numpy() == approx([1.0, 2.25, np.nan], nan_ok=True)  # 12.5 N/V, -0.25 N
    assert recording["rotation_speed"].to_numpy() == approx(6.67 / 60)
    assert recording["friction_force"].attrs["calibration_gain"] == 12.5


def test_dropped_samples_are_counted(tmp_path: Path) -> None:
    recording = read_recording(CORPUS / "tabs.txt")
    assert recording.attrs["dropped_samples"] == 0  # two intervals do not tell which is right
    path = tmp_path / "gap.csv"
    path.write_text("time,friction_force\n" + "".join(f"{t},1\n" for t in (0, 1, 2, 3, 7, 8)))
    assert read_recording(path).attrs["dropped_samples"] == 3


def test_an_export_with_one_row_per_cycle_has_the_axis_revolutions(tmp_path: Path) -> None:
    if not COF.is_file():
        pytest.skip(f"{COF.name} is not beside the project; see shared/data")
    mapping = ROOT / "examples" / "mappings" / "friction-by-cycle.toml"
    recording = read_recording(COF, mapping=mapping)
    assert recording.sizes == {"revolutions": 30}  # cycles 3 to 32 of the first sequence
    assert recording["revolutions"].to_numpy().tolist() == list(range(3, 33))
    # first and second line of the file, read by eye
    assert recording["friction_coefficient"].to_numpy()[:2].tolist() == [2.188295411, 1.736416265]
    assert recording["normal_load"].to_numpy() == approx(10e-3)
    assert recording["sliding_speed"].to_numpy() == approx(10e-3)
    assert recording["nominal_pressure"].to_numpy() == approx(620.0)
    again = read_recording(write_recording(recording, path=tmp_path / "again.nc"))
    assert np.array_equal(again["friction_coefficient"], recording["friction_coefficient"])


def test_an_export_whose_cycles_restart_is_refused() -> None:
    if not COF.is_file():
        pytest.skip(f"{COF.name} is not beside the project; see shared/data")
    mapping = RecordingMapping(
        channels={"friction_coefficient": ChannelSource(column="CoF.mean", unit="")},
        axis=ChannelSource(column="CycleID"),
        axis_quantity="revolutions",
    )
    with raises(InvalidInput, match=r"line 92: revolutions decreases to 2"):  # 30 rows of three lines, one header
        read_recording(COF, mapping=mapping)


@pytest.mark.parametrize("name", ["one-x-column", "no-x-column", "many-x-columns"])
def test_lvm_files_with_any_layout_of_time_give_the_same_recording(name: str) -> None:
    recording = read_recording(CORPUS / f"{name}.lvm").isel(time=slice(0, 3))
    assert recording["time"].to_numpy() == approx([0.0, 0.0025, 0.005])
    assert recording["friction_force"].to_numpy().tolist() == [1.0, 1.25, 0.75]
    assert recording["drive"].to_numpy().tolist() == [0.0, 2.5, -2.5]
    assert recording["drive"].attrs["units"] == "V"
    assert recording.attrs["begun"] == "2016/03/04 14:10:11.5"


def test_segments_of_an_lvm_file_are_shifted_by_their_start_times() -> None:
    recording = read_recording(CORPUS / "decimal-comma-segments.lvm")
    assert recording["time"].to_numpy() == approx([0.0, 0.0025, 2.0, 2.0025])  # the second begins 2 s later
    assert recording["friction_force"].to_numpy().tolist() == [1.0, 1.25, 2.0, 2.25]


def test_a_special_section_of_an_lvm_file_is_skipped() -> None:
    assert read_recording(CORPUS / "special-section.lvm")["friction_force"].to_numpy().tolist() == [1.0, 1.25]


def test_tdms_segments_are_concatenated() -> None:
    recording = read_recording(CORPUS / "two-segments.tdms")
    assert recording["friction_force"].to_numpy().tolist() == [1, 1.25, 1.5, 1.75, 2, 2.25, 2.5, 2.75]
    assert recording["drive"].to_numpy().tolist() == [0, 1, 2, 3, 10, 11, 12, 13]
    assert recording["time"].to_numpy() == approx(0.0025 * np.arange(8))
    assert recording.attrs["sample_rate"] == approx(400.0)


def test_a_truncated_tdms_file_gives_its_complete_samples() -> None:
    recording = read_recording(CORPUS / "truncated.tdms")
    assert 4 <= recording.sizes["time"] < 8
    assert recording.attrs["incomplete"]
    whole = read_recording(CORPUS / "two-segments.tdms").isel(time=slice(0, recording.sizes["time"]))
    assert np.array_equal(recording["friction_force"], whole["friction_force"])


def test_interleaved_tdms_data_are_separated_by_channel(tmp_path: Path) -> None:
    def text(value: str) -> bytes:
        return struct.pack("<I", len(value)) + value.encode()

    def described(path: str, interval: float) -> bytes:
        index = struct.pack("<IIIQ", 20, 10, 1, 3)  # three doubles
        return text(path) + index + struct.pack("<I", 1) + text("wf_increment") + struct.pack("<Id", 10, interval)

    meta = struct.pack("<I", 2) + described("/'g'/'friction_force'", 0.5) + described("/'g'/'normal_load'", 0.5)
    data = np.array([1.0, 10.0, 2.0, 20.0, 3.0, 30.0]).tobytes()
    toc = (1 << 1) | (1 << 2) | (1 << 3) | (1 << 5)
    lead = b"TDSm" + struct.pack("<IIQQ", toc, 4713, len(meta) + len(data), len(meta))
    path = tmp_path / "interleaved.tdms"
    path.write_bytes(lead + meta + data)
    recording = read_recording(path)
    assert recording["friction_force"].to_numpy().tolist() == [1, 2, 3]
    assert recording["normal_load"].to_numpy().tolist() == [10, 20, 30]


def test_channels_of_different_rates_are_refused_without_a_mapping_that_selects_one(tmp_path: Path) -> None:
    path = tmp_path / "rates.tdms"
    with TdmsWriter(path) as writer:
        fast = ChannelObject("g", "force", np.arange(100.0), {"wf_increment": 0.01})
        slow = ChannelObject("g", "temperature", np.arange(10.0) + 290, {"wf_increment": 0.1})
        writer.write_segment([fast, slow])
    with raises(InvalidInput, match="different numbers of samples"):
        read_recording(path)
    mapping = RecordingMapping(channels={"friction_force": ChannelSource(column="force", unit="N")})
    assert read_recording(path, mapping=mapping).sizes["time"] == 100


@pytest.mark.parametrize("size", [1, 3, 4, 5, 8, 100])
def test_concatenated_blocks_equal_the_whole_recording(size: int) -> None:
    path = CORPUS / "two-segments.tdms"
    parts = list(recording_blocks(path, block_samples=size))
    whole = read_recording(path)
    assert [part.sizes["time"] for part in parts[:-1]] == [size] * (len(parts) - 1)
    for name in ("time", "friction_force", "drive"):
        assert np.array_equal(np.concatenate([part[name] for part in parts]), whole[name])


def test_matlab_files_of_versions_5_and_7_3_give_the_same_recording(tmp_path: Path) -> None:
    force = np.array([1.0, 1.5, 0.5])
    scipy.io.savemat(tmp_path / "five.mat", {"friction_force": force, "fs": 400.0, "test": {"load": force * 3}})
    with h5py.File(tmp_path / "seven.mat", "w", userblock_size=512) as file:
        file["friction_force"] = force[:, None]
        file["fs"] = np.array([[400.0]])
        file["test/load"] = force[:, None] * 3
    with (tmp_path / "seven.mat").open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512))
    for name in ("five.mat", "seven.mat"):
        recording = read_recording(tmp_path / name)
        assert recording["friction_force"].to_numpy().tolist() == [1.0, 1.5, 0.5]
        assert recording["test_load"].to_numpy().tolist() == [3.0, 4.5, 1.5]
        assert recording["time"].to_numpy() == approx([0, 0.0025, 0.005])


def test_netcdf_3_and_4_give_the_recording_they_were_written_from(tmp_path: Path) -> None:
    recording = read_recording(CORPUS / "one-x-column.lvm")
    modern = write_recording(recording, path=tmp_path / "modern.nc")
    recording.to_netcdf(tmp_path / "classic.nc", engine="scipy", format="NETCDF3_64BIT")
    for path in (modern, tmp_path / "classic.nc"):
        again = read_recording(path)
        assert np.array_equal(again["time"], recording["time"])
        assert np.array_equal(again["friction_force"], recording["friction_force"], equal_nan=True)
        assert again["friction_force"].attrs["units"] == "N"
        assert again.attrs["original_sha256"] == recording.attrs["sha256"]
        assert again.attrs["begun"] == recording.attrs["begun"]


@pytest.mark.parametrize("kind", ["ascii", "binary"])
def test_a_universal_file_of_a_vibrometer_is_read(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "vibrometer.uff"
    velocity = np.sin(np.arange(50) / 3)
    data = pyuff.prepare_58(
        binary=0, id1="x", id2="x", id3="x", id4="x", id5="x", func_type=1, rsp_node=1, rsp_dir=3,
        ref_node=1, ref_dir=3, data=velocity, x=np.arange(50) * 1e-5, abscissa_spacing=1, abscissa_min=0.0,
        abscissa_inc=1e-5, ordinate_axis_units_lab="mm/s",
        abscissa_spec_data_type=17, ordinate_spec_data_type=11, orddenom_spec_data_type=0, ver_num=0, load_case_id=0,
        rsp_ent_name="NONE", ref_ent_name="NONE", z_axis_value=0.0, ord_data_type=4,
    )  # fmt: skip
    data["ordinate_axis_lab"] = "vibration_velocity"
    pyuff.UFF(str(path)).write_sets([data], "overwrite")
    if kind == "binary":  # as vibrometers write it; pyuff reads it but cannot write it
        lines = path.read_bytes().splitlines(keepends=True)
        lines[1] = b"    58b     1     2          11%12d     0     0           0           0\n" % (8 * velocity.size)
        path.write_bytes(b"".join(lines[:13]) + velocity.astype("<f8").tobytes() + b"\n" + lines[-1])
    recording = read_recording(path)
    assert recording["vibration_velocity"].to_numpy() == approx(velocity * 1e-3, abs=1e-9)
    assert recording.attrs["sample_rate"] == approx(1e5)


def test_gauss_and_rpm_are_converted_as_instruments_use_them(tmp_path: Path) -> None:
    path = tmp_path / "probe.csv"
    path.write_text(
        "time [s],magnetic_flux_density [G],rotation_speed [rpm],temperature [degC]\n0,10,60,20\n1,20,120,25\n"
    )
    recording = read_recording(path)
    assert recording["magnetic_flux_density"].to_numpy() == approx([1e-3, 2e-3])
    assert recording["rotation_speed"].to_numpy() == approx([1.0, 2.0])  # turns a second, not radians
    assert recording["temperature"].to_numpy() == approx([293.15, 298.15])


def test_a_channel_without_a_stated_unit_is_marked() -> None:
    recording = read_recording(CORPUS / "tabs.txt")
    assert recording["friction_force"].attrs["source_unit"] == "not stated, taken as SI"


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("[channels.friction_forc]\ncolumn = 'F'", "unknown quantity 'friction_forc'; did you mean friction_force"),
        (
            "[channels.friction_force]\ncolum = 'F'",
            r"channels\.friction_force\.colum: unknown key; did you mean column",
        ),
        ("[text]\nseparator = ','\ndecimal_sign = ','", "separator and decimal_sign are both ','"),
        ("[axis]\nquantity = 'temperature'", r"axis\.quantity must be one of time, revolutions"),
        ("[axis]\nsample_rate = '2 mm'", r"axis\.sample_rate 2 mm is a length"),
        ("axis = 3", "axis must be a section, got 3"),
        ("[channels.friction_force]\ncolumn = 'F'\ngain = 0.0", "gain of column 'F' must not be zero"),
        ("nonsense", "Expected '='"),
    ],
)
def test_a_wrong_mapping_is_refused_with_its_key(text: str, match: str, tmp_path: Path) -> None:
    path = tmp_path / "mapping.toml"
    path.write_text(text)
    with raises(InvalidInput, match=match):
        read_mapping(path)


def test_a_missing_column_is_refused_with_the_closest_label(tmp_path: Path) -> None:
    mapping = RecordingMapping(channels={"friction_force": ChannelSource(column="friction_forc")}, sample_rate=1.0)
    with raises(InvalidInput, match="has no column 'friction_forc'; did you mean friction_force"):
        read_recording(CORPUS / "tabs.txt", mapping=mapping)
