"""Records of runs from Python: listed, shown, recovered and exported as on a terminal; and devices checked."""

import json
from pathlib import Path

from pytest import approx, raises
from tests.cli.conftest import Program
from tests.laboratory.catalogue.test_catalogue import run_of
from tests.laboratory.records.recorded import begun, recorded
from tests.laboratory.records.test_recovery import unfinished
from tests.laboratory.rig_stand_ins import EXAMPLE, analogue_rig
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.tasks import lab


def test_runs_are_found_by_the_same_texts_and_are_a_dataset(tmp_path: Path, sonolube: Program) -> None:
    run_of(tmp_path)
    run_of(tmp_path, normal_load=9.0, tags="map")
    found = lab.runs(tmp_path, material=["brass"])
    same(
        json.loads(found.to_json()), _without_files(sonolube("lab", "runs", tmp_path, "--material", "brass", "--json"))
    )
    assert found["normal_load"].to_numpy() == approx([5.0, 9.0])
    assert found["normal_load"].attrs["units"] == "N"
    assert lab.runs(tmp_path, tag=["map"]).object()["of"] == 2


def test_facts_of_recordings_that_are_taken_in_are_a_mapping(tmp_path: Path) -> None:
    (tmp_path / "old.csv").write_text("time (s),friction_force (N)\n0,1\n1,1\n2,1\n")
    found = lab.runs(tmp_path / "runs", add=[tmp_path / "old.csv"], fact={"normal_load": 4, "pin_material": "brass"})
    assert [(entry.normal_load, entry.pin_material) for entry in found.found.entries] == [(4.0, "brass")]
    with raises(InvalidInput, match="fact has no meaning without add, whose recordings it describes"):
        lab.runs(tmp_path / "runs", fact={"normal_load": 4})


def test_a_run_is_shown_with_its_figure_and_its_recording(tmp_path: Path, sonolube: Program) -> None:
    folder = recorded(tmp_path)
    shown = lab.show(folder)
    same(shown.json_object(), _without_files(sonolube("lab", "show", folder, "--json")))
    assert len(shown.plot().axes) == len(shown.run.summary.channels)
    assert shown.dataset().sizes["time"] == shown.run.summary.samples


def test_a_run_without_a_folder_for_its_figure_leaves_no_file(tmp_path: Path, sonolube: Program) -> None:
    folder = recorded(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    assert sonolube("lab", "show", folder, "--json").answer["files"] == []
    assert sorted(tmp_path.rglob("*")) == before


def test_runs_at_work_are_refusals_beside_those_recovered(tmp_path: Path) -> None:
    killed, recorder = unfinished(tmp_path), begun(tmp_path)
    answer = lab.recover(tmp_path)
    assert list(answer.recovered) == [killed]
    assert list(answer.refusals()) == [str(recorder.folder)]
    recorder.finish("completed")
    with raises(InvalidInput, match="holds no run"):
        lab.recover(killed / "raw")


def test_an_export_is_its_files_and_their_dataset(tmp_path: Path) -> None:
    folder = run_of(tmp_path)
    answer = lab.export(folder, out=tmp_path / "out")
    assert list(answer.files()) == [f"{folder.name}.nc"]
    assert answer["friction_force"].sizes["time"] > 0
    assert list(lab.export(folder, file_format="csv", out=tmp_path / "out").files()) == [f"{folder.name}.csv"]


def test_devices_are_checked_and_read_with_everything_off(tmp_path: Path, sonolube: Program) -> None:
    checked = lab.check(EXAMPLE, protocol="map_test")
    assert checked.is_failure  # no driver is installed here
    same(checked.json_object(), _without_files(sonolube("lab", "check", EXAMPLE, "--protocol", "map_test", "--json")))
    with analogue_rig(tmp_path) as rig:
        rig.was_on()
        read = lab.check(tmp_path / "devices.toml", connect=True)
        assert (rig.voltage(), rig.rotation_speed()) == (0.0, 0.0)
    assert read["friction_force"].attrs["units"] == "N"


def _without_files(run: object) -> dict[str, object]:
    """Answer of the terminal but for the names of its files."""
    content: dict[str, object] = run.answer  # type: ignore[attr-defined]
    content.pop("files")
    return content
