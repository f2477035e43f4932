"""Task `literature`: earlier studies that the dissertation reviews, and a rig among them."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Annotated, Any, Unpack

from sonolube.facts.published import PreviousStudy, previous_studies
from sonolube.report import Drawing
from sonolube.report.results import model_comparison as results
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, answer, si
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.own_tables import MappedRuns, runs_of
from sonolube.tasks.parameters import File, OptionalRig, RigEntries, RunsSource, optional_rig
from sonolube.tasks.task import task
from sonolube.text.units import format_si
from sonolube.validation.previous_study_map import StudyPoint, studies_of_runs, study_chart, study_table

_TABLE = File(
    "Further studies to draw on the map, in the columns of studies.csv, which is written; each point with"
    " study, source and a friction, as in a table of runs. Or own runs of the laboratory, such as"
    " catalogue:material=brass,load=5N.",
    "STUDIES.csv",
)


@task
def literature(
    rig: OptionalRig = None,
    *,
    table: Annotated[RunsSource, _TABLE] = None,
    mapping: MappedRuns = None,
    **entries: Unpack[RigEntries],
) -> "LiteratureAnswer":
    """Earlier studies the dissertation reviews, as a list, a table and a map over speed and pressure, with your rig.

    Example: sonolube literature examples/rigs/tribometer.toml

    Examples
    --------
    >>> import sonolube as sl
    >>> [study.study for study in sl.literature().studies[:2]]
    ['Mason', 'Littmann et al.']
    """
    known = optional_rig(rig)
    point = outside = None
    if known is not None:
        point, outside = results.point_of_rig(known)
    runs = runs_of(table, mapping)
    title = table.name if isinstance(table, NamedBytes) else str(table)
    others, caveats = ((), ()) if runs is None else studies_of_runs(runs, title=title)
    return LiteratureAnswer(
        studies=previous_studies(), rig=known, point=point, outside=outside, others=others, skipped=caveats
    )


@answer
class LiteratureAnswer(Answer):
    """Earlier studies with their printed numbers, and the friction reduction of a rig beside them."""

    studies: tuple[PreviousStudy, ...]
    rig: Rig | None
    point: StudyPoint | None
    outside: str | None
    others: tuple[StudyPoint, ...] = ()
    skipped: tuple[str, ...] = ()

    def blocks(self) -> Sequence[Block]:
        """Studies with their text and numbers, and the rig."""
        return [*self._study_lines(), *self._rig_lines()]

    def first_blocks(self) -> Sequence[Block]:
        """The same, the rig first."""
        return [*self._rig_lines(), *self._study_lines()]

    def _study_lines(self) -> list[str]:
        """Studies with their text and numbers."""
        lines = [line for study in self.studies for line in results.study_lines(study)]
        return lines + list(map(results.own_point_line, self.others))

    def _rig_lines(self) -> list[str]:
        """Rig with its place and its reduction; none without one."""
        if self.point is None:
            return []
        place = f"{format_si(_speed(self.point), 'm/s')}, {format_si(self.point.nominal_pressure or 0.0, 'Pa')}"
        reduction = self.outside or f"computed friction reduction {100 * self.point.friction_reduction:.0f} %"
        return [f"{self.point.label}: {place}, {reduction}"]

    def object(self) -> dict[str, Any]:
        """Studies, and speed, pressure and friction reduction of the rig."""
        content: dict[str, Any] = {"studies": list(map(results.study_object, self.studies))}
        content["table"] = [asdict(point) for point in self.others]
        if self.point is not None:
            content["rig"] = si(
                {
                    "sliding_speed": _speed(self.point),
                    "nominal_pressure": self.point.nominal_pressure,
                    "friction_reduction": None if self.outside else self.point.friction_reduction,
                }
            ) | {"reason": self.outside}
        return content

    def figures(self) -> Mapping[str, Drawing]:
        """Friction reduction of the studies over sliding speed and nominal pressure."""
        point = None if self.outside else self.point
        return {"map-of-studies": Drawing(chart=lambda: study_chart(point, others=self.others))}

    def files(self) -> Mapping[str, str]:
        """Points of the package as a table that users extend."""
        return {"studies.csv": study_table()}

    def caveats(self) -> Sequence[str]:
        """Points of an own table that were left out."""
        return self.skipped


def _speed(point: StudyPoint) -> float:
    """Sliding speed of a rig on the map."""
    assert point.sliding_speed is not None
    return point.sliding_speed[0]
