"""A clock for the records of runs that goes on when a test says so."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from pytest import MonkeyPatch

_READERS = ("sonolube.laboratory.records.observation.time", "sonolube.laboratory.records.recovery.time")


class Clock:
    """Time of day and a steady clock in place of the module `time`."""

    def __init__(self) -> None:
        self._now = time.time()
        self.offset = 0.0
        """Of the time of day, which somebody sets, before the steady clock. [s]"""
        self.delay = 0.0
        """By which the process is held up when it reads the time of day next. [s]"""

    @classmethod
    @contextmanager
    def installed(cls) -> Iterator["Clock"]:
        """Clock that a run and who observes it read inside a `with` block."""
        clock = cls()
        with MonkeyPatch.context() as patch:
            for reader in _READERS:
                patch.setattr(reader, clock)
            yield clock

    def pass_by(self, seconds: float) -> None:
        """Let time go on."""
        self._now += seconds

    def time(self) -> float:
        """Time since 1970. [s]"""
        told = self._now + self.offset
        self._now, self.delay = self._now + self.delay, 0.0
        return told

    def monotonic(self) -> float:
        """Steady time. [s]"""
        return self._now
