"""The process of a run, in this one: its record, how it ends, and what a signal or a fault before the run leaves."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch
from tests.browser.laboratory import RIG, SHORT

from sonolube.browser.lab import runner
from sonolube.errors import InvalidInput
from sonolube.operating_system import process_start
from sonolube.tasks.files import NamedBytes

REQUEST: dict[str, Any] = {
    "about": {"title": "Own"}, "places": {"rigs": {}, "runs": "/runs"}, "rig": RIG, "seed": 3, "anyway": True,
    "tags": ["a"], "facts": {"operator": "Ann"}, "protocol": {"name": "short", "text": SHORT},
}  # fmt: skip


class Server:
    """Stands in for the server of the stop page."""

    def __init__(self, live: Any, control: Any) -> None:
        self.port, self.token, self.control, self.calls = 8765, "t", "word", made
        made.append("made")

    def start(self) -> None:
        self.calls.append("started")

    def close(self) -> None:
        self.calls.append("closed")


made: list[str] = []


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: MonkeyPatch) -> Path:
    """Folder of a runner with its request; signals of this process stay as they are."""
    made.clear()
    monkeypatch.setattr(runner, "StopServer", Server)
    monkeypatch.setattr(runner, "end_program_at_signals", lambda: None)
    place = tmp_path / "lab" / "one"
    place.mkdir(parents=True)
    (place / "request.json").write_text(json.dumps(REQUEST))
    return place


def content(folder: Path, name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / name).read_text())
    return found


def run_as(monkeypatch: MonkeyPatch, act: Callable[..., Any]) -> list[dict[str, Any]]:
    """Let the task of a run act so, and list its arguments."""
    from sonolube.tasks.lab import protocol_run

    asked: list[dict[str, Any]] = []

    class Answer:
        def __init__(self, state: str, outcome: str, reason: str) -> None:
            self.result = SimpleNamespace(state=SimpleNamespace(value=state), outcome=outcome, reason=reason)

    def run(protocol: Any, **named: Any) -> Any:
        asked.append({"protocol": protocol, **named})
        return Answer(*act(**named))

    monkeypatch.setattr(protocol_run, "RunAnswer", Answer)
    monkeypatch.setattr(protocol_run, "run", run)
    return asked


def test_a_run_is_recorded_while_it_is_at_work_and_at_its_end(
    folder: Path, tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    def act(*, watcher: Any, **_: Any) -> tuple[str, str, str]:
        known = content(folder, "runner.json")
        assert known == {
            "process": os.getpid(), "started": process_start(os.getpid()), "port": 8765, "token": "t",
            "control": "word",
        }  # fmt: skip
        watcher.records(tmp_path / "runs" / "7")
        assert content(folder, "runner.json")["run_folder"] == str((tmp_path / "runs" / "7").resolve())
        return "safe", "completed", "all done"

    asked = run_as(monkeypatch, act)
    runner.main(folder)
    (named,) = asked
    assert named["protocol"] == NamedBytes("short.toml", SHORT.encode())
    assert (named["seed"], named["real_time"], named["anyway"], named["tag"]) == (3, True, True, ["a"])
    assert (named["fact"], named["out"]) == ({"operator": "Ann"}, "/runs")
    assert named["rig"].title.startswith("Modified pin-on-disc tribometer")
    assert named["operator"].__func__.__name__ == "ask"
    end = content(folder, "end.json")
    assert (end["state"], end["outcome"], end["reason"], end["is_ended"], end["folder"]) == (
        "safe", "completed", "all done", True, "7",
    )  # fmt: skip
    assert made == ["made", "started", "closed"]


def test_devices_of_a_map_have_no_seed_and_a_protocol_of_the_dissertation_goes_by_its_name(
    folder: Path, monkeypatch: MonkeyPatch
) -> None:
    places = {"rigs": {}, "runs": "/runs", "device_map": "map.toml"}
    protocol = {"name": "map_test", "text": ""}
    (folder / "request.json").write_text(json.dumps(REQUEST | {"places": places, "rig": None, "protocol": protocol}))
    asked = run_as(monkeypatch, lambda **_: ("safe", "completed", ""))
    runner.main(folder)
    (named,) = asked
    assert (named["protocol"], named["device_map"], named["rig"]) == ("map_test", "map.toml", None)
    assert not {"seed", "real_time"} & set(named)


@pytest.mark.parametrize(
    ("is_begun", "failure", "ended"),
    [
        (False, InvalidInput("too fast"), ("safe", "refused", "too fast")),
        (True, InvalidInput("too fast"), ("running", "failed", "too fast")),
        (
            False,
            ValueError("odd"),
            ("safe", "refused", "a fault of sonolube itself, not of your input: ValueError (odd)"),
        ),
        (
            True,
            KeyboardInterrupt(),
            ("running", "failed", "a fault of sonolube itself, not of your input: KeyboardInterrupt"),
        ),
    ],
)
def test_a_failure_before_anything_was_connected_is_a_refusal_and_later_one_a_failure(
    is_begun: bool, failure: BaseException, ended: tuple[str, str, str], folder: Path, monkeypatch: MonkeyPatch
) -> None:
    def act(*, watcher: Any, **_: Any) -> Any:
        if is_begun:
            watcher.notes("state", {"state": "running"})
        raise failure

    run_as(monkeypatch, act)
    runner.main(folder)
    end = content(folder, "end.json")
    assert (end["state"], end["outcome"]) == ended[:2]
    assert end["reason"].startswith(ended[2])
    assert made[-1] == "closed"


def test_a_signal_before_anything_was_connected_ends_the_record_and_later_leaves_it_to_the_run(folder: Path) -> None:
    live = runner._Recorded({}, SimpleNamespace(stop_reason="", is_paused=False), folder)  # type: ignore[arg-type]
    live.notes("state", {"state": "running"})
    runner._note_early_end(live, folder)
    assert not (folder / "end.json").exists()
    live.notes("state", {"state": "preparing"})
    runner._note_early_end(live, folder)
    end = content(folder, "end.json")
    assert (end["state"], end["outcome"], end["reason"]) == (
        "safe", "refused", "ended by a signal before anything was connected",
    )  # fmt: skip
