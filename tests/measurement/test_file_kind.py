"""Kinds of measured files, of synthetic ones and of those of instruments."""

from pathlib import Path

import numpy as np
import pytest
from pytest import raises

from sonolube.errors import InvalidInput
from sonolube.measurement.file_kind import file_kind

SHARED = Path(__file__).parents[3] / "shared" / "data"
EXAMPLES = Path(__file__).parents[2] / "examples"
HEATED = "\n".join(["time (s),temperature (degC)", *(f"{k / 10},{20 + k / 100}" for k in range(100))])
GRID = "\n".join(f"{x} {y} {0.1 * x * y}" for y in range(8) for x in range(8))

TEXTS = {
    "heated.csv": (HEATED, "recording"),
    "force.csv": ("time,friction_force\n0,1\n1,2\n", "recording"),
    "own.csv": ("Zeit;Kraft\n0;1\n1;2\n", "recording"),
    "cycles.csv": ("CycleID,CoF.mean\n1,0.3\n2,0.4\n", "recording"),
    "runs.csv": ("sliding_speed [mm/s],friction_force [N],intrinsic_friction_force [N]\n20,1,2\n", "runs"),
    "reduction.csv": ("amplitude [um],friction_reduction [%]\n1,20\n", "runs"),
    "levels.csv": ("voltage_peak_to_peak [V],friction_force [N]\n28,1\n0,2\n", "runs"),
    "spectrum.csv": ("frequency [Hz],|Z| [ohm],phase [deg]\n1e3,1e4,-90\n2e3,5e3,-89\n", "spectrum"),
    "plate.xyz": (GRID, "scan"),
    "plate.txt": (GRID, "scan"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_text_is_known_by_its_headings(name: str, tmp_path: Path) -> None:
    text, kind = TEXTS[name]
    path = tmp_path / name
    path.write_text(text)
    assert file_kind(path) == kind


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252", "utf-16"])
@pytest.mark.parametrize("rows", [10, 2000])
def test_a_spectrum_is_one_in_every_encoding_and_of_every_length(encoding: str, rows: int, tmp_path: Path) -> None:
    body = "".join(f"{20 + k / 1000:.3f};{60 + k / 7:.2f};{-900 + k}\n".replace(".", ",") for k in range(rows))
    path = tmp_path / "gerät.csv"
    path.write_bytes(f"Gerät A\n\nFrequenz in kHz;Realteil (Ohm);Imaginärteil (Ohm)\n{body}".encode(encoding))
    assert file_kind(path) == "spectrum"


@pytest.mark.parametrize("headings", ["w,z,t", "time,F (N),R (mm)", "frequency (Hz),velocity (mm/s),phase (deg)"])
def test_other_columns_of_short_names_are_no_spectrum(headings: str, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(f"{headings}\n1,2,3\n2,3,4\n")
    assert file_kind(tmp_path / "a.csv") == "recording"


def test_arrays_are_scans_and_examples_are_runs(tmp_path: Path) -> None:
    np.save(tmp_path / "heights.npy", np.zeros((4, 4)))
    assert file_kind(tmp_path / "heights.npy") == "scan"
    assert {file_kind(path) for path in EXAMPLES.glob("*-runs.csv")} == {"runs"}


@pytest.mark.skipif(not SHARED.is_dir(), reason="files of instruments are not beside the project; see shared/data")
def test_files_of_instruments_are_what_their_folders_say() -> None:
    folders = {"friction": "recording", "impedance": "spectrum", "surfaces": "scan"}
    found = {path: file_kind(path) for folder in folders for path in (SHARED / folder).iterdir()}
    assert {path.name: kind for path, kind in found.items() if kind != folders[path.parent.name]} == {}


def test_an_empty_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty.csv").touch()
    with raises(InvalidInput, match="is empty"):
        file_kind(tmp_path / "empty.csv")
