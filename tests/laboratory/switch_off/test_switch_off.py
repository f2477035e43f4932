"""The switch-off process against hardware that is a log: whatever dies, hangs or raises, it ends off, and that is said.

The oracle is the log, which both programs write and neither reads: the last value of each output.
"""

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from pytest import MonkeyPatch, raises

from sonolube.laboratory import Devices, DriveSetting
from sonolube.laboratory.devices import DeviceError, DeviceLost
from sonolube.laboratory.driver_trial import Fault, Trial
from sonolube.laboratory.drivers import read_device_map
from sonolube.laboratory.switch_off import client, with_outputs_apart
from sonolube.operating_system import process_start

ON = DriveSetting(voltage_peak_to_peak=20.0, frequency=22e3)
_LOOKS = 5000  # of 0.02 s
OWN_WORD = "confirmed off, drive and motor by the device's own word, not measured"
needs_signals = pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals")


PATIENT = """import runpy
import sonolube.laboratory.supervision as supervision
supervision.LATE = 3600.0
runpy.run_module("sonolube", run_name="__main__", alter_sys=True)
"""


def logged_rig(folder: Path, *, duration: float = 0.4, is_patient: bool = False, **fault: Any) -> Trial:
    """A rig of pretended devices; patient, its supervisor lets blocks and calls be late on a slow machine."""
    program = ("-c", PATIENT) if is_patient else ("-m", "sonolube")
    return Trial(folder, fault=Fault(**fault), duration=duration, program=program)


@contextmanager
def connected(folder: Path, **fault: Any) -> Iterator[tuple[Trial, Devices]]:
    """Outputs of the logged rig in a switch-off process, connected but for a fault, and released."""
    rig = logged_rig(folder / "rig", **fault)
    with MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(rig.folder))
        devices = with_outputs_apart(read_device_map(rig.folder / "devices.toml"))
        assert devices.switch_off is not None
        devices.switch_off.begin()
        try:
            devices.drive.connect()
            devices.motor.connect()
            yield rig, devices
        finally:
            devices.drive.close()
            devices.motor.close()
            devices.switch_off.end()
    assert not any(map(process_start, processes_of(rig)))


def processes_of(rig: Trial) -> list[int]:
    """Processes that have set an output, in order."""
    return list(dict.fromkeys(int(line[1]) for line in rig.log if line[2] not in ("call", "fault")))


def test_outputs_are_set_by_another_process_which_ends_with_their_release(tmp_path: Path) -> None:
    with connected(tmp_path) as (rig, devices):
        devices.drive.drive(ON)
        devices.motor.turn(2.0)
        assert (rig.last("drive"), rig.last("motor")) == (20.0, 2.0)
        (process,) = processes_of(rig)
        assert process != os.getpid()
        assert os.getsid(process) != os.getsid(0)  # no signal of the terminal reaches it
        devices.drive.off()
        devices.motor.off()
        assert (rig.last("drive"), rig.last("motor")) == (0.0, 0.0)
    assert not process_start(process)
    assert (devices.drive.voltage_maximum, devices.motor.rotation_speed_maximum) == (
        10.0,
        5.0,
    )  # the amplifier takes 10 V, gain 1


def test_devices_are_connected_anew_after_their_release(tmp_path: Path) -> None:
    with connected(tmp_path) as (rig, devices):
        assert devices.switch_off is not None
        devices.switch_off.end()
        devices.switch_off.end()  # harmless, as the following
        devices.switch_off.watch()
        devices.drive.off()
        with raises(DeviceError, match=r"^drive: connect: the switch-off process has not begun$"):
            devices.drive.connect()
        devices.switch_off.begin()
        devices.drive.connect()
        devices.drive.drive(ON)
        assert rig.last("drive") == 20.0
        assert len(processes_of(rig)) == 2


@pytest.mark.parametrize("method", ["halt", "off"])
def test_a_setting_that_hangs_ends_with_its_process_and_another_switches_off(method: str, tmp_path: Path) -> None:
    with connected(tmp_path, where="drive.drive", kind="hang") as (rig, devices):
        devices.motor.turn(1.0)
        told: list[str] = []
        setting = threading.Thread(target=lambda: told.append(failure_in(lambda: devices.drive.drive(ON))))
        setting.start()
        until(lambda: ["call", "drive.drive"] in [line[2:] for line in rig.log])
        devices.motor.halt()  # type: ignore[attr-defined]
        getattr(devices.drive, method)()
        setting.join(30)
        assert (rig.last("drive"), rig.last("motor")) == (0.0, 0.0)
        assert told == ["drive: drive did not return; the switch-off process has switched off"]
        with raises(DeviceLost, match="did not return"):
            devices.drive.drive(ON)


def failure_in(call: Callable[[], object]) -> str:
    """What a call raises, in words; empty where it raises nothing."""
    try:
        call()
    except DeviceError as failure:
        return str(failure)
    return ""


def until(holds: Callable[[], object]) -> None:
    """Wait until something holds."""
    for _ in range(_LOOKS):
        if holds():
            return
        time.sleep(0.02)
    raise AssertionError("nothing came of it")


def test_a_setting_that_returns_after_off_is_switched_off_anew_before_that_is_confirmed(tmp_path: Path) -> None:
    with connected(tmp_path, where="drive.drive", kind="late 1") as (rig, devices):
        setting = threading.Thread(target=devices.drive.drive, args=(ON,), daemon=True)
        setting.start()
        until(lambda: ["call", "drive.drive"] in [line[2:] for line in rig.log])
        devices.drive.halt()  # type: ignore[attr-defined]
        settings = [float(line[3]) for line in rig.log if line[2] == "drive"]
        assert settings[-2:] == [20.0, 0.0]
        with raises(DeviceError, match="was switched off for good"):
            devices.drive.drive(ON)
        assert rig.last("drive") == 0.0


@needs_signals
def test_where_the_process_is_killed_another_connects_and_switches_off(tmp_path: Path) -> None:
    with connected(tmp_path) as (rig, devices):
        devices.drive.drive(ON)
        (process,) = processes_of(rig)
        os.kill(process, signal.SIGKILL)
        apart = devices.switch_off
        assert apart is not None
        until(lambda: not process_start(process))
        until(lambda: failure_in(apart.watch))
        with raises(DeviceLost, match="the switch-off process has ended"):
            apart.watch()
        with raises(DeviceLost, match="has ended"):
            devices.drive.drive(ON)
        assert rig.last("drive") == 20.0
        devices.drive.off()
        devices.motor.off()
        assert (rig.last("drive"), len(processes_of(rig))) == (0.0, 2)


@needs_signals
def test_where_the_process_falls_silent_it_is_ended_and_another_switches_off(
    tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    with connected(tmp_path) as (rig, devices):
        devices.drive.drive(ON)
        (process,) = processes_of(rig)
        os.kill(process, signal.SIGSTOP)
        monkeypatch.setattr(client, "SILENT", 0.5)
        with suppress(DeviceError):
            devices.drive.off()
        monkeypatch.undo()
        assert rig.last("drive") == 0.0
        assert not process_start(process)
        assert devices.switch_off is not None
        with raises(DeviceLost, match="no sign of life"):
            devices.switch_off.watch()


@pytest.mark.parametrize("kind", ["raise OSError", "raise SystemExit", "raise GeneratorExit", "unspeakable"])
def test_whatever_a_device_raises_is_a_device_error_that_names_it(kind: str, tmp_path: Path) -> None:
    with connected(tmp_path, where="drive.off", kind=kind) as (rig, devices):
        devices.drive.drive(ON)
        with raises(DeviceError, match=r"^drive: ") as failure:
            devices.drive.off()
        assert "\n" not in str(failure.value)
        assert rig.last("drive") == 20.0
        devices.drive.off()
        assert rig.last("drive") == 0.0


def test_a_process_that_cannot_make_the_devices_connects_nothing(tmp_path: Path) -> None:
    rig = logged_rig(tmp_path / "rig")
    with MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(rig.folder))
        devices = with_outputs_apart(read_device_map(rig.folder / "devices.toml"))
    assert devices.switch_off is not None
    with raises(DeviceLost, match=r"the switch-off process did not start: .*driver must be") as failure:
        devices.switch_off.begin()
    devices.drive.close()
    devices.switch_off.end()
    assert "\n" not in str(failure.value)
    assert rig.log == []


@needs_signals
@pytest.mark.parametrize(
    ("number", "what"),
    [(signal.SIGKILL, "has ended before it switched off"), (signal.SIGSTOP, "has given no sign of life for 5 s")],
)
def test_where_the_program_of_a_run_dies_or_stops_its_switch_off_process_has_the_last_word(
    number: signal.Signals, what: str, tmp_path: Path
) -> None:
    rig = logged_rig(tmp_path / "rig", duration=90, is_patient=True)
    process = rig.start()
    until(lambda: rig.last("drive"))
    os.kill(process.pid, number)
    ended = rig.ended(process)
    assert ended.is_off
    assert (ended.code, ended.output) == (-signal.SIGKILL, "")
    *_, told, record = ended.error.splitlines()  # behind lines of progress
    assert told.startswith(f"sonolube: the program of the run, process {process.pid}, {what}")
    assert told.endswith(f"; motor and drive: {OWN_WORD}")
    assert record.startswith("sonolube: the record is closed: ")
    assert ended.recorded == OWN_WORD


@needs_signals
def test_a_run_whose_inputs_keep_the_interpreter_is_ended_and_switched_off(tmp_path: Path) -> None:
    ended = logged_rig(
        tmp_path / "rig", duration=90, is_patient=True, where="acquisition.read", call=3, kind="held 1000"
    ).run()
    assert (ended.is_off, ended.recorded) == (True, OWN_WORD)
    assert "has given no sign of life for 5 s, and was ended; motor and drive: confirmed off" in ended.error


@needs_signals
@pytest.mark.parametrize(
    ("where", "kind", "verdict"),
    [
        ("drive.drive", "hang", OWN_WORD),
        ("drive.drive", "late 3", OWN_WORD),
        ("motor.turn", "signal SIGKILL", OWN_WORD),
        ("drive.drive", "signal SIGSTOP", OWN_WORD),
        ("drive.off", "raise OSError", "cut the power: drive: OSError"),
    ],
)
def test_a_run_ends_with_the_verdict_that_holds(where: str, kind: str, verdict: str, tmp_path: Path) -> None:
    ended = logged_rig(tmp_path / "rig", where=where, kind=kind).run()
    assert ended.recorded.startswith(verdict)
    assert f'"outputs": "{verdict}' in ended.output
    assert ended.code == (1 if verdict == OWN_WORD else 3)
    assert ended.is_off is (verdict == OWN_WORD) or kind.startswith("raise")
    assert "Traceback" not in ended.error
