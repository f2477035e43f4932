"""Task `reproduce`: published numbers of the dissertation beside computed ones."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Unpack

from sonolube.report import reproduction_files, summary_lines, validation_object
from sonolube.reproduction import Reproduction, reproduction
from sonolube.tasks.answer import Answer, Block, answer
from sonolube.tasks.parameters import Parameter, Watched
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task


@task
def reproduce(
    *,
    chapter: Annotated[int | None, Parameter("Only this chapter: 2, 3 or 4.", lowest=2, highest=4)] = None,
    **watch: Unpack[Watched],
) -> "ReproductionAnswer":
    """Ten claims of the dissertation judged, and every published number beside the computed one, with figures.

    Example: sonolube reproduce --chapter 3 --out out
    """
    with stage("reproducing") as advance:
        return ReproductionAnswer(result=reproduction(chapter=chapter, advance=advance))


@answer
class ReproductionAnswer(Answer):
    """Claims of a reproduction with their findings, and its rows, with the report and its figures."""

    result: Reproduction

    def blocks(self) -> Sequence[Block]:
        """Scorecard of the claims, and the number of rows by class and verdict."""
        return summary_lines(self.result)

    def object(self) -> dict[str, Any]:
        """Claims, rows, and the number of rows by class and verdict."""
        return validation_object(self.result)

    def caveats(self) -> Sequence[str]:
        """Assumptions of the rows that contradict the dissertation."""
        return self.result.caveats

    def files(self) -> Mapping[str, str | bytes]:
        """Report, claims and rows as JSON, and every figure."""
        with stage("drawing") as advance:
            return reproduction_files(self.result, advance=advance)
