"""Requests to an application by ASGI, without a network and without another library."""

import asyncio
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import unquote, urlencode

Message = dict[str, Any]


@dataclass(frozen=True)
class Answer:
    """Answer of an application."""

    status_code: int
    headers: Mapping[str, str]
    content: bytes

    @property
    def text(self) -> str:
        return self.content.decode()

    def json(self) -> Any:
        return json.loads(self.content)


@dataclass(frozen=True)
class Client:
    """Client of an application, which sends some headers with every request."""

    application: Any
    headers: Mapping[str, str] = field(default_factory=dict)

    def get(self, path: str, *, params: Mapping[str, str] | None = None, **headers: str) -> Answer:
        return self.ask("GET", path, b"", query=urlencode(params or {}), **headers)

    def post(self, path: str, content: object = None, **headers: str) -> Answer:
        body = content if isinstance(content, bytes) else json.dumps(content or {}).encode()
        return self.ask("POST", path, body, **headers)

    def ask(self, method: str, path: str, body: bytes = b"", *, query: str = "", **headers: str) -> Answer:
        """Answer to a request; names of headers with _ for -."""
        named = {"host": "localhost", **self.headers} | {name.replace("_", "-"): text for name, text in headers.items()}
        scope = {
            "type": "http", "method": method, "path": unquote(path), "raw_path": path.encode(), "root_path": "",
            "query_string": query.encode(), "scheme": "http", "http_version": "1.1", "server": ("localhost", 80),
            "headers": [(name.lower().encode(), text.encode()) for name, text in named.items()],
        }  # fmt: skip
        sent: list[Message] = []

        async def answered() -> None:
            waiting: list[Message] = [{"type": "http.request", "body": body, "more_body": False}]
            never = asyncio.Event()

            async def receive() -> Message:
                if not waiting:
                    await never.wait()  # the client stays until it has its answer
                return waiting.pop()

            async def send(message: Message) -> None:
                sent.append(message)

            await self.application(scope, receive, send)

        asyncio.run(answered())
        start, *parts = sent
        given = {name.decode(): text.decode() for name, text in start["headers"]}
        return Answer(start["status"], given, b"".join(part.get("body", b"") for part in parts))
