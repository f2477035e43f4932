"""Page of a run's own process: what it says of each state, who may steer, and frames, without a network."""

import asyncio
import json
from collections.abc import Iterator
from typing import Any

import pytest
from pytest import MonkeyPatch
from tests.browser.asgi import Client
from tests.names import names_of

from sonolube.browser.lab import stop_page as pages
from sonolube.browser.lab.live_run import LiveRun
from sonolube.browser.lab.runner_records import CONTROL_HEADER, SAFETY
from sonolube.browser.lab.stop_page import StopServer, stop_page
from sonolube.facts.protocol import Prompt
from sonolube.laboratory import RunControl


def status(**changes: Any) -> dict[str, Any]:
    known = {
        "title": "Brass <1>", "protocol": "short", "outcome": "", "state": "running", "reason": "", "step": "2.1",
        "kind": "motor_speed", "time": 12.34, "total": 60.0, "folder": "0715", "is_ended": False, "is_stopping": False,
    }  # fmt: skip
    return known | changes


BUTTON = '<form method="post" action="stop">'


@pytest.mark.parametrize(
    ("changes", "head", "has_button", "is_danger"),
    [
        ({}, "A run is at work", True, False),
        ({"is_stopping": True}, "Stopping: motor and drive are being switched off", True, False),
        ({"is_ended": True, "state": "safe"}, "The run has ended; motor and drive: off", False, False),
        (
            {"is_ended": True, "state": "safe", "outputs": "measured off"},
            "The run has ended; motor and drive: measured off",
            False,
            False,
        ),
        ({"is_ended": True, "state": "failed"}, "motor and drive: cut the power: they may be on", False, True),
        ({"state": "failed"}, "A run is at work", True, True),
    ],
)
def test_the_page_says_whether_motor_and_drive_are_off(
    changes: dict[str, Any], head: str, has_button: bool, is_danger: bool
) -> None:
    text = stop_page(status(**changes))
    assert head in text
    assert (BUTTON in text, ' class="danger"' in text) == (has_button, is_danger)
    assert SAFETY in text
    assert "[[" not in text


def test_the_facts_of_a_run_are_escaped_and_those_that_are_not_known_are_left_out() -> None:
    text = stop_page(status(outcome="stopped", reason="by hand"))
    for fact in (
        "<dt>run</dt><dd>Brass &lt;1&gt;</dd>", "<dt>state</dt><dd>stopped: by hand</dd>",
        "<dt>step</dt><dd>2.1 motor speed</dd>", "<dt>time</dt><dd>12.3 s of 60.0 s</dd>",
        "<dt>record</dt><dd>0715</dd>",
    ):  # fmt: skip
        assert fact in text
    bare = stop_page(status(title="", step="", kind="", folder="", total=None))
    assert "<dt>run</dt><dd>short</dd>" in bare
    assert "<dt>state</dt><dd>running</dd>" in bare
    assert "12.3 s of 0.0 s" in bare
    assert "<dt>step</dt>" not in bare
    assert "<dt>record</dt>" not in bare


@pytest.fixture
def control() -> RunControl:
    return RunControl()


@pytest.fixture
def live(control: RunControl) -> LiveRun:
    return LiveRun({"title": "Own"}, control)


@pytest.fixture
def server(live: LiveRun, control: RunControl) -> Iterator[StopServer]:
    found = StopServer(live, control)
    yield found
    found._listening.close()


@pytest.fixture
def client(server: StopServer, monkeypatch: MonkeyPatch) -> Client:
    """Requests to the application without its guard, which waits for an end no longer than a moment."""
    monkeypatch.setattr(pages, "_STOPPING", 0.05)
    return Client(server._application(), headers={CONTROL_HEADER: server.control})


def test_every_server_has_its_own_token_and_word_on_this_computer(server: StopServer, live: LiveRun) -> None:
    other = StopServer(live, RunControl())
    other._listening.close()
    assert len({server.token, server.control, other.token, other.control}) == 4
    assert server._listening.getsockname() == ("127.0.0.1", server.port)


def test_anybody_stops_by_the_page_and_a_program_gets_the_state(
    client: Client, control: RunControl, live: LiveRun
) -> None:
    assert "A run is at work" in client.get("/").text
    answer = client.post("/stop", x_sonolube_control="", accept="text/html")
    assert (answer.status_code, "Stopping" in answer.text) == (200, True)
    assert control.stop_reason == "stopped on a page"
    live.end("safe", "stopped", "stopped on a page")
    answer = client.post("/stop", accept="application/json")
    assert (answer.json()["outcome"], answer.headers["cache-control"]) == ("stopped", "no-store")
    assert client.get("/status").json()["is_ended"] is True


def test_the_workbench_alone_pauses_and_resumes(client: Client, control: RunControl) -> None:
    for word in ("", "wrong"):
        refused = client.post("/pause", x_sonolube_control=word)
        assert (refused.status_code, refused.text) == (403, "This page only stops the run.")
    assert not control.is_paused
    assert client.post("/pause").json()["is_paused"] is True
    assert client.post("/resume").json()["is_paused"] is False


@pytest.mark.parametrize(
    ("content", "key", "words"),
    [
        ({"number": 1, "is_done": 1}, "is_done", "say true or false"),
        ({"number": 1}, "is_done", "say true or false"),
        ({"number": True, "is_done": True}, "number", "of the prompt on screen"),
        ({"number": "1", "is_done": True}, "number", "of the prompt on screen"),
        ({"number": 1, "is_done": True}, "number", "nothing is asked now"),
    ],
)
def test_a_prompt_is_confirmed_by_its_number_and_by_true_or_false(
    content: dict[str, Any], key: str, words: str, client: Client
) -> None:
    answer = client.post("/confirm", content)
    assert answer.status_code == 422
    (fault,) = answer.json()["faults"]
    assert (fault["key"], words in fault["text"]) == (key, True)


def test_a_prompt_that_is_asked_is_answered(client: Client, live: LiveRun) -> None:
    live._prompt, live._asked = Prompt(text="Mount the pin."), 4
    assert client.post("/confirm", {"number": 4, "is_done": False}).status_code == 200
    assert live._answer is False


def test_files_of_the_page_alone_are_served(client: Client) -> None:
    assert client.get("/static/stop.css").status_code == 200
    for name in ("app.css", "none.css"):
        assert (client.get(f"/static/{name}").status_code, client.get(f"/static/{name}").text) == (
            404, "There is no such file.",
        )  # fmt: skip


def test_sixteen_readers_watch_at_one_time(client: Client, server: StopServer, live: LiveRun) -> None:
    live.end("safe", "completed", "")
    server._readers = 15
    answer = client.get("/live")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/x-ndjson")
    (line,) = answer.text.splitlines()
    assert json.loads(line)["outcome"] == "completed"
    assert server._readers == 15
    server._readers = 16
    refused = client.get("/live")
    assert (refused.status_code, refused.json()["text"]) == (422, "16 pages watch the run already; close one")


def test_frames_come_with_news_once_a_second_without_and_at_the_end(
    server: StopServer, live: LiveRun, monkeypatch: MonkeyPatch
) -> None:
    frames: list[dict[str, Any]] = []
    slept: list[float] = []

    async def sleep(seconds: float) -> None:
        slept.append(seconds)
        if len(slept) == 3:
            live.notes("trip", {"reason": "hot"})
        if len(slept) == 40:
            live.end("safe", "completed", "")

    monkeypatch.setattr(names_of(pages).asyncio, "sleep", sleep)

    async def read() -> None:
        frames.extend(
            [
                {"at": len(slept), "trips": len(frame["trips"]), "state": frame["state"]}
                async for frame in server._news()
            ]
        )

    asyncio.run(read())
    # the first, the news after the third sleep, 1 s = 25 frames of 40 ms later one without news, and the end
    assert [frame["at"] for frame in frames] == [0, 3, 28, 40]
    assert [frame["trips"] for frame in frames] == [0, 1, 1, 1]
    assert frames[-1]["state"] == "safe"
