"""Example files: those that help texts name are there, are written as they are, and never replace a changed one."""

import json
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest import raises
from tests.same import same

from sonolube.cli.app import COMMANDS
from sonolube.errors import UnknownName
from sonolube.example_files import example_file, example_files
from sonolube.facts.protocol import protocol_names, read_protocol
from sonolube.rig import read_rig
from sonolube.tasks.lookup.example import example

ROOT = Path(__file__).parents[3]
Program = Callable[..., Any]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def named_files() -> set[str]:
    """Example files that help texts name."""
    words = (word for command in COMMANDS for word in shlex.split(command.help.partition("Example: ")[2]))
    return {word for word in words if word.startswith("examples/")}


def test_every_file_that_a_help_text_names_is_an_example() -> None:
    named = named_files()
    assert {"examples/rigs/tribometer.toml", "examples/efficiency-runs.csv", "examples/lab/devices.toml"} <= named
    assert named <= {each.path for each in example_files().values()}


def test_the_list_has_every_rig_and_protocol_with_its_title() -> None:
    listed = example_files()
    rigs = sorted((ROOT / "examples" / "rigs").glob("*.toml"))
    assert [each.name for each in listed.values() if each.is_rig] == [path.stem for path in rigs]
    assert {f"protocols/{name}" for name in protocol_names()} <= set(listed)
    assert listed["power_map"].title == read_rig(ROOT / "examples" / "rigs" / "power_map.toml").title
    assert all(each.title.strip() for each in listed.values())
    assert not any("modes" in name or "normal_load" in name or "notebooks" in name for name in listed)


def test_all_examples_are_written_with_what_belongs_to_them_and_can_be_read(folder: Path, sonolube: Program) -> None:
    run = sonolube("example", "all", "--json")
    assert set(run.answer["files"]) >= named_files() | {"examples/lab/normal_load.csv"}
    for path in sorted((ROOT / "examples" / "rigs").glob("*.toml")):
        written = read_rig(folder / "examples" / "rigs" / path.name)
        assert (written.title, written.normal_load) == (read_rig(path).title, read_rig(path).normal_load)
    assert read_protocol(folder / "examples" / "protocols" / "map_test.toml").title


def test_a_rig_is_written_where_help_texts_look_for_it(folder: Path, sonolube: Program) -> None:
    refused = sonolube("contact", "examples/rigs/tribometer.toml").refusal
    assert refused.endswith("examples/rigs/tribometer.toml: no such file; to get it: sonolube example tribometer\n")
    written = sonolube("example", "tribometer").out.splitlines()
    assert written[0].startswith("tribometer: Modified pin-on-disc tribometer")
    assert "  try: sonolube wear examples/rigs/tribometer.toml" in written
    assert Path(written[-1].strip()) == Path("examples/rigs/tribometer.toml")
    assert sonolube("contact", "examples/rigs/tribometer.toml").code == 0
    (path,) = folder.rglob("*.*")
    assert path.name == "tribometer.toml"
    path.write_text("#:schema rig.schema.json\n" + path.read_text(encoding="utf-8"), encoding="utf-8")
    assert sonolube("example", "tribometer").code == 0  # the line of an editor is no change
    path.write_text("# mine\n" + path.read_text(encoding="utf-8"), encoding="utf-8")
    assert "tribometer.toml: has other content" in sonolube("example", "tribometer").refusal


def test_the_schema_of_editors_is_not_looked_for_where_it_is_not() -> None:
    assert "#:schema" in example_file("tribometer").source.read_text(encoding="utf-8")
    assert "#:schema" not in example_file("tribometer").text


def test_a_changed_file_is_kept_and_an_unchanged_one_written_again(folder: Path, sonolube: Program) -> None:
    assert sonolube("example", "collar").code == sonolube("example", "collar").code == 0
    rig = folder / "examples" / "rigs" / "collar.toml"
    changed = rig.read_text(encoding="utf-8") + "# mine\n"
    rig.write_text(changed, encoding="utf-8")
    assert "has other content, which would be lost" in sonolube("example", "collar").refusal
    assert rig.read_text(encoding="utf-8") == changed
    assert sonolube("example", "collar", "--out", "new").code == 0
    assert (folder / "new" / "examples" / "rigs" / "modes" / "collar-modes.toml").is_file()


def test_a_script_is_written_with_the_rigs_that_it_reads_and_the_command_that_runs_it(
    folder: Path, sonolube: Program
) -> None:
    written = sonolube("example", "collar_on_command").out.splitlines()
    assert "  try: python examples/collar_on_command.py" in written
    names = {path.relative_to(folder / "examples").as_posix() for path in folder.rglob("*.*")}
    assert names == {"collar_on_command.py", "rigs/collar.toml", "rigs/modes/collar-modes.toml"}
    assert "collar" in example_files()
    assert not any("gallery" in each.path or "notebooks" in each.path for each in example_files().values())


@pytest.mark.parametrize(
    "name",
    [
        *("wire_drawing", "vibrated_turning", "vibrated_drilling"),
        *("bronze_bush", "pom_on_steel", "webbing_on_ring", "finger_on_glass"),
    ],
)
def test_the_worked_cases_of_the_page_are_examples(name: str) -> None:
    assert f"`{name}`" in (ROOT / "docs" / "applications.md").read_text(encoding="utf-8")
    assert [Path(path).stem for path in example(name).files()] == [name]


def test_the_list_writes_nothing(folder: Path, sonolube: Program) -> None:
    assert "tribometer_uncertain" in sonolube("example").out
    assert list(folder.iterdir()) == []


def test_the_answer_in_python_is_that_of_the_terminal(folder: Path, sonolube: Program) -> None:
    answer = example("facts/tribometer")
    typed = sonolube("example", "facts/tribometer", "--json").answer
    assert typed.pop("files") == list(answer.files()) == ["examples/facts/tribometer.toml"]
    assert json.loads(answer.to_json()) == typed
    same(example("examples/facts/tribometer.toml").object(), answer.object())
    assert str(example().dataset()["path"].sel(example="tribometer").values) == "examples/rigs/tribometer.toml"


def test_an_unknown_example_is_answered_with_the_closest() -> None:
    with raises(UnknownName, match=r"unknown example 'tribometr'; did you mean tribometer\?"):
        example("tribometr")


@pytest.mark.parametrize("word", ["help", "demo", "examples"])
def test_words_that_are_no_command_lead_to_the_right_one(word: str, sonolube: Program) -> None:
    assert "sonolube --help" in sonolube(word).refusal or "sonolube example" in sonolube(word).refusal
