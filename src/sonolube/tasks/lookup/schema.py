"""Task `schema`: JSON schema of rig files, protocols, device maps and published tests, and description of the tasks."""

from json import dumps
from typing import Annotated, Literal

from sonolube.facts.protocol import protocol_schema
from sonolube.laboratory.drivers import device_map_schema
from sonolube.prediction.source_file import evidence_schema
from sonolube.report.blocks import Verbatim
from sonolube.rig import rig_schema
from sonolube.tasks.answer import Listing
from sonolube.tasks.openapi import tasks_description
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.task import task

_SCHEMAS = {
    "rig": rig_schema,
    "protocol": protocol_schema,
    "devices": device_map_schema,
    "evidence": evidence_schema,
    "tasks": tasks_description,
}


@task
def schema(
    kind: Annotated[
        Literal["rig", "protocol", "devices", "evidence", "tasks"],
        Parameter("Files to describe, or the tasks of sonolube."),
    ] = "rig",
) -> Listing:
    """JSON schema of rigs, protocols, device maps or published tests, or OpenAPI of the tasks; --json changes nothing.

    Example: sonolube schema > rig.schema.json

    Examples
    --------
    >>> import sonolube as sl
    >>> sorted(sl.schema("rig").object()["required"])
    ['contact', 'friction', 'sliding', 'source', 'title']
    """
    content = _SCHEMAS[kind]()
    return Listing(parts=[Verbatim(dumps(content, indent=2))], content=content)
