"""Exports: TDMS, CSV and netCDF hold the samples bit for bit and are read back by the readers of measurement."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from tests.laboratory.records.recorded import CHANNELS, begun, block_of, recorded, values_of

from sonolube.errors import InvalidInput, UnknownName
from sonolube.laboratory import Block, Channel
from sonolube.laboratory.records import EXPORT_FORMATS, export_run, new_run
from sonolube.measurement.recordings.reader import read_recording


@pytest.mark.parametrize("file_format", EXPORT_FORMATS)
def test_every_format_is_read_back_bit_for_bit(tmp_path: Path, file_format: str) -> None:
    folder = recorded(tmp_path / "runs")
    (path,) = export_run(folder, file_format=file_format, out=tmp_path / "out")
    read = read_recording(path)
    for column, channel in enumerate(CHANNELS):
        assert np.array_equal(read[channel.quantity], values_of(0, 150)[:, column])
        assert read[channel.quantity].attrs["units"] == channel.unit
    assert np.allclose(read["time"], np.arange(150) / 1000, rtol=0, atol=1e-12)
    assert read.attrs["dropped_samples"] == 0


@pytest.mark.parametrize("file_format", EXPORT_FORMATS)
def test_a_gap_stays_a_gap_in_every_format(tmp_path: Path, file_format: str) -> None:
    recorder = begun(tmp_path / "runs")
    recorder.append(block_of(0, 20))
    recorder.append(block_of(25, 20))
    folder = recorder.finish("completed").folder
    (path,) = export_run(folder, file_format=file_format, out=tmp_path / "out")
    assert read_recording(path).attrs["dropped_samples"] == 5


def test_parts_are_files_of_their_own(tmp_path: Path) -> None:
    recorder = begun(tmp_path / "runs")
    recorder.append(block_of(0, 20))
    recorder.end()
    recorder.begin(CHANNELS, sample_rate=10.0)
    recorder.append(block_of(0, 5, rate=10.0))
    folder = recorder.finish("completed").folder
    names = [path.name for path in export_run(folder, file_format="tdms", out=tmp_path / "out")]
    assert names == [f"{folder.name}.tdms", f"{folder.name}-2.tdms"]


def test_unknown_formats_and_empty_runs_are_refused(tmp_path: Path) -> None:
    folder = begun(tmp_path).finish("stopped").folder
    with pytest.raises(UnknownName, match="unknown format 'tdm'; did you mean tdms"):
        export_run(folder, file_format="tdm", out=tmp_path)
    with pytest.raises(InvalidInput, match="no recording to export"):
        export_run(folder, file_format="tdms", out=tmp_path)


@pytest.mark.parametrize("file_format", ["netcdf", "tdms"])
def test_memory_does_not_grow_with_the_recording(tmp_path: Path, file_format: str) -> None:
    channels = [Channel(name=f"channel{number}", quantity="temperature") for number in range(8)]
    values = np.random.default_rng(0).standard_normal((5000, 8))
    peaks = []
    for blocks in (100, 400):
        recorder = new_run(tmp_path, title="long", protocol="")
        recorder.begin(channels, sample_rate=1e5)
        for number in range(blocks):
            recorder.append(Block(first_sample=5000 * number, sample_rate=1e5, values=values))
        recorder.end()
        export_run(recorder.folder, file_format=file_format, out=tmp_path / "first")  # imports what is needed
        tracemalloc.start()
        export_run(recorder.folder, file_format=file_format, out=tmp_path / "out")
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        recorder.finish("completed")
    assert max(peaks) < 1.2 * min(peaks)
    assert max(peaks) < 100e6
