"""Command `doctor`: state of the installation, how to mend it, and a self-check against closed forms."""

from collections.abc import Sequence
from typing import Any, ClassVar

import typer

from sonolube.cli.console.delivery import deliver
from sonolube.cli.console.options import Json, progress
from sonolube.report.results.installation import Installation, installation
from sonolube.tasks.answer import Answer, Block, answer


def doctor(json: Json = False) -> None:
    """State of the installation: versions, optional parts, GPU, compiled code, programs, and a self-check.

    Ends with exit code 0 if all self-checks pass and compiled code can be kept, else with 1.

    Example: sonolube doctor
    """
    with progress("checking") as advance:
        state = installation(advance)
    deliver(Diagnosis(state=state), as_json=json)
    if not state.healthy:
        raise typer.Exit(1)


@answer
class Diagnosis(Answer):
    """State of an installation."""

    is_lookup: ClassVar[bool] = True

    state: Installation

    def blocks(self) -> Sequence[Block]:
        """Sections of the state, each missing part with its remedy, and the verdict."""
        return self.state.blocks()

    def object(self) -> dict[str, Any]:
        """Same as an object."""
        return self.state.object()
