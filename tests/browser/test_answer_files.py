"""Files that pages save of an answer: those of the task, alone or in an archive that says what made them."""

import base64
import io
import zipfile
from typing import Any

import pytest
from tests.browser.test_answers import TRIBOMETER
from tests.same import same_files

import sonolube as sl
from sonolube import __version__
from sonolube.browser.answer_files import answer_files
from sonolube.browser.requests import Places
from sonolube.browser.worker import reply
from sonolube.rig import read_rig
from sonolube.tasks.answer import Answer

NOWHERE = Places(rigs={})
RIG = {"name": "tribometer", "changes": {"sliding.sliding_speed": "30 mm/s"}}
CONTROL: dict[str, Any] = {"task": "control", "arguments": {"rig": RIG, "duration": "40ms", "friction": "0.5N"}}


def by_the_task() -> Answer:
    rig = read_rig(TRIBOMETER, changes=["sliding.sliding_speed=30 mm/s"])
    return sl.control(rig, duration="40ms", friction="0.5N")


def content(file: dict[str, Any]) -> bytes:
    return base64.b64decode(file["base64"])


def plain(file: bytes) -> str:
    """Text of a table without the line that says what made it."""
    first, *lines = file.decode().splitlines(keepends=True)
    return "".join(lines if first.startswith("# ") else [first, *lines])


@pytest.mark.parametrize("ending", [".c", ".csv"])
def test_a_file_is_that_of_the_task(ending: str) -> None:
    found = answer_files(CONTROL | {"ending": ending}, NOWHERE)
    assert found["name"] == f"tribometer-control{ending}"
    same_files({ending: plain(content(found))}, {ending: by_the_task().files()[found["name"]]})


def test_the_source_in_c_names_rig_changes_and_version() -> None:
    first = content(answer_files(CONTROL | {"ending": ".c"}, NOWHERE)).decode().partition("\n")[0]
    assert read_rig(TRIBOMETER).title in first
    assert "sliding.sliding_speed=30 mm/s" in first
    assert f"sonolube {__version__}" in first


def test_the_archive_has_every_file_and_says_what_made_it() -> None:
    found = answer_files(CONTROL, NOWHERE)
    archive = zipfile.ZipFile(io.BytesIO(content(found)))
    assert found["name"] == "tribometer-control.zip"
    assert set(archive.namelist()) == {"about.txt", *by_the_task().files()}
    about = archive.read("about.txt").decode()
    for text in (f"sonolube {__version__}", "changed: sliding.sliding_speed=30 mm/s", "--duration 40ms"):
        assert text in about
    again = answer_files(CONTROL, NOWHERE)
    same_files({again["name"]: content(again)}, {found["name"]: content(found)})


def test_the_archive_of_a_plan_has_its_protocols_and_names_the_seed() -> None:
    arguments = {"rig": {"name": "tribometer"}, "points": 2, "seed": 3}
    archive = zipfile.ZipFile(io.BytesIO(content(answer_files({"task": "plan", "arguments": arguments}, NOWHERE))))
    protocols = [name for name in archive.namelist() if name.endswith(".toml")]
    assert len(protocols) == len(plain(archive.read("tribometer-plan-runs.csv")).splitlines()) - 1
    assert "--seed 3" in archive.read("about.txt").decode()


@pytest.mark.parametrize(
    ("payload", "text"),
    [
        (CONTROL | {"ending": ".exe"}, "control has no file of the ending '.exe'; it has tribometer-control.nc"),
        ({"task": "materials", "arguments": {}}, "materials has no files to take away"),
        ({"task": "lab run", "arguments": {}}, "unknown task 'lab run'"),
        ({"task": "control", "arguments": {"rig": RIG, "rate": "0 Hz"}}, "rate 0 Hz and duration"),
    ],
)
def test_what_has_no_such_file_is_refused(payload: dict[str, Any], text: str) -> None:
    status, body = reply("files", payload, NOWHERE)
    assert status == 422
    assert text in body.decode()
