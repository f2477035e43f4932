"""Helpers of tasks called as within a call of their task, with its marks and the arguments that were given."""

from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

from sonolube.rig import Rig
from sonolube.tasks import task as tasks
from sonolube.tasks.parameters import Call
from sonolube.tasks.progress import within
from sonolube.tasks.task import marks_of


@contextmanager
def running(function: Any, **given: Any) -> Iterator[None]:
    """Let a task be the running one, with some arguments given and the others left to their defaults."""
    call = Call(str(function.__name__), given, frozenset(given), marks_of(function))
    with within(tasks._CALL, call):
        yield


class RigStandIn(SimpleNamespace):
    """Stands for a rig where a task is called with what its parts return."""

    @property  # type: ignore[misc]
    def __class__(self) -> type:
        return Rig
