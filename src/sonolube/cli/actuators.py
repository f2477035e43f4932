"""The command that lists actuators one can buy."""

import json as json_module
from typing import Annotated

import typer

from sonolube.cli.operate import Json


def actuators(
    name: Annotated[str | None, typer.Argument(help="One actuator; all of them where absent.")] = None,
    json: Json = False,
) -> None:
    """Actuators one can buy, with the numbers of their data sheets and where these were read.

    Example: sonolube actuators sa050510
    """
    from sonolube.cli.actuator_listing import actuator_lines, actuator_object

    typer.echo(json_module.dumps(actuator_object(name), indent=2) if json else "\n".join(actuator_lines(name)))
