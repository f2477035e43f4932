"""Requests of the workbench to the process of a run: what is sent, what counts as an answer, a refusal, or silence."""

import asyncio
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest import raises

from sonolube.browser.lab.runner_client import NoAnswer, asked, stream
from sonolube.browser.lab.runner_records import CONTROL_HEADER, RunnerRecord
from sonolube.errors import InvalidInput


def exchanged(reply: bytes, act: Callable[[RunnerRecord], Any]) -> tuple[bytes, Any]:
    """What a server that replies so was sent, and what the act returned."""

    async def run() -> tuple[bytes, Any]:
        got = bytearray()

        async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            head = await reader.readuntil(b"\r\n\r\n")
            length = int(head.lower().partition(b"content-length: ")[2].split(b"\r\n")[0])
            got.extend(head + await reader.readexactly(length))
            writer.write(reply)
            await writer.drain()
            writer.close()

        server = await asyncio.start_server(answer, "127.0.0.1", 0)
        async with server:
            port = server.sockets[0].getsockname()[1]
            record = RunnerRecord(id="r", folder=Path(), about={}, process=77, port=port, token="t", control="word")
            found = await act(record)
        return bytes(got), found

    return asyncio.run(run())


def head(status: int) -> bytes:
    return f"HTTP/1.0 {status} Any\r\ncontent-type: x\r\n\r\n".encode()


def test_a_request_has_cookie_word_and_its_content_and_its_answer_is_an_object() -> None:
    sent, found = exchanged(
        head(200) + b'{"state": "running"}', lambda record: asked(record, "POST", "/confirm", {"number": 1})
    )
    assert found == {"state": "running"}
    lines, _, body = sent.decode().partition("\r\n\r\n")
    first, *rest = lines.split("\r\n")
    named = dict(line.split(": ", 1) for line in rest)
    assert first == "POST /confirm HTTP/1.0"
    assert named[CONTROL_HEADER] == "word"
    assert named["Cookie"].startswith("sonolube-")
    assert named["Host"].startswith("127.0.0.1:")
    assert (json.loads(body), int(named["Content-Length"])) == ({"number": 1}, len(body))


@pytest.mark.parametrize(("method", "body"), [("GET", b""), ("POST", b"{}")])
def test_a_question_has_no_content_and_a_request_without_any_an_empty_object(method: str, body: bytes) -> None:
    sent, _ = exchanged(head(200) + b"{}", lambda record: asked(record, method, "/status"))
    assert sent.partition(b"\r\n\r\n")[2] == body


@pytest.mark.parametrize(
    ("reply", "text", "key"),
    [
        (head(422) + b'{"faults": [{"text": "too late", "key": "number"}]}', "too late", "number"),
        (head(422) + b'{"faults": []}', "the run refuses that", ""),
        (head(500) + b"[]", "the run refuses that", ""),
        (head(200) + b"[]", "the run refuses that", ""),
    ],
)
def test_a_refusal_is_that_of_the_run_with_its_key(reply: bytes, text: str, key: str) -> None:
    with raises(InvalidInput) as refused:
        exchanged(reply, lambda record: asked(record, "GET", "/status"))
    assert not isinstance(refused.value, NoAnswer)
    assert (str(refused.value), refused.value.key) == (text, key)


@pytest.mark.parametrize("reply", [b"", head(200) + b"{", b"HTTP/1.0 x\r\n\r\n"])
def test_a_process_that_answers_nothing_that_can_be_read_does_not_answer(reply: bytes) -> None:
    with raises(NoAnswer, match=r"^the process of the run, 77, does not answer$"):
        exchanged(reply, lambda record: asked(record, "GET", "/status"))


def test_nobody_listens_is_no_answer() -> None:
    record = RunnerRecord(id="r", folder=Path(), about={}, process=77, port=1)
    with raises(NoAnswer):
        asyncio.run(asked(record, "GET", "/status", longest=5.0))


def test_frames_come_as_they_are_sent_until_the_end() -> None:
    async def read(record: RunnerRecord) -> bytes:
        return b"".join([part async for part in stream(record)])

    sent, found = exchanged(head(200) + b"one\ntwo\n", read)
    assert found == b"one\ntwo\n"
    assert sent.startswith(b"GET /live HTTP/1.0\r\n")
