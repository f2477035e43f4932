"""JSON schema of rig files."""

from collections.abc import Iterator, Mapping
from typing import Any

from sonolube.rig.file.sections import RigFile


def rig_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) that every rig file follows.

    Returns
    -------
    dict
    """
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "sonolube rig"} | {
        key: value for key, value in RigFile.model_json_schema().items() if key != "title"
    }


def tables_of(entry: Mapping[str, Any]) -> Iterator[str]:
    """Yield the names, among the definitions of the schema, of the tables that a key may hold, alone or in a list."""
    if "$ref" in entry:
        yield entry["$ref"].rpartition("/")[2]
    if "items" in entry:
        yield from tables_of(entry["items"])
    for option in (*entry.get("anyOf", ()), *entry.get("oneOf", ())):
        yield from tables_of(option)
