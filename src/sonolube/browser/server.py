"""The server of the workbench: its link, its processes and their end."""

import asyncio
import os
import secrets
import signal
import socket
import sys
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import uvicorn

from sonolube.browser.access import Access, Guard
from sonolube.browser.connections import BoundedProtocol
from sonolube.browser.jobs import Jobs, jobs_folder
from sonolube.browser.requests import OPENED
from sonolube.browser.routes import Workbench
from sonolube.browser.uploads import Uploads
from sonolube.browser.worker import Pool
from sonolube.errors import InvalidInput
from sonolube.operating_system import remove_file
from sonolube.rig.file.rig_folder import RECORDS
from sonolube.storage.files import user_state_folder, write_atomically

_HEAD_START: Final = 0.35  # seconds of the first page in the browser before the first worker


class _Server(uvicorn.Server):
    """Server that prints the link once it listens, and starts the first worker a moment later."""

    def __init__(self, config: uvicorn.Config, *, link: str, opened: Path | None, pool: Pool) -> None:
        super().__init__(config)
        self._link, self._opened, self._pool = link, opened, pool

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen, and print the link."""
        await super().startup(sockets)
        sys.stdout.write(f"The workbench is at {self._link}\nCtrl-C ends it.\n")
        sys.stdout.flush()
        asyncio.get_running_loop().call_later(_HEAD_START, self._pool.start)
        if self._opened is not None:
            webbrowser.open(self._opened.as_uri())


def run(
    *,
    rig: Path | None = None,
    port: int = 8765,
    host: str = "127.0.0.1",
    token: str = "",
    hosts: Sequence[str] = (),
    opens_browser: bool = True,
    device_map: Path | None = None,
    runs: Path | None = None,
) -> None:
    """Serve the workbench until it is interrupted.

    Parameters
    ----------
    rig : Path or None
        File or folder of the rig that the first page shows; an example where None.
    port : int
        0 for any free one.
    host : str
        Address on which it listens.
    token : str
        Empty for a random one.
    hosts : sequence of str
        Names beyond those of this computer by which pages may ask.
    opens_browser : bool
    device_map : Path or None
        Of the rig of the laboratory; None for the virtual tribometer.
    runs : Path or None
        Folder of its runs; where None, the records of the folder of the rig, or `runs`.

    Raises
    ------
    InvalidInput
        If the port is taken, or the file is no rig.
    """
    listening = _listening(host, port)
    port = listening.getsockname()[1]
    access = Access(
        token=token or secrets.token_urlsafe(32), key=secrets.token_urlsafe(32), port=port, hosts=frozenset(hosts)
    )
    name = f"[{host}]" if ":" in host else host
    link = f"http://{name}:{port}/?token={access.token}"
    opened = _page_that_opens(f"http://{name}:{port}/?key={access.key}", port) if opens_browser else None
    workbench = _workbench(rig, device_map, runs)
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
                timeout_graceful_shutdown=2,  # of what never ends by itself, such as the frames of a run
                limit_concurrency=2000,
                http=BoundedProtocol,
                h11_max_incomplete_event_size=64 * 1024,
            ),
            link=link,
            opened=opened,
            pool=workbench.pool,
        )
        server.run(sockets=[listening])
    finally:
        if opened is not None:
            remove_file(opened)
        workbench.pool.end()
        workbench.jobs.end()
        workbench.uploads.end()
        if goes_on := workbench.laboratory.end():
            sys.stdout.write(f"A run goes on without the workbench. It can be stopped at {goes_on}\n")


def _page_that_opens(link: str, port: int) -> Path:
    """File, readable by its owner alone, that leads a browser to a link: that of a command others can read."""
    onward = f'<meta http-equiv="refresh" content="0; url={link}">'
    page = f'<!doctype html><meta charset="utf-8">{onward}<title>sonolube</title>'
    path = user_state_folder() / f"open-{port}.html"
    remove_file(path)
    return write_atomically(path, page, is_private=True)


def _leave(number: int, frame: object) -> None:
    """End this process after its workers and jobs."""
    del frame
    sys.exit(128 + number)


def _workbench(rig: Path | None, device_map: Path | None, runs: Path | None) -> Workbench:
    """Workbench with its processes."""
    cores = os.cpu_count() or 1
    folder = rig if rig is not None and rig.is_dir() else None
    rigs = {} if rig is None else {rig.resolve().name if folder else rig.stem: str(rig.resolve())}
    if runs is None:
        runs = Path("runs") if folder is None else folder / RECORDS
    return Workbench(
        pool=Pool(max(2, min(cores, 4))),
        jobs=Jobs(jobs_folder(), most=cores),
        uploads=Uploads(),
        rigs=rigs,
        opened=next(iter(rigs), OPENED),
        device_map=device_map,
        runs=runs,
        folder=folder,
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
