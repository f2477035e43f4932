"""Kinds of requests that a worker answers, by name."""

from collections.abc import Mapping
from typing import Any

from sonolube.browser.answers import Answering, answered, offered_task, offered_tasks
from sonolube.browser.places import Places
from sonolube.variants import VariantTable


def task_answer(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Answer of a task."""
    task, arguments = offered_task(str(payload.get("task", ""))), payload.get("arguments") or {}
    return answered(task, arguments, places, has_tables=payload.get("tables", True))


def description(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """OpenAPI description of the tasks."""
    from sonolube.tasks.openapi import tasks_description

    del payload, places
    offered = {f"/tasks/{task.name.replace(' ', '/')}" for task in offered_tasks()}
    content = tasks_description()
    paths = {f"/api{path}": each for path, each in content["paths"].items() if path in offered}
    return content | {"paths": paths}


KINDS: VariantTable[Answering] = VariantTable(
    "kind of request",
    {
        "task": "sonolube.browser.kinds:task_answer",
        "rig": "sonolube.browser.rig_view:rig_view",
        "take": "sonolube.browser.take_away:taken",
        "description": "sonolube.browser.kinds:description",
    },
)
"""Functions that answer each kind of request."""
