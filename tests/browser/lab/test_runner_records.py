"""Records of runners: written for their owner alone, found latest first, alive, ended or lost by their process."""

import json
import os
from pathlib import Path
from typing import Any

import pytest
from pytest import MonkeyPatch, raises

from sonolube.browser.lab import runner_records as records
from sonolube.errors import InvalidInput


def written(parent: Path, name: str = "20260715-100000-0a0b", **files: object) -> records.RunnerRecord:
    """Record with the content of its files."""
    folder = parent / name
    folder.mkdir(parents=True)
    for file, content in ({"request": {"about": {"title": "Own"}}} | files).items():
        (folder / f"{file}.json").write_text(content if isinstance(content, str) else json.dumps(content))
    return records.read_record(parent, name)


RUNNER = {"process": 77, "started": "at noon", "port": 8765, "token": "t", "control": "c", "run_folder": "/runs/7"}


def test_a_record_has_what_its_files_say(tmp_path: Path) -> None:
    found = written(tmp_path, runner=RUNNER, end={"state": "safe"})
    assert (found.id, found.folder, found.about) == ("20260715-100000-0a0b", tmp_path / found.id, {"title": "Own"})
    assert (found.process, found.started, found.port, found.token, found.control, found.run_folder) == (
        77, "at noon", 8765, "t", "c", "/runs/7",
    )  # fmt: skip
    assert found.end == {"state": "safe"}
    assert found.link() == "http://127.0.0.1:8765/?token=t"
    assert found.link("localhost") == "http://localhost:8765/?token=t"
    assert (found.access.token, found.access.port) == ("t", 8765)


@pytest.mark.parametrize("runner", ["{", "[]", "null"])
def test_damaged_files_count_as_none_and_a_missing_request_is_refused(runner: str, tmp_path: Path) -> None:
    found = written(tmp_path, runner=runner, request={"about": [1]})
    assert (found.process, found.port, found.about, found.end) == (None, 0, {}, None)
    (found.folder / "request.json").unlink()
    with raises(InvalidInput, match=r"^the laboratory has no runner '20260715-100000-0a0b'$"):
        records.read_record(tmp_path, found.id)


@pytest.mark.parametrize(
    ("runner", "end", "now", "is_alive", "is_lost"),
    [
        (RUNNER, None, "at noon", True, False),
        (RUNNER, None, "at night", False, True),  # a later process of the same number
        (RUNNER, {"state": "safe"}, "", False, False),
        (RUNNER | {"started": ""}, None, "", False, True),
        ({}, None, "", False, False),
    ],
)
def test_a_run_is_lost_where_its_very_process_is_gone_without_an_end(
    runner: dict[str, object], end: object, now: str, is_alive: bool, is_lost: bool, tmp_path: Path,
    monkeypatch: MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr(records, "process_start", lambda process: now if process == 77 else "")
    ended: dict[str, Any] = {} if end is None else {"end": end}
    found = written(tmp_path, runner=runner, **ended)
    assert (found.is_alive, found.is_lost) == (is_alive, is_lost)


def test_an_end_that_was_written_after_the_record_was_read_is_no_loss(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(records, "process_start", lambda process: "")
    found = written(tmp_path, runner=RUNNER)
    assert found.is_lost
    (found.folder / "end.json").write_text("{}")
    assert not found.is_lost


def test_names_come_latest_first_and_of_folders_with_a_request_alone(tmp_path: Path) -> None:
    for name in ("20260101", "20260301", "20260201"):
        written(tmp_path, name)
    (tmp_path / "20260401").mkdir()
    assert records.record_names(tmp_path) == ["20260301", "20260201", "20260101"]
    assert records.record_names(tmp_path / "none") == []


def test_a_new_record_is_its_owners_alone_and_fifty_older_ones_are_kept(tmp_path: Path) -> None:
    parent = tmp_path / "lab"
    for number in range(52):
        written(parent, f"2020-{number:02d}")
    found = records.new_record(parent, {"about": {"title": "New"}, "seed": 3})
    names = records.record_names(parent)
    assert (names[0], len(names)) == (found.id, 51)
    assert names[1:] == [f"2020-{number:02d}" for number in range(51, 1, -1)]
    assert json.loads((found.folder / "request.json").read_text()) == {"about": {"title": "New"}, "seed": 3}
    assert found.about == {"title": "New"}
    if os.name == "posix":
        assert found.folder.stat().st_mode & 0o777 == 0o700
        assert (found.folder / "request.json").stat().st_mode & 0o777 == 0o600


def test_the_records_lie_below_the_state_of_the_user(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(records, "user_state_folder", lambda: tmp_path)
    assert records.laboratory_folder() == tmp_path / "lab"
