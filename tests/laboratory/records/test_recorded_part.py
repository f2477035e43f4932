"""Parts of a recording: names and units of variables, caveats, a chart, and the parts with friction joined."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import raises
from tests.same import approx

from sonolube.charts import Line
from sonolube.errors import InvalidInput
from sonolube.laboratory import Block, Channel
from sonolube.laboratory.block import quantity_of
from sonolube.laboratory.records import RunRecorder, drop_raw_blocks, new_run, read_run
from sonolube.laboratory.records.documents import read_documents
from sonolube.laboratory.records.recorded_part import channels_chart, converted_part, recorded_part, switched_recording
from sonolube.laboratory.records.run_folder import recording_path, sha256


def channel(name: str, quantity: str = "") -> Channel:
    return Channel(name=name, quantity=quantity or quantity_of(name))


FORCE, LOAD = channel("friction_force"), channel("normal_load")
EMISSION = Channel(name="ae", quantity="acoustic_emission", free_unit="V")
COUNT = Channel(name="count", quantity="events", free_unit="")


def begun(parent: Path, *channels: Channel, rate: float = 100.0) -> RunRecorder:
    recorder = new_run(parent, title="Parts", protocol="")
    recorder.begin(channels, sample_rate=rate)
    return recorder


def block(first: int, samples: int, channels: int = 1, *, level: float = 1.0, rate: float = 100.0) -> Block:
    return Block(first_sample=first, sample_rate=rate, values=np.full((samples, channels), level))


def test_variables_are_named_by_their_quantity_where_one_standard_channel_measures_it(tmp_path: Path) -> None:
    channels = (channel("gaussmeter"), channel("temperature"), channel("pin", "temperature"), EMISSION, COUNT)
    recorder = begun(tmp_path, *channels)
    recorder.note("drive", sample=0, voltage_peak_to_peak=4.0, frequency=1e3)
    recorder.append(block(0, 5, 5))
    folder = recorder.folder
    raw = recorded_part(folder, 1, read_documents(folder), facts={})
    assert dict(raw.variables) == {
        "magnetic_flux_density": "magnetic_flux_density",
        "temperature": "temperature",  # the channel itself, since the pin has one too
        "pin": "temperature",
        "ae": "acoustic_emission",
        "count": "events",
        "voltage_peak_to_peak": "voltage_peak_to_peak",
        "voltage_peak_to_peak_set": "voltage_peak_to_peak_set",
        "frequency_set": "frequency_set",
        "lubricant_set": "lubricant_set",
        "recording_part": "recording_part",
    }
    assert dict(raw.units) == {"ae": "V", "count": ""}
    assert raw.set_points == ("voltage_peak_to_peak_set", "frequency_set", "lubricant_set", "recording_part")
    assert raw.caveats == ["voltage_peak_to_peak is the voltage that was set, not measured"]
    recorder.finish("completed")
    written = converted_part(folder / "recording.nc")
    for name in ("samples", "missing", "sample_rate", "variables", "units", "clock", "set_points", "lubricants"):
        assert getattr(written, name) == getattr(raw, name), name
    assert written.begun == approx(raw.begun, abs=1e-5)
    (time, columns), (again, stored) = next(raw.pieces()), next(written.pieces())
    assert time == approx([0.0, 0.01, 0.02, 0.03, 0.04])
    assert columns[5:8] == [approx(4.0), approx(4.0), approx(1e3)]
    assert np.array_equal(np.stack([again, *stored]), np.stack([time, *columns]))


def test_a_voltage_that_was_measured_stands_for_itself(tmp_path: Path) -> None:
    recorder = begun(tmp_path, channel("voltage_peak_to_peak"))
    recorder.note("drive", sample=0, voltage_peak_to_peak=4.0, frequency=1e3)
    recorder.append(block(0, 5, level=3.9))
    folder = recorder.finish("completed").folder
    data = read_run(folder).dataset()
    assert data["voltage_peak_to_peak"].to_numpy() == approx(3.9)
    assert data["voltage_peak_to_peak_set"].to_numpy() == approx(4.0)
    assert "not measured" not in str(data.attrs.get("caveats", ""))


def test_gaps_and_damage_are_told_with_their_number_and_place(tmp_path: Path) -> None:
    recorder = begun(tmp_path, FORCE)
    for first in (0, 15, 30):
        recorder.append(block(first, 10))
    folder = recorder.folder
    part = recorded_part(folder, 1, read_documents(folder), facts={})
    assert part.caveats == ["10 samples are missing in 2 gaps, the first at 0.1 s"]
    assert (part.samples, part.missing, part.damaged) == (30, 10, 0)
    path = folder / "raw" / "blocks-1.bin"
    content = bytearray(path.read_bytes())
    content[-(2 * (32 + 80)) + 40] ^= 1  # a sample of the second block
    path.write_bytes(bytes(content))
    damaged = recorded_part(folder, 1, read_documents(folder), facts={})
    assert damaged.caveats == [
        "20 samples are missing in a gap, the first at 0.1 s",
        "the raw blocks are damaged at 1 places, whose samples are left out",
    ]
    assert np.concatenate([time for time, _ in damaged.pieces()])[[9, 10]] == approx([0.09, 0.3])


def test_a_part_of_another_clock_tells_its_offset_and_is_a_file_by_its_name(tmp_path: Path) -> None:
    recorder = begun(tmp_path, FORCE)
    recorder.append(block(0, 10))
    recorder.begin_beside("slow", [EMISSION], sample_rate=10.0, first=7, ago=0.0, uncertainty=0.15)
    recorder.append(block(7, 4, rate=10.0), clock="slow")
    folder = recorder.finish("completed").folder
    run = read_run(folder)
    assert run.clocks == {"slow": (folder / "clock-slow-2.nc",)}
    assert run.recordings == (folder / "recording.nc",)
    part = converted_part(recording_path(folder, 2, "slow"))
    assert part.clock is not None
    assert (part.clock_name, part.clock.part, part.clock.first_sample, part.clock.uncertainty) == ("slow", 1, 7, 0.15)
    assert part.caveats == [
        f"clock slow: time 0 is {part.clock.offset:.4g} s after that of part 1 of the recording, within 150 ms; the"
        " clocks drift apart, and set points are placed by the clock of the computer"
    ]
    (time, _) = next(part.pieces())
    assert time == approx([0.0, 0.1, 0.2, 0.3])
    assert (run.channels["ae"].clock, run.channels["ae"].unit) == ("slow", "V")
    assert run.summary.samples == 10  # of the clock of the run
    assert run.summary.duration == approx(0.1)


def test_raw_blocks_are_told_part_by_part_as_they_are_removed(tmp_path: Path) -> None:
    recorder = begun(tmp_path, FORCE)
    recorder.append(block(0, 25_000))
    folder = recorder.folder
    with raises(InvalidInput):  # at work
        drop_raw_blocks(folder)
    recorder.finish("completed")
    size = (folder / "raw" / "blocks-1.bin").stat().st_size
    assert drop_raw_blocks(folder) == (f"blocks-1.bin removed, {size / 1e6:.3g} MB",)
    assert size / 1e6 == approx(0.2, abs=2e-3)
    assert drop_raw_blocks(folder) == ()


def test_raw_blocks_that_are_damaged_or_not_in_the_recording_are_kept(tmp_path: Path) -> None:
    recorder = begun(tmp_path, FORCE)
    recorder.append(block(0, 10))
    recorder.append(block(10, 10))
    folder = recorder.finish("completed").folder
    path = folder / "raw" / "blocks-1.bin"
    whole = path.read_bytes()
    content = bytearray(whole)
    content[-(2 * (32 + 80)) + 40] ^= 1
    path.write_bytes(bytes(content))
    with raises(InvalidInput, match="is damaged at 1 places, and is kept"):
        drop_raw_blocks(folder)
    path.write_bytes(whole[: -(32 + 80)])
    with raises(InvalidInput, match=r"has other samples than the raw blocks|differs from the raw blocks"):
        drop_raw_blocks(folder)
    path.write_bytes(whole)
    assert len(drop_raw_blocks(folder)) == 1


def test_a_recording_whose_values_differ_from_its_blocks_is_told_by_the_variable(tmp_path: Path) -> None:
    import h5netcdf

    recorder = begun(tmp_path, FORCE)
    recorder.append(block(0, 10))
    folder = recorder.finish("completed").folder
    with h5netcdf.File(folder / "recording.nc", "r+") as file:
        file["friction_force"][3] = 7.0
    facts = json.loads((folder / "run.json").read_text())
    facts["recordings"]["recording.nc"] = sha256((folder / "recording.nc").read_bytes())
    (folder / "run.json").write_text(json.dumps(facts))
    with raises(InvalidInput, match=r"recording\.nc: friction_force differs from the raw blocks, which are kept"):
        drop_raw_blocks(folder)


def test_a_file_that_is_no_recording_of_a_run_is_refused(tmp_path: Path) -> None:
    (tmp_path / "x.nc").write_bytes(b"no HDF5")
    with raises(InvalidInput, match=r"x\.nc: is no recording of a run"):
        converted_part(tmp_path / "x.nc")


def test_the_chart_has_a_panel_a_channel_with_its_meaning_and_unit() -> None:
    time = np.arange(50) / 10
    data = {
        "friction_force": ("time", np.linspace(1.0, 2.0, 50), {"units": "N"}),
        "ae_level": ("time", np.ones(50)),
        "normal_load_set": ("time", np.ones(50), {"units": "N"}),
    }
    chart = channels_chart(xr.Dataset(data, {"time": time}))
    told = [(panel.x.label, panel.x.unit, panel.y.label, panel.y.unit) for panel in chart.panels]
    assert told == [("Time", "s", "Friction force", "N"), ("Time", "s", "Ae level", "1")]
    (line,) = chart.panels[0].parts
    assert isinstance(line, Line)
    assert (line.x[[0, -1]], line.y[[0, -1]], line.is_stepped) == (approx([0.0, 4.9]), approx([1.0, 2.0]), True)
    assert (chart.size, chart.shares_x) == (approx((7.0, 0.6 + 2 * 1.4)), True)


def test_the_parts_with_friction_and_load_are_joined_and_those_without_a_drive_were_not_driven(tmp_path: Path) -> None:
    recorder = begun(tmp_path, FORCE, LOAD)
    recorder.append(block(0, 10, 2, level=2.0))
    recorder.end()
    recorder.begin([FORCE], sample_rate=100.0)
    recorder.append(block(0, 20, level=3.0))
    recorder.end()
    folder = recorder.folder
    recorder.begin([FORCE, LOAD], sample_rate=100.0)
    recorder.note("drive", sample=0, voltage_peak_to_peak=12.0, frequency=1e3)
    values = np.full((15, 2), 4.0)
    values[4, 1] = np.nan
    recorder.append(Block(first_sample=0, sample_rate=100.0, values=values))
    recorder.finish("completed")
    joined = switched_recording(folder)
    assert joined["friction_force"].to_numpy().tolist() == [2.0] * 10 + [4.0] * 14
    assert joined["voltage_peak_to_peak"].to_numpy()[10:].tolist() == [12.0] * 14
    assert joined["voltage_peak_to_peak"].attrs["units"] == "V"


@pytest.mark.parametrize(
    ("channels", "driven", "reason"),
    [
        ((FORCE,), True, "no part of its recording has the channels friction_force and normal_load"),
        ((FORCE, LOAD), False, "its vibration is never switched on; run the protocol decay_length_run"),
    ],
)
def test_a_run_without_load_or_vibration_is_refused(
    tmp_path: Path, channels: tuple[Channel, ...], driven: bool, reason: str
) -> None:
    recorder = begun(tmp_path, *channels)
    if driven:
        recorder.note("drive", sample=0, voltage_peak_to_peak=12.0, frequency=1e3)
    recorder.append(block(0, 10, len(channels)))
    with raises(InvalidInput, match=reason):
        switched_recording(recorder.finish("completed").folder)
