"""What a recording says of itself by the CF conventions, to a reader who has nothing but the netCDF file."""

import re
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest
import xarray as xr
from pytest import approx
from tests.laboratory.records.described_runs import FREQUENCY, RUNS, by_device_map, lubricated, two_clocks
from tests.laboratory.records.recorded import RATE, recorded

from sonolube.laboratory.records import drop_raw_blocks, export_run, read_run
from sonolube.measurement import read_recording

STANDARD_NAMES = {"time": "s", "air_temperature": "K", "relative_humidity": "1"}  # of CF's table, version 92
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def faults(path: Path) -> list[str]:
    """Rules of the CF conventions that a file breaks."""
    units: Any = pint.UnitRegistry()
    found = []
    with xr.open_dataset(path, decode_cf=False) as data:
        stated = {"Conventions", "title", "source", "history", "references", "id", "institution", "license"}
        found += [f"no attribute {name}" for name in sorted({*stated, "creator_name"} - data.attrs.keys())]
        for name, variable in data.variables.items():
            about = variable.attrs
            unit, _, since = str(about.get("units", "")).partition(" since ")
            try:
                dimension = units.Quantity(1, re.sub(r"(?<=[a-z])(\d)", r"**\1", unit))
            except pint.PintError:
                found.append(f"{name}: no unit {unit}")
                continue
            standard = about.get("standard_name")
            if standard is not None and not dimension.check(units.Quantity(1, STANDARD_NAMES[standard]).dimensionality):
                found.append(f"{name}: {unit} is no unit of {standard}")
            if name == "time" and datetime.fromisoformat(since).tzinfo is None:
                found.append("time without a zone")
            if not about.get("long_name") or not NAME.fullmatch(str(name)):
                found.append(f"{name}: no long name, or no name")
            words = str(about.get("flag_meanings", "")).split()
            if len(words) != np.size(about.get("flag_values", ())):
                found.append(f"{name}: flags {words}")
    return found


@pytest.fixture(scope="module", params=RUNS)
def folder(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return RUNS[request.param](tmp_path_factory.mktemp("described"))


def test_every_netcdf_file_of_a_run_keeps_the_rules_of_the_conventions(folder: Path) -> None:
    paths = sorted(folder.rglob("*.nc"))
    assert paths
    assert {path.name: faults(path) for path in paths} == {path.name: [] for path in paths}


def test_another_reader_gets_times_of_day_in_utc_and_ours_gets_seconds(tmp_path: Path) -> None:
    run = read_run(two_clocks(tmp_path))
    for path, first in ((run.recordings[0], 0.0), (run.clocks["slow"][0], -0.5)):
        with xr.open_dataset(path) as theirs:
            moment = datetime.fromtimestamp(run.summary.begun, UTC).replace(tzinfo=None)
            late = (theirs["time"].to_numpy() - np.datetime64(moment, "ns")) / np.timedelta64(1, "s")
        ours = read_recording(path)["time"]
        assert ours.attrs["units"] == "s"
        assert ours.to_numpy()[0] == 0
        assert late - late[0] == approx(ours.to_numpy(), abs=2e-9)
        assert late[0] == approx(first, abs=0.4)  # the part begins soon after the run


def test_sensor_wave_lubricant_and_settings_stand_in_the_file_also_after_an_export_of_it(tmp_path: Path) -> None:
    folder = lubricated(tmp_path)
    run = read_run(folder)
    drop_raw_blocks(folder)
    (again,) = export_run(folder, file_format="netcdf", out=tmp_path / "export")
    start = run._documents.of("start")[0]
    for path in (run.recordings[0], again):
        with xr.open_dataset(path) as data:
            force = data["friction_force"].attrs
            assert (force["identifier"], force["calibration"], force["calibrated"], force["uncertainty"]) == (
                *("LCM-1", "gain 2 N/V", "2026-03-01", 0.05),
            )
            alias = data["stack_voltage"].attrs["comment"]
            assert alias.startswith("aliased: the drive at 22.3 kHz is above half of the sample rate of 1 kHz")
            assert "it appears at 300 Hz" in alias  # 22.3 kHz less 22 times 1 kHz
            assert "comment" not in force
            assert data["lubricant_set"].attrs["flag_meanings"] == "none PAO_6_MoS2"
            assert data["lubricant_set"].to_numpy()[-1] == data["lubricant_set"].attrs["flag_values"][1]
            assert data.attrs["lubricants"] == '["PAO 6 / MoS2"]'
            assert data.attrs["drive_read_back"] == "0.1 s: FREQ 22300; LOAD INF"
            assert data["relative_humidity" if "relative_humidity" in data else "humidity"].attrs["standard_name"] == (
                "relative_humidity"
            )
            assert (data.attrs["id"], data.attrs["references"]) == (start["uid"], "protocol map_test; rig tribometer")
            assert (data.attrs["creator_name"], data.attrs["license"]) == ("Ann", "CC-BY-4.0")
    assert FREQUENCY > RATE / 2


def test_a_channel_of_a_device_map_has_its_calibration_in_the_file(tmp_path: Path) -> None:
    (path,) = read_run(by_device_map(tmp_path)).recordings
    with xr.open_dataset(path) as data:
        force = data["friction_force"].attrs
        assert force["calibration"] == "gain 4 N/V, offset -0.012 N"
        assert (force["identifier"], force["uncertainty"]) == ("LCM-1234", 0.02)
        assert data["temperature"].attrs["calibration"] == "gain 100 K/V, offset 0 degC"
        assert data["stack_voltage"].attrs["comment"].startswith("aliased: the drive at 22 kHz is above half")


def test_a_recording_of_an_earlier_version_reads_as_before(tmp_path: Path) -> None:
    import h5py

    folder = recorded(tmp_path)
    path = folder / "recording.nc"
    with h5py.File(path, "r+") as file:
        begun = str(file.attrs["begun"])
        file.attrs["begun"] = begun.replace("T", " ").removesuffix("Z")
        file["time"].attrs["units"] = "s"
        for name in ("id", "Conventions"):
            del file.attrs[name]
    drop = folder / "raw" / "blocks-1.bin"
    drop.unlink()
    (again,) = export_run(folder, file_format="netcdf", out=tmp_path / "export")
    with xr.open_dataset(again, decode_cf=False) as data:
        assert data["time"].attrs["units"] == f"seconds since {begun}"
    assert read_recording(path)["time"].to_numpy()[:3] == approx(np.arange(3) / RATE)
