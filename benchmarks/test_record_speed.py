"""Blocks of 8 channels at 100 kS/s, 10 ms each, kept on disk: time of each, beside a growing HDF5 dataset and TDMS."""

import io
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.laboratory import Block, Channel
from sonolube.laboratory.records import new_run

CHANNELS = [Channel(name=f"channel{number}", quantity="temperature") for number in range(8)]
RATE, SAMPLES, BLOCKS = 100_000.0, 1000, 1000
VALUES = np.random.default_rng(0).standard_normal((SAMPLES, len(CHANNELS)))

Append = Callable[[int], None]


def ours(folder: Path) -> tuple[Append, Callable[[], object]]:
    recorder = new_run(folder, title="speed", protocol="")
    recorder.begin(CHANNELS, sample_rate=RATE)

    def append(number: int) -> None:
        recorder.append(Block(first_sample=number * SAMPLES, sample_rate=RATE, values=VALUES))

    return append, recorder.end


def hdf5(folder: Path) -> tuple[Append, Callable[[], object]]:
    """Dataset that grows, flushed after each block, so that a killed process loses no block."""
    file = h5py.File(folder / "rival.h5", "w")
    data = file.create_dataset("data", (0, len(CHANNELS)), "f8", maxshape=(None, len(CHANNELS)), chunks=VALUES.shape)

    def append(number: int) -> None:
        data.resize((number + 1) * SAMPLES, axis=0)
        data[number * SAMPLES :] = VALUES
        file.flush()

    return append, file.close


def tdms(folder: Path) -> tuple[Append, Callable[[], object]]:
    """Segment for each block, handed to the operating system."""
    stream: io.BufferedWriter = (folder / "rival.tdms").open("wb")
    writer = TdmsWriter(stream)
    writer.open()
    columns = [np.ascontiguousarray(column) for column in VALUES.T]

    def append(number: int) -> None:
        writer.write_segment(
            [ChannelObject("DAQ", each.name, data) for each, data in zip(CHANNELS, columns, strict=True)]
        )
        stream.flush()

    def close() -> None:
        writer.close()
        stream.close()

    return append, close


@pytest.mark.parametrize("keep", [ours, hdf5, tdms])
def test_a_block_is_kept(
    benchmark: BenchmarkFixture, tmp_path: Path, keep: Callable[[Path], tuple[Append, Callable[[], object]]]
) -> None:
    append, close = keep(tmp_path)
    times = []

    def record() -> None:
        for number in range(BLOCKS):
            begin = time.perf_counter()
            append(number)
            times.append(time.perf_counter() - begin)

    benchmark.pedantic(record, rounds=1, iterations=1)  # type: ignore[no-untyped-call]
    close()
    benchmark.extra_info["megabytes_per_second"] = VALUES.nbytes * BLOCKS / sum(times) / 1e6
    benchmark.extra_info["median_us"] = 1e6 * float(np.median(times))
    benchmark.extra_info["quantile_99_us"] = 1e6 * float(np.quantile(times, 0.99))
    benchmark.extra_info["longest_us"] = 1e6 * max(times)
    if keep is ours:
        assert np.quantile(times, 0.99) < SAMPLES / RATE  # a block is kept before the next one is there
