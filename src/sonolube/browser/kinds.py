"""Kinds of requests that a worker answers, by name; no function is imported before it is asked for."""

from collections.abc import Callable, Mapping
from typing import Any, Final

from sonolube.browser.places import Places
from sonolube.variants import VariantTable

Answering = Callable[[Mapping[str, Any], Places], dict[str, Any]]
"""Answers one kind of request."""

VIEWS: Final = {"rig": "sonolube.browser.rig_view:rig_view", "take": "sonolube.browser.take_away:taken"}
"""What pages ask for beside the answers of tasks, each by its name as `/api/{name}`."""

KINDS: VariantTable[Answering] = VariantTable(
    "kind of request",
    {"task": "sonolube.browser.answers:task_answer", "description": "sonolube.browser.answers:description", **VIEWS},
)
"""Functions that answer each kind of request."""
