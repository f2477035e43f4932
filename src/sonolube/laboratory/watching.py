"""Watchers of a run: told its set points, blocks and events while it goes on; none can hold or end a run."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Protocol

from sonolube.facts.protocol import SetPoint
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.interlocks import Interlock


class RunWatcher(Protocol):
    """Watcher of a run.

    Notes
    -----
    Its methods are called by the thread that holds the run to its limits: they must return at once, as by appending to
    a queue of bounded length. What they raise is dropped. They are told, not asked: no answer reaches the run.
    """

    def records(self, folder: Path) -> None:
        """Take the folder of the record, before anything is connected."""

    def begins(self, channels: Mapping[str, Channel], locks: Sequence[Interlock]) -> None:
        """Take the channels of all acquisitions by name, and the limits that they are held to."""

    def reaches(self, point: SetPoint) -> None:
        """Take the set point that is to hold from now on."""

    def takes(self, names: Sequence[str], block: Block, *, time: float) -> None:
        """Take a block of channels, whose first sample is at a time of the protocol, in s."""

    def takes_aside(self, names: Sequence[str], block: Block) -> None:
        """Take a block that the clock of the protocol does not time: of another clock, or while an operator is asked.

        Called by other threads than that of the run.
        """

    def notes(self, kind: str, facts: Mapping[str, str | float]) -> None:
        """Take an event as the record has it."""


def told(watcher: RunWatcher | None, tell: Callable[[RunWatcher], object]) -> None:
    """Tell a watcher where there is one; what it raises is dropped."""
    if watcher is not None:
        with suppress(Exception):
            tell(watcher)
