"""The server of the workbench: its link, its processes and their end, and who has access.

Access is checked by token and cookie, Host, Origin and sizes; every answer has headers of its own.
"""

import asyncio
import hmac
import os
import secrets
import signal
import socket
import sys
import webbrowser
from collections.abc import Awaitable, Callable, Mapping, MutableMapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any, Final
from urllib.parse import parse_qs, urlsplit

import uvicorn

from sonolube.browser.jobs import Jobs, jobs_folder
from sonolube.browser.places import OPENED
from sonolube.browser.routes import Workbench
from sonolube.browser.uploads import Uploads
from sonolube.browser.worker import Pool
from sonolube.errors import InvalidInput

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
    hosts : frozenset of str
        Names of hosts beyond those of this computer, such as that of a proxy.
    """

    token: str
    port: int
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
        self._application, self._access = application, access

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
        elif token := _token_of(scope):
            await self._admit(guarded, token)
        elif not self._has_cookie(headers.get("cookie", "")) and not _is_open(scope):
            await _refuse(guarded, 401, is_page=scope["path"] == "/")
        elif scope["method"] not in _SAFE and not _is_own_page(headers):
            await _refuse(guarded, 403)
        else:
            await self._application(scope, receive, guarded)

    async def _admit(self, send: Send, token: str) -> None:
        """Exchange the token of a link for a cookie; the page is then read again without it."""
        if not hmac.compare_digest(token.encode(), self._access.token.encode()):
            await _refuse(send, 401, is_page=True)
            return
        cookie = f"{self._access.cookie}={self._access.secret}; HttpOnly; SameSite=Strict; Path=/"
        headers = [(b"location", b"./"), (b"set-cookie", cookie.encode()), (b"content-length", b"0")]
        await send({"type": "http.response.start", "status": 303, "headers": headers})
        await send({"type": "http.response.body", "body": b""})

    def _has_cookie(self, header: str) -> bool:
        """Whether a Cookie header has the secret of this workbench."""
        pairs = (pair.strip().partition("=") for pair in header.split(";"))
        values = [value for name, _, value in pairs if name == self._access.cookie]
        return any(hmac.compare_digest(value.encode(), self._access.secret.encode()) for value in values)


def _is_open(scope: Scope) -> bool:
    """Whether a request is for a file of the page that asks for the link."""
    return scope["method"] in _SAFE and scope["path"] in _OPEN


def _token_of(scope: Scope) -> str:
    """Token in the query of the first page; empty where there is none."""
    if scope["path"] != "/" or scope["method"] != "GET":
        return ""
    query: str = scope["query_string"].decode("latin-1")
    return parse_qs(query).get("token", [""])[0]


def _is_own_page(headers: Mapping[str, str]) -> bool:
    """Whether a request that changes something comes from a page of this workbench, by what browsers say."""
    origin, site = headers.get("origin"), headers.get("sec-fetch-site")
    if site is not None and site not in ("same-origin", "none"):
        return False
    return origin is None or urlsplit(origin).netloc == headers.get("host")


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
            "headers": [(b"content-type", kind), (b"content-length", length)],
        }
    )
    await send({"type": "http.response.body", "body": body})


_HEAD_START: Final = 0.35  # seconds of the first page in the browser before the first worker


class _Server(uvicorn.Server):
    """Server that prints the link once it listens, and starts the first worker a moment later."""

    def __init__(self, config: uvicorn.Config, *, link: str, opens_browser: bool, pool: Pool) -> None:
        super().__init__(config)
        self._link, self._opens, self._pool = link, opens_browser, pool

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen, and print the link."""
        await super().startup(sockets)
        sys.stdout.write(f"The workbench is at {self._link}\nCtrl-C ends it.\n")
        sys.stdout.flush()
        asyncio.get_running_loop().call_later(_HEAD_START, self._pool.start)
        if self._opens:
            webbrowser.open(self._link)


def run(
    *,
    rig: Path | None = None,
    port: int = 8765,
    host: str = "127.0.0.1",
    token: str = "",
    hosts: Sequence[str] = (),
    opens_browser: bool = True,
) -> None:
    """Serve the workbench until it is interrupted.

    Parameters
    ----------
    rig : Path or None
        File that the first page shows; an example where None.
    port : int
        0 for any free one.
    host : str
        Address on which it listens.
    token : str
        Empty for a random one.
    hosts : sequence of str
        Names beyond those of this computer by which pages may ask.
    opens_browser : bool

    Raises
    ------
    InvalidInput
        If the port is taken, or the file is no rig.
    """
    listening = _listening(host, port)
    port = listening.getsockname()[1]
    access = Access(token=token or secrets.token_urlsafe(32), port=port, hosts=frozenset(hosts))
    name = f"[{host}]" if ":" in host else host
    link = f"http://{name}:{port}/?token={access.token}"
    workbench = _workbench(rig)
    signal.signal(signal.SIGTERM, _leave)  # the server raises it again once it has shut down
    try:
        server = _Server(
            uvicorn.Config(
                Guard(workbench.application(), access),
                log_level="critical",
                access_log=False,
                server_header=False,
                lifespan="off",
                timeout_keep_alive=30,
                limit_concurrency=2000,
                h11_max_incomplete_event_size=64 * 1024,
            ),
            link=link,
            opens_browser=opens_browser,
            pool=workbench.pool,
        )
        server.run(sockets=[listening])
    finally:
        workbench.pool.end()
        workbench.jobs.end()
        workbench.uploads.end()


def _leave(number: int, frame: object) -> None:
    """End this process after its workers and jobs."""
    del frame
    sys.exit(128 + number)


def _workbench(rig: Path | None) -> Workbench:
    """Workbench with its processes."""
    cores = os.cpu_count() or 1
    rigs = {} if rig is None else {rig.stem: str(rig.resolve())}
    return Workbench(
        pool=Pool(max(2, min(cores, 4))),
        jobs=Jobs(jobs_folder(), most=cores),
        uploads=Uploads(),
        rigs=rigs,
        opened=next(iter(rigs), OPENED),
    )


def _listening(host: str, port: int) -> socket.socket:
    """Socket that listens on an address."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    found = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)  # so that asyncio sends answers at once
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((host, port))
    except OSError as failure:
        found.close()
        raise InvalidInput(
            f"--port {port}: {failure.strerror or failure}; name another, or 0 for any free one"
        ) from None
    return found


def plain_options(arguments: Sequence[str]) -> dict[str, Any] | None:
    """Arguments of `run` where nothing but a port and `--no-browser` is given; None where there is more to read.

    Parameters
    ----------
    arguments : sequence of str
        Words behind the command `app`.

    Returns
    -------
    dict or None
    """
    options: dict[str, Any] = {}
    words = [part for word in arguments for part in word.split("=", 1)]
    while words:
        match words:
            case ["--no-browser", *rest]:
                options["opens_browser"] = False
            case ["--port", number, *rest] if number.isdecimal() and int(number) < 2**16:
                options["port"] = int(number)
            case _:
                return None
        words = rest
    return options


def token_of_file(path: Path) -> str:
    """Token in a file that only its owner can read."""
    try:
        text = path.read_text(encoding="utf-8").strip()
    except OSError as failure:
        raise InvalidInput(f"--token-file {path}: {failure.strerror}") from None
    if sys.platform != "win32" and path.stat().st_mode & 0o077:
        raise InvalidInput(f"--token-file {path}: others can read it; protect it by: chmod 600 {path}")
    if len(text) < 32 or not text.isascii() or not text.isprintable() or " " in text:
        raise InvalidInput(f"--token-file {path}: needs one line of 32 or more printable characters without spaces")
    return text
