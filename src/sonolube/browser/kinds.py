"""Kinds of requests that a worker answers, by name."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from sonolube.browser.answers import Answering, answered, offered_task, offered_tasks
from sonolube.browser.places import Places


def _task(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Answer of a task."""
    return answered(offered_task(str(payload.get("task", ""))), payload.get("arguments") or {}, places)


def _rig(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Fields and drawing of a rig."""
    from sonolube.browser.rig_view import rig_view

    return rig_view(payload, places)


def _take(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """File to take away."""
    from sonolube.browser.take_away import taken

    return taken(payload, places)


def _description(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """OpenAPI description of the tasks."""
    from sonolube.tasks.openapi import tasks_description

    del payload, places
    offered = {f"/tasks/{task.name.replace(' ', '/')}" for task in offered_tasks()}
    content = tasks_description()
    paths = {f"/api{path}": each for path, each in content["paths"].items() if path in offered}
    return content | {"paths": paths}


KINDS: Mapping[str, Answering] = MappingProxyType(
    {"task": _task, "rig": _rig, "take": _take, "description": _description}
)
"""Functions that answer each kind of request."""
