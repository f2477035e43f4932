"""Routes of the workbench: pages and their files, tasks, rigs, uploads and jobs.

Scripts, styles and drawings are kept in memory as they are sent: compressed and tagged by content.
"""

import gzip
import json
from collections.abc import Mapping
from dataclasses import asdict
from functools import cache
from hashlib import sha256
from importlib.resources import files
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import Any, Final

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Route

from sonolube.browser.first_page import shipped_answer
from sonolube.browser.jobs import KEPT_DAYS, Jobs
from sonolube.browser.kinds import VIEWS
from sonolube.browser.places import Places
from sonolube.browser.uploads import Uploads
from sonolube.browser.worker import Pool
from sonolube.errors import InvalidInput, SonolubeError, UnknownName

_FOLDER: Final = Path(str(files("sonolube.browser"))) / "static"
_KINDS: Final = MappingProxyType(
    {
        ".js": "text/javascript; charset=utf-8",
        ".css": "text/css; charset=utf-8",
        ".html": "text/html; charset=utf-8",
        ".json": "application/json",
        ".svg": "image/svg+xml",
    }
)
_PLAIN: Final = "text/plain; charset=utf-8"
_LEVEL: Final = 6  # of the compression, once a file


async def static_file(request: Request) -> Response:
    """File below `static` of a request, by its path; 404 where there is none, 304 where the browser has it."""
    name = request.path_params["name"]
    if name not in _names():
        return Response("There is no such file.", status_code=404, media_type="text/plain")
    content, compressed, kind, tag = _kept(name)
    headers = {"cache-control": "no-cache", "etag": tag, "vary": "Accept-Encoding"}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return Response(content, media_type=kind, headers=headers)
    return Response(compressed, media_type=kind, headers=headers | {"content-encoding": "gzip"})


@cache
def _names() -> frozenset[str]:
    """Paths of all files, with slashes."""
    return frozenset(path.relative_to(_FOLDER).as_posix() for path in _FOLDER.rglob("*") if path.is_file())


@cache
def _kept(name: str) -> tuple[bytes, bytes, str, str]:
    """Content of a file, read and compressed once."""
    content = (_FOLDER / name).read_bytes()
    kind = _KINDS.get(PurePosixPath(name).suffix, _PLAIN)
    compressed = gzip.compress(content, _LEVEL, mtime=0)
    return content, compressed, kind, f'"{sha256(content).hexdigest()[:16]}"'


_LARGEST_REQUEST: Final = 4 * 2**20  # bytes of JSON
_JSON: Final = "application/json"


class Workbench:
    """Endpoints of the pages, with pool, jobs and uploads behind them.

    Parameters
    ----------
    pool : Pool
    jobs : Jobs
    uploads : Uploads
    rigs : mapping of str to str
        Paths of rig files by name, beside the examples.
    opened : str
        Name of the rig that the first page shows.
    """

    def __init__(self, *, pool: Pool, jobs: Jobs, uploads: Uploads, rigs: Mapping[str, str], opened: str) -> None:
        self.pool, self.jobs, self.uploads, self.opened = pool, jobs, uploads, opened
        self._places = Places(rigs=dict(rigs), uploads=str(uploads.folder))

    def application(self) -> Starlette:
        """Application by ASGI, without the checks of `Guard`."""
        routes = [
            Route("/", self._page),
            Route("/api/start", self._start),
            Route("/api/description", self._description, methods=["GET"]),
            Route("/api/tasks/{name:path}", self._task, methods=["POST"]),
            Route("/api/uploads", self._upload, methods=["POST"]),
            Route("/api/jobs", self._list_jobs, methods=["GET"]),
            Route("/api/jobs", self._start_job, methods=["POST"]),
            Route("/api/jobs/{id}", self._job, methods=["GET"]),
            Route("/api/jobs/{id}", self._delete_job, methods=["DELETE"]),
            Route("/api/jobs/{id}/cancel", self._cancel_job, methods=["POST"]),
            Route("/api/jobs/{id}/result", self._job_result, methods=["GET"]),
            Route("/api/jobs/{id}/files/{name:path}", self._job_file, methods=["GET"]),
            Route("/api/{kind}", self._view, methods=["POST"]),
            Route("/static/{name:path}", static_file, methods=["GET"]),
        ]
        middleware = [Middleware(GZipMiddleware, minimum_size=500, compresslevel=4)]
        return Starlette(routes=routes, middleware=middleware, exception_handlers={SonolubeError: _refusal})

    async def _page(self, request: Request) -> Response:
        """The one page; everything else is in its scripts."""
        del request
        content = files("sonolube.browser").joinpath("static/index.html").read_bytes()
        return Response(content, media_type="text/html", headers={"cache-control": "no-cache"})

    async def _start(self, request: Request) -> Response:
        """Rig that the first page shows, and what is offered."""
        del request
        from sonolube import __version__

        return _json({"rig": self.opened, "version": __version__})

    async def _description(self, request: Request) -> Response:
        """OpenAPI description of the tasks."""
        return await self._ask("description", {}, request)

    async def _view(self, request: Request) -> Response:
        """What a page shows beside the answers of tasks, such as the fields of a rig, or a file to take away."""
        kind = request.path_params["kind"]
        if kind not in VIEWS:
            raise UnknownName.among(list(VIEWS), kind="view", name=kind)
        return await self._ask(kind, await _content(request), request)

    async def _task(self, request: Request) -> Response:
        """Answer of a task; `?tables=no` leaves out the tables of its charts, as while a slider moves."""
        name = request.path_params["name"].replace("/", " ")
        less = {"tables": False} if request.query_params.get("tables") == "no" else {}
        return await self._ask("task", {"task": name, "arguments": await _content(request)} | less, request)

    async def _ask(self, kind: str, payload: Mapping[str, Any], request: Request | None = None) -> Response:
        """Answer of a worker, which is ended where it computes long and the page waits no more.

        While the workers start, the first page gets the shipped one.
        """
        shipped = None if self.pool.is_warm or self._places.rigs else shipped_answer(kind, payload)
        gone = None if request is None else request.is_disconnected
        status, body = (200, shipped) if shipped else await self.pool.ask(kind, payload, self._places, is_gone=gone)
        return Response(body, status_code=status, media_type=_JSON, headers={"cache-control": "no-store"})

    async def _upload(self, request: Request) -> Response:
        """Name of an uploaded file."""
        length = request.headers.get("content-length", "")
        announced = int(length) if length.isdigit() else None
        return _json({"upload": await self.uploads.keep(request.stream(), length=announced)})

    async def _list_jobs(self, request: Request) -> Response:
        """All jobs."""
        del request
        jobs = [asdict(job) for job in self.jobs.list()]
        return _json({"jobs": jobs, "days": KEPT_DAYS, "folder": self.jobs.folder.name})

    async def _start_job(self, request: Request) -> Response:
        """Record of a job that was started."""
        content = await _content(request)
        places = {"rigs": dict(self._places.rigs), "uploads": self._places.uploads}
        task, label = str(content.get("task", "")), str(content.get("label", ""))[:200]
        _require_task(task)
        return _json(asdict(self.jobs.start(task, content.get("arguments") or {}, label=label, places=places)))

    async def _job(self, request: Request) -> Response:
        """Record of a job."""
        name = request.path_params["id"]
        self.jobs.tend()
        return _json(asdict(self.jobs.job(name)) | {"request": self.jobs.request(name)})

    async def _delete_job(self, request: Request) -> Response:
        """Name of a job that was deleted."""
        name = request.path_params["id"]
        self.jobs.tend()
        self.jobs.delete(name)
        return _json({"deleted": name})

    async def _cancel_job(self, request: Request) -> Response:
        """Record of a job that was stopped."""
        return _json(asdict(self.jobs.cancel(request.path_params["id"])))

    async def _job_result(self, request: Request) -> Response:
        """Answer of a job that is done."""
        self.jobs.tend()
        return Response(self.jobs.result(request.path_params["id"]), media_type=_JSON)

    async def _job_file(self, request: Request) -> Response:
        """File of the answer of a job."""
        path = self.jobs.file(request.path_params["id"], request.path_params["name"])
        return FileResponse(path, headers={"content-disposition": f'attachment; filename="{path.name}"'})


def _require_task(name: str) -> None:
    """Raise if there is no task of this name; which of them are offered, the process of the job says."""
    from sonolube.tasks.table import TASKS

    if name not in {task.name for task in TASKS}:
        raise InvalidInput(f"task: there is none named {name[:60]!r}", key="task")


async def _refusal(request: Request, failure: Exception) -> Response:
    """Refusal as JSON."""
    del request
    text = str(failure)
    return _json({"text": text, "faults": [{"key": getattr(failure, "key", ""), "text": text}]}, status=422)


async def _content(request: Request) -> dict[str, Any]:
    """Object of a request as JSON."""
    body = bytearray()
    async for part in request.stream():
        body += part
        if len(body) > _LARGEST_REQUEST:
            raise InvalidInput("the request is larger than 4 MiB; upload files instead")
    try:
        content = json.loads(body or b"{}", parse_constant=_refuse_constant)
    except (ValueError, RecursionError):
        raise InvalidInput("the request is no JSON") from None
    if not isinstance(content, dict):
        raise InvalidInput("the request is no object of JSON")
    return content


def _refuse_constant(name: str) -> None:
    """Refuse constants that JSON lacks."""
    raise ValueError(name)


def _json(content: Mapping[str, Any], *, status: int = 200) -> Response:
    """Answer as JSON."""
    body = json.dumps(content).encode()
    return Response(body, status_code=status, media_type=_JSON, headers={"cache-control": "no-store"})
