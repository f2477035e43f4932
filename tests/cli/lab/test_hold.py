"""`sonolube lab hold`: friction held at a reference while the speed steps, beside what `control` tells of the loop."""

from pathlib import Path

import pytest
import xarray as xr
from pytest import MonkeyPatch, approx
from tests.cli.conftest import Program
from tests.laboratory import rig_stand_ins
from tests.laboratory.rig_stand_ins import instrument_rig
from tests.same import same

from sonolube.laboratory.records import read_run

pytestmark = pytest.mark.usefixtures("compiled_kernels")

SHORT = ("--duration", "6s", "--run-in", "0.5s", "--friction", "0.75N", "--step-to", "30mm/s")


def test_friction_is_held_before_and_after_a_step_of_speed_beside_the_margins_that_control_tells(
    sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    rig = rigs / "tribometer.toml"
    answer = sonolube("lab", "hold", rig, *SHORT, "--out", tmp_path / "runs", "--json").answer
    assert (answer["outcome"], answer["safe"], answer["simulated"]) == ("completed", True, True)
    slow, fast = answer["phases"]
    assert [slow["sliding_speed"]["value"], fast["sliding_speed"]["value"]] == approx([0.0203, 0.03])
    for phase in (slow, fast):
        assert phase["friction_force"]["value"] == approx(0.75, rel=0.02)
        assert phase["tracking_error"]["value"] < 0.035  # N, scatter of D Table 2.3
        assert phase["saturated_fraction"] < 0.05
    control = sonolube(
        *("control", rig, "--friction", "0.75N", "--rate", "20Hz", "--duration", "6s", "--out", tmp_path / "out"),
        "--json",
    ).answer
    for name in ("gain_margin", "phase_margin", "delay_margin", "sensitivity_peak", "integral_time"):
        same(answer[name], control[name])
    folder = Path(answer["folder"])
    assert [Path(path).relative_to(folder).as_posix() for path in answer["files"]] == [
        *(f"hold/held-friction.{ending}" for ending in ("png", "svg", "pdf")),
        "hold/held-friction.nc",
    ]
    with xr.open_dataset(folder / "hold" / "held-friction.nc") as held:
        assert held.sizes["time"] == 120
        assert held["sliding_speed"].to_numpy()[59:61] == approx([0.0203, 0.03])
        assert held.attrs["reference_friction_force"] == approx(0.75)


def test_the_record_is_a_run_like_others(sonolube: Program, rigs: Path, tmp_path: Path) -> None:
    options = (*SHORT, "--duration", "2s", "--tag", "loop", "--seed", "4", "--out", tmp_path)
    folder = Path(sonolube("lab", "hold", rigs / "tribometer.toml", *options, "--json").answer["folder"])
    run = read_run(folder)
    unseen = "voltage at 2 kHz does not resolve the drive (fewer than five samples a period)"
    assert (run.summary.outcome, run.summary.samples, run.caveats) == ("completed", 5000, (unseen,))
    assert run.facts["reference_friction_force"] == approx(0.75)
    assert [note.kind for note in run.notes] == ["prepared", "motor", "motor", "completed", "off"]
    found = sonolube("lab", "runs", tmp_path, "--tag", "loop", "--json").answer["runs"]
    assert [each["folder"] for each in found] == [str(folder)]
    assert sonolube("lab", "watch", tmp_path, "--once", "--json").answer["duration"]["value"] == approx(2.5)
    assert (folder / "truth" / "truth.nc").is_file()


def test_a_reference_beyond_reach_is_a_caveat_and_the_voltage_stays_below_its_limit(
    sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    options = ("--friction", "0.53N", "--duration", "2s", "--voltage-limit", "20V", "--step-to", "20.3mm/s")
    specimen = ("--seed", "3", "--out", tmp_path)
    answer = sonolube("lab", "hold", rigs / "tribometer.toml", *options, *specimen, "--json").answer
    (phase,) = answer["phases"]
    assert phase["voltage_peak_to_peak"]["value"] <= 20.0
    assert any("the voltage was at its limit or 0 for" in line for line in answer["caveats"])


def test_a_limit_ends_the_hold_with_everything_off_and_exit_code_1(
    sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    options = (*SHORT, "--friction-limit", "0.5N", "--out", tmp_path)
    run = sonolube("lab", "hold", rigs / "tribometer.toml", *options)
    assert run.code == 1
    assert "outcome          stopped: channel friction_force is 5" in run.out
    assert "motor and drive  confirmed off" in run.out
    assert "held-friction" not in run.out  # the controller never took over


def test_the_devices_of_a_map_are_driven_and_end_off(
    sonolube: Program, rigs: Path, tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(rig_stand_ins, "voltages", lambda terminal, numbers: 0.2 + 0 * numbers)  # V at every input
    options = ["--duration", "1s", "--run-in", "0.1s", "--rate", "50Hz", "--delay", "0s", "--step-to", "30mm/s"]
    options.append("--no-self-test")  # the inputs here follow no drive
    with instrument_rig(tmp_path) as rig:
        answer = sonolube(
            *("lab", "hold", rigs / "tribometer.toml", "--device", tmp_path / "devices.toml", *options),
            *("--out", tmp_path / "runs", "--json"),
        ).answer
        assert (rig.voltage(), rig.rotation_speed()) == (0.0, 0.0)
    assert (answer["outcome"], answer["simulated"], answer["safe"]) == ("completed", False, True)
    assert read_run(Path(answer["folder"])).summary.samples == 2200


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (("--friction", "5mm"), "--friction 5mm"),
        (("--rate", "0Hz"), "--rate 0Hz and --duration 10s must be positive"),
        (("--step-at", "0s"), "--step-at 0s must be positive"),
        (("--step-to", "40m/s"), "virtual motor turns at most at 20 1/s"),
        (("--temperature-limit", "60"), "--temperature-limit 60 has no unit"),
        (("--temperature-limit", "900degC"), "limits.temperature_maximum of"),
        (("--device", "none.toml"), "none.toml: no such file"),
        (("--device", "none.toml", "--seed", "1"), "--seed has no meaning with --device MAP.toml"),
        (("--quality", "20"), "--quality has no meaning for a rig whose file has the table structure"),
    ],
)
def test_what_cannot_be_held_is_refused_in_one_line_and_makes_no_folder(
    options: tuple[str, ...], line: str, sonolube: Program, rigs: Path, tmp_path: Path
) -> None:
    assert line in sonolube("lab", "hold", rigs / "tribometer.toml", *options, "--out", tmp_path / "runs").refusal
    assert not (tmp_path / "runs").exists()
