"""Tables of runs as laboratories write them: at least three of every kind, each with its right value."""

import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises
from tests.measurement.laboratory_tables import FULL, LABORATORY_TABLES, LaboratoryTable, ods, xlsx

import sonolube
from sonolube.errors import InvalidInput, MissingPackage
from sonolube.measurement.measured_runs import read_runs, run_caveats
from sonolube.rig import Rig
from sonolube.tasks.lookup.mapping import MappingAnswer
from sonolube.vocabulary import quantities


def written(table: LaboratoryTable, folder: Path) -> Path:
    path = folder / f"runs{table.suffix}"
    path.write_bytes(table.content)
    return path


def require_right(runs: xr.Dataset, table: LaboratoryTable) -> None:
    for name, values in table.right.items():
        found = 1 - runs["friction_reduction"].to_numpy() if name == "friction_ratio" else runs[name].to_numpy()
        assert found == approx(np.array(values), rel=1e-9), name


def test_each_kind_has_at_least_three_tables() -> None:
    kinds = Counter(table.kind for table in LABORATORY_TABLES.values())
    assert min(kinds.values()) >= 3
    assert len(LABORATORY_TABLES) >= 60


def test_right_values_are_of_four_runs_and_of_known_quantities() -> None:
    for table in LABORATORY_TABLES.values():
        assert {len(values) for values in table.right.values()} == {4}
        assert set(table.right) <= set(quantities())


@pytest.mark.parametrize("name", [name for name, table in LABORATORY_TABLES.items() if not table.is_asked])
def test_a_table_that_tells_its_values_is_read_right(name: str, tmp_path: Path) -> None:
    require_right(read_runs(written(LABORATORY_TABLES[name], tmp_path)), LABORATORY_TABLES[name])


@pytest.mark.parametrize("name", [name for name, table in LABORATORY_TABLES.items() if table.is_asked])
def test_a_table_that_does_not_is_refused_with_a_remedy_that_works(name: str, tmp_path: Path) -> None:
    table = LABORATORY_TABLES[name]
    path = written(table, tmp_path)
    with raises(InvalidInput, match=r"sonolube mapping|put it into the heading") as refusal:
        read_runs(path)
    assert "\n" not in str(refusal.value)
    answer = sonolube.mapping(path, column=table.statements, decimal_sign=table.decimal_sign)
    require_right(read_runs(path, mapping=mapping_file(answer, tmp_path)), table)


@pytest.mark.parametrize("name", LABORATORY_TABLES)
def test_what_the_command_mapping_writes_is_read_right(name: str, tmp_path: Path) -> None:
    table = LABORATORY_TABLES[name]
    path = written(table, tmp_path)
    answer = sonolube.mapping(path, column=table.statements, decimal_sign=table.decimal_sign)
    assert answer.object()["friction_ratios"] == approx(list(table.right["friction_ratio"]))
    require_right(read_runs(path, mapping=mapping_file(answer, tmp_path)), table)


@pytest.fixture(scope="module")
def rig() -> Rig:
    known = {"pin": "brass", "disc": "304", "load": "5N", "speed": "0.2m/s", "frequency": "20kHz"}
    return sonolube.new(**known, calibration="25V = 2um").rig


@pytest.mark.parametrize("name", [name for name, table in LABORATORY_TABLES.items() if table.is_asked])
def test_fit_takes_what_the_command_mapping_writes(name: str, rig: Rig, tmp_path: Path) -> None:
    table = LABORATORY_TABLES[name]
    path = written(table, tmp_path)
    answer = sonolube.mapping(path, column=table.statements, decimal_sign=table.decimal_sign)
    found = sonolube.fit(path, rig=rig, mapping=mapping_file(answer, tmp_path), model=["kinematic-fitted"])
    assert "4 runs" in str(found)


def mapping_file(answer: MappingAnswer, folder: Path) -> Path:
    ((name, content),) = answer.files().items()
    (folder / name).write_text(content, encoding="utf-8")
    return folder / name


KINDS_THAT_ARE_SAID = {
    "comment rows 45": "line 4 is no run and left out: 'pause'",
    "summary rows 47": "line 6 is no run and left out: 'Mean'",
    "repeated header 50": "line 4 repeats the headings and is left out",
    "plain headings 4": "'Amplitude pp [um]' is read as peak to peak: the amplitude is half of it",
    "uncertainty in cells 24": "what stands behind +- in friction_force is taken as its standard uncertainty",
    "empty columns 68": "column 1 has no heading, numbers the rows and is left out",
    "xlsx 80": "of 2 sheets only 'Runs' is read",
}


@pytest.mark.parametrize(("name", "caveat"), KINDS_THAT_ARE_SAID.items())
def test_what_is_left_out_or_assumed_is_said(name: str, caveat: str, tmp_path: Path) -> None:
    assert caveat in run_caveats(read_runs(written(LABORATORY_TABLES[name], tmp_path)))


def test_a_spreadsheet_without_its_reader_names_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "python_calamine", None)
    with raises(MissingPackage, match=r"need python-calamine.*: pip install python-calamine, or save the table as CSV"):
        read_runs(written(LABORATORY_TABLES["ods 82"], tmp_path))


def test_sheets_that_may_both_be_the_table_are_refused_and_one_is_selected(tmp_path: Path) -> None:
    path = tmp_path / "runs.xlsx"
    path.write_bytes(xlsx({"March": FULL, "April": FULL[:3]}))
    with raises(InvalidInput, match=r"sheets 'March' and 'April' may both be the table; .* selection\.sections"):
        read_runs(path)
    mapping = tmp_path / "sheet.toml"
    mapping.write_text('[selection]\nsections = ["April"]\n')
    assert read_runs(path, mapping=mapping).sizes["run"] == 2
    mapping.write_text('[selection]\nsections = ["May"]\n')
    with raises(InvalidInput, match="has no sheet 'May' with cells; it has March, April"):
        read_runs(path, mapping=mapping)


@pytest.mark.parametrize("content", [b"PK\x03\x04" + bytes(50), ods({"Runs": FULL})[:400]])
def test_a_damaged_spreadsheet_is_refused_in_one_line(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "runs.ods"
    path.write_bytes(content)
    with raises(InvalidInput, match="cannot be read as a spreadsheet") as refusal:
        read_runs(path)
    assert "\n" not in str(refusal.value)
