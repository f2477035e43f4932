"""Access to a server on this computer: token and cookie, Host and Origin; and the headers of every answer."""

import hmac
from collections.abc import Awaitable, Callable, Mapping, MutableMapping
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Any, Final
from urllib.parse import parse_qs, urlsplit

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
Asgi = Callable[[Scope, Receive, Send], Awaitable[None]]

_LOOPBACK: Final = frozenset({"localhost", "127.0.0.1", "[::1]"})
_HEADERS: Final = (
    (
        b"content-security-policy",
        b"default-src 'self'; img-src 'self' data: blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'self';"
        b" object-src 'none'",
    ),
    (b"x-content-type-options", b"nosniff"),
    (b"x-frame-options", b"DENY"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
_REFUSED: Final[Mapping[int, str]] = {
    401: "This workbench asks for its link: open the one that it printed when it was started.",
    403: "This request does not come from a page of this workbench.",
    421: "This name is not one of this workbench; open it by the link that it printed.",
}
_ONWARD: Final = (
    b'<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url=./"><title>sonolube</title>'
)
_SAFE: Final = ("GET", "HEAD")
_OPEN: Final = frozenset({"/static/link.css", "/static/link.js", "/static/icon.svg"})
"""Files of the page that asks for the link."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Access:
    """Conditions under which a request is admitted.

    Parameters
    ----------
    token : str
        In the link that is printed.
    port : int
        In the name of the cookie, so that several workbenches on one host do not log each other out.
    key : str
        In the link by which the browser is opened, which lets in once; empty for none.
    hosts : frozenset of str
        Names of hosts beyond those of this computer, such as that of a proxy.
    """

    token: str
    port: int
    key: str = ""
    hosts: frozenset[str] = field(default_factory=frozenset)

    @property
    def cookie(self) -> str:
        """Name of the cookie."""
        return f"sonolube-{self.port}"

    @property
    def secret(self) -> str:
        """Value of the cookie, from which the token does not follow."""
        return sha256(f"cookie of {self.token}".encode()).hexdigest()

    def knows_host(self, host: str) -> bool:
        """Whether a Host header names this computer, whatever the port, or a host that was allowed."""
        name = host.rpartition(":")[0] if host.rpartition(":")[2].isdigit() else host
        return name.lower() in _LOOPBACK | self.hosts


class Guard:
    """Application behind its checks: a request is refused in one line or passed on, and every answer gets the headers.

    Parameters
    ----------
    application : callable
        By ASGI.
    access : Access
    """

    def __init__(self, application: Asgi, access: Access) -> None:
        self._application, self._access, self._key = application, access, access.key

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request."""
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await self._application(scope, receive, send)
            return
        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        guarded = _with_headers(send, is_stated=headers.get("x-status") == "in-header")
        if not self._access.knows_host(headers.get("host", "")):
            await _refuse(guarded, 421)
        elif token := _stated(scope, "token"):
            await self._admit(guarded, hmac.compare_digest(token.encode(), self._access.token.encode()))
        elif key := _stated(scope, "key"):
            await self._admit_once(guarded, key)
        elif not self._has_cookie(headers.get("cookie", "")) and not _is_open(scope):
            await _refuse(guarded, 401, is_page=scope["path"] == "/")
        elif scope["method"] not in _SAFE and not _is_own_page(headers):
            await _refuse(guarded, 403)
        else:
            await self._application(scope, receive, guarded)

    async def _admit(self, send: Send, is_right: bool) -> None:
        """Exchange the token of a link for a cookie; the page is then read again without it."""
        if not is_right:
            await _refuse(send, 401, is_page=True)
            return
        headers = [(b"location", b"./"), (b"set-cookie", self._set_cookie()), (b"content-length", b"0")]
        await send({"type": "http.response.start", "status": 303, "headers": headers})
        await send({"type": "http.response.body", "body": b""})

    async def _admit_once(self, send: Send, key: str) -> None:
        """Exchange the key for a cookie, the first time.

        A page of this workbench leads on: behind a redirect of a file a browser would keep the cookie back.
        """
        if not self._key or not hmac.compare_digest(key.encode(), self._key.encode()):
            await _refuse(send, 401, is_page=True)
            return
        self._key = ""
        kind = (b"content-type", b"text/html; charset=utf-8")
        length = (b"content-length", str(len(_ONWARD)).encode())
        headers = [kind, length, (b"set-cookie", self._set_cookie()), (b"cache-control", b"no-store")]
        await send({"type": "http.response.start", "status": 200, "headers": headers})
        await send({"type": "http.response.body", "body": _ONWARD})

    def _set_cookie(self) -> bytes:
        """Cookie that lets in."""
        return f"{self._access.cookie}={self._access.secret}; HttpOnly; SameSite=Strict; Path=/".encode()

    def _has_cookie(self, header: str) -> bool:
        """Whether a Cookie header has the secret of this workbench."""
        pairs = (pair.strip().partition("=") for pair in header.split(";"))
        values = [value for name, _, value in pairs if name == self._access.cookie]
        return any(hmac.compare_digest(value.encode(), self._access.secret.encode()) for value in values)


def _is_open(scope: Scope) -> bool:
    """Whether a request is for a file of the page that asks for the link."""
    return scope["method"] in _SAFE and scope["path"] in _OPEN


def _stated(scope: Scope, name: str) -> str:
    """Value in the query of the first page; empty where there is none."""
    if scope["path"] != "/" or scope["method"] != "GET":
        return ""
    query: str = scope["query_string"].decode("latin-1")
    return parse_qs(query).get(name, [""])[0]


def _is_own_page(headers: Mapping[str, str]) -> bool:
    """Whether a request that changes something comes from a page of this workbench, by what browsers say."""
    origin, site = headers.get("origin"), headers.get("sec-fetch-site")
    if site is not None and site not in ("same-origin", "none"):
        return False
    is_bare = origin == "null" and site == "same-origin"  # a form of a page that tells nobody where it was
    return origin is None or is_bare or urlsplit(origin).netloc == headers.get("host")


def _with_headers(send: Send, *, is_stated: bool) -> Send:
    """Send that adds the headers of every answer, and states there the status of a refusal where a page asks for it.

    A browser reports any other status than 200 as an error of the page.
    """

    async def guarded(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            status = message["status"]
            message["headers"] = [*message.get("headers", ()), *_HEADERS]
            if is_stated and status >= 400:
                message.update(status=200, headers=[*message["headers"], (b"x-status", str(status).encode())])
        await send(message)

    return guarded


async def _refuse(send: Send, status: int, *, is_page: bool = False) -> None:
    """Answer with one line of text; a page asked for without the cookie says how to get in."""
    text = _REFUSED[status]
    body = text.encode()
    kind = b"text/plain; charset=utf-8"
    if is_page:
        from importlib.resources import files

        body, kind = files("sonolube.browser").joinpath("static/link.html").read_bytes(), b"text/html; charset=utf-8"
    length = str(len(body)).encode()
    await send(
        {
            "type": "http.response.start",
            "status": status,
            "headers": [(b"content-type", kind), (b"content-length", length), (b"connection", b"close")],
        }
    )
    await send({"type": "http.response.body", "body": body})
