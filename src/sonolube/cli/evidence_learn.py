"""Command `evidence learn`: the task, and the file of the posterior."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from sonolube.cli.console.delivery import deliver
from sonolube.cli.console.options import OUT, OutputFile
from sonolube.cli.generated import argument, command_of
from sonolube.tasks.evidence.learned_posterior import LearnedEvidenceAnswer
from sonolube.tasks.table import task_named

_OUT: Final = Annotated[Path, typer.Option(metavar="POSTERIOR.json", help="File of the posterior."), OutputFile()]


def _delivered(answer: LearnedEvidenceAnswer, typed: Mapping[str, Any]) -> None:
    """Write the posterior, and print what was learned."""
    out: Path = typed["out"]
    deliver(replace(answer, target=out), folder=out.parent, as_json=typed["json"])


evidence_learn = command_of(
    task_named("evidence learn"), more=(argument("out", _OUT, OUT / "posterior.json"),), delivery=_delivered
)
