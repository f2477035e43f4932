"""Threads to share work among, which an interruption does not wait for."""

import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

_NAME = "sonolube"


@contextmanager
def threads(workers: int) -> Iterator[ThreadPoolExecutor]:
    """Give threads for a while; what they have begun is waited for, unless the user interrupts.

    Parameters
    ----------
    workers : int
        At least 1.

    Yields
    ------
    concurrent.futures.ThreadPoolExecutor
    """
    pool, interrupted = ThreadPoolExecutor(workers, _NAME), False
    try:
        yield pool
    except KeyboardInterrupt:
        interrupted = True
        raise
    finally:
        pool.shutdown(wait=not interrupted, cancel_futures=interrupted)


def still_busy() -> bool:
    """Return whether threads of an interrupted run are at work, for which Python would wait before it ends."""
    return any(thread.name.startswith(_NAME) for thread in threading.enumerate())
