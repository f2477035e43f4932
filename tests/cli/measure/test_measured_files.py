"""Commands of `measure`: many files at once, bad ones among them, and answers against known inputs."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx

from sonolube.cli import main


def run(*words: object) -> int:
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    return int(ended.value.code or 0)


@pytest.fixture
def plates(tmp_path: Path) -> Path:
    folder = tmp_path / "plates"
    folder.mkdir()
    x = np.arange(64.0)
    wave = 1e-6 * np.sin(2 * np.pi * x / 16)
    np.save(folder / "a.npy", wave[np.newaxis] + wave[:, np.newaxis])
    (folder / "b.npy").write_bytes(b"\x93NUMPY damaged")
    np.save(folder / "c.npy", 2 * (wave[np.newaxis] + wave[:, np.newaxis]))
    (folder / ".hidden").write_text("not a scan")
    return folder


def answer_of(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(capsys.readouterr().out)
    return content


def test_one_bad_file_of_a_folder_does_not_lose_the_others(plates: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("measure", "surface", plates, "--spacing", "1um", "--json") == 1
    answer = answer_of(capsys)
    assert [result["title"] for result in answer["results"]] == ["a.npy", "c.npy"]
    # two crossed sines of amplitude a have the variance a^2
    assert [result["values"]["rms_height"]["value"] for result in answer["results"]] == approx([1e-6, 2e-6], rel=0.02)
    assert [Path(refusal["file"]).name for refusal in answer["refused"]] == ["b.npy"]
    assert "not a whole NPY file" in answer["refused"][0]["reason"]
    assert answer["settings"]["spacing"] == "1um"


def test_the_page_lists_the_file_that_was_refused(plates: Path, tmp_path: Path) -> None:
    assert run("measure", "surface", plates, "--spacing", "1um", "--report", tmp_path / "page.html") == 1
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "Not measured" in page
    assert "b.npy: not a whole NPY file" in page


def test_all_files_refused_is_bad_input(plates: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("measure", "surface", plates / "b.npy", "--spacing", "1um") == 2
    assert "not a whole NPY file" in capsys.readouterr().err


def test_an_empty_folder_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("measure", "impedance", tmp_path) == 2
    assert "holds no file" in capsys.readouterr().err


def test_a_length_in_newton_is_refused_by_its_option(plates: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("measure", "surface", plates, "--spacing", "1N") == 2
    assert "--spacing 1N is a force; expected a length" in capsys.readouterr().err


def test_the_hall_probe_of_a_steady_disc_gives_its_speed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time = np.arange(0, 10, 0.005)
    pulse = np.exp(-(((0.8 * time % 1 - 0.5) / 0.03) ** 2))
    rows = np.stack([time, pulse], 1)
    path = tmp_path / "hall.csv"
    np.savetxt(path, rows, delimiter=",", header="time (s),magnetic_flux_density (mT)", comments="", fmt="%.6g")
    assert run("measure", "rotation", path, "--groove-diameter", "50mm", "--json") == 0
    values = answer_of(capsys)["results"][0]["values"]
    assert values["sliding_speed"]["value"] == approx(np.pi * 0.05 * 0.8, rel=1e-4)
    assert values["repaired_pulses"]["value"] == 0


def test_a_linear_spring_is_calibrated_to_its_stiffness(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time = np.arange(0, 40, 0.1)
    x = 50 * (1 - np.cos(0.5 * time))  # um
    path = tmp_path / "spring.csv"
    heading = "time (s),displacement (um),applied_force (N)"
    np.savetxt(path, np.stack([time, x, 0.02 * x], 1), delimiter=",", header=heading, comments="", fmt="%.9g")
    assert run("measure", "calibration", path, "--apply", path, "--json") == 0
    spring, force = answer_of(capsys)["results"]
    assert spring["values"]["mean_stiffness"]["value"] == approx(2e4, rel=1e-6)
    assert spring["values"]["dissipated_energy"]["value"] == approx(0.0, abs=1e-9)
    assert force["values"]["highest_force"]["value"] == approx(2.0, rel=1e-3)


def test_velocities_become_displacements_per_volt(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time, omega = np.arange(0, 2e-3, 1e-6), 2 * np.pi * 20e3
    for volts in (10.0, 20.0, 30.0):
        drive, velocity = volts / 2 * np.cos(omega * time), omega * 50e-9 * volts * np.cos(omega * time + 0.5)
        np.savetxt(
            tmp_path / f"{volts}.csv",
            np.stack([time, drive, velocity], 1),
            delimiter=",",
            header="time (s),stack_voltage (V),tip (m/s)",
            comments="",
        )
    files = sorted(tmp_path.glob("*.csv"))
    assert run("measure", "vibration", *files, "--frequency", "20kHz", "--json") == 0
    *each, proportion = answer_of(capsys)["results"]
    assert [sheet["values"]["vibration_amplitude"]["value"] for sheet in each] == approx([0.5e-6, 1e-6, 1.5e-6])
    assert each[0]["tables"]["points"]["rows"][0]["phase"] == approx(0.5 - np.pi / 2)
    assert proportion["values"]["amplitude_per_volt"]["value"] == approx(50e-9)


def test_the_stack_of_a_rig_is_found_in_the_impedance_that_the_rig_computes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from sonolube.models.dynamics.structure import electrical_admittance
    from sonolube.rig import read_rig, structure_by_stack

    rig = Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml"
    stack, in_structure = structure_by_stack(read_rig(rig))
    frequency = np.linspace(15e3, 40e3, 201)
    z = 1 / electrical_admittance(in_structure(stack), frequency=frequency)
    rows = np.stack([frequency, np.abs(z), np.degrees(np.angle(z))], 1)
    path = tmp_path / "stack.csv"
    np.savetxt(path, rows, delimiter=",", header="frequency (Hz),|Z| (ohm),phase (deg)", comments="")
    assert run("measure", "impedance", path, "--stack-of", rig, "--json") == 0
    values = answer_of(capsys)["results"][0]["values"]
    assert values["stack_stiffness"]["value"] == approx(stack.stack_stiffness, rel=0.01)
    assert values["free_capacitance"]["value"] == approx(stack.free_capacitance, rel=0.01)


def test_rings_of_known_depth_give_their_volume_and_the_reduction(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from sonolube.models.surfaces import GrooveShape, GrooveTrack, ScannedField, synthetic_groove

    field = ScannedField(field_shape=(160, 220), spacing_x=11e-6, spacing_y=11e-6)
    areas = {}
    for ring, depth in {"off": 60e-6, "on": 24e-6}.items():
        (tmp_path / ring).mkdir()
        shape = GrooveShape(groove_width=0.8e-3, groove_depth=depth)
        for place in (1, 2):
            track = GrooveTrack(track_direction=0.4 * place, track_curvature=0.0, track_offset=0.0)
            scan = synthetic_groove(shape, track=track, seed=place, field=field).scan
            np.save(tmp_path / ring / f"{place}.npy", scan.height)
        across = np.linspace(-0.5e-3, 0.5e-3, 20001)
        areas[ring] = float(np.trapezoid(shape.depth_at(across, np.zeros_like(across)), across))
    (tmp_path / "on" / "3.npy").write_bytes(b"damaged")
    words = ["--groove-diameter", "50mm", "--sliding-distance", "100m", "--spacing", "11um", "--json"]
    page = tmp_path / "ring.html"
    call = ["measure", "groove", tmp_path / "on", "--without-vibration", tmp_path / "off", *words, "--report", page]
    assert run(*call) == 1
    answer = answer_of(capsys)
    sheets = {result["title"]: result["values"] for result in answer["results"]}
    for title, ring in {"the ring": "on", "the ring without vibration": "off"}.items():
        # Pappus: section times circumference
        assert sheets[title]["ring_volume"]["value"] == approx(np.pi * 0.05 * areas[ring], rel=0.02)
        assert sheets[title]["wear_rate"]["value"] == approx(np.pi * 0.05 * areas[ring] / 100, rel=0.02)
    assert sheets["1 ring with vibration against 1 without"]["wear_reduction"]["value"] == approx(0.6, abs=0.02)
    assert [Path(refusal["file"]).name for refusal in answer["refused"]] == ["3.npy"]
    assert page.read_text(encoding="utf-8").count("data:image/png") >= 18


def test_a_ring_needs_diameter_and_distance(plates: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("measure", "groove", plates, "--groove-diameter", "50mm", "--spacing", "1um") == 2
    assert "--groove-diameter and --sliding-distance" in capsys.readouterr().err
