"""One run at a time has a device, whatever folder, map or process it comes from; a dead process keeps nobody out."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from pytest import MonkeyPatch, raises
from tests.laboratory.rig_stand_ins import HARDWARE
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig

from sonolube.facts.protocol import protocol_from
from sonolube.laboratory import run_plan as reservation, run_protocol
from sonolube.laboratory.drivers.daqmx_library import daqmx_resource
from sonolube.laboratory.drivers.device_map import first_readings
from sonolube.laboratory.drivers.visa_connection import visa_resource
from sonolube.laboratory.run_plan import DeviceInUse, require_free, reserved

CARD = "ni-daqmx dev1"
HOLDING = """
import sys
from sonolube.laboratory.run_plan import reserved
with reserved([sys.argv[1]]):
    print("has it", flush=True)
    sys.stdin.read()
"""
WAITING = protocol_from(
    {
        "title": "test",
        "source": "test",
        "limits": {"voltage_maximum": "60 V", "duration_maximum": "1 s"},
        "steps": [{"kind": "wait", "duration": "0.1 s"}],
    }
)


def holder(folder: Path) -> "subprocess.Popen[str]":
    """Process that has the card, at work in another folder."""
    pipe = subprocess.PIPE
    command = [sys.executable, "-c", HOLDING, CARD]
    process = subprocess.Popen(command, cwd=folder, stdin=pipe, stdout=pipe, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "has it\n"
    return process


def test_another_process_in_another_folder_is_kept_out_and_told_who_has_the_device(tmp_path: Path) -> None:
    with holder(tmp_path) as process:
        line = rf"^ni-daqmx dev1 is in use by another run: process {process.pid}, started in {tmp_path}$"
        with raises(DeviceInUse, match=line):
            require_free([CARD, "serial 3"])
        require_free(["ni-daqmx dev2", "serial 3"])
        process.communicate("")
    require_free([CARD])


def test_a_process_that_was_killed_keeps_nobody_out(tmp_path: Path) -> None:
    with holder(tmp_path) as process:
        process.kill()
        process.wait()
    require_free([CARD])


def test_a_shell_with_another_folder_of_states_has_the_same_locks(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    with holder(tmp_path) as process:
        monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "other"))
        with raises(DeviceInUse, match=f"process {process.pid}"):
            require_free([CARD])
        process.communicate("")


def test_the_locks_are_in_the_home_of_the_user_whatever_the_environment_says(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.delenv(reservation.LOCKS)
    places = [reservation._folder(CARD)]
    for name in ("XDG_STATE_HOME", "HOME"):
        monkeypatch.setenv(name, "/elsewhere")
        places.append(reservation._folder(CARD))
    assert len(set(places)) == 1
    assert places[0].parts[-5:-1] == (".local", "state", "sonolube", "devices")


def test_another_run_of_the_same_process_is_kept_out() -> None:
    with reserved([CARD]), raises(DeviceInUse, match=f"process {os.getpid()}"):
        require_free([CARD])
    require_free([CARD])


@pytest.mark.skipif(os.name != "posix", reason="the locks of Windows suffice")
def test_where_files_cannot_be_locked_the_start_time_tells_a_process_from_a_later_one(
    tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr("sonolube.storage.files.lock_file", lambda handle, wait=False: None)
    with holder(tmp_path) as process:
        with raises(DeviceInUse, match=f"process {process.pid}"):
            require_free([CARD])
        note = reservation._folder(CARD) / "holder.json"
        known = json.loads(note.read_text())
        note.write_text(json.dumps(known | {"started": "long ago"}))
        require_free([CARD])
        process.communicate("")


@pytest.mark.parametrize(
    "addresses",
    [
        ("TCPIP::192.168.1.21::5025::SOCKET", "tcpip0::192.168.1.21::5025::socket"),
        ("TCPIP::generator.local::INSTR", "TCPIP0::GENERATOR.local::inst0::INSTR"),
        ("TCPIP::192.168.1.21", "TCPIP1::192.168.1.21::INST0::INSTR"),
        ("ASRL3::INSTR", "asrl3::instr"),
        ("ASRL3::INSTR", "com3"),
        ("ASRLCOM12::INSTR", r"\\.\COM12"),
        ("GPIB::10::INSTR", "GPIB0::10::INSTR"),
        ("GPIB::5", "GPIB0::0x5::INSTR"),
        ("USB::0x0957::0x2807::MY500::INSTR", "USB0::2391::10247::my500::0::INSTR"),
        ("USB::0x0957::0x2807::MY500", "USB1::0x957::0x2807::MY500::INSTR"),
    ],
)
def test_two_ways_to_write_an_address_are_one_device(addresses: tuple[str, str]) -> None:
    assert len(set(map(visa_resource, addresses))) == 1


def test_a_link_to_a_serial_port_is_that_port(tmp_path: Path) -> None:
    (tmp_path / "port").touch()
    (tmp_path / "by-id").symlink_to(tmp_path / "port")
    assert visa_resource(f"ASRL{tmp_path}/by-id::INSTR") == visa_resource(f"ASRL{tmp_path}/port::INSTR")


def test_different_devices_have_different_names() -> None:
    addresses = (
        "TCPIP::h::5025::SOCKET",
        "TCPIP::h::5026::SOCKET",
        "GPIB0::1::INSTR",
        "GPIB1::1::INSTR",
        "ASRL1::INSTR",
        "COM2",
        "TCPIP::h::inst1::INSTR",
        "TCPIP::h::INSTR",
        "USB::1::2::0::INSTR",
        "USB::1::2::00::INSTR",
        "USB::1::2::0::1::INSTR",
    )
    assert len(set(map(visa_resource, addresses))) == len(addresses)
    assert daqmx_resource("Dev1/ao0") == daqmx_resource("DEV1/ao1") == daqmx_resource("dev1") != daqmx_resource("Dev11")


def test_a_run_on_devices_that_another_has_opens_and_switches_nothing() -> None:
    rig, record = SimulatedRig(), MemoryRecord()
    with reserved([CARD]):
        result = run_protocol(WAITING, replace(rig.devices(), resources=(CARD,)), record, operator=lambda _: True)
    assert result.outcome == record.outcome == "failed"
    assert result.reason.startswith("ni-daqmx dev1 is in use by another run: process")
    assert (rig.connected, rig.calls) == (0, [])


@pytest.mark.parametrize("kind", HARDWARE)
def test_the_devices_of_a_map_are_reserved_until_the_run_has_ended(kind: str, tmp_path: Path) -> None:
    with HARDWARE[kind](tmp_path) as rig:
        assert CARD in rig.devices.resources
        rig.was_on()
        with reserved(rig.devices.resources):
            record = MemoryRecord()
            run_protocol(WAITING, rig.devices, record, operator=lambda _: True)
            assert "is in use by another run" in record.reason
            with raises(DeviceInUse):
                first_readings(rig.devices, sample_rate=1e3)
            assert rig.rotation_speed() > 0  # what another run has set goes on
        record = MemoryRecord()
        run_protocol(WAITING, rig.devices, record, operator=lambda _: True)
        assert record.outcome == "completed"
        require_free(rig.devices.resources)


def test_the_acquisition_is_connected_first() -> None:
    connected: list[str] = []

    class Named(SimulatedRig):
        def connect(self) -> None:
            connected.append(self.name)

    devices = replace(
        SimulatedRig().devices(), acquisition=Named(name="inputs"), drive=Named(name="drive"), motor=Named(name="motor")
    )
    run_protocol(WAITING, devices, MemoryRecord(), operator=lambda _: True)
    assert connected == ["inputs", "drive", "motor"]
