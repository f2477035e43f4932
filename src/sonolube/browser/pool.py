"""Warm worker processes: each answers one request at a time; one that hangs or dies is replaced."""

import asyncio
import contextlib
import json
import multiprocessing
import tempfile
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.process import BaseProcess
from typing import Any, Final

from sonolube.browser.places import Places
from sonolube.browser.worker import serve

_LONGEST: Final = 120.0  # seconds of one request, beyond which it belongs to a job
_DIED: Final = 503
_CONTEXT: Final = multiprocessing.get_context("spawn")


class _Worker:
    """One process with its connection."""

    def __init__(self, folder: str) -> None:
        self.connection, other = _CONTEXT.Pipe()
        self.warm = _CONTEXT.Event()
        self.process: BaseProcess = _CONTEXT.Process(target=serve, args=(other, folder, self.warm), daemon=True)
        self.process.start()
        other.close()

    def ask(self, request: tuple[str, Mapping[str, Any], Places], longest: float) -> tuple[int, bytes]:
        """Answer to a request; the process is dead afterwards where it did not answer in time."""
        try:
            self.connection.send(request)
            if self.connection.poll(longest):
                found: tuple[int, bytes] = self.connection.recv()
                return found
            text = f"took longer than {longest:.0f} s; start it as a job, or ask for fewer points"
        except (EOFError, OSError):
            text = "the process that computed this has ended; ask again, with fewer points if it needs much memory"
        self.end()
        return _DIED, json.dumps({"text": text, "faults": [{"key": "", "text": text}]}).encode()

    def end(self) -> None:
        """End the process."""
        with contextlib.suppress(OSError):
            self.connection.close()
        self.process.kill()
        self.process.join(1.0)


class Pool:
    """Workers that answer requests in the order in which they come.

    Parameters
    ----------
    count : int
        Number of processes.
    """

    def __init__(self, count: int) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="sonolube-work-")
        self._threads = ThreadPoolExecutor(count, thread_name_prefix="worker")
        self._workers = [_Worker(self._folder.name) for _ in range(count)]
        self._free: asyncio.Queue[int] = asyncio.Queue()
        for place in range(count):
            self._free.put_nowait(place)

    @property
    def is_warm(self) -> bool:
        """Whether a worker has imported what most requests need."""
        return any(worker.warm.is_set() for worker in self._workers)

    async def ask(
        self, kind: str, payload: Mapping[str, Any], places: Places, *, longest: float = _LONGEST
    ) -> tuple[int, bytes]:
        """Status and JSON of the answer to a request.

        Parameters
        ----------
        kind : str
            Of `KINDS`.
        payload : mapping
        places : Places
        longest : float
            Seconds, after which the worker is ended and a refusal is returned.

        Returns
        -------
        (int, bytes)
        """
        place = await self._free.get()
        try:
            worker = self._workers[place]
            if not worker.process.is_alive():
                worker = self._workers[place] = _Worker(self._folder.name)
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(self._threads, worker.ask, (kind, payload, places), longest)
        finally:
            self._free.put_nowait(place)

    def end(self) -> None:
        """End all workers."""
        for worker in self._workers:
            worker.end()
        self._threads.shutdown(wait=False, cancel_futures=True)
        self._folder.cleanup()
