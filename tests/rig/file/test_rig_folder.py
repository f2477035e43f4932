"""Folder of a rig: read in place of its file, with names by the folder, and refused without its file."""

from pathlib import Path
from shutil import copy

import pytest
from pytest import raises
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.rig import read_rig
from sonolube.rig.file.rig_folder import folder_of

RIGS = Path(__file__).parents[3] / "examples" / "rigs"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (place := tmp_path / "pin.v2").mkdir()
    copy(RIGS / "tribometer.toml", place / "rig.toml")
    return place


def test_a_folder_is_read_as_its_rig_file_and_named_by_itself(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rig = read_rig(folder, changes=("contact.normal_load=5N",))
    same(rig.content(), read_rig(folder / "rig.toml", changes=("contact.normal_load=5N",)).content())
    assert (rig.file, rig.name, folder_of(rig)) == (folder, "pin.v2", folder)
    assert folder_of(rig.replace("contact.normal_load", "4 N")) == folder
    monkeypatch.chdir(folder)
    assert read_rig(".").name == "pin.v2"


def test_the_file_alone_has_no_folder(folder: Path) -> None:
    assert folder_of(read_rig(folder / "rig.toml")) is None


def test_modes_beside_the_file_are_those_of_the_folder(folder: Path) -> None:
    text = (folder / "rig.toml").read_text()
    (folder / "rig.toml").write_text(
        text.partition("[structure")[0] + '[structure]\nkind = "modes"\nfile = "own.toml"\n'
    )
    with raises(InvalidInput, match=r"pin\.v2[/\\]own\.toml"):
        read_rig(folder)


def test_a_folder_without_a_rig_file_is_refused(tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"is a folder, not a file, and without rig\.toml"):
        read_rig(tmp_path)
