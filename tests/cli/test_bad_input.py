"""Bad input to every command: one line that names it, exit code 2, nothing written."""

import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pytest import CaptureFixture, MonkeyPatch, raises

from sonolube.cli import main

ROOT = Path(__file__).parents[2]
TRIBOMETER, POWER_MAP = "examples/rigs/tribometer.toml", "examples/rigs/power_map.toml"
UNCERTAIN, COLLAR = "examples/rigs/tribometer_uncertain.toml", "examples/rigs/collar.toml"
RUNS = (ROOT / "examples" / "efficiency-runs.csv").read_text(encoding="utf-8")
HEAD, *ROWS = RUNS.splitlines()
FEW = ("--samples", "32")
THREE = ("drive.frequency", "sliding.sliding_speed", "contact.normal_load")
UTF8_MARK = b"\xef\xbb\xbf"


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: MonkeyPatch) -> Path:
    """Work in a folder that has the examples, its name with a space and an umlaut."""
    folder = tmp_path / "Prüfstand 2"
    folder.mkdir()
    shutil.copytree(ROOT / "examples", folder / "examples")
    (folder / "file").write_text("in the way")
    (folder / "empty").touch()
    (folder / "garbage").write_bytes(bytes(range(256)) * 64)
    (folder / "long").write_text(f"{HEAD}\n{'x' * 100_000},1,2,3\n")
    monkeypatch.chdir(folder)
    return folder


def refused(capsys: CaptureFixture[str], *arguments: str, faults: int = 0) -> str:
    before = sorted(Path().rglob("*"))
    with raises(SystemExit) as end:
        main(arguments)
    out, err = capsys.readouterr()
    assert (end.value.code, out) == (2, ""), err
    assert err.count("\n") == 1 + faults
    assert len(err) < 1500 + 300 * faults
    assert sorted(Path().rglob("*")) == before
    return err


RIG_COMMANDS = {
    "contact": (),
    "friction": (),
    "wear": (),
    "simulate": (),
    "response": (),
    "transient": (),
    "thermal": ("--pin", "m50", "--disc", "m50"),
    "regime": ("--film-coefficient", "0.2", "--asperity-pressure", "10MPa"),
    "control": (),
    "sweep": ("--over", "drive.frequency=20kHz:24kHz:3"),
    "map": (),
    "uncertainty": (),
    "optimise": ("--target-friction", "0.15"),
    "compare": (),
    "literature": (),
}


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize("command", RIG_COMMANDS)
@pytest.mark.parametrize(
    ("rig", "line"),
    [
        ("none.toml", "none.toml: no such file"),
        ("examples", "examples: cannot be read: is a folder, not a file"),
        ("garbage", "garbage: not UTF-8 text: byte 0x80 at 128"),
    ],
)
def test_what_is_no_rig_file_is_refused_by_every_command(
    command: str, rig: str, line: str, capsys: CaptureFixture[str]
) -> None:
    assert f"sonolube {command}: {line}" in refused(capsys, command, rig, *RIG_COMMANDS[command])


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize("command", RIG_COMMANDS)
def test_an_empty_rig_file_is_refused_by_all_that_it_lacks(command: str, capsys: CaptureFixture[str]) -> None:
    lines = refused(capsys, command, "empty", *RIG_COMMANDS[command], faults=9).splitlines()
    assert lines[0] == f"sonolube {command}: empty: 9 faults"
    assert lines[1] == "  title: missing"


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize("command", ["thermal", "regime", "sweep"])
@pytest.mark.parametrize("out", ["file", "file/deeper"])
def test_a_folder_that_cannot_be_made_is_refused_by_its_path(
    command: str, out: str, capsys: CaptureFixture[str]
) -> None:
    line = refused(capsys, command, TRIBOMETER, *RIG_COMMANDS[command], "--out", out)
    assert out in line
    assert "cannot be written" in line


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("--over", "drive.frequency=30kHz:18kHz"), "--over drive.frequency: needs a range from above 0 that rises"),
        (("--over", "structure.tip_mas=50g:150g"), "unknown entry of structure 'tip_mas'; did you mean tip_mass?"),
        (("--over", "tip_mass=1g:2g"), "--over tip_mass: choose over drive.frequency"),
        (("--over", "drive.waveform=blob"), "'blob' is none of sine, square, triangle, sawtooth"),
        (("--temperature-limit", "40degC", "--conductance", "1W/K"), "--temperature-limit 40degC is a temperature"),
        (("--catalogue", "empty"), "empty: holds no actuator"),
        (("--catalogue", "garbage"), "garbage: not UTF-8 text: byte 0x80 at 128"),
        (("--actuator", "nope"), "unknown actuator 'nope'"),
        (("--bolt", "M10x60mm"), "--bolt and --preload belong together"),
        (("--robust", "nan"), "Invalid value for '--robust'"),
        (("--minimise", "money"), "'money' is not one of"),
        (("--source-resistance", "-50ohm"), "source_resistance must be positive, got -50.0 ohm"),
    ],
)
def test_a_design_that_cannot_be_asked_for_is_refused(
    arguments: tuple[str, ...], line: str, capsys: CaptureFixture[str]
) -> None:
    refusal = refused(capsys, "optimise", TRIBOMETER, "--target-friction", "0.15", *arguments)
    assert line in refusal
    assert "Value error" not in refusal


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize("friction", ["0", "-1", "nan", "inf", "", "0,15", "0.5", "5N", "0.15mm", "1e400"])
def test_a_friction_that_no_vibration_gives_is_refused(friction: str, capsys: CaptureFixture[str]) -> None:
    assert "--target-friction" in refused(capsys, "optimise", TRIBOMETER, "--target-friction", friction)


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize(
    ("table", "line"),
    [
        ("", "is empty"),
        (HEAD, "needs a head and at least one run"),
        (RUNS.replace(",", " "), "must name a quantity"),
        (RUNS.replace("mm/s", "%"), "line 1: sliding_speed: % is a pure number; expected a speed"),
        (RUNS.replace("mm/s", "furlong"), "is a length; expected a speed"),
        ("\n".join([HEAD, *(f"{row},3" for row in ROWS)]), "line 2: has 5 cells where 4 columns are named"),
        ("\n".join([f"{HEAD},{HEAD}", *(f"{row},{row}" for row in ROWS)]), "two columns are named sliding_speed"),
        ("\n".join([HEAD, "1e300,1,3,50", *ROWS]), "sliding_speed '1e300' lies beyond any run"),
        ("\n".join([HEAD, "inf,1,3,50", *ROWS]), "line 2: sliding_speed"),
        ("\n".join([HEAD, "40,some,3,50", *ROWS]), "line 2: actuator_power 'some' is no number"),
        ("\n".join([HEAD, '"40,1,3,50', *ROWS]), "line 2: unexpected end of data"),
    ],
)
def test_a_table_of_runs_is_refused_by_line_and_column(table: str, line: str, capsys: CaptureFixture[str]) -> None:
    Path("runs.csv").write_text(table, encoding="utf-8")
    assert line in refused(capsys, "efficiency", "runs.csv", "--rig", POWER_MAP)


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize("table", ["none", "examples", "garbage", "long"])
def test_what_is_no_table_of_runs_is_refused_by_its_path(table: str, capsys: CaptureFixture[str]) -> None:
    assert f"sonolube efficiency: {table}: " in refused(capsys, "efficiency", table, "--rig", POWER_MAP)


def test_files_may_begin_with_the_mark_that_windows_writes(desk: Path, capsys: CaptureFixture[str]) -> None:
    for name, source in {"rig.toml": POWER_MAP, "runs.csv": "examples/efficiency-runs.csv"}.items():
        (desk / name).write_bytes(UTF8_MARK + (desk / source).read_bytes())
    with raises(SystemExit) as end:
        main(("efficiency", "runs.csv", "--rig", "rig.toml", "--out", "Läufe"))
    assert end.value.code == 0, capsys.readouterr().err
    assert {path.suffix for path in (desk / "Läufe").iterdir()} == {".html", ".png", ".svg", ".pdf", ".nc"}


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("--delay", "1e9s"), "--delay 1e9s must not exceed --duration"),
        (("--warming", "40degC"), "--warming 40degC is a temperature; expected a temperature difference, such as 40K"),
        (("--warming", "1e9K"), "final_temperature_rise must shift the resonance by no more than a tenth"),
        (("--rate", "0Hz"), "--rate 0Hz"),
        (("--friction", "nanN"), "--friction 'nanN' is not a number"),
        (("--factor", "nan"), "Invalid value for '--factor'"),
    ],
)
def test_a_control_task_that_makes_no_sense_is_refused(
    arguments: tuple[str, ...], line: str, capsys: CaptureFixture[str]
) -> None:
    assert line in refused(capsys, "control", COLLAR, *arguments)


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ((UNCERTAIN, "--sobol", "--identified"), "leave out --over and --identified"),
        ((UNCERTAIN, "--samples", "10000000000000"), "does not fit into memory; ask for fewer points"),
        ((UNCERTAIN, "--over", "drive.frequency=1kHz:2kHz:99999999999999"), "does not fit into memory"),
        ((UNCERTAIN, "--over", "drive.frequency=2kHz:1kHz:3"), "needs at least 2 values that rise"),
        ((UNCERTAIN, "--over", "sliding.sliding_speed=20mm/s"), "a band needs at least 2 values that rise"),
        ((UNCERTAIN, "--over", "friction.model=kinematic,asperity_stick_slip"), "a band needs numbers to run over"),
        (
            (UNCERTAIN, *(word for key in THREE for word in ("--over", f"{key}=1,2"))),
            "--over gives a band once and a map twice",
        ),
        ((UNCERTAIN, "--samples", "1e3"), "Invalid value for '--samples'"),
        ((UNCERTAIN, *FEW, "--set", "contact.normal_load=1MN"), "no sample has a result: normal_load leaves no separ"),
        (
            (UNCERTAIN, *FEW, "--set", "contact.normal_load=1MN", "--over", "sliding.sliding_speed=1mm/s,2mm/s"),
            "no sample has a result: normal_load leaves no separation between the surfaces: lower the load",
        ),
    ],
)
def test_samples_that_cannot_be_drawn_are_refused(
    arguments: tuple[str, ...], line: str, capsys: CaptureFixture[str]
) -> None:
    assert line in refused(capsys, "uncertainty", *arguments)


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("--sliding-speed", "-1mm/s"), "sliding_speed must be positive, got -0.001 m/s"),
        (("--rotation-speed", "0/min"), "rotation_speed must be positive"),
        (("--window", "0s"), "window_duration must be positive"),
    ],
)
def test_a_measurement_is_not_begun_with_a_setting_that_makes_no_sense(
    arguments: tuple[str, ...], line: str, capsys: CaptureFixture[str]
) -> None:
    assert line in refused(capsys, "measure", "friction", "none.csv", *arguments)


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize("frequency", ["0Hz", "-1kHz", "22mm", "22000"])
def test_a_drive_without_a_frequency_moves_nothing(frequency: str, capsys: CaptureFixture[str]) -> None:
    assert "frequency" in refused(capsys, "measure", "vibration", "none.csv", "--frequency", frequency)


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("regime", "--film-coefficient", "1e9", "--asperity-pressure", "10MPa"), "--film-coefficient 1e9 lies"),
        (("regime", "--film-coefficient", "0.1", "--asperity-pressure", "1e30Pa"), "--asperity-pressure 1e30Pa lies"),
        (("thermal", "--pin", "m50", "--disc", "m50", "--conductance", "1e30W/K"), "--conductance 1e30W/K lies"),
        (("friction", "--set", "drive.voltage_peak_to_peak=1e9V"), "drive.voltage_peak_to_peak: 1e9V lies"),
        (("simulate", "--set", "structure.tip_mass=1e-30kg"), "structure.tip_mass: 1e-30kg lies"),
    ],
)
def test_what_no_rig_has_is_refused_before_any_work(
    arguments: tuple[str, ...], line: str, capsys: CaptureFixture[str]
) -> None:
    assert f"{line} beyond any rig: expected " in refused(capsys, arguments[0], TRIBOMETER, *arguments[1:])


@pytest.mark.usefixtures("desk")
def test_measured_runs_that_a_map_has_no_place_for_are_refused_before_it_is_made(
    capsys: CaptureFixture[str], monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr("sonolube.design.MAPS", {})
    arguments = ("map", POWER_MAP, "--kind", "frequency-voltage", "--measured", "examples/efficiency-runs.csv")
    assert "measured runs need a column frequency for a frequency-voltage map" in refused(capsys, *arguments)


@pytest.mark.usefixtures("desk")
def test_a_map_needs_two_values_across_and_up(capsys: CaptureFixture[str]) -> None:
    line = refused(capsys, "map", POWER_MAP, "--over", "drive.voltage_peak_to_peak=5V")
    assert "--over drive.voltage_peak_to_peak: a velocity-power map runs over it" in line


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize("command", ["contact", "friction", "wear", "simulate", "response", "transient", "thermal"])
def test_a_load_that_presses_the_surfaces_through_each_other_is_refused(
    command: str, capsys: CaptureFixture[str]
) -> None:
    line = refused(capsys, command, TRIBOMETER, *RIG_COMMANDS[command], "--set", "contact.normal_load=1MN")
    assert "contact.normal_load 1e+06 N leaves no separation between the surfaces" in line


@pytest.mark.usefixtures("desk")
def test_a_complaint_about_very_long_input_stays_short(capsys: CaptureFixture[str]) -> None:
    line = refused(capsys, "friction", TRIBOMETER, "--set", f"drive.frequency={'9' * 100_000}Hz")
    assert "is not finite" in line


def recording(desk: Path, force: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> str:
    rows = np.stack([0.01 * np.arange(force.size), force], 1)
    np.savetxt(desk / "test.csv", rows, delimiter=",", header="time (s),friction_force (N)", comments="", fmt="%.9g")
    return "test.csv"


def test_windows_in_which_nothing_was_recorded_do_not_hide_the_others(desk: Path, capsys: CaptureFixture[str]) -> None:
    force = 0.4 + 0.01 * np.random.default_rng(0).standard_normal(2000)
    force[1000:] = np.nan
    with raises(SystemExit) as end:
        main(("measure", "friction", recording(desk, force)))
    out, err = capsys.readouterr()
    assert (end.value.code, err) == (0, "")
    assert "Root mean square of the fluctuation in windows of 2 s  9." in out


def test_a_force_beyond_any_sensor_is_refused_by_its_line(desk: Path, capsys: CaptureFixture[str]) -> None:
    line = refused(capsys, "measure", "friction", recording(desk, np.full(100, 1e299)))
    assert "test.csv: line 2: 'friction_force (N)' is 1e+299, beyond any sensor" in line


def test_heights_beyond_any_surface_are_refused(desk: Path, capsys: CaptureFixture[str]) -> None:
    np.save(desk / "scan.npy", 1e290 * np.random.default_rng(0).standard_normal((32, 32)))
    for what in ("surface", "groove"):
        assert "height must not exceed 1e+06 m" in refused(capsys, "measure", what, "scan.npy", "--spacing", "1um")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signal")
def test_a_run_that_is_killed_leaves_nothing_half_written(desk: Path) -> None:
    program = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a background job ignores it
        "from sonolube.cli.console import options; options.SHORT = options._BETWEEN_LINES = 0.05\n"
        "from sonolube.cli import main; main()"
    )
    command = [sys.executable, "-c", program, "uncertainty", UNCERTAIN, "--samples", "65536"]
    with subprocess.Popen(command, cwd=desk, stderr=subprocess.PIPE) as run:
        assert run.stderr
        while b"of 65536" not in run.stderr.readline():  # the first samples are computed
            assert run.poll() is None
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=60)
    assert run.returncode == 130
    assert not (desk / "out").exists()


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize(
    ("text", "said"),
    [
        (TRIBOMETER, "RIG.toml=RUNS.csv"),
        (f"nothing.toml={COLLAR}", "nothing.toml"),
        (f"{TRIBOMETER}=nothing.csv", "nothing.csv"),
        (f"{TRIBOMETER}=garbage", "garbage"),
    ],
)
def test_another_rig_of_the_laboratory_that_cannot_be_read_is_named(
    text: str, said: str, capsys: CaptureFixture[str]
) -> None:
    assert said in refused(capsys, "predict", TRIBOMETER, "--laboratory", text)
