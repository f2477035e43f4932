"""Workers: a fault of the program is one line, after which the same process answers; a killed one has its own."""

import asyncio
import json
import os
import re
import signal
from collections.abc import Iterator, Mapping
from pathlib import Path
from threading import Event, Thread
from typing import Any

import pytest
from pytest import MonkeyPatch

from sonolube.browser import worker
from sonolube.browser.requests import KINDS, Places
from sonolube.browser.worker import Pool, reply

NOWHERE = Places(rigs={})
UNFORESEEN = {
    "IndexError": IndexError("list index out of range"),
    "ZeroDivisionError": ZeroDivisionError("float division by zero"),
    "RuntimeError": RuntimeError("generator raised StopIteration\nin a loop"),
    "RecursionError": RecursionError("maximum recursion depth exceeded"),
    "AssertionError": AssertionError(),
    "KeyError": KeyError("normal_load"),
    "SystemExit": SystemExit(3),
}


def stand_in(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Process that answers; or raises, or ends as a request says."""
    del places
    if payload.get("signal"):
        os.kill(os.getpid(), signal.Signals[payload["signal"]])
    if "code" in payload:
        os._exit(payload["code"])
    if payload.get("raises") == "OSError":
        raise OSError(28, "No space left on device")
    if "raises" in payload:
        raise UNFORESEEN[payload["raises"]]
    return {"process": os.getpid()}


def serve_stand_in(*arguments: Any) -> None:
    """A worker, in whose process a stand-in takes the place of the tasks."""
    KINDS._loaded["task"] = stand_in
    worker.serve(*arguments)


class StandIns:
    """A pool of one worker whose tasks are the stand-in."""

    def __init__(self) -> None:
        self._runner = asyncio.Runner()
        self._pool: Pool | None = None

    def ask(self, **payload: Any) -> tuple[int, dict[str, Any]]:
        return self._runner.run(self._ask(payload))

    async def _ask(self, payload: Mapping[str, Any]) -> tuple[int, dict[str, Any]]:
        self._pool = self._pool or Pool(1)
        return await self._pool.answer("task", payload, NOWHERE)

    def end(self) -> None:
        if self._pool is not None:
            self._pool.end()
        self._runner.close()


@pytest.fixture(scope="module")
def pool() -> Iterator[StandIns]:
    with MonkeyPatch.context() as patch:
        patch.setattr(worker, "serve", serve_stand_in)
        found = StandIns()
        yield found
        found.end()


@pytest.mark.parametrize("kind", UNFORESEEN)
def test_an_unforeseen_exception_is_one_line_and_the_same_process_answers_the_next_request(
    pool: StandIns, kind: str
) -> None:
    _, before = pool.ask()
    status, answer = pool.ask(raises=kind)
    assert status == 500
    assert answer["text"].startswith("a fault of sonolube itself, not of your input: ")
    assert kind in answer["text"]
    assert " in sonolube/browser/worker.py, line " in answer["text"]
    assert "please report it" in answer["text"]
    assert "memory" not in answer["text"]
    assert "\n" not in answer["text"]
    assert answer["faults"] == [{"key": "", "text": answer["text"]}]
    assert pool.ask() == (200, before)


def test_a_full_disk_is_a_refusal_and_the_same_process_answers_the_next_request(pool: StandIns) -> None:
    _, before = pool.ask()
    status, answer = pool.ask(raises="OSError")
    assert (status, answer["text"]) == (422, "[Errno 28] No space left on device")
    assert pool.ask() == (200, before)


@pytest.mark.parametrize("name", ["SIGKILL", "SIGSEGV"])
def test_a_process_that_was_killed_has_the_line_about_memory_and_another_answers(pool: StandIns, name: str) -> None:
    _, before = pool.ask()
    status, answer = pool.ask(signal=name)
    assert status == 503
    assert "the process that computed this has ended; ask again, with fewer points" in answer["text"]
    assert "memory" in answer["text"]
    status, after = pool.ask()
    assert status == 200
    assert after["process"] != before["process"]


def test_a_process_that_ends_itself_is_a_fault_of_sonolube(pool: StandIns) -> None:
    status, answer = pool.ask(code=7)
    assert status == 503
    assert re.search(r"has ended itself \(code 7\), a fault of sonolube; please report it", answer["text"])
    assert "memory" not in answer["text"]
    assert pool.ask()[0] == 200


def test_memory_that_runs_out_is_told_as_such(monkeypatch: MonkeyPatch) -> None:
    def too_large(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
        raise MemoryError

    monkeypatch.setitem(KINDS._loaded, "task", too_large)
    status, body = reply("task", {}, NOWHERE)
    assert status == 422
    assert "does not fit into the memory of a worker; ask for fewer points" in json.loads(body)["text"]


def test_the_line_of_a_fault_names_the_file_with_its_request_and_traceback(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setitem(KINDS._loaded, "task", stand_in)
    line = json.loads(reply("task", {"raises": "IndexError"}, NOWHERE)[1])["text"]
    file = Path(line.partition(", and attach ")[2].partition(",")[0])
    record = json.loads(file.read_text(encoding="utf-8"))
    assert record["arguments"] == {"raises": "IndexError"}
    assert record["traceback"].startswith("Traceback")
    file.unlink()


def test_a_pool_ends_while_a_request_still_waits() -> None:
    let_go, ended = Event(), Event()
    pool = Pool(1)
    waiting = pool._threads.submit(let_go.wait, 30.0)

    def end() -> None:
        pool.end()
        ended.set()

    ending = Thread(target=end)
    ending.start()
    try:
        assert ended.wait(10.0)
        assert not waiting.done()
    finally:
        let_go.set()
        ending.join()
