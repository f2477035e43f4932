"""Table of own runs: digits as written, sources, rows added once, edits, switches, and what predictions read."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import raises
from tests.same import approx

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import read_runs
from sonolube.measurement.run_sheet import (
    RunSheet,
    joined,
    read_sheet,
    sheet_of_rows,
    with_cell,
    with_switch,
    without_row,
)

GERMAN = (
    "Amplitude [nm];Geschwindigkeit [m/s];Reibungszahl mit;Reibungszahl ohne\n"
    "2500;0,0300;0,20;0,40\n2500;0,060;0,3;0,40\n"
)


@pytest.fixture
def german(tmp_path: Path) -> Path:
    path = tmp_path / "runs.csv"
    path.write_text(GERMAN)
    return path


def test_a_table_has_usual_units_and_the_digits_of_its_file(german: Path) -> None:
    sheet = read_sheet(german, source="runs.csv")
    assert sheet.headings[:2] == ("vibration_amplitude [um]", "sliding_speed [mm/s]")
    assert [sheet.cell(0, name) for name in sheet.names] == ["2.500", "30.0", "0.20", "0.40", "runs.csv"]
    assert [sheet.cell(1, name) for name in sheet.names] == ["2.500", "60", "0.3", "0.40", "runs.csv"]


def test_what_is_written_is_read_as_the_same_runs(german: Path, tmp_path: Path) -> None:
    (tmp_path / "own.csv").write_text(read_sheet(german).csv())
    before, after = read_runs(german), read_runs(tmp_path / "own.csv")
    for name in before.data_vars:
        assert after[name].to_numpy() == approx(before[name].to_numpy(), nan_ok=True)


def test_rows_are_added_once_and_repeats_of_one_table_stay(german: Path) -> None:
    german.write_text(GERMAN + GERMAN.splitlines()[-1] + "\n")
    first, added = joined(RunSheet(), read_sheet(german, source="a"))
    assert added == len(first.rows) == 3
    again, added = joined(first, read_sheet(german, source="a"))
    assert (len(again.rows), added) == (3, 0)
    switched, added = joined(with_switch(first, row=0, is_used=False), read_sheet(german, source="a"))
    assert (len(switched.rows), added) == (3, 0)
    other, added = joined(first, read_sheet(german, source="b"))
    assert (len(other.rows), added) == (6, 3)


def test_a_run_that_is_switched_off_is_left_out_of_what_is_read_and_said(german: Path, tmp_path: Path) -> None:
    sheet = with_switch(read_sheet(german), row=0, is_used=False)
    (tmp_path / "own.csv").write_text(sheet.csv())
    runs = read_runs(tmp_path / "own.csv")
    assert runs["sliding_speed"].to_numpy() == approx([0.06])
    assert runs.attrs["caveats"] == "switched off by the column 'used' and left out: line 2"
    (tmp_path / "own.csv").write_text(with_switch(sheet, row=1, is_used=False).csv())
    with raises(InvalidInput, match="every run is switched off by the column 'used'"):
        read_runs(tmp_path / "own.csv")
    assert with_switch(sheet, row=0, is_used=True) == read_sheet(german)


def test_cells_are_edited_in_any_unit_and_rows_removed(german: Path) -> None:
    sheet = read_sheet(german)
    assert with_cell(sheet, row=1, name="sliding_speed", text="0.1 m/s").cell(1, "sliding_speed") == "100"
    assert with_cell(sheet, row=1, name="sliding_speed", text=" 45.0 ").cell(1, "sliding_speed") == "45.0"
    assert with_cell(sheet, row=2, name="note", text="dry day").cell(2, "note") == "dry day"
    emptied = with_cell(with_cell(RunSheet(), row=0, name="note", text="a"), row=0, name="note", text="")
    assert emptied == RunSheet()
    assert not emptied.csv()
    assert without_row(sheet, row=0).rows == sheet.rows[1:]


@pytest.mark.parametrize(
    ("row", "name", "text", "said"),
    [
        (5, "sliding_speed", "1", "row must be one of the 2 of the table, counted from 0, got 5"),
        (-1, "sliding_speed", "1", "row must be one of the 2"),
        (0, "sliding_speed", "fast", "sliding speed 'fast' is not a number with a unit"),
        (0, "sliding_speed", "3 N", "sliding speed 3 N is a force"),
        (0, "sliding_speed", "nan", "sliding speed 'nan mm/s' is not a number with a unit"),
        (0, "colour", "red", "'colour' is no column of a table of runs"),
        (0, "note", "x" * 501, "a cell has at most 500 characters"),
    ],
)
def test_a_change_that_makes_no_sense_is_refused(row: int, name: str, text: str, said: str, german: Path) -> None:
    with raises(InvalidInput, match=said):
        with_cell(read_sheet(german), row=row, name=name, text=text)


@given(st.floats(1e-9, 1e3), st.text(st.characters(categories=["L", "N", "P"]), min_size=1, max_size=20))
def test_numbers_in_si_are_written_in_usual_units(speed: float, note: str) -> None:
    sheet = sheet_of_rows([{"sliding_speed": speed, "note": note}], source="recording")
    assert float(sheet.cell(0, "sliding_speed")) == approx(1e3 * speed, rel=1e-9)
    assert (sheet.cell(0, "note"), sheet.cell(0, "source")) == (note, "recording")


def test_words_of_a_direction_stay(tmp_path: Path) -> None:
    (tmp_path / "runs.csv").write_text("vibration_direction [deg],friction_ratio\nalong,0.5\n30,0.6\n")
    sheet = read_sheet(tmp_path / "runs.csv")
    assert [sheet.cell(row, "vibration_direction") for row in (0, 1)] == ["along", "30"]
    (tmp_path / "own.csv").write_text(sheet.csv())
    angles = read_runs(tmp_path / "own.csv")["vibration_direction"].to_numpy()
    assert angles == approx([0.0, np.pi / 6])
