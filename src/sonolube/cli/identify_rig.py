"""Command `identify rig`: the task, and the rig file on standard output or in a file."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from sonolube.cli.console.delivery import deliver
from sonolube.cli.console.options import OutputFile
from sonolube.cli.generated import argument, command_of
from sonolube.tasks.identify.rig_of_facts import IdentificationAnswer
from sonolube.tasks.table import task_named
from sonolube.text.plain_text import printable

_OUT: Final = Annotated[Path | None, typer.Option(help="File to write; standard output by default."), OutputFile()]


def _delivered(answer: IdentificationAnswer, typed: Mapping[str, Any]) -> None:
    """Write the rig file and print what was found, or print the file with that as comments."""
    out: Path | None = typed["out"]
    if out is not None:
        deliver(replace(answer, target=out), folder=out.parent, as_json=typed["json"])
    elif typed["json"]:
        deliver(answer, as_json=True)
    else:
        typer.echo(printable(answer.file_text()))


identify_rig = command_of(task_named("identify rig"), more=(argument("out", _OUT, None),), delivery=_delivered)
