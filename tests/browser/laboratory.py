"""Page Lab without a browser: its server in this process, requests to it, and processes of runs."""

import asyncio
import http.client
import json
import time
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from typing import Any, cast
from urllib.parse import urlencode, urlsplit

import uvicorn

from sonolube.browser.access import Access, Guard
from sonolube.browser.jobs import Jobs
from sonolube.browser.requests import Places
from sonolube.browser.routes import Workbench
from sonolube.browser.server import _listening
from sonolube.browser.uploads import Uploads
from sonolube.browser.worker import Pool, reply

TOKEN = "t" * 43
RIG = {"name": "tribometer"}
HOLDER, OTHER = "tab-of-the-operator", "tab-of-a-watcher"
HEAD = """title = "Short"
source = "a test"

[limits]
voltage_maximum = "30 V"
duration_maximum = "100 s"
temperature_maximum = "80 degC"
friction_force_maximum = "50 N"
"""
RECORDED = """
[[steps]]
kind = "acquire"
channels = ["friction_force", "voltage_peak_to_peak", "temperature"]
sample_rate = "400 Hz"
duration = "{duration}"

[[steps]]
kind = "motor_speed"
sliding_speed = "20 mm/s"

[[steps]]
kind = "wait" # before the drive
duration = "0.7 s"

[[steps]]
kind = "drive"
voltage_peak_to_peak = "20 V"
frequency = "22 kHz"
"""
PROMPT = """
[[steps]]
kind = "prompt"
task = "load"
text = "Bring the pin into contact."
"""
SHORT = HEAD + RECORDED.format(duration="1.5 s")
LONG = HEAD + PROMPT + RECORDED.format(duration="60 s")


@dataclass(frozen=True)
class Asked:
    """A server that may be asked, by its port and token."""

    port: int
    token: str

    @property
    def access(self) -> Access:
        return Access(token=self.token, port=self.port)

    def raw(self, method: str, path: str, body: bytes | None = None, **headers: str) -> tuple[int, Any, bytes]:
        """Status, headers and body of an answer; names of headers with _ for -."""
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        with closing(http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)) as connection:
            connection.request(method, path, body=body, headers=named)
            found = connection.getresponse()
            return found.status, found.headers, found.read()

    def get(self, path: str, **headers: str) -> tuple[int, bytes]:
        """Status and body, asked with the cookie."""
        status, _, body = self.raw("GET", path, None, **({"cookie": self.cookie} | headers))
        return status, body

    def post(self, path: str, content: object = None, **headers: str) -> tuple[int, Any]:
        """Status and object, asked with the cookie."""
        body = content if isinstance(content, bytes) else json.dumps(content or {}).encode()
        status, _, found = self.raw("POST", path, body, **({"cookie": self.cookie} | headers))
        return status, json.loads(found)

    @property
    def cookie(self) -> str:
        return f"{self.access.cookie}={self.access.secret}"

    def state(self, holder: str = "") -> dict[str, Any]:
        """State of the laboratory, as a tab asks for it."""
        status, body = self.get(f"/api/lab?{urlencode({'holder': holder})}")
        assert status == 200, body
        found: dict[str, Any] = json.loads(body)
        return found

    def start(self, text: str, *, seed: int = 3, rig: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """State of a run that the operator starts."""
        assert self.post("/api/lab/hold", {"holder": HOLDER})[0] == 200
        asked = {"holder": HOLDER, "protocol": {"name": "short", "text": text}, "rig": rig or RIG, "seed": seed}
        status, run = self.post("/api/lab/start", asked | {"tags": ["tried"], "facts": {"operator": "Ann"}})
        assert status == 200, run
        return cast(dict[str, Any], run)

    def run_when(self, is_so: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
        """State of the run as soon as it is so."""
        found: list[dict[str, Any]] = []

        def looked() -> bool:
            found.append(self.state(HOLDER)["run"])
            assert is_so(found[-1]) or not found[-1]["is_ended"], found[-1]
            return bool(is_so(found[-1]))

        until(looked)
        return found[-1]


def stop_page(run: Mapping[str, Any]) -> Asked:
    """Server of the process of a run, by its link."""
    link = urlsplit(str(run["stop_link"]))
    return Asked(link.port or 0, link.query.partition("=")[2])


def until(is_so: Callable[[], bool]) -> None:
    """Wait for a state; the limit is for what never comes, on a slow machine too."""
    for _ in range(2400):
        if is_so():
            return
        time.sleep(0.05)
    raise AssertionError("the state did not come")


class DirectPool:
    """Pool that answers in a thread of this process."""

    is_warm = True

    async def ask(
        self,
        kind: str,
        payload: Mapping[str, Any],
        places: Places,
        *,
        is_gone: Callable[[], Awaitable[bool]] | None = None,
    ) -> tuple[int, bytes]:
        del is_gone
        return await asyncio.to_thread(reply, kind, payload, places)

    async def answer(self, kind: str, payload: Mapping[str, Any], places: Places) -> tuple[int, dict[str, Any]]:
        status, body = await self.ask(kind, payload, places)
        return status, json.loads(body)


@contextmanager
def laboratory(folder: Path, *, device_map: Path | None = None) -> Iterator[Asked]:
    """Serve page Lab in a thread; its runs below a folder, and at the end none of its runs at work."""
    uploads = Uploads()
    workbench = Workbench(
        pool=cast(Pool, DirectPool()),
        jobs=Jobs(folder / "jobs", most=1),
        uploads=uploads,
        rigs={},
        opened="tribometer",
        device_map=device_map,
        runs=folder / "runs",
    )
    listening = _listening("127.0.0.1", 0)
    asked = Asked(listening.getsockname()[1], TOKEN)
    config = uvicorn.Config(
        Guard(workbench.application(), asked.access), log_level="critical", lifespan="off", timeout_graceful_shutdown=1
    )
    server = uvicorn.Server(config)
    thread = Thread(target=server.run, kwargs={"sockets": [listening]}, daemon=True)
    listening.listen()
    thread.start()
    try:
        yield asked
    finally:
        server.should_exit = True
        thread.join()
        uploads.end()
