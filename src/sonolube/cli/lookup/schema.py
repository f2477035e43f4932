"""Command `schema`: JSON schema of rig files, protocols and device maps."""

from enum import StrEnum
from json import dumps
from typing import Annotated

import typer

from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import Json
from sonolube.cli.lookup.listing import Listing
from sonolube.facts.protocol import protocol_schema
from sonolube.laboratory.drivers import device_map_schema
from sonolube.rig import rig_schema


class Kind(StrEnum):
    """Kind of file that a schema describes."""

    RIG = "rig"
    PROTOCOL = "protocol"
    DEVICES = "devices"


_SCHEMAS = {Kind.RIG: rig_schema, Kind.PROTOCOL: protocol_schema, Kind.DEVICES: device_map_schema}


def schema(kind: Annotated[Kind, typer.Argument(help="Files to describe.")] = Kind.RIG, json: Json = False) -> None:
    """JSON schema of rig files, protocols or device maps, for editors and programs; the same with and without --json.

    Example: sonolube schema > rig.schema.json
    """
    content = _SCHEMAS[kind]()
    deliver(Listing(text=dumps(content, indent=2).splitlines(), content=content), as_json=json)
