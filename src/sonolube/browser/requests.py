"""Requests of pages: the files of this computer that they may name, and their kinds, imported when asked for."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from sonolube.variants import VariantTable

OPENED: Final = "tribometer"
"""Name of the example that the first page shows."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Places:
    """Files of this computer that requests may name.

    Parameters
    ----------
    rigs : mapping of str to str
        Paths of rig files by name, beside those of the examples.
    uploads : str
        Folder of the files that were uploaded; empty for none.
    device_map : str
        Path of the map of the rig's devices; empty for the virtual tribometer.
    runs : str
        Folder of all runs of the laboratory; empty for none.
    folder : str
        Folder of the rig that the workbench was opened with; empty where that is a file.
    """

    rigs: Mapping[str, str]
    uploads: str = ""
    device_map: str = ""
    runs: str = ""
    folder: str = ""


Answering = Callable[[Mapping[str, Any], Places], dict[str, Any]]
"""Answers one kind of request."""

VIEWS: Final = {
    "file": "sonolube.browser.recording_view:file_view",
    "measured-table": "sonolube.browser.measured_use:measured_table",
    "measured-use": "sonolube.browser.measured_use:measured_use",
    "own-runs": "sonolube.browser.measured_use:own_runs",
    "folder-runs": "sonolube.browser.measured_use:folder_runs",
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
