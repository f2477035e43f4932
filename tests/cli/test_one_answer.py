"""One answer on every way in: what a command answered is what its task answers in Python with the same arguments."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from pytest import CaptureFixture, MonkeyPatch
from tests.cli.option_uses import MODES, write_inputs
from tests.same import same

import sonolube as sl
from sonolube.cli import generated, main
from sonolube.cli.console import delivery
from sonolube.execution.compilation import few_points
from sonolube.tasks.answer import Answer
from sonolube.tasks.table import TASKS

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("compiled_kernels")]

LONG = ("identify rig", "reproduce")  # which take twenty seconds and more; their functions have tests of their own
RUNNING = (
    "lab run",
    "lab virtual",
    "lab hold",
    "lab check",
    "lab try-driver",
    "new",
    "example",
    "runs",
)  # which have the time of day, or write
USES = {mode.command: mode for mode in reversed(MODES.values())}
NAMES = [task.name for task in TASKS if task.name in USES and task.name not in (*LONG, *RUNNING)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the files that commands read and write here."""
    place = tmp_path_factory.mktemp("inputs")
    write_inputs(place)
    return place


def function(name: str) -> Any:
    """Function of a task as `import sonolube as sl` offers it."""
    found: Any = sl
    for word in name.replace("-", "_").split():
        found = getattr(found, word)
    return found


def without_files(answer: Mapping[str, Any]) -> dict[str, Any]:
    """Answer without the files that a terminal lists."""
    return {key: value for key, value in answer.items() if key != "files"}


@pytest.mark.parametrize("name", NAMES)
def test_python_gives_the_numbers_and_lines_of_the_terminal(
    name: str, folder: Path, monkeypatch: MonkeyPatch, capsys: CaptureFixture[str], tmp_path: Path
) -> None:
    delivered: list[Answer] = []
    deliver = delivery.deliver

    def kept(answer: Answer, **options: Any) -> None:
        delivered.append(answer)
        deliver(answer, **options)

    monkeypatch.setattr(generated, "deliver", kept)
    monkeypatch.setattr("sonolube.report.page.drawn", lambda drawing, *, forms: dict.fromkeys(forms, b""))
    words = [word.replace("FOLDER", str(folder)) for word in USES[name].base]
    task = next(each for each in TASKS if each.name == name)
    out = ("--out", str(tmp_path)) if task.writes else ()
    with pytest.raises(SystemExit):
        main([*name.split(), *words, *out, "--json"])
    printed = json.loads(capsys.readouterr().out)
    (answer,) = delivered
    assert answer.call is not None
    with few_points():  # as on a terminal; the other way agrees to 1e-9
        again = function(name)(**{each: answer.call.arguments[each] for each in answer.call.given})
    same(without_files(json.loads(again.to_json())), without_files(printed))
    assert again.text(line_length=None) == answer.text(line_length=None)


@pytest.mark.parametrize("name", NAMES)
def test_no_line_on_a_terminal_is_wider_than_eighty_columns(
    name: str, folder: Path, monkeypatch: MonkeyPatch, capsys: CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setenv("COLUMNS", "")
    monkeypatch.setattr("sonolube.report.page.drawn", lambda drawing, *, forms: dict.fromkeys(forms, b""))
    words = [word.replace("FOLDER", str(folder)) for word in USES[name].base]
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit):
        main([*name.split(), *words])
    lines = capsys.readouterr().out.splitlines()
    assert lines
    long_words = str(folder), str(tmp_path), "examples"  # paths, which are not broken
    assert [line for line in lines if len(line) > 80 and not any(word in line for word in long_words)] == []
