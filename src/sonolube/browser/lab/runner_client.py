"""Requests of the workbench to the process of a run, on this computer."""

import asyncio
import json
from collections.abc import AsyncIterator, Mapping
from contextlib import suppress
from typing import Any, Final

from sonolube.browser.lab.runner_records import CONTROL_HEADER, RunnerRecord
from sonolube.errors import InvalidInput

_CONNECTING: Final = 5.0  # s
_ANSWERING: Final = 10.0  # s
_PART: Final = 64 * 1024  # bytes


class NoAnswer(InvalidInput):
    """A process of a run that does not answer."""


async def asked(
    record: RunnerRecord,
    method: str,
    path: str,
    content: Mapping[str, Any] | None = None,
    *,
    longest: float = _ANSWERING,
) -> dict[str, Any]:
    """Answer of the process of a run within a time. [s]

    Raises
    ------
    NoAnswer
        If it does not answer.
    InvalidInput
        If it refuses.
    """
    try:
        async with asyncio.timeout(longest):
            reader, writer = await _opened(record, method, path, content)
            try:
                status = await _head(reader)
                body = await reader.read()
            finally:
                writer.close()
        answer = json.loads(body)
    except (OSError, TimeoutError, ValueError, EOFError):
        raise NoAnswer(f"the process of the run, {record.process}, does not answer") from None
    if status != 200 or not isinstance(answer, dict):
        fault = (answer.get("faults") or [{}])[0] if isinstance(answer, dict) else {}
        raise InvalidInput(str(fault.get("text") or "the run refuses that"), key=str(fault.get("key", "")))
    return answer


async def stream(record: RunnerRecord) -> AsyncIterator[bytes]:
    """Frames of a run as they come, until its end; a reader that is slow keeps nobody waiting but itself."""
    reader, writer = await _opened(record, "GET", "/live", None)
    try:
        await _head(reader)
        while part := await reader.read(_PART):
            yield part
    except (OSError, EOFError):
        return
    finally:
        writer.close()


async def _opened(
    record: RunnerRecord, method: str, path: str, content: Mapping[str, Any] | None
) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Connection on which a request was sent; by HTTP/1.0, whose answers end with the connection."""
    body = json.dumps(content or {}).encode() if method == "POST" else b""
    access = record.access
    lines = [
        f"{method} {path} HTTP/1.0",
        f"Host: 127.0.0.1:{record.port}",
        f"Cookie: {access.cookie}={access.secret}",
        f"{CONTROL_HEADER}: {record.control}",
        "Accept: application/json",
        f"Content-Length: {len(body)}",
        "Connection: close",
    ]
    async with asyncio.timeout(_CONNECTING):
        reader, writer = await asyncio.open_connection("127.0.0.1", record.port)
    try:
        writer.write("\r\n".join([*lines, "", ""]).encode() + body)
        await writer.drain()
    except BaseException:
        with suppress(OSError):
            writer.close()
        raise
    return reader, writer


async def _head(reader: asyncio.StreamReader) -> int:
    """Status of an answer, its head read."""
    head = await reader.readuntil(b"\r\n\r\n")
    return int(head.split(maxsplit=2)[1])
