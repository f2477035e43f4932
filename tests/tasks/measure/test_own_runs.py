"""Table of own runs in Python and on a terminal: rows with sources, each change a new table, saved and undone."""

import json
from pathlib import Path
from shutil import copy

import numpy as np
import pytest
from pytest import approx, raises
from tests.same import same

import sonolube as sl
from sonolube.cli import main
from sonolube.errors import InvalidInput
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.measure.own_runs import OwnRunsAnswer

EXAMPLES = Path(__file__).parents[3] / "examples"
RUNS = EXAMPLES / "tribometer-runs.csv"
RIG = EXAMPLES / "rigs" / "tribometer.toml"
ROW: dict[str, float | str] = {
    "friction_force": 0.6,
    "intrinsic_friction_force": 1.2,
    "sliding_speed": "40 mm/s",
    "voltage_peak_to_peak": 28.0,
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (place := tmp_path / "bench").mkdir()
    copy(RIG, place / "rig.toml")
    copy(RUNS, place / "runs.csv")
    return place


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """Export of 10 s at 1 N without and 10 s at 0.4 N with vibration, by the voltage that it states."""
    time = np.arange(0, 20, 0.01)
    force = np.where(time < 10, 1.0, 0.4) + 0.002 * (-1) ** np.arange(time.size)
    rows = zip(time, force, np.where(time < 10, 0, 28), strict=True)
    text = "time (s),friction_force (N),voltage_peak_to_peak (V)\n" + "\n".join(
        f"{t:.2f},{f:.4f},{u}" for t, f, u in rows
    )
    (path := tmp_path / "friction.csv").write_text(text)
    return path


def used(table: OwnRunsAnswer) -> list[bool]:
    return [run["is_used"] for run in table.object()["runs"]]


def test_each_change_is_a_new_table_and_undone_step_by_step() -> None:
    first = sl.runs(RUNS)
    off = first.leave_out(2, 3)
    less = off.remove(1)
    assert (used(first), used(off), used(less)) == ([True] * 4, [True, False, False, True], [False, False, True])
    assert less.undo().sheet == off.sheet
    assert less.undo().undo().sheet == first.sheet
    assert used(off.use(2)) == [True, True, False, True]
    with raises(InvalidInput, match="nothing was changed"):
        first.undo()
    with raises(InvalidInput, match="there is no run 5; the table has runs 1 to 4"):
        first.leave_out(5)


def test_a_row_is_typed_in_si_or_with_units_and_edited() -> None:
    table = sl.runs().add(ROW)
    (run,) = table.object()["runs"]
    assert run["sliding_speed"]["value"] == approx(0.04, rel=1e-9)
    edited = table.edit(1, sliding_speed="50 mm/s", friction_force=0.7)
    (run,) = edited.object()["runs"]
    assert (run["sliding_speed"]["value"], run["friction_force"]["value"]) == approx((0.05, 0.7), rel=1e-9)
    with raises(InvalidInput, match=r"'colour' is no column"):
        table.add({"colour": "red"})


def test_tables_frames_and_datasets_are_taken_and_nothing_twice() -> None:
    table = sl.runs(RUNS)
    for source in (RUNS, table, NamedBytes("runs.csv", RUNS.read_bytes())):
        assert len(sl.runs(source).sheet.rows) == 4
    frame = sl.runs(sl.read_runs(RUNS).to_dataframe())
    assert len(frame.sheet.rows) == 4
    assert len(table.add(RUNS).sheet.rows) == 8  # of another source, which the table itself does not state
    twice = sl.runs().add(RUNS).add(RUNS)
    assert len(twice.sheet.rows) == 4
    assert "0 added, 4 in the table already" in twice.text()


def test_a_recording_gives_its_level_and_an_answer_of_its_measurement_the_same(recording: Path) -> None:
    table = sl.runs().add(recording, speed="30 mm/s", load=3.0)
    run = table.object()["runs"][-1]
    assert run["friction_force"]["value"] == approx(0.4, abs=0.01)
    assert run["sliding_speed"]["value"] == approx(0.03, rel=1e-9)
    assert "friction.csv" in run["run"]
    by_answer = sl.runs().add(sl.measure.friction(recording), speed="30 mm/s", load=3.0)
    assert by_answer.sheet == table.sheet
    assert len(table.add(recording, speed="30 mm/s", load=3.0).sheet.rows) == len(table.sheet.rows)


def test_a_table_is_shown_with_its_sources_as_text_and_in_notebooks(recording: Path) -> None:
    table = sl.runs().add(RUNS).leave_out(3)
    assert "4 own runs, 1 of them left out" in str(table)
    assert "tribometer-runs.csv" in table._repr_html_()
    assert "<table>" in table._repr_html_()


def test_predictions_and_fits_take_the_table_as_its_file(tmp_path: Path) -> None:
    table = sl.runs(RUNS).leave_out(2)
    saved = table.save(tmp_path / "own.csv")
    for each in (saved, sl.runs(tmp_path / "own.csv")):
        assert used(each) == [True, False, True, True]
    found, expected = (sl.predict(RIG, runs=runs, draws=500).object() for runs in (table, tmp_path / "own.csv"))
    assert found["friction_reduction"]["interval_80"] == approx(
        expected["friction_reduction"]["interval_80"], abs=1e-12
    )
    errors = [sl.fit(runs, rig=RIG, model=["kinematic"])["rms"].values for runs in (table, tmp_path / "own.csv")]
    assert errors[0] == approx(errors[1], abs=1e-12)
    with raises(InvalidInput, match="this table has no run yet"):
        sl.predict(RIG, runs=sl.runs())


def test_a_file_that_another_program_changed_is_not_overwritten(folder: Path) -> None:
    table = sl.runs(folder).leave_out(1)
    other = (folder / "runs.csv").read_text() + "14,60,1.2,1.3\n"
    (folder / "runs.csv").write_text(other)
    with raises(InvalidInput, match=r"runs\.csv: another program changed it since it was read"):
        table.save()
    same((folder / "runs.csv").read_text(), other)
    assert used(sl.runs(folder).leave_out(1).save().undo().save()) == [True] * 5


def test_columns_that_a_table_does_not_keep_are_not_lost_in_silence(folder: Path) -> None:
    lines = (folder / "runs.csv").read_text().splitlines()
    (folder / "runs.csv").write_text(
        "\n".join(f"{line},{cell}" for line, cell in zip(lines, ["operator", *"abcd"], strict=True))
    )
    with raises(InvalidInput, match="'operator' would be lost"):
        sl.runs(folder).leave_out(1).save()


def test_a_new_table_asks_for_its_file_and_an_empty_one_keeps_its_headings(folder: Path) -> None:
    with raises(InvalidInput, match="has no file yet"):
        sl.runs().add(ROW).save()
    sl.runs(folder).remove(1, 2, 3, 4).save()
    assert (folder / "runs.csv").read_text().count("\n") == 1
    assert len(sl.runs(folder).add(ROW).save().sheet.rows) == 1


def test_the_command_shows_the_table_and_saves_what_it_changes(
    folder: Path, recording: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (folder / "runs.csv").read_bytes()
    with raises(SystemExit):
        main(["runs", str(folder), "--json"])
    assert len(json.loads(capsys.readouterr().out)["runs"]) == 4
    same((folder / "runs.csv").read_bytes(), before)
    expected = sl.runs(folder).add(recording, speed="30 mm/s", load="3 N").leave_out(2)
    added = "--add", str(recording), "--speed", "30mm/s", "--load", "3N", "--leave-out", "2"
    with raises(SystemExit) as end:
        main(["runs", str(folder), *added])
    assert (end.value.code or 0) == 0
    assert sl.runs(folder).sheet == expected.sheet
