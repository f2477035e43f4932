"""Command `schema`: JSON schema of rig files."""

from json import dumps

from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import Json
from sonolube.cli.lookup.listing import Listing
from sonolube.rig import rig_schema


def schema(json: Json = False) -> None:
    """JSON schema of rig files, for editors and other programs; the same with and without --json.

    Example: sonolube schema > rig.schema.json
    """
    content = rig_schema()
    deliver(Listing(text=dumps(content, indent=2).splitlines(), content=content), as_json=json)
