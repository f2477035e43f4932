"""Workers in this process: limits, replies by kind of failure, numbers that JSON lacks, and a pool of stand-ins."""

import asyncio
import json
import resource
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import MonkeyPatch
from tests.names import names_of

from sonolube.browser import requests, worker
from sonolube.browser.requests import Places
from sonolube.errors import InvalidInput
from sonolube.variants import VariantTable

NOWHERE = Places(rigs={})
GIBIBYTE = 2**30


@pytest.mark.parametrize(("more", "processor"), [({}, None), ({"memory": 1000, "file_size": 10, "cpu_time": 600}, 600)])
def test_a_process_is_limited_to_two_gibibytes_one_a_file_and_a_time_where_it_is_given(
    more: dict[str, int], processor: int | None, monkeypatch: MonkeyPatch
) -> None:
    limits: dict[int, tuple[int, int]] = {}
    monkeypatch.setattr(resource, "setrlimit", lambda kind, ends: limits.update({kind: ends}))
    worker.limit_process(**more)
    memory, size = more.get("memory", 2 * GIBIBYTE), more.get("file_size", GIBIBYTE)
    expected = {resource.RLIMIT_DATA: (memory, memory), resource.RLIMIT_FSIZE: (size, size)}
    assert limits == expected | ({} if processor is None else {resource.RLIMIT_CPU: (processor, processor)})


def test_a_limit_that_the_system_refuses_is_none(monkeypatch: MonkeyPatch) -> None:
    def refuse(kind: int, ends: tuple[int, int]) -> None:
        raise ValueError

    monkeypatch.setattr(resource, "setrlimit", refuse)
    worker.limit_process()


def raising(failure: BaseException) -> Callable[..., Any]:
    def answer(payload: Any, places: Places) -> Any:
        raise failure

    return answer


@pytest.mark.parametrize(
    ("failure", "status", "text", "faults"),
    [(InvalidInput("load: too much", key="load"), 422, "load: too much", [{"key": "load", "text": "load: too much"}])],
)
def test_a_failure_is_a_refusal_or_a_fault_of_its_kind(
    failure: BaseException, status: int, text: str, faults: list[Any], monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(requests, "KINDS", {"own": raising(failure)})
    found, body = worker.reply("own", {}, NOWHERE)
    assert (found, json.loads(body)) == (status, {"text": text, "faults": faults})


def test_too_little_memory_is_refused_with_a_remedy_and_an_answer_is_as_it_is(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(
        requests, "KINDS", {"big": raising(MemoryError()), "own": lambda payload, places: {"a": payload}}
    )
    status, body = worker.reply("big", {}, NOWHERE)
    text = "does not fit into the memory of a worker; ask for fewer points, or use the terminal"
    assert (status, json.loads(body)) == (422, {"text": text, "faults": [{"key": "", "text": text}]})
    assert worker.reply("own", {"b": 1}, NOWHERE) == (200, b'{"a": {"b": 1}}')
    assert isinstance(requests.VIEWS, dict)
    assert not isinstance(requests.KINDS, VariantTable)


def test_numbers_that_json_lacks_become_null_wherever_they_are() -> None:
    content = {"a": [1.5, np.nan, (np.inf, "text", None)], "b": {"c": -np.inf, "d": True, "e": 3}}
    assert json.loads(worker.encoded(content)) == {
        "a": [1.5, None, [None, "text", None]], "b": {"c": None, "d": True, "e": 3},
    }  # fmt: skip
    assert worker.encoded({"a": 1.0}) == b'{"a": 1.0}'


class Ends:
    """Connection by which requests come in until it ends."""

    def __init__(self, requests: list[Any], *, is_broken: bool = False) -> None:
        self.requests, self.sent, self.is_broken = requests, list[Any](), is_broken

    def recv(self) -> Any:
        if not self.requests:
            raise EOFError
        return self.requests.pop(0)

    def send(self, content: Any) -> None:
        if self.is_broken:
            raise BrokenPipeError
        self.sent.append(content)


def test_a_worker_is_limited_and_warm_before_it_answers_until_its_connection_ends(
    tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    done: list[Any] = []
    monkeypatch.setattr(names_of(worker).signal, "signal", lambda number, act: done.append((number, act)))
    monkeypatch.setattr(names_of(worker).os, "chdir", lambda folder: done.append(folder))
    monkeypatch.setattr(worker, "limit_process", lambda: done.append("limited"))
    monkeypatch.setattr(worker, "warm_up", lambda: done.append("warm"))
    monkeypatch.setattr(worker, "reply", lambda kind, payload, places: (200, kind.encode()))
    connection, warm = Ends([("a", {}, NOWHERE), ("b", {}, NOWHERE)]), Ends([])
    worker.serve(connection, str(tmp_path), warm)  # type: ignore[arg-type]
    assert done == [(names_of(worker).signal.SIGINT, names_of(worker).signal.SIG_IGN), str(tmp_path), "limited", "warm"]
    assert connection.sent == [(200, b"a"), (200, b"b")]
    assert warm.sent == [True]
    gone = Ends([("a", {}, NOWHERE), ("b", {}, NOWHERE)], is_broken=True)
    worker.serve(gone, str(tmp_path), Ends([], is_broken=True))  # type: ignore[arg-type]
    assert len(gone.requests) == 1


class Process:
    """Stands in for a process."""

    exitcode = -9  # ended by a signal

    def __init__(self, *, is_alive: bool = True) -> None:
        self.alive, self.calls = is_alive, list[str]()

    def is_alive(self) -> bool:
        return self.alive

    def kill(self) -> None:
        self.calls.append("kill")

    def join(self, longest: float) -> None:
        self.calls.append("join")


def bare_worker(connection: Any) -> Any:
    """Worker without a process of its own."""
    found = object.__new__(worker._Worker)
    found.connection, found.process = connection, Process()  # type: ignore[assignment]
    return found


@pytest.mark.parametrize(
    ("answers", "failure", "words"),
    [(False, None, "took longer than 2 s"), (True, EOFError(), "has ended"), (True, OSError(), "has ended")],
)
def test_a_worker_that_does_not_answer_is_ended_and_says_why(
    answers: bool, failure: Exception | None, words: str
) -> None:
    class Connection:
        def send(self, request: Any) -> None: ...
        def poll(self, longest: float) -> bool:
            assert longest == 2.0
            return answers

        def recv(self) -> Any:
            assert failure is not None
            raise failure

        def close(self) -> None: ...

    found = bare_worker(Connection())
    status, body = found.ask(("task", {}, NOWHERE), 2.0)
    content = json.loads(body)
    assert (status, words in content["text"]) == (503, True)
    assert content["faults"] == [{"key": "", "text": content["text"]}]
    assert found.process.calls[-2:] == ["kill", "join"]


class StandIn:
    """Stands in for a worker; the first is warm, others when a test says so."""

    made: list["StandIn"]
    is_warm = True

    def __init__(self, folder: str) -> None:
        self.process, self.folder, self.ended = Process(), folder, 0
        self.made.append(self)

    def ask(self, request: Any, longest: float) -> tuple[int, bytes]:
        return 200, json.dumps({"worker": self.made.index(self), "kind": request[0], "longest": longest}).encode()

    def end(self) -> None:
        self.ended += 1


@pytest.fixture
def pool(monkeypatch: MonkeyPatch) -> Iterator[worker.Pool]:
    StandIn.made = []
    StandIn.is_warm = True
    monkeypatch.setattr(worker, "_Worker", StandIn)
    found = worker.Pool(3)
    yield found
    found.end()
    assert all(each.ended == 1 for each in found._workers)  # type: ignore[attr-defined]


def test_the_first_worker_starts_alone_and_the_others_once_it_is_warm(pool: worker.Pool) -> None:
    assert not pool.is_warm
    StandIn.is_warm = False
    pool.start()
    pool.start()
    assert [len(StandIn.made), int(pool.is_warm)] == [1, 0]
    status, found = asyncio.run(pool.answer("a", {}, NOWHERE))
    assert (status, found) == (200, {"worker": 0, "kind": "a", "longest": 120.0})
    assert len(StandIn.made) == 1
    StandIn.is_warm = True
    assert int(pool.is_warm) == 1
    asyncio.run(pool.answer("a", {}, NOWHERE))
    assert len(StandIn.made) == 3
    assert pool._free.qsize() == 3
    assert pool._starting == []


def test_each_worker_is_free_again_after_its_answer_and_a_dead_one_is_replaced(pool: worker.Pool) -> None:
    for _ in range(2):
        asyncio.run(pool.answer("a", {}, NOWHERE))
    StandIn.made[pool._free._queue[0]].process.alive = False  # type: ignore[attr-defined]
    _, found = asyncio.run(pool.answer("b", {}, NOWHERE))
    assert found["worker"] == 3
    assert pool._free.qsize() == 3


def test_a_worker_of_a_page_that_waits_no_more_is_killed(pool: worker.Pool, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(worker, "_BETWEEN", 0.01)
    pool.start()
    own = StandIn.made[0]
    asked: list[bool] = []

    def ask(request: Any, longest: float) -> tuple[int, bytes]:
        while "kill" not in own.process.calls:
            pass
        return 503, b"{}"

    async def gone() -> bool:
        asked.append(len(asked) > 0)
        return asked[-1]

    monkeypatch.setattr(own, "ask", ask)
    assert asyncio.run(pool.ask("a", {}, NOWHERE, is_gone=gone)) == (503, b"{}")
    assert asked[:2] == [False, True]


def test_warming_up_makes_a_prediction_of_the_first_page(monkeypatch: MonkeyPatch) -> None:
    asked: list[Any] = []

    def reply(*each: Any) -> tuple[int, bytes]:
        asked.append(each)
        raise InvalidInput("whatever")

    monkeypatch.setattr(worker, "reply", reply)
    monkeypatch.setattr(names_of(worker).gc, "freeze", lambda: asked.append("frozen"))
    worker.warm_up()
    (kind, payload, places), frozen = asked
    assert (kind, payload["task"], payload["arguments"]["rig"]["name"]) == ("task", "predict", "tribometer")
    assert (places.rigs, frozen) == ({}, "frozen")
