"""Checks of the workbench: token, cookie, Host, Origin and the headers of every answer, without a network."""

import asyncio
from collections.abc import MutableMapping
from dataclasses import dataclass
from typing import Any

import pytest

from sonolube.browser.access import Access, Guard, Receive, Scope, Send

TOKEN = "t" * 43
ACCESS = Access(token=TOKEN, port=8765)
COOKIE = f"{ACCESS.cookie}={ACCESS.secret}"


@dataclass
class Reply:
    status: int
    headers: dict[str, str]
    body: bytes


async def application(scope: Scope, receive: Receive, send: Send) -> None:
    del scope, receive
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"inside"})


def ask(path: str = "/", *, query: str = "", method: str = "GET", access: Access = ACCESS, **headers: Any) -> Reply:
    """Reply of the guarded application; header names with _ for -."""
    sent: list[MutableMapping[str, Any]] = []
    named = {"host": "127.0.0.1:8765"} | {name.replace("_", "-"): value for name, value in headers.items()}
    scope = {
        "type": "http",
        "path": path,
        "method": method,
        "query_string": query.encode(),
        "headers": [(name.encode(), value.encode()) for name, value in named.items()],
    }

    async def receive() -> MutableMapping[str, Any]:
        return {"type": "http.request", "body": b""}

    async def send(message: MutableMapping[str, Any]) -> None:
        sent.append(message)

    asyncio.run(Guard(application, access)(scope, receive, send))
    given = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
    return Reply(sent[0]["status"], given, b"".join(each.get("body", b"") for each in sent[1:]))


def test_the_token_of_the_link_is_exchanged_for_a_cookie_that_lets_in() -> None:
    reply = ask(query=f"token={TOKEN}")
    assert (reply.status, reply.headers["location"]) == (303, "./")
    cookie, *marks = reply.headers["set-cookie"].split("; ")
    assert {"HttpOnly", "SameSite=Strict"} <= set(marks)
    assert TOKEN not in cookie
    assert ask(cookie=cookie).body == b"inside"


@pytest.mark.parametrize("query", ["", "token=", "token=wrong", f"token={TOKEN[:-1]}", f"token={TOKEN}x"])
def test_without_the_right_token_nothing_is_shown(query: str) -> None:
    assert ask(query=query).status == 401


@pytest.mark.parametrize("cookie", ["", f"sonolube-8765={TOKEN}", f"sonolube-1={ACCESS.secret}", "sonolube-8765="])
def test_without_the_right_cookie_nothing_is_shown(cookie: str) -> None:
    assert ask("/api/jobs", cookie=cookie).status == 401
    assert ask("/static/app.css", cookie=cookie).status == 401


def test_the_key_of_the_opened_page_lets_in_once_by_a_page_that_leads_on() -> None:
    sent: list[MutableMapping[str, Any]] = []

    async def receive() -> MutableMapping[str, Any]:
        return {"type": "http.request", "body": b""}

    async def send(message: MutableMapping[str, Any]) -> None:
        sent.append(message)

    guard = Guard(application, Access(token=TOKEN, key="k" * 43, port=8765))
    host = [(b"host", b"127.0.0.1:8765")]
    for key in ("wrong", "k" * 43, "k" * 43, ""):
        scope = {"type": "http", "path": "/", "method": "GET", "query_string": f"key={key}".encode(), "headers": host}
        asyncio.run(guard(scope, receive, send))
    starts = [message for message in sent if message["type"] == "http.response.start"]
    assert [message["status"] for message in starts] == [401, 200, 401, 401]
    let_in = dict(starts[1]["headers"])
    assert let_in[b"set-cookie"].decode().partition(";")[0] == COOKIE
    assert b"url=./" in sent[3]["body"]


def test_a_refused_connection_is_closed() -> None:
    assert ask("/api/jobs").headers["connection"] == "close"


def test_a_token_opens_the_first_page_only() -> None:
    assert ask("/api/jobs", query=f"token={TOKEN}").status == 401


@pytest.mark.parametrize("host", ["127.0.0.1:8765", "localhost", "localhost:9000", "[::1]:8765", "LOCALHOST:1"])
def test_names_of_this_computer_are_known(host: str) -> None:
    assert ask(host=host, cookie=COOKIE).status == 200


@pytest.mark.parametrize("host", ["", "evil.example", "127.0.0.1.evil.example", "evil.example:8765", "0.0.0.0:8765"])
def test_foreign_names_are_refused_as_by_rebinding(host: str) -> None:
    assert ask(host=host, cookie=COOKIE).status == 421


def test_a_proxy_is_let_in_by_its_name() -> None:
    access = Access(token=TOKEN, port=8765, hosts=frozenset({"lab.example"}))
    assert ask(host="lab.example", cookie=COOKIE, access=access).status == 200
    assert ask(host="lab.example", cookie=COOKIE).status == 421


@pytest.mark.parametrize(
    "headers",
    [
        {"origin": "http://evil.example"},
        {"origin": "http://127.0.0.1:9999"},
        {"origin": "null"},
        {"sec_fetch_site": "cross-site"},
        {"sec_fetch_site": "same-site"},
        {"origin": "http://127.0.0.1:8765", "sec_fetch_site": "cross-site"},
    ],
)
def test_other_pages_change_nothing(headers: dict[str, Any]) -> None:
    assert ask("/api/jobs", method="POST", cookie=COOKIE, **headers).status == 403
    assert ask("/api/jobs/x", method="DELETE", cookie=COOKIE, **headers).status == 403


@pytest.mark.parametrize("headers", [{}, {"origin": "http://127.0.0.1:8765", "sec_fetch_site": "same-origin"}])
def test_own_pages_and_programs_with_the_cookie_may_change(headers: dict[str, Any]) -> None:
    assert ask("/api/jobs", method="POST", cookie=COOKIE, **headers).status == 200


def test_every_answer_has_the_headers_also_a_refusal() -> None:
    for reply in (ask(), ask(cookie=COOKIE), ask(host="evil.example"), ask(query=f"token={TOKEN}")):
        policy = reply.headers["content-security-policy"]
        assert "default-src 'self'" in policy
        assert "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy
        assert reply.headers["x-content-type-options"] == "nosniff"
        assert reply.headers["referrer-policy"] == "no-referrer"
        assert reply.headers["cross-origin-opener-policy"] == "same-origin"
        assert reply.headers["cross-origin-resource-policy"] == "same-origin"
        assert not any(name.startswith("access-control") for name in reply.headers)


def test_a_page_gets_the_status_of_its_refusal_in_a_header_and_nothing_else() -> None:
    asked: dict[str, Any] = {"x_status": "in-header"}
    reply = ask("/api/jobs", **asked)
    assert (reply.status, reply.headers["x-status"]) == (200, "401")
    assert reply.body != b"inside"
    assert ask("/api/jobs", method="POST", cookie=COOKIE, sec_fetch_site="cross-site", **asked).body != b"inside"
    assert "x-status" not in ask("/api/jobs", cookie=COOKIE, **asked).headers


@pytest.mark.parametrize("name", ["link.css", "link.js", "icon.svg"])
def test_the_page_that_asks_for_the_link_is_read_with_its_files(name: str) -> None:
    assert ask(f"/static/{name}").body == b"inside"
    assert ask(f"/static/{name}", method="POST").status == 401
    assert ask(f"/static/../{name}").status == 401
