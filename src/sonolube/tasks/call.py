"""Call of a task: its name and its arguments as they were given."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin

from sonolube.tasks.parameters import DoorParameter, Parameter, RigParameter

Mark = Parameter | RigParameter | DoorParameter
"""Annotation of an argument of a task."""


@dataclass(frozen=True, slots=True)
class Call:
    """Call of a task: its name, and its arguments as they were given, those left to their defaults among them.

    Parameters
    ----------
    task : str
        Name of its function.
    arguments : mapping of str to object
    given : frozenset of str
        Names of arguments that were not left to their defaults.
    marks : mapping of str to Parameter or RigParameter
        Annotations of the arguments.
    names : callable
        Returns the name of an argument as it is shown.
    """

    task: str
    arguments: Mapping[str, Any]
    given: frozenset[str] = field(default_factory=frozenset)
    marks: Mapping[str, Mark] = field(default_factory=dict)
    names: Callable[[str], str] = str

    def settings(self) -> list[tuple[str, str]]:
        """Arguments with their values as they were given, those left to their defaults marked so; without the rig."""
        rows = []
        for name, value in self.arguments.items():
            if isinstance(self.marks.get(name), Parameter) and value is not None and value != () and value != {}:
                text = _as_typed(value)
                rows.append((self.names(name), text if name in self.given else f"{text} (default)"))
        return rows


def members_of(kind: Any) -> tuple[Any, ...]:
    """Types of a union but None; a type alone."""
    members = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    return tuple(each for each in members if each is not NoneType)


def item_of(kind: Any) -> Any:
    """Type of each of several values that an argument of a type takes; None where it takes one."""
    several = (each for each in members_of(kind) if get_origin(each) in (Sequence, list, tuple))
    return next((get_args(each)[0] for each in several), None)


def _as_typed(value: Any) -> str:
    """Value of an argument as a user types it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Mapping):
        return "; ".join(f"{key}={each}" for key, each in value.items())
    if isinstance(value, list | tuple):
        return "; ".join(map(str, value))
    return str(getattr(value, "name", value)) if not isinstance(value, str) else value
