"""The JSON schema of rig files."""

from typing import Any

from sonolube.rig.file.sections import RigFile


def rig_schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) that every rig file follows."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "sonolube rig",
    } | {key: value for key, value in RigFile.model_json_schema().items() if key != "title"}
