"""Routes of page Lab without processes: state, hold, start, stop and recovery by hand-made records of runners."""

import asyncio
import json
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import pytest
from pytest import MonkeyPatch
from starlette.applications import Starlette
from tests.browser.asgi import Client
from tests.names import names_of

from sonolube.browser.lab import routes
from sonolube.browser.lab.routes import Laboratory
from sonolube.browser.lab.runner_client import NoAnswer
from sonolube.browser.lab.runner_records import SAFETY, RunnerRecord
from sonolube.browser.messages import refused
from sonolube.browser.requests import Places
from sonolube.browser.uploads import Uploads
from sonolube.browser.worker import Pool
from sonolube.errors import InvalidInput, SonolubeError

HOLDER, OTHER = "tab-of-the-operator", "tab-of-a-watcher"


class FakePool:
    """Pool that answers what a test has put there, and lists what it was asked."""

    def __init__(self) -> None:
        self.replies: dict[str, tuple[int, dict[str, Any]]] = {"lab_devices": (200, {"devices": {"kind": "virtual"}})}
        self.asked: list[tuple[str, Any]] = []

    async def answer(self, kind: str, payload: Any, places: Places) -> tuple[int, dict[str, Any]]:
        self.asked.append((kind, payload))
        status, found = self.replies[kind]
        return status, dict(found)

    async def ask(self, kind: str, payload: Any, places: Places, *, is_gone: Any) -> tuple[int, bytes]:
        status, found = await self.answer(kind, payload, places)
        return status, json.dumps(found).encode()


class Bench:
    """Laboratory with its client, pool, folder, living processes, and what runs were asked."""

    def __init__(self, folder: Path, monkeypatch: MonkeyPatch) -> None:
        self.folder, self.pool, self.uploads = folder / "lab", FakePool(), Uploads()
        self.alive: set[int] = set()
        self.asked: list[tuple[str, str, Any]] = []
        self.reply: dict[str, Any] | Exception = {"state": "running", "is_ended": False}
        places = Places(rigs={}, uploads="up", runs=str(folder / "runs"))
        self.laboratory = Laboratory(
            pool=cast(Pool, self.pool), uploads=self.uploads, places=places, folder=self.folder
        )
        application = Starlette(routes=self.laboratory.routes(), exception_handlers={SonolubeError: refused})
        self.client = Client(application)
        self.folder.mkdir()
        monkeypatch.setattr(
            "sonolube.browser.lab.runner_records.process_start", lambda process: "noon" if process in self.alive else ""
        )
        monkeypatch.setattr(routes, "asked", self.ask)

    async def ask(self, record: RunnerRecord, method: str, path: str, content: Any = None, **_: Any) -> dict[str, Any]:
        self.asked.append((method, path, content))
        if isinstance(self.reply, Exception):
            raise self.reply
        return dict(self.reply)

    def record(self, name: str, process: int | None, *, end: Any = None, is_alive: bool = True) -> None:
        """Write a record of a run."""
        place = self.folder / name
        place.mkdir()
        (place / "request.json").write_text(json.dumps({"about": {"title": f"Run {name}"}}))
        if process is not None:
            known = {"process": process, "started": "noon", "port": 8765, "token": "t", "run_folder": f"/runs/{name}"}
            (place / "runner.json").write_text(json.dumps(known))
            if is_alive:
                self.alive.add(process)
        if end is not None:
            (place / "end.json").write_text(json.dumps(end))

    def state(self, holder: str = "") -> dict[str, Any]:
        answer = self.client.get("/api/lab", params={"holder": holder})
        assert answer.status_code == 200, answer.text
        found: dict[str, Any] = answer.json()
        return found

    def post(self, path: str, **content: Any) -> tuple[int, dict[str, Any]]:
        answer = self.client.post(f"/api/lab/{path}", content)
        return answer.status_code, answer.json()


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: MonkeyPatch) -> Iterator[Bench]:
    found = Bench(tmp_path, monkeypatch)
    yield found
    found.uploads.end()


def test_an_empty_laboratory_has_its_devices_read_once_and_nobody_at_work(bench: Bench) -> None:
    assert bench.state() == {
        "devices": {"kind": "virtual"}, "runs_folder": "runs", "holder": {"is_me": False, "is_free": True},
        "safety": SAFETY, "run": None, "lost": None,
    }  # fmt: skip
    bench.state()
    assert bench.pool.asked == [("lab_devices", {})]
    assert not bench.laboratory.is_at_work()
    assert bench.laboratory.end() == ""
    assert bench.post("stop") == (
        422,
        {"text": "no run is at work", "faults": [{"key": "", "text": "no run is at work"}]},
    )


def test_devices_that_cannot_be_read_are_a_refusal_that_is_tried_again(bench: Bench) -> None:
    bench.pool.replies["lab_devices"] = (422, {"text": "no map"})
    for _ in range(2):
        assert bench.client.get("/api/lab").json()["text"] == "no map"
    assert len(bench.pool.asked) == 2


def test_the_run_at_work_is_shown_before_later_ones_that_ended_and_its_process_is_asked(bench: Bench) -> None:
    bench.record("1", 11)
    bench.record("2", 12, end={"state": "safe", "is_ended": True}, is_alive=False)
    bench.record("3", None)  # which has not listened yet
    run = bench.state()["run"]
    assert (run["id"], run["process"], run["state"]) == ("1", 11, "running")
    assert run["stop_link"] == "http://localhost:8765/?token=t"
    assert bench.asked == [("GET", "/status", None)]
    assert bench.laboratory.is_at_work()
    assert bench.laboratory.end() == "http://127.0.0.1:8765/?token=t"
    bench.reply = {"state": "safe", "is_ended": True}
    assert bench.state()["run"]["stop_link"] == ""


def test_a_run_whose_process_does_not_answer_is_shown_as_it_was_seen_last(bench: Bench) -> None:
    bench.record("1", 11)
    bench.reply = NoAnswer("silent")
    silent = bench.state()["run"]
    assert (silent["state"], silent["title"], silent["prompt"]) == ("preparing", "Run 1", None)
    assert silent["reason"] == "its process, 11, does not answer; stop it here, or by its own page"
    assert silent["stop_link"] == "http://127.0.0.1:8765/?token=t"
    bench.reply = {"state": "paused", "time": 3.0, "reason": "by hand"}
    bench.state()
    bench.reply = NoAnswer("silent")
    again = bench.state()["run"]
    assert (again["state"], again["time"]) == ("paused", 3.0)
    assert "does not answer" in again["reason"]


def test_the_latest_run_is_shown_after_its_end_and_a_lost_one_is_told(bench: Bench) -> None:
    bench.record("1", 11, is_alive=False)
    bench.record("2", 12, end={"state": "safe", "outcome": "completed"}, is_alive=False)
    found = bench.state()
    assert (found["run"]["id"], found["run"]["outcome"], found["run"]["stop_link"]) == ("2", "completed", "")
    assert found["lost"]["id"] == "1"
    assert "The program of the run 'Run 1' was killed" in found["lost"]["text"]
    assert bench.asked == []
    (bench.folder / "2" / "request.json").unlink()
    lost = bench.state()["run"]
    assert (lost["id"], lost["state"], lost["is_lost"], lost["folder"]) == ("1", "lost", True, "1")


def test_runs_that_have_ended_are_read_once(bench: Bench, monkeypatch: MonkeyPatch) -> None:
    bench.record("1", 11, end={"state": "safe"}, is_alive=False)
    bench.record("2", 12)
    read: list[str] = []
    original = names_of(routes).read_record

    def reading(folder: Path, name: str) -> RunnerRecord:
        read.append(name)
        found: RunnerRecord = original(folder, name)
        return found

    monkeypatch.setattr(routes, "read_record", reading)
    assert [each.id for each in bench.laboratory._records()] == ["2", "1"]
    assert [each.id for each in bench.laboratory._records()] == ["2", "1"]
    assert read == ["2", "1", "2"]


def test_the_hold_is_taken_and_released_by_one_tab(bench: Bench) -> None:
    assert bench.post("hold", holder=HOLDER)[1]["holder"] == {"is_me": True, "is_free": False}
    assert "another tab has" in bench.post("hold", holder=OTHER)[1]["text"]
    assert bench.state(OTHER)["holder"] == {"is_me": False, "is_free": False}
    bench.post("release", holder=OTHER)
    assert bench.state(HOLDER)["holder"]["is_me"]
    assert bench.post("release", holder=HOLDER)[1]["holder"] == {"is_me": False, "is_free": True}
    assert "8 to 64 letters" in bench.post("hold", holder=3)[1]["text"]


def test_steering_needs_the_hold_and_reaches_the_process_of_the_run(bench: Bench) -> None:
    bench.record("1", 11)
    assert "watches only" in bench.post("pause", holder=HOLDER)[1]["text"]
    bench.post("hold", holder=HOLDER)
    bench.asked.clear()
    assert bench.post("pause", holder=HOLDER)[0] == 200
    bench.post("confirm", holder=HOLDER, number=2, is_done=True, more=1)
    assert [each for each in bench.asked if each[0] == "POST"] == [
        ("POST", "/pause", {"number": None, "is_done": None}), ("POST", "/confirm", {"number": 2, "is_done": True}),
    ]  # fmt: skip


def test_a_stop_that_is_not_answered_is_a_signal(bench: Bench, monkeypatch: MonkeyPatch) -> None:
    killed: list[tuple[int, int]] = []
    monkeypatch.setattr(names_of(routes).os, "kill", lambda process, number: killed.append((process, number)))
    monkeypatch.setattr(routes, "ON_WINDOWS", False)
    bench.record("1", 11)
    assert bench.post("stop")[0] == 200
    assert killed == []
    bench.reply = NoAnswer("silent")
    assert bench.post("stop")[0] == 200
    assert killed == [(11, signal.SIGTERM)]
    monkeypatch.setattr(routes, "ON_WINDOWS", True)
    assert bench.post("stop") == (422, {"text": "silent", "faults": [{"key": "", "text": "silent"}]})
    assert len(killed) == 1


def test_a_start_needs_the_hold_an_idle_laboratory_and_a_plan(bench: Bench, monkeypatch: MonkeyPatch) -> None:
    assert "watches only" in bench.post("start", holder=HOLDER)[1]["text"]
    bench.post("hold", holder=HOLDER)
    bench.pool.replies["lab_plan"] = (422, {"text": "too fast"})
    assert bench.post("start", holder=HOLDER, rig=1) == (422, {"text": "too fast"})
    assert bench.pool.asked[-1] == ("lab_plan", {"rig": 1})
    bench.pool.replies["lab_plan"] = (200, {"about": {"title": "New"}, "seed": 3})
    started: list[Any] = []

    async def spawned(plan: Any) -> RunnerRecord:
        started.append(plan)
        bench.record("9", 19)
        found: RunnerRecord = names_of(routes).read_record(bench.folder, "9")
        return found

    monkeypatch.setattr(bench.laboratory, "_spawned", spawned)
    status, run = bench.post("start", holder=HOLDER)
    assert (status, run["id"], started[0]["seed"]) == (200, "9", 3)
    assert bench.post("start", holder=HOLDER)[1]["text"] == "a run is at work; wait for its end, or stop it"
    bench.alive.clear()
    refusal = bench.post("start", holder=HOLDER)[1]["faults"][0]
    assert (refusal["key"], "Cut the power" in refusal["text"]) == ("lost", True)


def test_a_process_that_ends_before_it_listens_is_refused_with_its_log(bench: Bench, monkeypatch: MonkeyPatch) -> None:
    class Ended:
        def __init__(self, command: list[str], **_: Any) -> None:
            self.command = command

        def poll(self) -> int:
            return 1

        def wait(self) -> int:
            return 1

    monkeypatch.setattr(names_of(routes).subprocess, "Popen", Ended)
    with pytest.raises(InvalidInput, match=r"the process of the run did not start; .*log\.txt says why"):
        asyncio.run(bench.laboratory._spawned({"about": {"title": "New"}}))
    (place,) = bench.folder.iterdir()
    end = json.loads((place / "end.json").read_text())
    assert (end["state"], end["outcome"], end["reason"], end["is_ended"], end["title"]) == (
        "safe", "refused", "its process did not start", True, "New",
    )  # fmt: skip
    request = json.loads((place / "request.json").read_text())
    assert request["places"]["uploads"] == "up"


def test_a_lost_run_is_recovered_once_its_outputs_were_seen_off(bench: Bench) -> None:
    bench.post("hold", holder=HOLDER)
    assert bench.post("recover", holder=HOLDER)[1]["text"] == "no run was killed; there is nothing to recover"
    bench.record("1", 11, is_alive=False)
    for is_off in (None, False, 1, "true"):
        assert bench.post("recover", holder=HOLDER, is_off=is_off)[1]["faults"][0]["key"] == "is_off"
    bench.pool.replies["lab_recover"] = (422, {"text": "cannot"})
    assert bench.post("recover", holder=HOLDER, is_off=True) == (422, {"text": "cannot"})
    assert bench.state()["lost"] is not None
    bench.pool.replies["lab_recover"] = (200, {"text": "recovered"})
    assert bench.post("recover", holder=HOLDER, is_off=True) == (200, {"text": "recovered"})
    assert bench.pool.asked[-1] == ("lab_recover", {"folder": "/runs/1"})
    found = bench.state()
    assert found["lost"] is None
    assert {name: found["run"][name] for name in ("state", "outcome", "reason", "is_lost", "is_ended")} == {
        "state": "safe", "outcome": "failed", "reason": "its program was killed", "is_lost": False, "is_ended": True,
    }  # fmt: skip
    assert found["run"]["outputs"] == "the operator has cut the power and seen that motor and drive are off"


def test_recordings_and_tables_become_uploads(bench: Bench, tmp_path: Path) -> None:
    (tmp_path / "a.nc").write_bytes(b"x" * (2**20 + 5))
    bench.pool.replies["lab_recording"] = (200, {"path": str(tmp_path / "a.nc"), "name": "7.nc", "part": 2})
    status, found = bench.post("runs/7/upload", part=2)
    assert (status, found["name"], "path" in found) == (200, "7.nc", False)
    assert bench.pool.asked[-1] == ("lab_recording", {"id": "7", "part": 2})
    assert (bench.uploads.folder / found["upload"]).stat().st_size == 2**20 + 5
    bench.post("runs/7/upload")
    assert bench.pool.asked[-1] == ("lab_recording", {"id": "7", "part": 1})
    bench.pool.replies["lab_compare"] = (200, {"table": "a,b\n", "name": "t.csv"})
    status, found = bench.post("compare", runs=["7"])
    assert (bench.uploads.folder / found["upload"]).read_bytes() == b"a,b\n"
    assert "table" not in found
    for kind, path in (("lab_recording", "runs/7/upload"), ("lab_compare", "compare")):
        bench.pool.replies[kind] = (422, {"text": "no"})
        assert bench.post(path) == (422, {"text": "no"})


def test_runs_on_disk_are_answers_of_a_worker(bench: Bench) -> None:
    bench.pool.replies |= {"lab_runs": (200, {"runs": []}), "lab_show": (422, {"text": "none"})}
    answer = bench.client.get("/api/lab/runs")
    assert (answer.json(), answer.headers["cache-control"]) == ({"runs": []}, "no-store")
    assert bench.client.get("/api/lab/runs/7").status_code == 422
    assert bench.pool.asked[-1] == ("lab_show", {"id": "7"})


def test_a_verdict_between_two_settings_ends_no_run_that_is_at_work(bench: Bench, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr("sonolube.laboratory.records.last_verdict", lambda folder: "confirmed off, drive and motor")
    bench.record("1", 11)
    assert (bench.state()["run"]["state"], bench.laboratory.is_at_work()) == ("running", True)
    assert not (bench.folder / "1" / "end.json").exists()
    bench.record("2", 12, is_alive=False)
    bench.state()
    assert json.loads((bench.folder / "2" / "end.json").read_text())["state"] == "safe"
