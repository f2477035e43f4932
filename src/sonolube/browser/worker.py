"""Warm worker processes: each imports sonolube once, then answers one request at a time, within limits.

One that hangs or dies is replaced.
"""

import asyncio
import contextlib
import gc
import json
import multiprocessing
import os
import signal
import tempfile
from collections.abc import Awaitable, Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Final

from sonolube.browser.requests import OPENED, Places
from sonolube.errors import SonolubeError, UnexpectedFault
from sonolube.tasks.faults import unexpected

_REFUSED, _FAILED = 422, 500
_GIBIBYTE: Final = 2**30


def limit_process(*, memory: int = 2 * _GIBIBYTE, file_size: int = _GIBIBYTE, cpu_time: int | None = None) -> None:
    """Limit what this process may use, where the system has such limits: bytes of memory and of a file, seconds."""
    try:
        import resource
    except ImportError:  # Windows
        return
    limits = {resource.RLIMIT_DATA: memory, resource.RLIMIT_FSIZE: file_size}
    if cpu_time is not None:
        limits[resource.RLIMIT_CPU] = cpu_time
    for kind, most in limits.items():
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(kind, (most, most))


def serve(connection: Connection, folder: str, warm: Connection) -> None:
    """Answer requests from a connection until it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its workers
    os.chdir(folder)
    limit_process()
    warm_up()
    with contextlib.suppress(OSError):  # where the workbench has ended meanwhile, as the next line sees
        warm.send(True)
    while True:
        try:
            request = connection.recv()
        except (EOFError, OSError):
            return
        answer = reply(*request)
        try:
            connection.send(answer)
        except OSError:
            return


def warm_up() -> None:
    """Import what most requests need, and load the kernels of a first prediction."""
    with contextlib.suppress(SonolubeError):
        reply("task", {"task": "predict", "arguments": {"rig": {"name": OPENED}, "draws": 200}}, Places(rigs={}))
    gc.collect()
    gc.freeze()  # modules and kernels stay, so that later collections need not look at them


def reply(kind: str, payload: Mapping[str, Any], places: Places) -> tuple[int, bytes]:
    """Status and JSON of the answer to a request."""
    from sonolube.browser.answers import refusal_object
    from sonolube.browser.requests import KINDS

    try:
        with _recipes(places):
            return 200, encoded(KINDS[kind](payload, places))
    except UnexpectedFault as fault:
        return _FAILED, _one_line(str(fault))
    except (SonolubeError, OSError) as failure:  # as the terminal does
        return _REFUSED, encoded(refusal_object(failure))
    except MemoryError:
        return _REFUSED, _one_line(
            "does not fit into the memory of a worker; ask for fewer points, or use the terminal"
        )
    except (Exception, SystemExit) as failure:  # whatever a task raises, the worker answers the next request
        return _FAILED, _one_line(str(unexpected(failure, kind, payload)))


def _recipes(places: Places) -> AbstractContextManager[None]:
    """Look for recipes of instruments in the folder of the rig first, where one is open."""
    if not places.folder:
        return nullcontext()
    from sonolube.measurement.recordings.reader import recipes_first_in
    from sonolube.rig.file.rig_folder import INSTRUMENTS

    return recipes_first_in(Path(places.folder, INSTRUMENTS))


def _one_line(text: str) -> bytes:
    """Refusal of a request as a whole."""
    return encoded({"text": text, "faults": [{"key": "", "text": text}]})


def encoded(content: Any) -> bytes:
    """JSON as bytes; numbers that JSON lacks become null."""
    try:
        return json.dumps(content, allow_nan=False).encode()
    except ValueError:
        return json.dumps(_finite(content)).encode()


def _finite(content: Any) -> Any:
    """Content with None in place of values that are not finite."""
    if isinstance(content, float):
        return content if content - content == 0.0 else None
    if isinstance(content, Mapping):
        return {key: _finite(value) for key, value in content.items()}
    return [_finite(each) for each in content] if isinstance(content, list | tuple) else content


_LONGEST: Final = 120.0  # seconds of one request, beyond which it belongs to a job
_BETWEEN: Final = 0.5  # seconds between questions whether somebody still waits
_DIED: Final = 503
_CONTEXT: Final = multiprocessing.get_context("spawn")


class _Worker:
    """One process with its connection."""

    def __init__(self, folder: str) -> None:
        self.connection, other = _CONTEXT.Pipe()
        self._warm, warm = _CONTEXT.Pipe(duplex=False)
        self.process: BaseProcess = _CONTEXT.Process(target=serve, args=(other, folder, warm), daemon=True)
        self.process.start()
        other.close()
        warm.close()

    @property
    def is_warm(self) -> bool:
        """Whether it has imported what most requests need, or has ended."""
        return self._warm.poll()

    def ask(self, request: tuple[str, Mapping[str, Any], Places], longest: float) -> tuple[int, bytes]:
        """Answer to a request; the process is dead afterwards where it did not answer in time."""
        try:
            self.connection.send(request)
            if self.connection.poll(longest):
                found: tuple[int, bytes] = self.connection.recv()
                return found
            text = f"took longer than {longest:.0f} s; start it as a job, or ask for fewer points"
        except (EOFError, OSError):
            text = self._ended()
        self.end()
        return _DIED, _one_line(text)

    def _ended(self) -> str:
        """Line on the end of the process: a fault of the program where it has ended by itself."""
        self.process.join(1.0)
        code = self.process.exitcode
        if code is None or code < 0:  # a signal, as the system sends where memory runs out
            return "the process that computed this has ended; ask again, with fewer points if it needs much memory"
        return f"the process that computed this has ended itself (code {code}), a fault of sonolube; please report it"

    def end(self) -> None:
        """End the process."""
        with contextlib.suppress(OSError):
            self.connection.close()
        self.process.kill()
        self.process.join(1.0)


class Pool:
    """Workers that answer requests in the order in which they come.

    The first one starts at the first request, or as `start` says, so that the first page in the browser has the
    processors before; the others start when it has.

    Parameters
    ----------
    count : int
        Number of processes.
    """

    def __init__(self, count: int) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="sonolube-work-")
        self._threads = ThreadPoolExecutor(count, thread_name_prefix="worker")
        self._count = count
        self._workers: list[_Worker] = []
        self._free: asyncio.Queue[int] = asyncio.Queue()
        self._free.put_nowait(0)
        self._starting: list[int] = []

    @property
    def is_warm(self) -> bool:
        """Whether the first worker has imported what most requests need."""
        return bool(self._workers) and self._workers[0].is_warm

    def start(self) -> None:
        """Start the first worker, where it has not started yet."""
        if not self._workers:
            self._workers.append(_Worker(self._folder.name))

    def _widen(self) -> None:
        """Start the other workers once the first is warm, and let in those that are."""
        if len(self._workers) < self._count and self.is_warm:
            self._starting = list(range(1, self._count))
            self._workers += [_Worker(self._folder.name) for _ in self._starting]
        for place in [place for place in self._starting if self._workers[place].is_warm]:
            self._starting.remove(place)
            self._free.put_nowait(place)

    async def ask(
        self,
        kind: str,
        payload: Mapping[str, Any],
        places: Places,
        *,
        longest: float = _LONGEST,
        is_gone: Callable[[], Awaitable[bool]] | None = None,
    ) -> tuple[int, bytes]:
        """Status and JSON of the answer to a request."""
        self.start()
        self._widen()
        place = await self._free.get()
        try:
            worker = self._workers[place]
            if not worker.process.is_alive():
                worker = self._workers[place] = _Worker(self._folder.name)
            loop = asyncio.get_running_loop()
            answer = loop.run_in_executor(self._threads, worker.ask, (kind, payload, places), longest)
            while not (await asyncio.wait({answer}, timeout=_BETWEEN))[0]:
                if is_gone is not None and await is_gone():
                    worker.process.kill()
            return await answer
        finally:
            self._free.put_nowait(place)
            self._widen()

    async def answer(self, kind: str, payload: Mapping[str, Any], places: Places) -> tuple[int, dict[str, Any]]:
        """Status of the answer to a request, and its object."""
        status, body = await self.ask(kind, payload, places)
        found: dict[str, Any] = json.loads(body)
        return status, found

    def end(self) -> None:
        """End all workers."""
        for worker in self._workers:
            worker.end()
        self._threads.shutdown(wait=False, cancel_futures=True)
        self._folder.cleanup()
