"""Threads that share work: waited for, unless the user interrupts."""

import threading
import time

import pytest

from sonolube.threads import thread_pool, threads_running


def test_what_was_begun_is_waited_for() -> None:
    done: list[int] = []

    def slowly(number: int) -> None:
        time.sleep(0.05)
        done.append(number)

    with thread_pool(2) as pool:
        for number in range(4):
            pool.submit(slowly, number)
    assert sorted(done) == [0, 1, 2, 3]
    assert not threads_running()


def interrupted(held: threading.Event, done: list[int]) -> None:
    with thread_pool(1) as pool:
        pool.submit(held.wait, 60)
        pool.submit(done.append, 1)
        raise KeyboardInterrupt


def test_an_interruption_waits_for_nothing_and_begins_nothing() -> None:
    held, done = threading.Event(), []  # type: ignore[var-annotated]
    with pytest.raises(KeyboardInterrupt):
        interrupted(held, done)
    assert threads_running()
    held.set()
    while threads_running():
        time.sleep(0.01)
    assert done == []
