"""Command `doctor`: state of the installation, how to mend it, and a self-check against closed forms."""

import typer

from sonolube.cli.console.delivery import deliver
from sonolube.cli.console.options import Json, progress
from sonolube.report.results.installation import installation
from sonolube.tasks.answer import Listing


def doctor(json: Json = False) -> None:
    """State of the installation: versions, optional parts, compiled code, programs, and a self-check.

    Ends with exit code 0 if all self-checks pass and compiled code can be kept, else with 1.

    Example: sonolube doctor
    """
    with progress("checking") as advance:
        state = installation(advance)
    deliver(Listing(parts=state.blocks(), content=state.object()), as_json=json)
    if not state.healthy:
        raise typer.Exit(1)
