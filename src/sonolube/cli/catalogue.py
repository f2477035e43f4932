"""Commands that list what the house holds: materials, published data, the schema of rig files."""

import json as json_module
from typing import Annotated

import typer

from sonolube.cli.operate import Json


def materials(
    name: Annotated[str | None, typer.Argument(help="One material; all of them where absent.")] = None,
    json: Json = False,
) -> None:
    """Materials and piezo ceramics, each property with its source.

    Example: sonolube materials aluminium_2024
    """
    from sonolube.cli.listing import material_lines, material_object

    typer.echo(json_module.dumps(material_object(name), indent=2) if json else "\n".join(material_lines(name)))


def published(
    table: Annotated[str | None, typer.Argument(help="One table, such as 2.5; the list where absent.")] = None,
    json: Json = False,
) -> None:
    """Published data of the dissertation, with the caveats about it.

    Example: sonolube published 2.5
    """
    from sonolube.cli.listing import published_lines, published_object

    typer.echo(json_module.dumps(published_object(table), indent=2) if json else "\n".join(published_lines(table)))


def schema() -> None:
    """JSON schema of rig files, for editors and other programs.

    Example: sonolube schema > rig.schema.json
    """
    from sonolube.rig import rig_schema

    typer.echo(json_module.dumps(rig_schema(), indent=2))
