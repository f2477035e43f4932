"""Thread pools that wait for their work unless the user interrupts, and chunked evaluation of batches."""

import threading
import time

import pytest

from sonolube.errors import InvalidInput
from sonolube.execution.threads import map_chunks, thread_pool, threads_running


def test_a_pool_waits_for_submitted_work() -> None:
    done: list[int] = []

    def slowly(number: int) -> None:
        time.sleep(0.05)
        done.append(number)

    with thread_pool(2) as pool:
        for number in range(4):
            pool.submit(slowly, number)
    assert sorted(done) == [0, 1, 2, 3]
    assert not threads_running()


def test_threads_that_python_does_not_wait_for_do_not_count() -> None:
    held = threading.Event()
    threading.Thread(target=held.wait, daemon=True, name="sonolube stop page").start()
    assert not threads_running()
    held.set()


def interrupted(held: threading.Event, done: list[int]) -> None:
    with thread_pool(1) as pool:
        pool.submit(held.wait, 60)
        pool.submit(done.append, 1)
        raise KeyboardInterrupt


def test_an_interrupted_pool_waits_for_nothing_and_starts_nothing() -> None:
    held, done = threading.Event(), []  # type: ignore[var-annotated]
    with pytest.raises(KeyboardInterrupt):
        interrupted(held, done)
    assert threads_running()
    held.set()
    while threads_running():
        time.sleep(0.01)
    assert done == []


@pytest.mark.parametrize("workers", [1, 3])
@pytest.mark.parametrize("points", [0, 1, 7, 40_000])
def test_chunks_cover_a_batch_in_order(points: int, workers: int) -> None:
    chunks = map_chunks(lambda chunk: range(points)[chunk], points, workers)
    assert [point for chunk in chunks for point in chunk] == list(range(points))


def test_no_workers_are_refused() -> None:
    with pytest.raises(InvalidInput, match="workers must be at least 1, got 0"):
        map_chunks(lambda chunk: chunk, 3, 0)
