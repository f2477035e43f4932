"""Task `reproduce`: published numbers of the dissertation beside computed ones, by the study of it."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Unpack

from sonolube.studies import StudyReport, study
from sonolube.tasks.answer import Answer, Block, answer
from sonolube.tasks.parameters import Parameter, Watched
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task

_STUDY = "dong2015"


@task
def reproduce(
    *,
    chapter: Annotated[int | None, Parameter("Only this chapter: 2, 3 or 4.", lowest=2, highest=4)] = None,
    **watch: Unpack[Watched],
) -> "ReproductionAnswer":
    """Ten claims of the dissertation judged, and every published number beside the computed one, with figures.

    Example: sonolube reproduce --chapter 3 --out out
    """
    chosen = study(_STUDY)
    with stage("reproducing") as advance:
        return ReproductionAnswer(result=chosen.reproduce(chapter=chapter, advance=advance))


@answer
class ReproductionAnswer(Answer):
    """Claims of a study with their findings, and its rows, with the report and its figures."""

    result: StudyReport

    def blocks(self) -> Sequence[Block]:
        """Scorecard of the claims, and the number of rows by class and verdict."""
        return self.result.lines()

    def object(self) -> dict[str, Any]:
        """Claims, rows, and the number of rows by class and verdict."""
        return self.result.object()

    def caveats(self) -> Sequence[str]:
        """Assumptions of the rows that contradict the dissertation."""
        return self.result.caveats

    def files(self) -> Mapping[str, str | bytes]:
        """Report, claims and rows as JSON, and every figure."""
        with stage("drawing") as advance:
            return self.result.files(advance=advance)
