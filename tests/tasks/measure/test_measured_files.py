"""Tasks of `measure` in Python: the answers of the program, files as bytes, and one dataset of many files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from pytest import CaptureFixture, approx, raises
from tests.same import same

from sonolube.cli import main
from sonolube.errors import InvalidInput, SonolubeError, UnknownName
from sonolube.report import Drawing
from sonolube.report.measured.sheet import Figure, Sheet
from sonolube.tasks import measure
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.measure.measured_files import MeasuredFiles, column_mapping
from sonolube.tasks.progress import TaskCancelled

ROOT = Path(__file__).parents[3]
SHEET = ROOT / "examples" / "test-sheet.toml"


def printed(capfd: CaptureFixture[str], *words: object, code: int = 0) -> dict[str, Any]:
    """JSON that the program prints, but the files that it wrote."""
    with raises(SystemExit) as end:
        main([*map(str, words), "--json"])
    assert (end.value.code or 0) == code
    content: dict[str, Any] = json.loads(capfd.readouterr().out)
    content.pop("files")
    return content


def table(path: Path, heading: str, *columns: NDArray[np.float64]) -> Path:
    np.savetxt(path, np.stack(columns, 1), delimiter=",", header=heading, comments="", fmt="%.9g")
    return path


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    time = np.arange(0, 20, 0.01)
    force = 0.4 + 0.02 * np.random.default_rng(0).standard_normal(time.size)
    return table(tmp_path / "friction.csv", "time (s),friction_force (N)", time, force)


@pytest.fixture
def plate(tmp_path: Path) -> Path:
    wave = 1e-6 * np.sin(2 * np.pi * np.arange(64.0) / 16)
    np.save(tmp_path / "plate.npy", wave[np.newaxis] + wave[:, np.newaxis])
    return tmp_path / "plate.npy"


def as_bytes(path: Path) -> NamedBytes:
    return NamedBytes(path.name, path.read_bytes())


def test_friction_in_python_is_the_answer_of_the_program(recording: Path, capfd: CaptureFixture[str]) -> None:
    words = ["--sliding-speed", "20mm/s", "--window", "1s", "--test-sheet", SHEET]
    program = printed(capfd, "measure", "friction", recording, *words)
    answer = measure.friction(recording, sliding_speed="20mm/s", window="1s", test_sheet=SHEET)
    same(json.loads(answer.to_json()), program)
    in_si = measure.friction([as_bytes(recording)], sliding_speed=0.02, window=1.0, test_sheet=as_bytes(SHEET))
    content = json.loads(in_si.to_json())
    assert content.pop("settings") == {"sliding speed": "0.02 m/s", "window": "1.0 s"}
    same(content, {name: each for name, each in program.items() if name != "settings"})


def test_the_conditions_of_the_test_are_printed_below_its_numbers(recording: Path) -> None:
    text = measure.friction(recording, test_sheet=SHEET).text()
    assert text.index("Mean force of the whole recording") < text.index("Test parameters") < text.index("not stated")
    assert "Test parameters" not in measure.friction(recording).text()


def test_friction_by_the_motor_needs_its_calibration_by_the_names_of_python(recording: Path) -> None:
    with raises(InvalidInput, match=r"^torque_constant needs idle_current and groove_diameter$"):
        measure.friction(recording, torque_constant=0.5)
    with raises(InvalidInput, match=r"^idle_current has no meaning without torque_constant"):
        measure.friction(recording, idle_current="1A")


def test_a_surface_of_a_bare_grid_takes_its_spacing_as_the_program_does(
    plate: Path, capfd: CaptureFixture[str]
) -> None:
    program = printed(capfd, "measure", "surface", plate, "--spacing", "1um", "--long-cutoff", "40um")
    text = measure.surface(plate, spacing="1um", long_cutoff="40um")
    same(json.loads(text.to_json()), program)
    in_si = measure.surface(as_bytes(plate), spacing=1e-6, long_cutoff=40e-6)
    same(in_si.object()["results"], program["results"])
    values = in_si.dataset()
    for name, value in program["results"][0]["values"].items():
        same(float(values[name]), value["value"])
        assert values[name].attrs["units"] == (value["unit"] or "1")
    assert text.plot().axes
    assert repr(text).startswith("plate.npy\n")
    assert "<th>Sq, root-mean-square height</th>" in text._repr_html_()
    with raises(UnknownName):
        text.plot("no such figure")


def test_a_grid_may_have_two_spacings_and_points_need_a_unit(tmp_path: Path, capfd: CaptureFixture[str]) -> None:
    heights = 1e-6 * np.random.default_rng(2).standard_normal((64, 80))
    np.save(tmp_path / "grid.npy", heights)
    y, x = np.mgrid[:40, :50]
    columns = np.stack([2.0 * x.ravel(), 3.0 * y.ravel(), 1e6 * heights[:40, :50].ravel()], axis=1)
    np.savetxt(tmp_path / "points.xyz", columns)
    calls: tuple[tuple[str, tuple[str, str], dict[str, Any]], ...] = (
        ("grid.npy", ("--spacing", "0.5um,0.6um"), {"spacing": "0.5um,0.6um"}),
        ("points.xyz", ("--length-unit", "um"), {"length_unit": "um"}),
    )
    for name, option, given in calls:
        program = printed(capfd, "measure", "surface", tmp_path / name, *option)
        same(json.loads(measure.surface(tmp_path / name, **given).to_json()), program)
    with raises(InvalidInput, match="give spacing_x and spacing_y"):
        measure.surface(tmp_path / "grid.npy")
    with raises(InvalidInput, match=r"^spacing 1N is a force; expected a length"):
        measure.groove(tmp_path / "grid.npy", spacing="1N")


def test_a_groove_in_python_is_the_answer_of_the_program(tmp_path: Path, capfd: CaptureFixture[str]) -> None:
    x = 8e-6 * np.arange(160)
    section = -3e-6 * np.exp(-(((x - x.mean()) / 120e-6) ** 2))
    path = tmp_path / "groove.npy"
    np.save(path, section + 5e-8 * np.random.default_rng(3).standard_normal((120, 160)))
    program = printed(capfd, "measure", "groove", path, "--spacing", "8um")
    same(json.loads(measure.groove(path, spacing="8um").to_json()), program)
    (in_si,) = measure.groove(as_bytes(path), spacing=8e-6).object()["results"]
    assert in_si.pop("title") == "groove.npy"  # of bytes there is no folder
    assert program["results"][0].pop("title") == f"{tmp_path.name}/groove.npy"
    same([in_si], program["results"])
    with raises(InvalidInput, match=r"^a ring needs groove_diameter and sliding_distance; without_vibration is"):
        measure.groove(path, spacing=8e-6, groove_diameter=0.05)


def test_a_rotation_in_python_is_the_answer_of_the_program(tmp_path: Path, capfd: CaptureFixture[str]) -> None:
    time = np.arange(0, 10, 0.005)
    pulse = np.exp(-(((0.8 * time % 1 - 0.5) / 0.03) ** 2))
    path = table(tmp_path / "hall.csv", "time (s),magnetic_flux_density (mT)", time, pulse)
    program = printed(capfd, "measure", "rotation", path, "--groove-diameter", "50mm", "--magnets", "2")
    same(json.loads(measure.rotation(path, groove_diameter="50mm", magnets=2).to_json()), program)
    in_si = measure.rotation([as_bytes(path)], groove_diameter=0.05, magnets=2)
    same(in_si.object()["results"], program["results"])
    with raises(InvalidInput, match=r"^groove_diameter 5N is a force"):
        measure.rotation(path, groove_diameter="5N")


def test_a_temperature_in_python_is_the_answer_of_the_program(tmp_path: Path, capfd: CaptureFixture[str]) -> None:
    time = np.arange(0, 60, 0.05)
    noise = 0.05 * np.random.default_rng(2).standard_normal(time.size)
    warm = 22 + 18 * -np.expm1(-np.clip(time - 4, 0, None) / 7) + noise
    path = table(tmp_path / "heated.csv", "time (s),temperature (degC)", time, warm)
    idle = table(tmp_path / "idle.csv", "time (s),temperature (degC)", time, 20 + 0 * time + noise)
    words = ["--start-time", "4s", "--end-time", "59s", "--without-vibration", idle]
    program = printed(capfd, "measure", "temperature", path, *words)
    answer = measure.temperature(path, start_time="4s", end_time="59s", without_vibration=idle)
    same(json.loads(answer.to_json()), program)
    values = program["results"][0]["values"]
    assert values["final_temperature_rise"]["value"] == approx(18, rel=5e-3)
    (term,) = answer.sheets[0].tables[0].rows
    assert term == approx((7, 7, 7, 18), rel=1e-2)
    # by hand: 2 + 18 (1 - 7/55 (1 - exp(-55/7)))
    assert values["temperature_rise"]["value"] == approx(2 + 18 * (1 - 7 / 55), rel=5e-3)
    with raises(InvalidInput, match=r"heated\.csv: 58 s to 58.1 s holds fewer than 8 temperatures"):
        measure.temperature(path, start_time=58, end_time=58.1).object()
    with raises(InvalidInput, match="end_time 5 s must be later than start_time 5 s"):
        measure.temperature(path, start_time=5, end_time=5)


def test_a_calibration_in_python_is_the_answer_of_the_program(tmp_path: Path, capfd: CaptureFixture[str]) -> None:
    time = np.arange(0, 40, 0.1)
    x = 50 * (1 - np.cos(0.5 * time))  # um
    path = table(tmp_path / "spring.csv", "time (s),displacement (um),applied_force (N)", time, x, 0.02 * x)
    words = ["--apply", path, "--displacement-uncertainty", "1um", "--degree", "2"]
    program = printed(capfd, "measure", "calibration", path, *words)
    text = measure.calibration(path, apply=[path], displacement_uncertainty="1um", degree=2)
    same(json.loads(text.to_json()), program)
    one = as_bytes(path)
    in_si = measure.calibration(one, apply=[one], displacement_uncertainty=1e-6, degree=2)
    same(in_si.object()["results"], program["results"])
    with raises(InvalidInput, match=r"^displacement_uncertainty has no meaning without apply"):
        measure.calibration(path, displacement_uncertainty=1e-6)
    with raises(InvalidInput, match=r"^apply needs one calibration, got 2 files$"):
        measure.calibration([path, path], apply=[path])


def test_a_spectrum_in_python_is_the_answer_of_the_program(tmp_path: Path, capfd: CaptureFixture[str]) -> None:
    f = np.linspace(15e3, 30e3, 400)
    w = 2 * np.pi * f
    z = 1 / (1j * w * 1e-8 + 1 / (20 + 1j * w * 0.1 + 1 / (1j * w * 6e-10)))
    heading = "frequency (Hz),|Z| (ohm),phase (deg)"
    path = table(tmp_path / "spectrum.csv", heading, f, np.abs(z), np.degrees(np.angle(z)))
    words = ["--residual", "log-magnitude", "--series-resistance", "2ohm"]
    program = printed(capfd, "measure", "impedance", path, *words)
    text = measure.impedance(path, residual="log-magnitude", series_resistance="2ohm")
    same(json.loads(text.to_json()), program)
    in_si = measure.impedance(as_bytes(path), residual="log-magnitude", series_resistance=2.0)
    same(in_si.object()["results"], program["results"])
    with raises(InvalidInput, match=r"^branches has no meaning for stack_of; it is for an equivalent circuit$"):
        measure.impedance(path, stack_of=ROOT / "examples" / "rigs" / "tribometer.toml", branches=2)


def test_a_vibration_in_python_is_the_answer_of_the_program(tmp_path: Path, capfd: CaptureFixture[str]) -> None:
    time = np.arange(0, 0.1, 5e-5)
    tips = [np.sin(2 * np.pi * 1000 * time + phase) for phase in (0.0, 0.3)]
    path = table(tmp_path / "tip.csv", "time (s),left (um),right (um)", time, *tips)
    shapes = tmp_path / "shapes.csv"
    shapes.write_text("1,0\n0.5,1\n")
    program = printed(capfd, "measure", "vibration", path, "--frequency", "1kHz", "--modes", shapes)
    same(json.loads(measure.vibration(path, frequency="1kHz", modes=shapes).to_json()), program)
    in_si = measure.vibration(as_bytes(path), frequency=1000.0, modes=as_bytes(shapes))
    same(in_si.object()["results"], program["results"])
    assert list(in_si.dataset()["modes_assurance"].values) == approx(
        [row["assurance"] for row in program["results"][0]["tables"]["modes"]["rows"]]
    )


def test_many_files_are_one_dataset_with_a_place_for_each(recording: Path, tmp_path: Path) -> None:
    time = np.arange(0, 60, 0.02)
    volts = 5.0 * np.floor(time / 10)
    force = 1 - 0.015 * volts + 0.03 * np.random.default_rng(1).standard_normal(time.size)
    heading = "time (s),voltage_peak_to_peak (V),friction_force (N)"
    stairs = table(tmp_path / "stairs.csv", heading, time, volts, force)
    answer = measure.friction([recording, stairs, NamedBytes("empty.csv", b"")])
    path = answer.to_netcdf(tmp_path / "friction.nc")
    one, other = answer.object()["results"]
    with xr.open_dataset(path, engine="h5netcdf") as data:
        assert list(data["sheet"].values) == ["friction.csv", "stairs.csv"]
        for name, unit in (("mean_force", "N"), ("friction_force_deviation", "N")):
            expected = [each["values"][name]["value"] for each in (one, other)]
            assert list(data[name].values) == expected
            assert data[name].attrs["units"] == unit
        assert float(data["mean_force_uncertainty"][0]) == one["values"]["mean_force"]["uncertainty"]
        assert np.isnan(data["stick_slip_steps"][0])  # the first file has no steps
        assert list(data["steps_sheet"].values) == 6 * ["stairs.csv"]
        assert list(data["source_sha256"].values) == [each["source"]["sha256"] for each in (one, other)]
        assert "stick-slip" in data.attrs["not_found"]
        assert data.attrs["settings"] == "window: 2s"
        assert data.attrs["refused"].startswith("empty.csv: ")


def test_a_refused_file_among_others_is_listed_and_one_alone_is_an_error(recording: Path) -> None:
    bad = NamedBytes("bad.csv", b"rubbish")
    answer = measure.friction([recording, bad])
    (reason,) = answer.refusals().values()
    assert list(answer.refusals()) == ["bad.csv"]
    assert answer.has_result
    assert f"  refused: {reason}" in answer.text(line_length=None)
    assert "/" not in reason  # no private folder
    assert not measure.friction([bad]).has_result
    with raises(SonolubeError, match=r"^bad\.csv: "):
        measure.friction(bad)


def test_progress_is_reported_for_each_file_and_a_measurement_can_be_cancelled(recording: Path) -> None:
    told: list[tuple[str, int, int]] = []
    measure.friction([recording, recording], progress=lambda *report: told.append(report))
    assert told == [("measuring: friction.csv", 0, 2), ("measuring: friction.csv", 1, 2)]
    with raises(TaskCancelled):
        measure.friction(recording, cancelled=lambda: True)


def test_figures_are_called_by_their_title_and_of_several_files_by_their_file_too() -> None:
    def sheet(title: str) -> Sheet:
        return Sheet(title=title, figures=(Figure(title="Trace", drawing=Drawing(chart=None, caption="", forms=())),))

    one, two = (MeasuredFiles(title="t", sheets=[sheet(f) for f in files], refused={}) for files in (["a"], ["a", "b"]))
    assert list(one.figures()) == ["Trace"]
    assert list(two.figures()) == ["a: Trace", "b: Trace"]
    assert one.has_result
    assert not MeasuredFiles(title="t", sheets=[], refused={"a": "no"}).has_result


def test_parts_of_a_recording_are_chosen_beside_the_mapping_of_its_columns() -> None:
    assert column_mapping(None) is None
    chosen = column_mapping(None, group="G", channels=("a", "b"), sections=("1",))
    assert chosen is not None
    assert (chosen.selection.group, chosen.selection.channels, chosen.selection.sections) == ("G", ("a", "b"), ("1",))
    assert dict(chosen.channels) == {}
    for given in ({"group": "G"}, {"channels": ("a",)}, {"sections": ("1",)}):
        assert column_mapping(None, **given) is not None
