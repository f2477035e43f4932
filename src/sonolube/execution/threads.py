"""Thread pools that a keyboard interrupt does not wait for, and chunked parallel evaluation of batches."""

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from sonolube.errors import InvalidInput
from sonolube.execution.compilation import thread_initializer

Result = TypeVar("Result")

_NAME = "sonolube"
_LARGEST_CHUNK = 16384  # points that a thread treats together at most, to bound the memory


@contextmanager
def thread_pool(workers: int, *, few_points: bool = False) -> Iterator[ThreadPoolExecutor]:
    """Provide a thread pool whose exit waits for submitted work, except after a keyboard interrupt."""
    initializer = thread_initializer() if few_points else None
    pool, interrupted = ThreadPoolExecutor(1 if initializer else workers, _NAME, initializer), False
    try:
        yield pool
    except KeyboardInterrupt:
        interrupted = True
        raise
    finally:
        pool.shutdown(wait=not interrupted, cancel_futures=interrupted)


def threads_running() -> bool:
    """Whether threads of an interrupted run are still at work, which Python would wait for at exit."""
    return any(thread.name.startswith(_NAME) and not thread.daemon for thread in threading.enumerate())


def map_chunks(function: Callable[[slice], Result], points: int, workers: int) -> list[Result]:
    """Results of a function for consecutive chunks of a batch, evaluated by several threads.

    In the order of the points.
    """
    if workers < 1:
        raise InvalidInput(f"workers must be at least 1, got {workers!r}")
    size = min(_LARGEST_CHUNK, max(-(-points // workers), 1))
    chunks = [slice(start, start + size) for start in range(0, max(points, 1), size)]
    if workers == 1 or len(chunks) == 1:
        return [function(chunk) for chunk in chunks]
    with thread_pool(workers) as pool:
        return list(pool.map(function, chunks))
