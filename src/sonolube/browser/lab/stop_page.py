"""Page of a run's own process: a button that stops it, without scripts; and what the workbench asks of it.

It needs no workbench: a run can be stopped here when the workbench has ended.
"""

import asyncio
import hmac
import secrets
import socket
from collections.abc import AsyncIterator
from html import escape
from importlib.resources import files
from threading import Thread
from typing import Any, Final

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route

from sonolube.browser.access import Access, Guard
from sonolube.browser.lab.live_run import LiveRun
from sonolube.browser.lab.runner_records import CONTROL_HEADER, SAFETY
from sonolube.browser.messages import content_of, refused
from sonolube.browser.static_files import static_file
from sonolube.browser.worker import encoded
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.laboratory import RunControl

_FRAME: Final = 0.04  # s, between two frames
_SILENCE: Final = 1.0  # s, after which a frame is sent without news
_STOPPING: Final = 3.0  # s, for which a request to stop waits
_POLL: Final = 0.02  # s
_LAST: Final = 5.0  # s, for what is still being sent at the end
_MOST: Final = 16  # readers of frames at one time
_STATIC: Final = frozenset({"stop.css", "link.css", "link.js", "icon.svg"})


class StopServer:
    """Server of one run in a thread of its process.

    Parameters
    ----------
    live : LiveRun
    control : RunControl
    """

    def __init__(self, live: LiveRun, control: RunControl) -> None:
        self._live, self._requests, self._readers = live, control, 0
        self._listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        self._listening.bind(("127.0.0.1", 0))
        self._listening.listen()
        self.port: int = self._listening.getsockname()[1]
        self.token, self.control = secrets.token_urlsafe(32), secrets.token_urlsafe(32)
        access = Access(token=self.token, port=self.port)
        config = uvicorn.Config(
            Guard(self._application(), access),
            http="h11",
            log_level="critical",
            access_log=False,
            server_header=False,
            lifespan="off",
            timeout_keep_alive=5,
            timeout_graceful_shutdown=2,
            limit_concurrency=500,
            h11_max_incomplete_event_size=16 * 1024,
        )
        self._server = uvicorn.Server(config)
        self._thread = Thread(
            target=self._server.run, kwargs={"sockets": [self._listening]}, daemon=True, name="sonolube stop page"
        )

    def start(self) -> None:
        """Serve; connections made before wait."""
        self._thread.start()

    def close(self) -> None:
        """End, once what is being sent has been sent."""
        self._server.should_exit = True
        self._thread.join(_LAST)

    def _application(self) -> Starlette:
        """Application by ASGI, without the checks of `Guard`."""
        routes = [
            Route("/", self._page, methods=["GET"]),
            Route("/stop", self._stop, methods=["POST"]),
            Route("/status", self._status, methods=["GET"]),
            Route("/live", self._stream, methods=["GET"]),
            Route("/pause", self._steer, methods=["POST"]),
            Route("/resume", self._steer, methods=["POST"]),
            Route("/confirm", self._steer, methods=["POST"]),
            Route("/static/{name}", _static, methods=["GET"]),
        ]
        return Starlette(routes=routes, exception_handlers={SonolubeError: refused})

    async def _page(self, request: Request) -> Response:
        """Page with the state of the run and the button."""
        del request
        return self._shown()

    def _shown(self) -> Response:
        """Page with the present state; no redirect to it, for the server may end with the run."""
        return Response(stop_page(self._live.status()), media_type="text/html", headers={"cache-control": "no-store"})

    async def _stop(self, request: Request) -> Response:
        """Stop the run; the answer waits until it has ended, or for three seconds."""
        self._requests.stop("stopped on a page")
        waited = 0.0
        while not self._live.has_ended.is_set() and waited < _STOPPING:
            await asyncio.sleep(_POLL)
            waited += _POLL
        if "json" in request.headers.get("accept", ""):
            return _json(self._live.status())
        return self._shown()

    async def _status(self, request: Request) -> Response:
        """State of the run."""
        del request
        return _json(self._live.status())

    async def _steer(self, request: Request) -> Response:
        """Pause, resume or confirm, as the workbench asks for its holder."""
        word = request.headers.get(CONTROL_HEADER, "")
        if not hmac.compare_digest(word.encode(), self.control.encode()):
            return Response("This page only stops the run.", status_code=403, media_type="text/plain")
        match request.url.path.rpartition("/")[2]:
            case "pause":
                self._requests.pause()
            case "resume":
                self._requests.resume()
            case _:
                content = await content_of(request)
                number, is_done = content.get("number"), content.get("is_done")
                if not isinstance(is_done, bool):
                    raise InvalidInput("is_done: say true or false", key="is_done")
                if isinstance(number, bool) or not isinstance(number, int):
                    raise InvalidInput("number: give that of the prompt on screen", key="number")
                if refusal := self._live.answer(number, is_done=is_done):
                    raise InvalidInput(refusal, key="number")
        return _json(self._live.status())

    async def _stream(self, request: Request) -> Response:
        """Frames, a line of JSON each."""
        del request
        if self._readers >= _MOST:
            raise InvalidInput(f"{_MOST} pages watch the run already; close one")
        headers = {"cache-control": "no-store", "content-encoding": "identity"}
        return StreamingResponse(self._frames(), media_type="application/x-ndjson", headers=headers)

    async def _frames(self) -> AsyncIterator[bytes]:
        """Frames with news, at most 25 a second; a reader that is slow gets fewer, and the run waits for none."""
        self._readers += 1
        try:
            async for frame in self._news():
                yield encoded(frame) + b"\n"
        finally:
            self._readers -= 1

    async def _news(self) -> AsyncIterator[dict[str, Any]]:
        """Frames with news, and one a second without; the last is that of the end."""
        last, shown, silent = -1, "", 0.0
        while True:
            is_last = self._live.has_ended.is_set()
            frame, newest = self._live.frame(last)
            news = f"{frame['state']} {frame['prompt']} {frame['is_paused']} {len(frame['trips'])} {frame['step']}"
            if newest > last or news != shown or silent >= _SILENCE or is_last:
                last, shown, silent = max(newest, last), news, 0.0
                yield frame
            if is_last and newest <= last and not frame["channels"]:
                return
            await asyncio.sleep(_FRAME)
            silent += _FRAME


async def _static(request: Request) -> Response:
    """File of the page."""
    if request.path_params["name"] not in _STATIC:
        return Response("There is no such file.", status_code=404, media_type="text/plain")
    return await static_file(request)


def _json(content: dict[str, Any]) -> Response:
    """Answer as JSON; numbers that JSON lacks become null."""
    return Response(encoded(content), media_type="application/json", headers={"cache-control": "no-store"})


def stop_page(status: dict[str, Any]) -> str:
    """HTML of the page for a state of the run."""
    template = files("sonolube.browser").joinpath("static/stop.html").read_text(encoding="utf-8")
    is_ended, is_safe = status["is_ended"], status["state"] != "failed"
    if is_ended:
        outputs = status.get("outputs") or ("off" if is_safe else "cut the power: they may be on")
        head = f"The run has ended; motor and drive: {outputs}"
    else:
        head = "Stopping: motor and drive are being switched off" if status["is_stopping"] else "A run is at work"
    facts = {
        "run": status.get("title") or status.get("protocol") or "",
        "state": f"{status['outcome'] or status['state']}{': ' if status['reason'] else ''}{status['reason']}",
        "step": f"{status['step']} {status['kind'].replace('_', ' ')}".strip(),
        "time": f"{status['time']:.1f} s of {status.get('total') or 0.0:.1f} s",
        "record": status["folder"],
    }
    rows = "".join(f"<dt>{name}</dt><dd>{escape(str(text))}</dd>" for name, text in facts.items() if text)
    button = '<form method="post" action="stop"><button class="stop" type="submit" autofocus>Stop</button></form>'
    note = "Stop switches motor and drive off after the present block of samples, and keeps the record."
    replaced = {
        "HEAD": escape(head),
        "CLASS": "" if is_safe else ' class="danger"',
        "BUTTON": "" if is_ended else f'{button}<p>{note}</p><p><a href="./">Look again</a></p>',
        "FACTS": rows,
        "SAFETY": escape(SAFETY),
    }
    for name, text in replaced.items():
        template = template.replace(f"[[{name}]]", text)
    return template
