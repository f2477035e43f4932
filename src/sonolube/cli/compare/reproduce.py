"""Command `reproduce`: published numbers of the dissertation beside computed ones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver
from sonolube.cli.console.options import OUT, Json, Out
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.report import reproduction_files, summary_lines, validation_object
from sonolube.reproduction import Reproduction, reproduction


def reproduce(
    chapter: Annotated[int | None, typer.Option(help="Only this chapter: 2, 3 or 4.", min=2, max=4)] = None,
    out: Annotated[Out, OutputFolder("reproduction.html validation.json figures/*")] = OUT,
    json: Json = False,
) -> None:
    """Ten claims of the dissertation judged, and every published number beside the computed one, with figures.

    Example: sonolube reproduce --chapter 3 --out out
    """
    with progress("reproducing"):
        result = reproduction(chapter=chapter)
    deliver(ReproductionAnswer(result), folder=out, as_json=json)


@dataclass(frozen=True)
class ReproductionAnswer(Answer):
    """Claims of a reproduction with their findings, and its rows, with the report and its figures."""

    result: Reproduction

    def lines(self) -> list[str]:
        """Scorecard of the claims, and the number of rows by class and verdict."""
        return summary_lines(self.result)

    def object(self) -> dict[str, Any]:
        """Claims, rows, and the number of rows by class and verdict."""
        return validation_object(self.result)

    def caveats(self) -> Sequence[str]:
        """What the rows rest on that the dissertation speaks against."""
        return self.result.caveats

    def files(self) -> Mapping[str, str | bytes]:
        """Report, claims and rows as JSON, and every figure."""
        with progress("drawing") as advance:
            return reproduction_files(self.result, advance=advance)
