"""`sonolube lab check`: what a device map lacks, what is beyond it, and what its inputs read."""

import sys
from pathlib import Path

import pytest
from pytest import MonkeyPatch, approx
from tests.cli.conftest import Program
from tests.laboratory.daqmx_device import DaqmxDevice, install
from tests.laboratory.rig_stand_ins import EXAMPLE, instrument_rig

from sonolube.extras import EXTRAS


@pytest.fixture
def with_driver(monkeypatch: MonkeyPatch) -> DaqmxDevice:
    card = DaqmxDevice()
    install(card, monkeypatch)
    return card


def test_a_computer_without_the_driver_of_the_card_is_told_how_to_install_it(sonolube: Program) -> None:
    run = sonolube("lab", "check", EXAMPLE)
    assert run.code == 1
    assert "missing: the driver NI-DAQmx is not installed: run `nidaqmx installdriver`" in run.out
    assert "MY50001234" in run.out
    assert "never on hardware" in run.out


def test_missing_packages_are_told_with_the_command_that_installs_each(
    sonolube: Program, monkeypatch: MonkeyPatch
) -> None:
    for name in ("nidaqmx", "pyvisa"):
        monkeypatch.setitem(sys.modules, name, None)
    missing = sonolube("lab", "check", EXAMPLE, "--json").answer["missing"]
    assert missing == [
        f"nidaqmx is not installed: {EXTRAS['daqmx'].command}",
        f"pyvisa-py is not installed: {EXTRAS['visa'].command}",
    ]


def test_a_protocol_within_the_devices_can_be_run(sonolube: Program, with_driver: DaqmxDevice) -> None:
    run = sonolube("lab", "check", EXAMPLE, "--protocol", "map_test")
    assert (run.code, run.err) == (0, "")
    assert "all packages and drivers are installed" in run.out
    assert "map_test can be run" in run.out


def test_a_protocol_beyond_the_devices_is_refused_by_step_with_exit_code_1(
    sonolube: Program, with_driver: DaqmxDevice, tmp_path: Path
) -> None:
    for name in ("devices.toml", "normal_load.csv"):
        text = (EXAMPLE.parent / name).read_text(encoding="utf-8")
        (tmp_path / name).write_text(text.replace('"100 kHz"', '"20 kHz"'), encoding="utf-8")
    run = sonolube("lab", "check", tmp_path / "devices.toml", "--protocol", "map_test", "--json")
    assert run.code == 1
    assert "the drive gives at most 20 kHz" in run.answer["impossible"][0]


def test_all_faults_of_a_map_stand_on_lines_of_their_own(sonolube: Program, tmp_path: Path) -> None:
    path = tmp_path / "devices.toml"
    path.write_text('title = "x"\n[acquisition]\ndriver = "daqmx"\n', encoding="utf-8")
    run = sonolube("lab", "check", path)
    assert run.code == 2
    for key in ("acquisition.device: missing", "acquisition.channels: missing", "drive: missing", "motor: missing"):
        assert any(line.strip() == key for line in run.err.splitlines()), run.err


def test_connected_devices_are_read_with_everything_off(sonolube: Program, tmp_path: Path) -> None:
    with instrument_rig(tmp_path) as rig:
        rig.was_on()
        run = sonolube("lab", "check", tmp_path / "devices.toml", "--connect", "--json")
        assert (rig.voltage(), rig.rotation_speed()) == (0.0, 0.0)
    readings = run.answer["readings"]
    assert readings["friction_force"] == {"value": approx(4 * 0.0495 - 0.012), "unit": "N"}
    assert readings["temperature"]["value"] == approx(273.15 + 100 * 4.0495)


def test_a_device_that_cannot_be_reached_is_refused_in_one_line(sonolube: Program, tmp_path: Path) -> None:
    with instrument_rig(tmp_path) as rig:
        rig.unplug()
        assert "NI-DAQmx knows no device" in sonolube("lab", "check", tmp_path / "devices.toml", "--connect").refusal
