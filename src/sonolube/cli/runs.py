"""Command `runs`: the task, and its table saved where it was changed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from sonolube.cli.console.delivery import deliver
from sonolube.cli.console.options import OutputFile
from sonolube.cli.generated import argument, command_of
from sonolube.tasks.measure.own_runs import OwnRunsAnswer
from sonolube.tasks.table import task_named

_OUT: Final = Annotated[
    Path | None,
    typer.Option(metavar="RUNS.csv", help="File to save the table to, in place of the one that was read."),
    OutputFile(),
]


def _delivered(answer: OwnRunsAnswer, typed: Mapping[str, Any]) -> None:
    """Save the table where it was changed, and print it."""
    changed, out = answer.before is not None, typed["out"]
    deliver(answer.save(out) if changed or out else answer, folder=None, as_json=typed["json"])


runs = command_of(task_named("runs"), more=(argument("out", _OUT, None),), delivery=_delivered)
