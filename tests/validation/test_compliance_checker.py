"""IOOS Compliance Checker 6.1.0 (Apache, run as another program): recordings by the CF conventions 1.11."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from tests.laboratory.records.described_runs import RUNS


@pytest.fixture(scope="module")
def checker() -> str:
    program = os.environ.get("CF_CHECKER")
    if not program:
        pytest.skip("the checker of the CF conventions is not installed beside sonolube: make cf")
    return program


def found_by(checker: str, paths: list[Path], report: Path) -> dict[str, list[Any]]:
    """Faults and recommendations that the checker reports of each file; it has the table of standard names with it."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command: list[str | Path] = [
        checker,
        "--test",
        "cf:1.11",
        "--criteria",
        "strict",
        "--format",
        "json_new",
        "--output",
        report,
    ]
    run = subprocess.run([*command, *paths], capture_output=True, text=True, env=environment)
    assert run.returncode in (0, 1), run.stderr
    told = json.loads(report.read_text(encoding="utf-8"))
    assert len(told) == len(paths)
    return {
        name: [
            (each["name"], each["msgs"])
            for priority in ("high_priorities", "medium_priorities", "low_priorities")
            for each in about["cf:1.11"][priority]
            if each["value"][0] < each["value"][1]  # points of all; messages stand also beside what passes
        ]
        for name, about in told.items()
    }


@pytest.mark.parametrize("kind", RUNS)
def test_the_checker_finds_no_fault_in_any_file_of_a_run(checker: str, kind: str, tmp_path: Path) -> None:
    folder = RUNS[kind](tmp_path)
    paths = sorted(folder.rglob("*.nc"))
    assert len(paths) == {"lubricated": 1, "two clocks": 2, "virtual": 2, "device map": 1}[kind]
    assert {name: faults for name, faults in found_by(checker, paths, tmp_path / "report").items() if faults} == {}


def test_the_checker_finds_a_unit_and_a_standard_name_that_are_none(checker: str, tmp_path: Path) -> None:
    path = tmp_path / "wrong.nc"
    about = {"units": "furlongs per fortnight squared!", "standard_name": "friction_force", "long_name": "Force"}
    xr.Dataset({"force": ("time", [1.0], about)}, attrs={"Conventions": "CF-1.11"}).to_netcdf(path, engine="h5netcdf")
    (faults,) = found_by(checker, [path], tmp_path / "report").values()
    assert "friction_force" in str(faults)
    assert "furlongs per fortnight squared!" in str(faults)
