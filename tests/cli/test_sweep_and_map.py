"""The commands `sweep` and `map`: what they write, tell and refuse."""

import json
from pathlib import Path

import pytest
import xarray as xr
from pytest import CaptureFixture, approx, raises

from sonolube.cli import main
from sonolube.dynamics.backend import device_name

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
TRIBOMETER, POWER_MAP = str(RIGS / "tribometer.toml"), str(RIGS / "power_map.toml")
VOLTS = "drive.voltage_peak_to_peak"


def answer(capsys: CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    with raises(SystemExit) as end:
        main(arguments)
    out, err = capsys.readouterr()
    return int(str(end.value.code)), out, err


def test_a_sweep_tells_its_least_friction_and_writes_what_goes_on(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    call = ("sweep", TRIBOMETER, "--over", f"{VOLTS}=14V,28V", "--json", "--out", str(tmp_path))
    code, out, _ = answer(capsys, *call)
    told = json.loads(out)
    assert code == 0
    assert told["points"] == 2
    assert told["statuses"] == {"periodic": 2}
    assert told["least_friction"][VOLTS] == 28
    assert told["least_friction"]["vibration_amplitude"]["value"] == approx(2.5e-6, rel=0.01)
    with xr.open_dataset(tmp_path / "sweep.nc") as found:
        assert found["friction_ratio"].shape == (2,)
    assert answer(capsys, *call)[1] == out
    code, _, err = answer(capsys, *call[:3], f"{VOLTS}=5V", "--out", str(tmp_path))
    assert code == 2
    assert "holds another sweep" in err


@pytest.mark.skipif(bool(device_name("gpu")), reason="there is a GPU")
@pytest.mark.parametrize("call", [("sweep", TRIBOMETER, "--over", f"{VOLTS}=14V,28V", "--json"), ("map", POWER_MAP)])
def test_without_a_gpu_one_line_says_so(call: tuple[str, ...], tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    over = ("--over", f"{VOLTS}=10V,20V", "--over", "sliding.sliding_speed=10mm/s,20mm/s", "--form", "png")
    drawn = over if call[0] == "map" else ()
    code, _, err = answer(capsys, *call, *drawn, "--backend", "gpu", "--out", str(tmp_path))
    assert code == 0
    assert [line for line in err.splitlines() if "GPU" in line] == [err.strip()]
    assert err.startswith("backend gpu: computed on the CPU: ")


def test_drawn_points_are_as_many_as_asked_for(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    over = ("--over", f"{VOLTS}=2V:28V", "--over", "sliding.sliding_speed=5mm/s:0.2m/s")
    code, out, _ = answer(
        capsys, "sweep", TRIBOMETER, *over, "--sample", "lhs", "--points", "7", "--out", str(tmp_path)
    )
    assert code == 0
    assert "7 points" in out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--over", f"{VOLTS}=2mm:28V:3"), "2mm is a length; expected a voltage"),
        (("--over", f"{VOLTS}=2V:28V"), "must look like drive.voltage_peak_to_peak=first:last:count"),
        (("--over", f"{VOLTS}=28V:2V:5"), "at least 2 values that rise"),
        (("--over", f"{VOLTS}=0V:2V:5:log"), "the first above 0"),
        (("--over", VOLTS), "must look like drive.frequency=20kHz:24kHz:50"),
        (("--over", f"{VOLTS}=1V", "--over", f"{VOLTS}=2V"), "was given twice"),
        (("--over", "drive.voltag=1,2"), "drive.voltag: unknown key"),
        (("--over", "friction.model=a:b:3"), "list its values"),
        (("--over", f"{VOLTS}=2V:28V", "--sample", "lhs"), "needs --points"),
        (("--over", f"{VOLTS}=2V:28V:3", "--points", "3"), "--points has no meaning for --sample grid"),
    ],
)
def test_a_sweep_that_makes_no_sense_is_refused_in_one_line(
    arguments: tuple[str, ...], said: str, tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    code, _, err = answer(capsys, "sweep", TRIBOMETER, *arguments, "--out", str(tmp_path / "none"))
    assert code == 2
    assert said in err
    assert err.count("\n") == 1
    assert not (tmp_path / "none").exists()


def test_a_map_draws_measured_runs_and_maps_them_where_they_are_enough(
    tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    runs = tmp_path / "runs.csv"
    rows = [f"{speed},{volts},{60 - speed / 4 + volts}" for speed in (50, 100, 150) for volts in (1, 3, 5)]
    runs.write_text("\n".join(["sliding_speed [mm/s],actuator_power [W],friction_reduction [%]", *rows]))
    over = ("--over", f"{VOLTS}=5V:25V:3", "--over", "contact.normal_load=5N", "--form", "png")
    code, out, _ = answer(capsys, "map", POWER_MAP, *over, "--measured", str(runs), "--json", "--out", str(tmp_path))
    assert code == 0
    assert json.loads(out)["map"] == "velocity-power"
    written = {Path(path).name for path in json.loads(out)["files"]}
    name = "power_map-velocity-power"
    assert written == {"map.html", f"{name}.png", f"{name}.nc", f"{name}-measured.png", f"{name}-measured.nc"}
    with xr.open_dataset(tmp_path / f"{name}-measured.nc") as found:
        middle = found.sel(sliding_speed=0.1, actuator_power=3.0, method="nearest")
        assert float(middle["friction_reduction"]) == approx(0.38, abs=0.01)


def test_the_report_of_a_sweep_tells_what_was_asked_and_which_points_failed(
    tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    over = ("--over", "contact.roughness.rms_height=6um,-6um", "--over", "friction.model=asperity_stick_slip,kinematic")
    code, _, _ = answer(capsys, "sweep", TRIBOMETER, *over, "--set", f"{VOLTS}=20V", "--out", str(tmp_path))
    page = (tmp_path / "sweep.html").read_text(encoding="utf-8")
    assert code == 0
    for told in (
        "contact.roughness.rms_height=6um,-6um",
        f"{VOLTS}=20V",
        "0 (default)",
        "Points without a result",
        "periodic",
    ):
        assert told in page
    assert "4, 2 with a result" in page


@pytest.mark.parametrize(
    "over", [(f"{VOLTS}=5V:28V:9",), (f"{VOLTS}=5V:28V:9", "sliding.sliding_speed=5mm/s:0.1m/s:9")]
)
def test_a_sweep_draws_what_it_ran_over(over: tuple[str, ...], tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    asked = [word for key in over for word in ("--over", key)]
    code, out, _ = answer(capsys, "sweep", TRIBOMETER, *asked, "--json", "--out", str(tmp_path))
    assert code == 0
    assert {Path(path).name for path in json.loads(out)["files"]} == {
        "sweep.html",
        "sweep.png",
        "sweep.svg",
        "sweep.nc",
    }
    drawing = (tmp_path / "sweep.svg").read_text(encoding="utf-8")
    assert "Drive voltage, peak to peak [V]" in drawing
    assert ("Sliding speed [mm/s]" in drawing) == (len(over) == 2)


@pytest.mark.parametrize(
    ("head", "row", "said"),
    [
        ("speed,friction_reduction [%]", "1,2", "column 'speed' must name a quantity"),
        ("sliding_speed [mm/s],friction_reduction [%]", "x,2", "line 2: sliding_speed 'x' is no number"),
        ("sliding_speed [N],friction_reduction [%]", "1,2", "line 2: sliding_speed"),
        ("sliding_speed [mm/s]", "1", "needs a column friction_reduction"),
        ("sliding_speed [mm/s],friction_reduction [%]", "1,2", "need a column actuator_power"),
    ],
)
def test_runs_that_cannot_be_read_are_refused_by_column(
    head: str, row: str, said: str, tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    runs = tmp_path / "runs.csv"
    runs.write_text(f"{head}\n{row}\n")
    over = ("--over", f"{VOLTS}=5V,25V", "--over", "contact.normal_load=5N")
    code, _, err = answer(capsys, "map", POWER_MAP, *over, "--measured", str(runs), "--out", str(tmp_path / "none"))
    assert code == 2
    assert said in err


def test_an_axis_of_another_map_is_refused(capsys: CaptureFixture[str]) -> None:
    code, _, err = answer(capsys, "map", POWER_MAP, "--over", "drive.frequency=1kHz:2kHz:3")
    assert code == 2
    assert "its axes are sliding.sliding_speed, contact.normal_load, drive.voltage_peak_to_peak" in err
