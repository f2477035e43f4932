"""A gigabyte of TDMS reduced to 2 s windows, in bounded memory; a long text beside the parser of pandas."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from nptdms import ChannelObject, TdmsWriter
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.measurement.recordings.reader import read_recording

CHANNELS = ("friction_force", "normal_load", "stack_voltage", "motor_current", "temperature", "magnetic_flux_density")
SAMPLE_RATE = 50_000.0
CHUNK = 100_000
GIGABYTE = 1_000_000_000

REDUCE = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from pathlib import Path
from peak_memory import peak_memory
from sonolube.measurement.friction.windows import streamed_window_statistics
reduced = streamed_window_statistics(Path(sys.argv[1]))
assert all(windows.time.size > 200 for windows in reduced.values())
print(peak_memory())
"""


def write_recording(path: Path, size: int) -> None:
    signals = np.random.default_rng(1).normal(1.0, 0.1, (len(CHANNELS), CHUNK))
    with TdmsWriter(path) as writer:
        for _ in range(size // (8 * CHUNK * len(CHANNELS)) + 1):
            writer.write_segment(
                [
                    ChannelObject("DAQ", name, signal, {"wf_increment": 1 / SAMPLE_RATE})
                    for name, signal in zip(CHANNELS, signals, strict=True)
                ]
            )


@pytest.fixture(scope="module")
def gigabyte(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "gigabyte.tdms"
    write_recording(path, GIGABYTE)
    return path


def test_a_gigabyte_is_reduced_to_windows_in_a_fresh_process(benchmark: BenchmarkFixture, gigabyte: Path) -> None:
    command = [sys.executable, "-c", REDUCE, str(gigabyte)]
    run = benchmark.pedantic(  # type: ignore[no-untyped-call]
        lambda: subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True), rounds=1, iterations=1
    )
    peak = int(run.stdout)
    benchmark.extra_info["peak_memory_bytes"] = peak
    assert peak < 500_000_000


ROWS = 2_000_000
READ = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from pathlib import Path
from peak_memory import peak_memory
{{read}}
print(peak_memory())
"""
PANDAS = "import pandas as pd\npd.read_csv(sys.argv[1])"
OURS = "from sonolube.measurement.recordings.reader import read_recording\nread_recording(sys.argv[1])"


@pytest.fixture(scope="module")
def two_million_rows(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "long.csv"
    columns = np.arange(ROWS) / 2000, np.random.default_rng(1).normal(2.0, 0.1, ROWS)
    head = "time [s],friction_force [N]"
    np.savetxt(path, np.column_stack(columns), fmt=["%.4f", "%.5f"], delimiter=",", header=head, comments="")
    return path


def peak_of(read: str, path: Path) -> int:
    """Peak memory of a fresh process that reads a file."""
    command = [sys.executable, "-c", READ.format(read=read), str(path)]
    return int(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)


@pytest.mark.benchmark(group="two million rows of text")
def test_two_million_rows_are_read(benchmark: BenchmarkFixture, two_million_rows: Path) -> None:
    recording = benchmark.pedantic(read_recording, args=[two_million_rows], rounds=5, warmup_rounds=1)  # type: ignore[no-untyped-call]
    benchmark.extra_info["peak_memory_bytes"] = peak_of(OURS, two_million_rows)
    assert recording.sizes["time"] == ROWS


@pytest.mark.benchmark(group="two million rows of text")
def test_rival_pandas_reads_two_million_rows(benchmark: BenchmarkFixture, two_million_rows: Path) -> None:
    frame = benchmark.pedantic(pd.read_csv, args=[two_million_rows], rounds=5, warmup_rounds=1)  # type: ignore[no-untyped-call]
    benchmark.extra_info["peak_memory_bytes"] = peak_of(PANDAS, two_million_rows)
    assert len(frame) == ROWS
