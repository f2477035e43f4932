"""Commands whose optional packages are missing: one line with the command that installs them."""

import sys
from pathlib import Path

import pytest
from pytest import MonkeyPatch
from tests.cli.conftest import Program

from sonolube.extras import EXTRAS

RIG = str(Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml")
DEVICES = str(Path(__file__).parents[2] / "examples" / "lab" / "devices.toml")
SPEEDS = ("--over", "sliding.sliding_speed=20mm/s,50mm/s")
VOLTS = ("--over", "drive.voltage_peak_to_peak=5V,10V")
NEEDING = {
    "fem": ("modes", "block", "--set", "length=20mm", "--set", "width=10mm", "--set", "thickness=5mm"),
    "surfaces": ("measure", "surface", "plate.sur"),
    "web": ("map", RIG, *SPEEDS, *VOLTS, "--form", "html"),
    "daqmx": ("lab", "check", DEVICES, "--connect"),
    "cluster": ("sweep", RIG, *SPEEDS, "--scheduler", "local"),
}


@pytest.fixture(autouse=True)
def _desk(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("plate.sur").write_bytes(b"DIGITAL SURF" + bytes(1000))


def hide(modules: tuple[str, ...], monkeypatch: MonkeyPatch) -> None:
    for name in {*modules, *(each for each in sys.modules if each.startswith(tuple(f"{one}." for one in modules)))}:
        monkeypatch.setitem(sys.modules, name, None)


@pytest.mark.parametrize("name", NEEDING)
def test_a_missing_package_is_refused_in_one_line_with_its_command(
    name: str, sonolube: Program, monkeypatch: MonkeyPatch
) -> None:
    hide(EXTRAS[name].modules, monkeypatch)
    refusal = sonolube(*NEEDING[name]).refusal
    assert EXTRAS[name].package in refusal
    assert EXTRAS[name].command in refusal
    assert not Path("out").exists()
