"""Folder of a rig in tasks: own runs, posterior, recipes and records are those in it, also in a copy."""

from pathlib import Path
from shutil import copy, copytree

import pytest
from pytest import approx, raises
from tests.tasks.running import running

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.reader import mapping_by_name, recipes_first_in
from sonolube.rig.file.rig_folder import rig_file
from sonolube.tasks.lab.protocol_run import virtual
from sonolube.tasks.lab.run_folders import place_of_records

EXAMPLES = Path(__file__).parents[2] / "examples"
RUNS = EXAMPLES / "tribometer-runs.csv"
KNOWN = {"pin": "brass", "disc": "304", "load": "5 N", "speed": "0.2 m/s", "frequency": "20 kHz", "amplitude": "3 um"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (place := tmp_path / "tribometer").mkdir()
    copy(EXAMPLES / "rigs" / "tribometer.toml", place / "rig.toml")
    copy(RUNS, place / "runs.csv")
    return place


def reductions(answer: object) -> list[float]:
    found = answer.object()["friction_reduction"]  # type: ignore[attr-defined]
    return [found["median"], *found["interval_80"]]


def test_a_new_folder_has_the_rig_and_an_empty_table_of_runs_with_units(tmp_path: Path) -> None:
    made = sl.new(**KNOWN).write_folder(tmp_path / "brass")
    assert {each.name for each in made.iterdir()} >= {"rig.toml", "runs.csv", "instruments", "records", "answers"}
    headings = (made / "runs.csv").read_text().strip().split(",")
    assert {"sliding_speed [mm/s]", "normal_load [N]", "friction_force [N]"} <= set(headings)
    assert sl.predict(made, draws=100).prediction.attrs["runs"] == 0
    with raises(InvalidInput, match="it exists; name a new folder"):
        sl.new(**KNOWN).write_folder(made)
    assert [each.name for each in tmp_path.iterdir()] == ["brass"]


def test_runs_of_the_folder_are_own_runs_and_that_is_said(folder: Path) -> None:
    own, given = sl.predict(folder), sl.predict(rig_file(folder), runs=RUNS)
    assert reductions(own) == approx(reductions(given), abs=1e-12)
    assert any("tribometer/runs.csv are taken as own runs" in each for each in own.caveats())
    without, alone = sl.predict(folder, runs="none"), sl.predict(rig_file(folder))
    assert reductions(without) == approx(reductions(alone), abs=1e-12)
    assert reductions(without) != approx(reductions(own), abs=0.01)


def test_a_copy_of_the_folder_gives_the_same_numbers(folder: Path, tmp_path: Path) -> None:
    before = reductions(sl.predict(folder))
    moved = copytree(folder, tmp_path / "colleague" / "tribometer")
    (folder / "runs.csv").unlink()
    assert reductions(sl.predict(moved)) == approx(before, abs=1e-12)


def test_runs_that_are_all_switched_off_are_left_out(folder: Path) -> None:
    head, *rows = [line for line in RUNS.read_text().splitlines() if line and not line.startswith("#")]
    (folder / "runs.csv").write_text("\n".join([f"{head},used", *(f"{row},no" for row in rows)]))
    assert reductions(sl.predict(folder)) == approx(reductions(sl.predict(rig_file(folder))), abs=1e-12)


def test_a_folder_stands_for_its_runs_where_runs_are_asked_for(folder: Path) -> None:
    by_folder, by_file = (sl.fit(runs, rig=folder, model=["kinematic"]) for runs in (folder, RUNS))
    assert by_folder["rms_unseen"].values == approx(by_file["rms_unseen"].values, abs=1e-12)


def test_a_posterior_in_the_folder_is_the_evidence_unless_it_is_left_out(folder: Path) -> None:
    (folder / "posterior.json").write_text("{}")
    with raises(InvalidInput, match=r"posterior\.json"):
        sl.predict(folder)
    sl.predict(folder, evidence="none", draws=100)


@pytest.fixture
def two_recipes(folder: Path, tmp_path: Path) -> Path:
    """Recipes of one name in the folder of the rig and beside the working folder."""
    recipe = '[channels.friction_force]\ncolumn = "F"\nunit = "{}"\n'
    for place, unit in ((folder, "mN"), (tmp_path, "N")):
        (place / "instruments").mkdir()
        (place / "instruments" / "scale.toml").write_text(recipe.format(unit))
    return folder / "instruments"


def test_recipes_of_the_folder_come_first(two_recipes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert mapping_by_name("scale").channels["friction_force"].unit == "N"
    with recipes_first_in(two_recipes):
        assert mapping_by_name("scale").channels["friction_force"].unit == "mN"


def test_records_lie_in_the_folder_unless_another_is_named(folder: Path) -> None:
    rig = sl.read_rig(folder)
    with running(virtual):
        assert place_of_records("runs", rig) == folder / "records"
        assert place_of_records("runs", sl.read_rig(rig_file(folder))) == Path("runs")
    with running(virtual, out="elsewhere"):
        assert place_of_records("elsewhere", rig) == Path("elsewhere")
