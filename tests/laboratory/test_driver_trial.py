"""Trials of drivers: which faults there are, which drivers a module has, and what is wrong of an end by hand."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from pytest import MonkeyPatch, approx, raises

from sonolube.errors import InvalidInput
from sonolube.laboratory.driver_trial import Fault, Trial, TriedFault, drivers_to_try, faults_of
from sonolube.laboratory.drivers import read_device_map

ROOT = Path(__file__).parents[2]
BENCH_SOURCE = ROOT / "examples" / "lab" / "bench_source.py"
OWN_WORD = "confirmed off, drive and motor by the device's own word, not measured"
ENDED = TriedFault(
    fault=Fault("drive.drive", "hang"), is_on=False, verdict=OWN_WORD, recorded=OWN_WORD, code=1, output="", error=""
)
SOURCE = """
from typing import Literal
from sonolube.laboratory.drivers import DriveEntry, MotorEntry

class Acme(DriveEntry):
    driver: Literal["acme"]
    address: str
    port: int = 1
    where = property(lambda self: self.address)
    reserved_as = property(lambda self: self.address)
    def new_device(self): ...
"""


def test_every_call_of_every_device_meets_every_kind_of_fault() -> None:
    found = faults_of(("drive", "motor", "acquisition"))
    assert len(found) == len(set(found)) == 13 * 26 + 6 + 3 + 2
    assert {each.where for each in found if each.kind == "hang"} == {each.where for each in found}
    assert {each.where for each in faults_of(("motor",))} == {
        f"motor.{each}" for each in ("connect", "turn", "off", "close")
    }
    assert {each.where for each in found if each.is_lie} == {"drive.off", "motor.off"}


def test_ten_faults_of_each_device_are_quick() -> None:
    for role in ("drive", "motor", "acquisition"):
        quick = faults_of((role,), quick=True)
        assert len(quick) == 10
        assert set(quick) <= set(faults_of((role,)))


@pytest.mark.parametrize(
    ("changes", "wrong"),
    [
        ({}, ""),
        ({"is_on": True}, "called off with an output on"),
        ({"is_on": True, "verdict": "measured off", "recorded": "measured off"}, "called off with an output on"),
        ({"is_on": True, "verdict": "cut the power: drive: hangs", "recorded": "cut the power: drive: hangs"}, ""),
        ({"verdict": ""}, "no verdict; another verdict in its record"),
        ({"recorded": ""}, "another verdict in its record"),
        ({"recorded": "", "fault": Fault("acquisition.read", "disk full", 3)}, ""),
        ({"error": "Traceback (most recent call last):"}, "a traceback"),
        ({"code": None}, "has not ended"),
        ({"is_on": True, "fault": Fault("drive.off", "acts lies", 0)}, ""),
        (
            {"is_on": True, "fault": Fault("drive.off", "acts lies", 0), "verdict": "measured off"},
            "called off with an output on; another verdict in its record",
        ),
    ],
)
def test_an_end_is_right_where_its_verdict_is_that_of_the_outputs(changes: dict[str, object], wrong: str) -> None:
    assert replace(ENDED, **changes).wrong == wrong  # type: ignore[arg-type]


def test_the_reason_of_a_failed_run_is_that_of_its_answer_else_its_last_line() -> None:
    assert replace(ENDED, output=json.dumps({"reason": "lost"})).reason == "lost"
    assert replace(ENDED, error="running\nsonolube: refused\n").reason == "sonolube: refused"
    assert replace(ENDED, code=0, error="running").reason == ""


def test_the_time_to_off_is_from_the_fault_to_the_last_output_that_went_off(tmp_path: Path) -> None:
    lines = [
        (0.0, "drive", 20.0),
        (1.0, "motor", 1.0),
        (1.5, "call", "drive.off"),
        (1.5, "fault", "drive.off"),
        (2.0, "drive", 0.0),
        (4.5, "motor", 0.0),
        (5.0, "drive", 0.0),
    ]
    trial = Trial(tmp_path / "rig")
    log = tmp_path / "rig" / "log.txt"
    log.write_text("".join(json.dumps([time, 1, *words]) + "\n" for time, *words in lines))
    assert trial._seconds_to_off() == approx(3.0)
    assert (trial.last("drive"), trial.last("motor"), trial.last("guard")) == (0.0, 0.0, 0.0)
    log.write_text("".join(json.dumps([time, 1, *words]) + "\n" for time, *words in lines[:-2]))
    assert trial._seconds_to_off() is None
    assert trial.last("motor") == 1.0


def test_a_file_with_a_driver_is_tried_with_what_its_section_must_have(tmp_path: Path) -> None:
    found = drivers_to_try(BENCH_SOURCE, {"drive.amplifier_gain": "5", "drive.voltage_maximum": "12 V"})
    assert found.roles == ("drive",)
    with found.instruments() as instruments:
        trial = Trial(tmp_path / "rig", found, instruments=instruments)
    with MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(trial.folder))
        devices = read_device_map(trial.folder / "devices.toml").devices()
    assert devices.drive.name == "bench source"
    assert devices.drive.voltage_maximum == approx(12.0)  # of the section, below 5 times 10 V
    assert devices.motor.rotation_speed_maximum == approx(5.0)  # 300 rpm, pretended
    assert 'voltage_peak_to_peak = "20.0 V"' in (trial.folder / "short.toml").read_text()


def test_what_is_no_driver_is_refused_in_one_line(tmp_path: Path) -> None:
    file = tmp_path / "acme_of_test.py"
    file.write_text(SOURCE)
    (tmp_path / "broken_of_test.py").write_text("1 / 0")
    (tmp_path / "empty_of_test.py").write_text("")
    found = drivers_to_try(file)
    with raises(InvalidInput, match=r"^acme_of_test: Acme: drive\.address: Field required; state entries by --set"):
        found.entry("drive", {})
    assert found.entry("drive", {"address": "here"})[1]["driver"] == "acme"
    assert drivers_to_try(f"{file.stem}:Acme", {"drive.port": "3"}).given == {"drive": {"port": 3}}
    for place, told in (
        (tmp_path / "none.py", r"none\.py: no such file"),
        (tmp_path / "broken_of_test.py", r"cannot be imported \(ZeroDivisionError: division by zero\)"),
        (tmp_path / "empty_of_test.py", r"has no driver: a class that derives from AcquisitionEntry"),
        (f"{file.stem}:Other", r"has no class Other that is a driver"),
        ("no_such_module_of_test", r"cannot be imported \(ModuleNotFoundError"),
    ):
        with raises(InvalidInput, match=told) as refusal:
            drivers_to_try(place)
        assert "\n" not in str(refusal.value)
    for key in ("address", "motor.port", "drive."):
        with raises(InvalidInput, match="is no entry of drive; write it as drive"):
            drivers_to_try(file, {key: "1"})
    file.write_text(SOURCE + SOURCE[SOURCE.index("class") :].replace("Acme", "Second"))
    (tmp_path / "two_of_test.py").write_text(file.read_text())
    with raises(InvalidInput, match=r"several drivers of the drive: Acme, Second; choose one as .*:NAME$"):
        drivers_to_try(tmp_path / "two_of_test.py")
