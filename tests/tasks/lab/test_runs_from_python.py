"""Runs from Python: prompts, progress and cancellation by functions, and motor and drive off at every ending."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, raises
from tests.cli.conftest import Program
from tests.laboratory import rig_stand_ins
from tests.laboratory.rig_stand_ins import analogue_rig
from tests.names import names_of
from tests.same import same

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.protocol import Prompt
from sonolube.laboratory import RunControl
from sonolube.laboratory.records import Run, read_run, run_folders
from sonolube.rig import read_rig
from sonolube.tasks import lab
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.lab import protocol_run
from sonolube.tasks.lab.protocol_run import RunAnswer
from sonolube.tasks.progress import TaskCancelled

LAB = Path(__file__).parents[3] / "examples" / "lab"
RIG = Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml"
ASKING = """title = "asking"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "2 s"

[[steps]]
kind = "motor_speed"
sliding_speed = "50 mm/s"

[[steps]]
kind = "acquire"
channels = ["friction_force"]
sample_rate = "400 Hz"
duration = "1 s"

[[steps]]
kind = "drive"
voltage_peak_to_peak = "10 V"
frequency = "22 kHz"

[[steps]]
kind = "wait"
duration = "0.5 s"

[[steps]]
kind = "prompt"
task = "load"
text = "Add a weight."

[[steps]]
kind = "wait"
duration = "0.4 s"
"""


class Broken(Exception):
    """Failure of the caller's own function."""


def broken(*_: object) -> Any:
    raise Broken


@pytest.fixture
def protocol(tmp_path: Path) -> Path:
    path = tmp_path / "asking.toml"
    path.write_text(ASKING)
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "runs"


@pytest.fixture(autouse=True)
def quiet_inputs(monkeypatch: MonkeyPatch) -> None:
    """20 mV at every input, within all limits."""
    monkeypatch.setattr(rig_stand_ins, "voltages", lambda terminal, numbers: 0.02 + 0 * numbers)


def the_run(folder: Path) -> Run:
    (path,) = run_folders(folder)
    return read_run(path)


def test_a_prompt_is_answered_by_a_function_with_motor_and_drive_off(
    protocol: Path, folder: Path, tmp_path: Path
) -> None:
    asked: list[tuple[str, float, float]] = []
    seen: list[str] = []
    with analogue_rig(tmp_path) as rig:

        def operator(prompt: Prompt) -> bool:
            asked.append((prompt.text, rig.voltage(), rig.rotation_speed()))
            return True

        answer = lab.run(
            protocol,
            tmp_path / "devices.toml",
            out=folder,
            operator=operator,
            progress=lambda what, done, total: seen.append(what),
        )
        assert (rig.voltage(), rig.rotation_speed()) == (0.0, 0.0)
    assert asked == [("Add a weight.", 0.0, 0.0)]
    assert answer.object()["outcome"] == "completed"
    assert not answer.is_failure
    assert answer.dataset().sizes["time"] == answer.object()["samples"]
    assert any(what.startswith("running: step 4, wait, 6") and "mN" in what for what in seen), seen


def test_a_prompt_that_nobody_answers_is_refused_before_anything_is_connected(
    protocol: Path, folder: Path, tmp_path: Path
) -> None:
    with analogue_rig(tmp_path) as rig:
        rig.was_on()
        with raises(InvalidInput, match="in Python with the argument operator, or take its prompts as done by yes"):
            lab.run(protocol, tmp_path / "devices.toml", out=folder)
        assert rig.rotation_speed() > 0  # untouched
    assert not folder.exists()


def test_an_operator_who_declines_stops_the_run(protocol: Path, folder: Path, tmp_path: Path) -> None:
    with analogue_rig(tmp_path) as rig:
        answer = lab.run(protocol, tmp_path / "devices.toml", out=folder, operator=lambda prompt: False)
        assert (rig.voltage(), rig.rotation_speed()) == (0.0, 0.0)
    assert answer.is_failure
    assert answer.object()["reason"] == "the operator did not confirm: Add a weight."


@pytest.mark.parametrize("functions", [{"operator": broken}, {"operator": lambda _: True, "progress": broken}])
def test_a_function_of_the_caller_that_fails_leaves_motor_and_drive_off(
    functions: dict[str, Any], protocol: Path, folder: Path, tmp_path: Path
) -> None:
    with analogue_rig(tmp_path) as rig:
        with raises(Broken):
            lab.run(protocol, tmp_path / "devices.toml", out=folder, **functions)
        assert (rig.voltage(), rig.rotation_speed()) == (0.0, 0.0)
    assert the_run(folder).summary.outcome == "failed"


def cancelled_at(number: int) -> Callable[[], bool]:
    """Whether a task is to stop, which is so from some look on."""
    looks = iter(range(1_000_000))
    return lambda: next(looks) >= number


def test_a_cancelled_run_is_stopped_in_order_and_its_record_is_whole(
    protocol: Path, folder: Path, tmp_path: Path
) -> None:
    with analogue_rig(tmp_path) as rig:
        with raises(TaskCancelled):
            lab.run(protocol, tmp_path / "devices.toml", out=folder, yes=True, cancelled=cancelled_at(3))
        assert (rig.voltage(), rig.rotation_speed()) == (0.0, 0.0)
    run = the_run(folder)
    assert (run.summary.outcome, run.summary.reason) == ("stopped", "cancelled")
    assert run.summary.samples > 0
    assert run.notes[-1].facts["state"] == "safe"


def test_a_cancelled_hold_is_stopped_in_order(folder: Path, tmp_path: Path) -> None:
    with analogue_rig(tmp_path) as rig:
        with raises(TaskCancelled):
            lab.hold(
                RIG,
                device_map=tmp_path / "devices.toml",
                duration=1.0,
                run_in=0.1,
                rate=50,
                delay=0,
                no_self_test=True,  # the inputs here follow no drive
                out=folder,
                cancelled=cancelled_at(8),
            )
        assert (rig.voltage(), rig.rotation_speed()) == (0.0, 0.0)
    assert the_run(folder).summary.reason == "cancelled"


def test_a_run_is_stopped_by_its_control(protocol: Path, folder: Path) -> None:
    control = RunControl()
    answer = lab.run(
        protocol, rig=RIG, out=folder, control=control, progress=lambda what, done, total: control.stop("enough")
    )
    assert (answer.object()["outcome"], answer.object()["reason"]) == ("stopped", "enough")


def test_python_and_the_terminal_run_the_same(folder: Path, tmp_path: Path, sonolube: Program) -> None:
    content = ASKING.encode()
    (tmp_path / "short.toml").write_bytes(content)
    typed = sonolube("lab", "run", tmp_path / "short.toml", "--rig", RIG, "--out", tmp_path / "other", "--json").answer
    called = lab.run(NamedBytes("short.toml", content), rig=read_rig(RIG), out=folder).json_object()
    for name in ("folder", "recordings"):
        typed.pop(name), called.pop(name)
    typed.pop("files")
    same(called, typed)


def test_si_and_text_hold_the_same_friction(folder: Path) -> None:
    given = {"run_in": "100ms", "duration": "1s", "step_to": "40mm/s", "step_at": "0.5s", "friction_limit": "5N"}
    numbers = {"run_in": 0.1, "duration": 1.0, "step_to": 0.04, "step_at": 0.5, "friction_limit": 5.0}
    one, other = (lab.hold(RIG, out=folder, **values).object() for values in (given, numbers))
    same(one["phases"], other["phases"])
    same(one["friction_force"], other["friction_force"])


def test_a_dry_run_touches_nothing(folder: Path, protocol: Path) -> None:
    answer = lab.run(protocol, rig=RIG, dry_run=True)
    assert answer.object()["duration"]["value"] == approx(1.0)
    with raises(InvalidInput, match="yes has no meaning with dry_run, which runs nothing"):
        lab.run(protocol, rig=RIG, dry_run=True, yes=True)


DRIVEN = """title = "driven"
source = "none"

[limits]
voltage_maximum = "85 V"
duration_maximum = "2 s"

[[steps]]
kind = "motor_speed"
rotation_speed = "1 1/s"

[[steps]]
kind = "drive"
voltage_peak_to_peak = "40 V"
frequency = "22 kHz"

[[steps]]
kind = "wait"
duration = "1 s"
"""


RECORDED = """[[steps]]
kind = "acquire"
channels = ["friction_force", "voltage"]
sample_rate = "1 kHz"
duration = "1 s"

"""


def test_a_dry_run_on_a_device_map_says_what_its_devices_cannot_do_and_do_not_tell(tmp_path: Path) -> None:
    (tmp_path / "driven.toml").write_text(DRIVEN)
    known, blind = LAB / "tektronix_afg.toml", tmp_path / "blind.toml"
    (tmp_path / "normal_load.csv").write_bytes((LAB / "normal_load.csv").read_bytes())
    blind.write_text(known.read_text().replace('"500 kHz"', '"100 kHz"'))  # fewer than five samples a period
    told = lab.run(tmp_path / "driven.toml", known, rig=RIG, dry_run=True)
    assert "drive not read back: combination, trips" in told.caveats()
    assert "4 V peak to peak at 22 kHz" in told.assumptions()["self-test"]  # a tenth of the first
    assert "157 mm/s" in " ".join(told.object()["lines"])  # a turn a second of 50 mm, by the map
    unseen = lab.run(tmp_path / "driven.toml", blind, dry_run=True)
    assert unseen.assumptions()["self-test"].startswith("none: no channel of the map shows the voltage")
    (tmp_path / "seen.toml").write_text(DRIVEN.replace("[[steps]]", f"{RECORDED}[[steps]]", 1))
    caveat = "voltage at 1 kHz does not resolve the drive (fewer than five samples a period)"
    assert caveat in lab.run(tmp_path / "seen.toml", known, dry_run=True).caveats()
    fast = lab.run(tmp_path / "seen.toml", LAB / "several_clocks.toml", dry_run=True)  # of a clock of 500 kHz
    assert not any("resolve the drive" in each for each in fast.caveats())
    (tmp_path / "driven.toml").write_text(DRIVEN.replace('"40 V"', '"164 V"'))
    beyond = lab.run(tmp_path / "driven.toml", known, dry_run=True)
    assert any("82 V" in each and "at most 80 V" in each for each in beyond.object()["refusals"])


def test_entries_that_were_replaced_stand_in_the_record_of_a_virtual_run(folder: Path, protocol: Path) -> None:
    answer = lab.virtual(read_rig(RIG, changes=["contact.normal_load=2N"]), protocol=protocol, out=folder)
    assert isinstance(answer, RunAnswer)
    assert answer.run.facts["changed_entries"] == "contact.normal_load=2N"


@pytest.mark.parametrize(
    ("call", "line"),
    [
        (lambda: lab.run("map_test"), "device_map virtual needs rig, whose friction it takes"),
        (lambda: lab.run("map_test", "none.toml", seed=1), "seed has no meaning with device_map MAP.toml"),
        (lambda: lab.hold(RIG, step_at="0s"), "step_at 0s must be positive"),
        (lambda: lab.hold(RIG, rate="0Hz"), "rate 0Hz and duration 10s must be positive"),
        (lambda: lab.hold(RIG, friction="5mm"), "friction 5mm"),
        (lambda: lab.virtual(RIG, file_format="xls"), "unknown file_format 'xls'"),  # type: ignore[arg-type]
    ],
)
def test_a_refusal_names_the_argument_of_python(call: Callable[[], object], line: str) -> None:
    with raises((InvalidInput, UnknownName), match=line):
        call()


WARM = """title = "warm"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "9 s"

[metadata]
thermocouple = "{place}"

[[steps]]
kind = "acquire"
channels = ["friction_force", "temperature"]
sample_rate = "100 Hz"
duration = "5 s"

[[steps]]
kind = "wait"
duration = "1 s"

[[steps]]
kind = "motor_speed"
sliding_speed = "220 mm/s"

[[steps]]
kind = "wait"
duration = "4 s"
"""


def test_a_virtual_thermocouple_is_where_its_protocol_says(tmp_path: Path) -> None:
    rig = RIG.with_name("coated_temperature.toml")
    rises: dict[str, float] = {}
    folders: dict[str, Path] = {}
    for place in ("actuator", "contact"):
        text = WARM.format(place=place).encode()
        found = lab.run(NamedBytes("warm.toml", text), rig=rig, out=tmp_path / place)
        assert isinstance(found, RunAnswer)
        temperature = found.run.dataset()["temperature"].to_numpy()
        rises[place] = float(temperature[-100:].mean() - temperature[:90].mean())
        assert found.run.facts["thermocouple"] == place
        folders[place] = found.run.folder
    with xr.open_dataset(folders["contact"] / "truth" / "truth.nc") as truth:
        flash = float(np.nanmax(truth["flash_temperature_rise"].to_numpy()))
    assert rises["actuator"] == approx(0.0, abs=0.05)  # K; nothing warms the actuator
    assert flash > 2.0
    assert rises["contact"] == approx(flash, abs=0.5)  # and the pin, which warms slowly


def test_set_and_measured_are_compared_on_devices_unless_that_is_left_out(
    tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    compared: list[bool] = []
    original = names_of(protocol_run).run_protocol

    def noted(*given: Any, self_test: bool, **named: Any) -> Any:
        compared.append(self_test)
        return original(*given, self_test=self_test, **named)

    monkeypatch.setattr(protocol_run, "run_protocol", noted)
    text = NamedBytes("warm.toml", WARM.format(place="actuator").replace('"4 s"', '"0.5 s"').encode())
    with analogue_rig(tmp_path) as rig, MonkeyPatch.context() as patch:  # undone before that of the rig
        patch.setattr(protocol_run, "ready_devices", lambda path: rig.devices)
        for no_self_test in (False, True):
            found = lab.run(text, tmp_path / "devices.toml", no_self_test=no_self_test, yes=True, out=tmp_path / "runs")
            assert isinstance(found, RunAnswer)
            assert found.run.facts.get("self_test") == ("left out" if no_self_test else None)
    assert compared == [True, False]
    with raises(InvalidInput, match="no_self_test has no meaning with device_map virtual"):
        lab.run(text, rig=RIG, no_self_test=True, out=tmp_path / "runs")
