"""Kinds of requests that a worker answers, by name; no function is imported before it is asked for."""

from collections.abc import Callable, Mapping
from typing import Any, Final

from sonolube.browser.places import Places
from sonolube.variants import VariantTable

Answering = Callable[[Mapping[str, Any], Places], dict[str, Any]]
"""Answers one kind of request."""

VIEWS: Final = {
    "file": "sonolube.browser.recording_view:file_view",
    "measured-table": "sonolube.browser.measured_use:measured_table",
    "measured-use": "sonolube.browser.measured_use:measured_use",
    "recording": "sonolube.browser.recording_view:recording_view",
    "scan": "sonolube.browser.scan_view:scan_view",
    "section": "sonolube.browser.scan_view:section_view",
    "parts": "sonolube.browser.mode_view:mode_parts",
    "files": "sonolube.browser.answer_files:answer_files",
    "rig": "sonolube.browser.rig_view:rig_view",
    "materials": "sonolube.browser.rig_view:material_titles",
    "take": "sonolube.browser.take_away:taken",
    "protocol": "sonolube.browser.lab.protocol_view:protocol_view",
    "edit_protocol": "sonolube.browser.lab.protocol_view:edited_protocol",
}
"""What pages ask for beside the answers of tasks, each by its name as `/api/{name}`."""

KINDS: VariantTable[Answering] = VariantTable(
    "kind of request",
    {
        "task": "sonolube.browser.answers:task_answer",
        "description": "sonolube.browser.answers:description",
        "lab_devices": "sonolube.browser.lab.plan_view:devices",
        "lab_plan": "sonolube.browser.lab.plan_view:plan",
        "lab_runs": "sonolube.browser.lab.runs_view:runs",
        "lab_show": "sonolube.browser.lab.runs_view:shown",
        "lab_recording": "sonolube.browser.lab.runs_view:recording",
        "lab_compare": "sonolube.browser.lab.runs_view:compared",
        "lab_recover": "sonolube.browser.lab.runs_view:recovered",
        **VIEWS,
    },
)
"""Functions that answer each kind of request."""
