"""Routes of the workbench: pages and their files, tasks, rigs, uploads, jobs and the laboratory."""

from collections.abc import Mapping
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import Request
from starlette.responses import FileResponse, Response
from starlette.routing import Route

from sonolube.browser.first_page import shipped_answer
from sonolube.browser.jobs import KEPT_DAYS, Jobs
from sonolube.browser.lab.routes import Laboratory
from sonolube.browser.lab.runner_records import laboratory_folder
from sonolube.browser.messages import (
    JSON as _JSON,
    content_of as _content,
    faulty,
    json_response as _json,
    refused as _refusal,
)
from sonolube.browser.requests import VIEWS, Places
from sonolube.browser.static_files import static_file
from sonolube.browser.uploads import Uploads
from sonolube.browser.worker import Pool
from sonolube.errors import InvalidInput, SonolubeError, UnknownName


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
    device_map : Path or None
        Of the rig of the laboratory; None for the virtual tribometer.
    runs : Path
        Folder of its runs.
    folder : Path or None
        Folder of the rig that is opened; None where that is a file.
    """

    def __init__(
        self,
        *,
        pool: Pool,
        jobs: Jobs,
        uploads: Uploads,
        rigs: Mapping[str, str],
        opened: str,
        device_map: Path | None = None,
        runs: Path = Path("runs"),
        folder: Path | None = None,
    ) -> None:
        self.pool, self.jobs, self.uploads, self.opened = pool, jobs, uploads, opened
        self._places = Places(
            rigs=dict(rigs),
            uploads=str(uploads.folder),
            device_map="" if device_map is None else str(device_map.resolve()),
            runs=str(runs.resolve()),
            folder="" if folder is None else str(folder.resolve()),
        )
        self.laboratory = Laboratory(pool=pool, uploads=uploads, places=self._places, folder=laboratory_folder())

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
            *self.laboratory.routes(),
            Route("/api/{kind}", self._view, methods=["POST"]),
            Route("/static/{name:path}", static_file, methods=["GET"]),
        ]
        middleware = [Middleware(GZipMiddleware, minimum_size=500, compresslevel=4)]
        told = {SonolubeError: _refusal, Exception: faulty}
        return Starlette(routes=routes, middleware=middleware, exception_handlers=told)

    async def _page(self, request: Request) -> Response:
        """The one page; everything else is in its scripts."""
        del request
        content = files("sonolube.browser").joinpath("static/index.html").read_bytes()
        return Response(content, media_type="text/html", headers={"cache-control": "no-cache"})

    async def _start(self, request: Request) -> Response:
        """Rig that the first page shows, and whether a run is at work, for the stop button of every page."""
        del request
        from sonolube import __version__

        return _json(
            {
                "rig": self.opened,
                "is_folder": bool(self._places.folder),
                "version": __version__,
                "is_running": self.laboratory.is_at_work(),
            }
        )

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
