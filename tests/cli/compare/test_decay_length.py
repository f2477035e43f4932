"""Command `identify decay-length`: verdict first, numbers as JSON, readings and courses as files."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from reliability import decay_length_recordings as made

Program = Callable[..., Any]


@pytest.fixture
def table(rigs: Path) -> Path:
    return rigs.parent / "decay-length-run.csv"


def test_the_verdict_is_the_first_line_and_the_courses_are_written(
    table: Path, tmp_path: Path, sonolube: Program
) -> None:
    run = sonolube("identify", "decay-length", table, "--free-frequency", "40Hz", "--out", tmp_path)
    assert run.code == 0
    first, second, *_ = run.out.splitlines()
    assert first.startswith("long sliding (")
    assert second == "decay-length-run.csv: 59 switches over 295 m; 5 N, 2.3 um, 22 kHz, 65 mm/s"
    with xr.open_dataset(tmp_path / "decay-length-run-decay-length.nc") as data:
        assert data.attrs["verdict"] == first
        assert data.sizes["sliding_distance"] == 59
    assert (tmp_path / "decay-length-run-decay-length.png").stat().st_size > 10_000


def test_a_recording_is_reduced_and_judged(tmp_path: Path, sonolube: Program) -> None:
    rng = np.random.default_rng(5)
    truth = made.truth(rng, "zero_error")
    channels = made.recording(rng, truth, rate=2.0)
    units = ("s", "N", "V", "N", "A", "Hz", "Hz")
    heads = [f"{name} ({unit})" for name, unit in zip(channels, units, strict=True)]
    columns = [np.char.mod("%.6g", values) for values in channels.values()]
    cells = np.where(np.char.equal(np.stack(columns, 1), "nan"), "", np.stack(columns, 1))
    path = tmp_path / "run.csv"
    path.write_text("\n".join([",".join(heads), *(",".join(row) for row in cells)]) + "\n")
    answer = sonolube("identify", "decay-length", path, "--free-frequency", "40Hz", "--out", tmp_path, "--json").answer
    assert answer["leading"] == "zero_error"
    assert answer["switches"] == 59
    assert answer["zero_factor"]["value"] > 1.3
    assert answer["probabilities"]["zero_error"] > 0.9


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (("--load", "4N"), "--load has no meaning without --modal-mass"),
        (("--modal-mass", "8kg"), "--modal-mass needs --free-frequency"),
        (("--rotation-speed", "0.5 1/s"), "--rotation-speed has no meaning for a table of switches"),
        (("--vibration", "2mm/s"), "--vibration 2mm/s is a speed; a length is needed"),
    ],
)
def test_options_without_use_here_are_refused(
    options: tuple[str, str], line: str, table: Path, tmp_path: Path, sonolube: Program
) -> None:
    refusal = sonolube("identify", "decay-length", table, *options, "--out", tmp_path).refusal
    assert line.partition(" is a")[0] in refusal
