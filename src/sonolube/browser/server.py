"""The server of the workbench: its link, its processes, and their end."""

import os
import secrets
import signal
import socket
import sys
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import uvicorn

from sonolube.browser.jobs import Jobs, jobs_folder
from sonolube.browser.places import OPENED
from sonolube.browser.pool import Pool
from sonolube.browser.routes import Workbench
from sonolube.browser.security import Access, Guard
from sonolube.browser.uploads import Uploads
from sonolube.errors import InvalidInput


class _Server(uvicorn.Server):
    """Server that prints the link once it listens."""

    def __init__(self, config: uvicorn.Config, *, link: str, opens_browser: bool) -> None:
        super().__init__(config)
        self._link, self._opens = link, opens_browser

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen, and print the link."""
        await super().startup(sockets)
        sys.stdout.write(f"The workbench is at {self._link}\nCtrl-C ends it.\n")
        sys.stdout.flush()
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
