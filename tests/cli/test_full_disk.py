"""A full disk: one line that names the file, nothing lost of what stood before, and no temporary file."""

import subprocess
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np
import pytest
from pytest import MonkeyPatch, mark
from tests.cli.conftest import Program

from sonolube.design import SweepPlan, grid_plan, sweep
from sonolube.errors import InvalidInput

ROOT = Path(__file__).parents[2]
TRIBOMETER = ROOT / "examples" / "rigs" / "tribometer.toml"
SPEEDS = "sliding.sliding_speed"
LargestFile = Callable[[int], AbstractContextManager[None]]


def recording(folder: Path) -> Path:
    time = 0.01 * np.arange(2000)
    rows = np.stack([time, 0.4 + 0.01 * np.random.default_rng(0).standard_normal(time.size)], 1)
    path = folder / "test.csv"
    np.savetxt(path, rows, delimiter=",", header="time (s),friction_force (N)", comments="", fmt="%.9g")
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_report_that_does_not_fit_leaves_the_one_before(
    desk: Path, sonolube: Program, largest_file: LargestFile
) -> None:
    call = ("measure", "friction", recording(desk), "--report", "report.html")
    assert sonolube(*call).code == 0
    before = contents(desk)
    with largest_file(20_000):
        refusal = sonolube(*call).refusal
    assert refusal == "sonolube measure: report.html: cannot be written: File too large\n"
    assert contents(desk) == before


def test_a_dataset_that_does_not_fit_leaves_the_one_before(
    desk: Path, sonolube: Program, largest_file: LargestFile
) -> None:
    call = ("response", TRIBOMETER)
    assert sonolube(*call).code == 0
    (desk / "out" / "tribometer-response.png").write_bytes(b"before")
    before = contents(desk / "out")
    with largest_file(5000):
        refusal = sonolube(*call).refusal
    assert refusal.startswith("sonolube response: out/tribometer-response.")
    assert refusal.endswith(": cannot be written: File too large\n")
    assert contents(desk / "out") == before


def small_plan() -> SweepPlan:
    return grid_plan(TRIBOMETER, over={SPEEDS: np.linspace(0.01, 0.1, 1000)})


@mark.parametrize("share", [0.0, 0.01, 0.05, 0.1, 0.3, 0.6, 0.9, 0.999])
def test_a_sweep_that_does_not_fit_keeps_what_stood_before_and_finishes_later(
    tmp_path: Path, share: float, largest_file: LargestFile
) -> None:
    sweep(small_plan(), folder=tmp_path, chunk_points=250).close()
    before = contents(tmp_path)
    chunk = next(name for name in before if name.startswith("chunk-000002"))
    (tmp_path / chunk).unlink()
    size = int(share * len(before["sweep.nc"]))
    with largest_file(size), pytest.raises(InvalidInput, match=r"\.n(c|pz): cannot be written: File too large"):
        sweep(small_plan(), folder=tmp_path, chunk_points=250)
    after = contents(tmp_path)
    assert after == {name: content for name, content in before.items() if name != chunk or name in after}
    with sweep(small_plan(), folder=tmp_path, chunk_points=250) as found:
        assert found.sizes["sliding_speed"] == 1000
    assert contents(tmp_path) == before


@mark.skipif(sys.platform != "linux", reason="file systems are mounted otherwise")
def test_the_program_names_the_file_of_a_sweep_that_a_disk_does_not_hold(tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", disk], check=False, capture_output=True
    ).returncode:
        pytest.skip("no file system can be mounted here")
    try:
        words = ["sweep", str(TRIBOMETER), "--over", f"{SPEEDS}=10mm/s:90mm/s:1000", "--chunk", "250"]
        code = (  # without lines of progress, which a slow machine would print
            "from sonolube.cli import main; from sonolube.cli.console import options\noptions.SHORT = 3600.0; main()"
        )
        (disk / "before").write_bytes(bytes(200_000))
        command = [sys.executable, "-c", code, *words, "--out", str(disk / "out")]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        assert (run.returncode, run.stdout, run.stderr.count("\n")) == (2, "", 1), run.stderr
        assert run.stderr.startswith(f"sonolube sweep: {disk}/out/")
        assert run.stderr.endswith(": cannot be written: No space left on device\n")
        assert not [path for path in disk.rglob("*") if path.name.startswith(".")]
        assert (disk / "before").stat().st_size == 200_000
    finally:
        subprocess.run(["umount", disk], check=True)
