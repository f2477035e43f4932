"""Routes of page Lab: state, hold, start and stop of runs, their frames, and runs on disk.

A run is never in this process: it is started in one of its own, found again by its record, and asked by its own server.
"""

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from threading import Thread
from typing import Any, Final

from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.routing import Route

from sonolube.browser.lab.hold import Hold
from sonolube.browser.lab.runner_client import NoAnswer, asked, stream
from sonolube.browser.lab.runner_records import (
    END,
    SAFETY,
    RunnerRecord,
    new_record,
    read_record,
    record_names,
    write_private,
)
from sonolube.browser.messages import JSON, content_of, json_response
from sonolube.browser.requests import Places
from sonolube.browser.uploads import Uploads
from sonolube.browser.worker import Pool
from sonolube.errors import InvalidInput
from sonolube.operating_system import ON_WINDOWS

_STARTING: Final = 120.0  # s, until the process of a run listens
_POLL: Final = 0.05  # s
_STOPPING: Final = 5.0  # s, until a signal stops a run whose process does not answer; an answer takes up to 3 s
_LOOKING: Final = 3.0  # s, for the state of a run
_LOOPBACK: Final = ("localhost", "127.0.0.1")
_PART: Final = 2**20  # bytes
_LOST: Final = (
    "The program of the run {title!r} was killed and has switched nothing off: motor or drive may be on. Cut the power"
    " of the rig, see that both are off, then recover the record."
)


class Laboratory:
    """Endpoints of page Lab.

    Parameters
    ----------
    pool : Pool
    uploads : Uploads
    places : Places
    folder : Path
        Of the records of runners.
    """

    def __init__(self, *, pool: Pool, uploads: Uploads, places: Places, folder: Path) -> None:
        self._pool, self._uploads, self._places, self._folder = pool, uploads, places, folder
        self._hold = Hold(folder)
        self._devices: dict[str, Any] | None = None
        self._starting = asyncio.Lock()
        self._seen: dict[str, Any] = {}  # of the run that answered last
        self._ended: dict[str, RunnerRecord] = {}  # by their names, which change no more

    def routes(self) -> list[Route]:
        """Routes below `/api/lab`."""
        return [
            Route("/api/lab", self._state, methods=["GET"]),
            Route("/api/lab/hold", self._take, methods=["POST"]),
            Route("/api/lab/release", self._release, methods=["POST"]),
            Route("/api/lab/start", self._start, methods=["POST"]),
            Route("/api/lab/pause", self._steer, methods=["POST"]),
            Route("/api/lab/resume", self._steer, methods=["POST"]),
            Route("/api/lab/confirm", self._steer, methods=["POST"]),
            Route("/api/lab/stop", self._stop, methods=["POST"]),
            Route("/api/lab/recover", self._recover, methods=["POST"]),
            Route("/api/lab/live", self._live, methods=["GET"]),
            Route("/api/lab/compare", self._compare, methods=["POST"]),
            Route("/api/lab/runs", self._runs, methods=["GET"]),
            Route("/api/lab/runs/{id}", self._run, methods=["GET"]),
            Route("/api/lab/runs/{id}/upload", self._upload, methods=["POST"]),
        ]

    def is_at_work(self) -> bool:
        """Whether a run is at work."""
        return self._at_work() is not None

    def end(self) -> str:
        """Link of the stop page of a run that goes on without this process; empty where none is at work."""
        record = self._at_work()
        return "" if record is None else record.link()

    async def _state(self, request: Request) -> Response:
        """State of the laboratory."""
        return await self._shown(request, request.query_params.get("holder", ""))

    async def _shown(self, request: Request, holder: str) -> Response:
        """State of the laboratory for a tab."""
        devices = await self._known_devices()
        record, lost = self._latest(), self._lost()
        state = {
            "runs_folder": Path(self._places.runs).name,
            "holder": self._hold.state(holder),
            "safety": SAFETY,
            "run": None if record is None else await self._told(record, request),
            "lost": None
            if lost is None
            else {"id": lost.id, "text": _LOST.format(title=str(lost.about.get("title", lost.id)))},
        }
        return json_response(devices | state)

    async def _known_devices(self) -> dict[str, Any]:
        """Devices and protocols, which a worker has read once.

        Raises
        ------
        InvalidInput
            If the map of devices cannot be read any more.
        """
        if self._devices is None:
            status, found = await self._pool.answer("lab_devices", {}, self._places)
            if status != 200:
                raise InvalidInput(str(found.get("text", "")))
            self._devices = found
        return self._devices

    async def _take(self, request: Request) -> Response:
        """State, after the hold was taken."""
        holder = _holder(await content_of(request))
        await self._known_devices()  # which may take a worker longer than a hold lasts
        self._hold.take(holder)
        return await self._shown(request, holder)

    async def _release(self, request: Request) -> Response:
        """State, after the hold was released."""
        holder = _holder(await content_of(request))
        self._hold.release(holder)
        return await self._shown(request, holder)

    async def _start(self, request: Request) -> Response:
        """State of a run that was started in a process of its own."""
        content = await content_of(request)
        self._hold.require(_holder(content))
        async with self._starting:
            self._require_idle()
            wanted = {key: value for key, value in content.items() if key != "holder"}
            status, plan = await self._pool.answer("lab_plan", wanted, self._places)
            if status != 200:
                return json_response(plan, status=status)
            record = await self._spawned(plan)
        with suppress(InvalidInput):
            self._hold.take(_holder(content))  # of which nothing was heard while this took
        link = record.link()
        sys.stdout.write(f"A run has started. It can be stopped at {link}\n")
        sys.stdout.flush()
        return json_response(await self._told(record, request))

    async def _spawned(self, plan: Mapping[str, Any]) -> RunnerRecord:
        """Record of a runner whose process listens."""
        record = new_record(self._folder, {**plan, "places": asdict(self._places)})
        command = [sys.executable, "-m", "sonolube.browser.lab.runner", str(record.folder)]
        flags = subprocess.CREATE_NEW_PROCESS_GROUP | subprocess.DETACHED_PROCESS if ON_WINDOWS else 0  # type: ignore[attr-defined,unused-ignore]
        with (record.folder / "log.txt").open("xb") as log:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                cwd=record.folder,
                start_new_session=True,  # no signal of this terminal reaches it
                creationflags=flags,
            )
        Thread(target=process.wait, daemon=True, name="sonolube run").start()  # so that its end is noticed
        waited = 0.0
        while (record := read_record(self._folder, record.id)).process is None:
            if process.poll() is not None or waited > _STARTING:
                ended = {"state": "safe", "outcome": "refused", "reason": "its process did not start", "is_ended": True}
                write_private(record.folder / END, _bare(record) | ended)
                raise InvalidInput(f"the process of the run did not start; {record.folder / 'log.txt'} says why")
            await asyncio.sleep(_POLL)
            waited += _POLL
        return record

    async def _steer(self, request: Request) -> Response:
        """State of the run after it was asked to pause or resume, or a prompt was answered; for the holder."""
        content = await content_of(request)
        self._hold.require(_holder(content))
        record = self._require_at_work()
        told = {key: content.get(key) for key in ("number", "is_done")}
        await asked(record, "POST", "/" + request.url.path.rpartition("/")[2], told)
        return json_response(await self._told(record, request))

    async def _stop(self, request: Request) -> Response:
        """State of the run after it was asked to stop, by anybody."""
        record = self._require_at_work()
        try:
            await asked(record, "POST", "/stop", longest=_STOPPING)
        except NoAnswer:
            if ON_WINDOWS:  # where a signal would end the process at once, and its outputs stay on
                raise
            if record.process is not None and record.is_alive:
                os.kill(record.process, signal.SIGTERM)  # which ends the run in order, too
        return json_response(await self._told(read_record(self._folder, record.id), request))

    async def _recover(self, request: Request) -> Response:
        """What was mended of a lost run, whose operator has seen that motor and drive are off."""
        content = await content_of(request)
        self._hold.require(_holder(content))
        lost = self._lost()
        if lost is None:
            raise InvalidInput("no run was killed; there is nothing to recover")
        if content.get("is_off") is not True:
            raise InvalidInput("is_off: say true when you have seen that motor and drive are off", key="is_off")
        status, found = await self._pool.answer("lab_recover", {"folder": lost.run_folder}, self._places)
        if status == 200:
            _write_end(lost, "safe", "the operator has cut the power and seen that motor and drive are off")
        return json_response(found, status=status)

    async def _live(self, request: Request) -> Response:
        """Frames of the run at work."""
        del request
        record = self._require_at_work()
        headers = {"cache-control": "no-store", "content-encoding": "identity", "x-accel-buffering": "no"}
        return StreamingResponse(stream(record), media_type="application/x-ndjson", headers=headers)

    async def _runs(self, request: Request) -> Response:
        """Runs on disk."""
        return await self._worked(request, "lab_runs", {})

    async def _run(self, request: Request) -> Response:
        """Record of a run."""
        return await self._worked(request, "lab_show", {"id": request.path_params["id"]})

    async def _upload(self, request: Request) -> Response:
        """Recording of a run as an upload."""
        wanted = {"id": request.path_params["id"], "part": (await content_of(request)).get("part", 1)}
        status, found = await self._pool.answer("lab_recording", wanted, self._places)
        if status != 200:
            return json_response(found, status=status)
        path = Path(found.pop("path"))
        upload = await self._uploads.keep(_parts_of(path), length=path.stat().st_size)
        return json_response({**found, "upload": upload})

    async def _compare(self, request: Request) -> Response:
        """Levels of several runs in one table, which is an upload too."""
        status, found = await self._pool.answer("lab_compare", await content_of(request), self._places)
        if status != 200:
            return json_response(found, status=status)
        text = found.pop("table").encode()
        return json_response({**found, "upload": await self._uploads.keep(_once(text), length=len(text))})

    async def _worked(self, request: Request, kind: str, payload: Mapping[str, Any]) -> Response:
        """Answer of a worker."""
        status, body = await self._pool.ask(kind, payload, self._places, is_gone=request.is_disconnected)
        return Response(body, status_code=status, media_type=JSON, headers={"cache-control": "no-store"})

    async def _told(self, record: RunnerRecord, request: Request) -> dict[str, Any]:
        """State of a run as its page shows it."""
        fixed = {"id": record.id, "process": record.process, "stop_link": ""}
        if record.is_alive:
            with suppress(InvalidInput):
                found = self._seen = await asked(record, "GET", "/status", longest=_LOOKING) | {"id": record.id}
                host = (request.url.hostname or "").lower()
                link = record.link(host if host in _LOOPBACK else "127.0.0.1")
                return found | fixed | {"stop_link": "" if found.get("is_ended") else link}
        record = read_record(self._folder, record.id)
        if record.end is not None:
            return {**record.end, **fixed}
        if record.is_lost:
            return _bare(record) | {"state": "lost", "is_lost": True} | fixed
        silent = {"reason": f"its process, {record.process}, does not answer; stop it here, or by its own page"}
        known = self._seen if self._seen.get("id") == record.id else _bare(record)
        return known | silent | fixed | {"stop_link": record.link()}

    def _records(self) -> Iterator[RunnerRecord]:
        """Records of runners that have listened or ended, the latest first; those that have ended are read once."""
        names = record_names(self._folder)
        self._ended = {name: self._ended[name] for name in names if name in self._ended}
        for name in names:
            record = self._ended.get(name) or _settled(read_record(self._folder, name))
            if record.end is not None:
                self._ended[name] = record
            if record.process is not None or record.end is not None:
                yield record

    def _latest(self) -> RunnerRecord | None:
        """Record of the run at work, else of the latest one."""
        return self._at_work() or next(self._records(), None)

    def _at_work(self) -> RunnerRecord | None:
        """Record of the run at work; None where there is none."""
        return next((each for each in self._records() if each.end is None and each.is_alive), None)

    def _lost(self) -> RunnerRecord | None:
        """Record of a run that was killed and not yet recovered."""
        return next((each for each in self._records() if each.is_lost), None)

    def _require_at_work(self) -> RunnerRecord:
        """Record of the run at work."""
        record = self._at_work()
        if record is None:
            raise InvalidInput("no run is at work")
        return record

    def _require_idle(self) -> None:
        """Raise where a run is at work, or was killed and not recovered."""
        if self._at_work() is not None:
            raise InvalidInput("a run is at work; wait for its end, or stop it")
        lost = self._lost()
        if lost is not None:
            raise InvalidInput(_LOST.format(title=str(lost.about.get("title", lost.id))), key="lost")


def _settled(record: RunnerRecord) -> RunnerRecord:
    """Record of a runner; of one that was killed, as its switch-off process has ended the run."""
    if not record.is_lost or not record.run_folder:
        return record
    from sonolube.laboratory.records import last_verdict
    from sonolube.laboratory.verdict import Outputs

    outputs = last_verdict(Path(record.run_folder))
    if not outputs:
        return record
    _write_end(record, "failed" if outputs.startswith(Outputs.CUT_THE_POWER.value) else "safe", outputs)
    return read_record(record.folder.parent, record.id)


def _write_end(record: RunnerRecord, state: str, outputs: str) -> None:
    """Write how a run has ended whose program was killed."""
    ended = {"state": state, "outcome": "failed", "reason": "its program was killed", "outputs": outputs}
    write_private(record.folder / END, {**_bare(record), **ended, "is_ended": True})


def _holder(content: Mapping[str, Any]) -> str:
    """Name of the tab that asks."""
    holder = content.get("holder", "")
    return holder if isinstance(holder, str) else ""


def _bare(record: RunnerRecord) -> dict[str, Any]:
    """State of a run of which nothing but its request is known."""
    nothing = dict.fromkeys(("outcome", "reason", "outputs", "step", "kind", "doing"), "")
    return {
        **record.about,
        **nothing,
        "state": "preparing",
        "folder": Path(record.run_folder).name,
        "time": 0.0,
        "prompt": None,
        "trips": [],
        "is_paused": False,
        "is_stopping": False,
        "is_ended": False,
        "is_lost": False,
    }


async def _parts_of(path: Path) -> AsyncIterator[bytes]:
    """Content of a file in parts."""
    with path.open("rb") as file:
        while part := file.read(_PART):
            yield part


async def _once(content: bytes) -> AsyncIterator[bytes]:
    """Content as one part."""
    yield content
