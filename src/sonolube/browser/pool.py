"""Warm worker processes: each answers one request at a time; one that hangs or dies is replaced."""

import asyncio
import contextlib
import json
import multiprocessing
import tempfile
from collections.abc import Awaitable, Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.process import BaseProcess
from typing import Any, Final

from sonolube.browser.places import Places
from sonolube.browser.worker import serve

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

    The first one starts alone, so that it and the first page in the browser share the processors; the others start when
    it has.

    Parameters
    ----------
    count : int
        Number of processes.
    """

    def __init__(self, count: int) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="sonolube-work-")
        self._threads = ThreadPoolExecutor(count, thread_name_prefix="worker")
        self._count, self._workers = count, [_Worker(self._folder.name)]
        self._free: asyncio.Queue[int] = asyncio.Queue()
        self._free.put_nowait(0)
        self._starting: list[int] = []

    @property
    def is_warm(self) -> bool:
        """Whether the first worker has imported what most requests need."""
        return self._workers[0].is_warm

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

    def end(self) -> None:
        """End all workers."""
        for worker in self._workers:
            worker.end()
        self._threads.shutdown(wait=False, cancel_futures=True)
        self._folder.cleanup()
