"""Watchdog and enable line of NI-DAQmx: outputs enabled, renewed, disabled, and at 0 V where nobody renews."""

from collections.abc import Iterator
from pathlib import Path
from threading import Event, enumerate as enumerate_threads

import numpy as np
import pytest
from pytest import MonkeyPatch, raises
from tests.laboratory.daqmx_device import DaqmxDevice, install
from tests.laboratory.rig_stand_ins import EXAMPLE, OUTPUTS
from tests.laboratory.simulated_rig import MemoryRecord
from tests.laboratory.supervised_clock import Clock

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import protocol_from
from sonolube.laboratory import DeviceError, Devices, State, run_protocol, supervision
from sonolube.laboratory.drivers import DaqmxGuard, read_device_map

TIMEOUT = 3.0  # s, of the watchdog
LINE = "Dev1/port0/line0"
GUARD = f'\n[guard]\ndriver = "daqmx"\nwatchdog_timeout = "3 s"\nenable_line = "{LINE}"\n'
PROTOCOL = protocol_from(
    {
        "title": "test",
        "source": "test",
        "limits": {"voltage_maximum": "60 V", "duration_maximum": "1 min"},
        "steps": [
            {"kind": "drive", "voltage_peak_to_peak": "10 V", "frequency": "22 kHz"},
            {"kind": "wait", "duration": "1 s"},
        ],
    }
)


@pytest.fixture
def card(monkeypatch: MonkeyPatch) -> Iterator[DaqmxDevice]:
    device = DaqmxDevice()
    install(device, monkeypatch)
    yield device
    assert device.open_tasks == 0, "a task was left to the driver"


def devices(folder: Path, guard: str = GUARD) -> Devices:
    inputs, _, _ = EXAMPLE.read_text(encoding="utf-8").partition("[drive]")
    (folder / "devices.toml").write_text(inputs + OUTPUTS + guard, encoding="utf-8")
    (folder / "normal_load.csv").write_text((EXAMPLE.parent / "normal_load.csv").read_text(encoding="utf-8"))
    return read_device_map(folder / "devices.toml").devices()


def test_the_line_is_high_and_the_watchdog_renewed_while_outputs_are_enabled(card: DaqmxDevice) -> None:
    guard = DaqmxGuard(outputs=["Dev1/ao0", "Dev1/ao1"], timeout=TIMEOUT, line=LINE)
    card.lines[LINE] = True
    guard.connect()
    assert not card.lines[LINE]
    for _ in range(2):
        guard.enable()
        guard.renew()
        assert card.lines[LINE]
        (watchdog,) = [each for each in card.tasks.values() if each.timeout]
        assert (watchdog.timeout, watchdog.is_running) == (3.0, True)
        assert watchdog.safe_voltages == {"Dev1/ao0": 0.0, "Dev1/ao1": 0.0}
        guard.disable()
        assert not card.lines[LINE]
    assert card.calls["watchdog RESET_TIMER"] == 2
    guard.close()
    guard.close()


def test_a_watchdog_that_nobody_renews_takes_the_outputs_off_and_the_renewal_says_so(card: DaqmxDevice) -> None:
    guard = DaqmxGuard(outputs=["Dev1/ao0"], timeout=TIMEOUT, line=LINE)
    guard.connect()
    guard.enable()
    card.outputs["Dev1/ao0"] = np.ones(1)
    card.let_watchdog_expire()
    assert card.is_off("Dev1/ao0")
    assert not card.lines[LINE]
    with raises(DeviceError, match="the watchdog has expired, and its outputs are at 0 V"):
        guard.renew()
    guard.close()
    assert card.calls["watchdog CLEAR_EXPIRATION"] == 1


def test_nothing_is_enabled_before_it_was_connected_nor_without_a_watchdog_that_starts(card: DaqmxDevice) -> None:
    guard = DaqmxGuard(outputs=["Dev1/ao0"], timeout=TIMEOUT, line=LINE)
    guard.disable()
    with raises(DeviceError, match="connect it"):
        guard.enable()
    guard.connect()
    card.errors["start_task"] = -200077
    with raises(DeviceError, match="-200077"):
        guard.enable()
    assert not card.lines[LINE]
    guard.close()


def test_a_run_enables_the_outputs_of_its_map_and_ends_with_them_disabled(card: DaqmxDevice, tmp_path: Path) -> None:
    enabled: list[bool] = []
    here = devices(tmp_path)
    result = run_protocol(
        PROTOCOL, here, MemoryRecord(), operator=lambda _: True, advance=lambda *_: enabled.append(card.lines[LINE])
    )
    assert (result.state, result.outcome) == (State.SAFE, "completed")
    assert set(enabled) == {True}
    assert not card.lines[LINE]
    assert card.calls["watchdog RESET_TIMER"] == 20
    assert here.description["guard"] == f"watchdog of 3 s; enable line {LINE}"


def test_a_watchdog_that_has_expired_ends_the_run_with_that_reason(card: DaqmxDevice, tmp_path: Path) -> None:
    result = run_protocol(
        PROTOCOL,
        devices(tmp_path),
        MemoryRecord(),
        operator=lambda _: True,
        advance=lambda *_: card.let_watchdog_expire(),
    )
    assert (result.state, result.outcome) == (State.SAFE, "failed")
    assert "the watchdog has expired" in result.reason


@pytest.mark.parametrize("hangs", ["read_analog_f64", "write_analog_f64"])
def test_a_call_of_the_driver_that_hangs_leaves_outputs_at_0_volt_and_the_line_low(
    hangs: str, tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    card, release, clock = DaqmxDevice(), Event(), Clock()
    install(card, monkeypatch)

    def hang(call: str) -> None:
        if call == hangs and any(card.lines.values()):
            card.hangs = lambda _: None
            clock.now += 1e5
            assert release.wait()

    monkeypatch.setattr(supervision, "time", clock)
    monkeypatch.setattr(supervision, "LATE", 2.0)
    monkeypatch.setattr(supervision, "_RETURNING", 0.2)
    card.hangs = hang
    result = run_protocol(PROTOCOL, devices(tmp_path), MemoryRecord(), operator=lambda _: True)
    assert (result.state, result.outcome) == (State.SAFE, "failed")
    assert result.reason.endswith("; the supervisor has told motor and drive to switch off")
    assert card.is_off("Dev1/ao0")
    assert card.is_off("Dev1/ao1")
    assert not card.lines[LINE]
    release.set()
    for thread in enumerate_threads():
        if thread.name == "sonolube devices":
            thread.join()  # the call has gone on
    assert card.is_off("Dev1/ao0")


@pytest.mark.parametrize(
    ("guard", "reason"),
    [
        ('[guard]\ndriver = "daqmx"\n', "guard: needs watchdog_timeout, enable_line or both"),
        ('[guard]\ndriver = "daqmx"\nenable_line = "Dev1/line0"\n', "guard.enable_line"),
        ('[guard]\ndriver = "relay"\nenable_line = "Dev1/port0/line0"\n', "guard: driver must be daqmx, got 'relay'"),
    ],
)
def test_a_guard_that_guards_nothing_is_refused(guard: str, reason: str, tmp_path: Path) -> None:
    with raises(InvalidInput, match=reason):
        devices(tmp_path, "\n" + guard)
