"""Task `literature`: earlier studies that the dissertation reviews, and a rig among them."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Annotated, Any

from sonolube.errors import InvalidInput
from sonolube.facts.published import PreviousStudy, Statement, previous_studies
from sonolube.report import Drawing
from sonolube.rig import Rig, friction_point
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block
from sonolube.tasks.files import NamedBytes
from sonolube.tasks.own_tables import MappedRuns, runs_of
from sonolube.tasks.parameters import OptionalRig, Parameter, RunsSource, optional_rig
from sonolube.tasks.task import task
from sonolube.units import format_si
from sonolube.validation.previous_study_map import StudyPoint, study_chart
from sonolube.validation.study_table import studies_of_runs, study_table
from sonolube.vocabulary import quantity, unit_of

_TABLE = Parameter(
    help="Further studies to draw on the map, in the columns of studies.csv, which is written; each point with"
    " study, source and a friction, as in a table of runs. Or own runs of the laboratory, such as"
    " catalogue:material=brass,load=5N.",
    kind="STUDIES.csv",
    is_file=True,
)


@task
def literature(
    rig: OptionalRig = None, *, table: Annotated[RunsSource, _TABLE] = None, mapping: MappedRuns = None
) -> "LiteratureAnswer":
    """Earlier studies the dissertation reviews, as a list, a table and a map over speed and pressure, with your rig.

    Example: sonolube literature examples/rigs/tribometer.toml
    """
    known = optional_rig(rig)
    point = outside = None
    if known is not None:
        point, outside = _point(known)
    runs = runs_of(table, mapping)
    title = table.name if isinstance(table, NamedBytes) else str(table)
    others, caveats = ((), ()) if runs is None else studies_of_runs(runs, title=title)
    return LiteratureAnswer(
        studies=previous_studies(), rig=known, point=point, outside=outside, others=others, skipped=caveats
    )


def _point(rig: Rig) -> tuple[StudyPoint, str | None]:
    """Rig as a point of the map, and why its reduction has no number."""
    speed = rig.sliding_speed
    if not speed > 0:
        raise InvalidInput(f"{rig.file or rig.title}: the map needs a sliding.sliding_speed above 0")
    friction = friction_point(rig)
    point = StudyPoint(
        label=rig.name,
        direction="perpendicular",
        friction_reduction=friction.friction_reduction,
        sliding_speed=(speed, speed),
        nominal_pressure=rig.normal_load / rig.contact.nominal_area,
    )
    return point, friction.reason


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
        lines: list[Block] = [line for study in self.studies for line in _study_lines(study)]
        lines += [f"{point.label}, own table: {_other_text(point)}" for point in self.others]
        for point in [self.point] if self.point else []:
            place = f"{format_si(_speed(point), 'm/s')}, {format_si(point.nominal_pressure or 0.0, 'Pa')}"
            reduction = self.outside or f"computed friction reduction {100 * point.friction_reduction:.0f} %"
            lines.append(f"{point.label}: {place}, {reduction}")
        return lines

    def object(self) -> dict[str, Any]:
        """Studies, and speed, pressure and friction reduction of the rig."""
        content: dict[str, Any] = {"studies": [_study_object(study) for study in self.studies]}
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


def _other_text(point: StudyPoint) -> str:
    """Friction reduction of a point of an own table, with direction, speed and pressure as far as known."""
    parts = [f"friction reduction {100 * point.friction_reduction:.0f} %", point.direction or "direction not stated"]
    if point.sliding_speed is not None:
        parts.append(format_si(point.sliding_speed[1], "m/s"))
    if point.nominal_pressure is not None:
        parts.append(format_si(point.nominal_pressure, "Pa"))
    return ", ".join(parts)


def _speed(point: StudyPoint) -> float:
    """Sliding speed of a rig on the map."""
    assert point.sliding_speed is not None
    return point.sliding_speed[0]


def _study_lines(study: PreviousStudy) -> list[str]:
    """Author, direction, references, text and numbers of a study."""
    lines = [
        f"{study.study}, {study.direction or 'direction not stated'}, D {study.section} {list(study.references)}",
        f"  {study.summary}",
    ]
    numbers = "; ".join(map(_number, study.numbers))
    return [*lines, f"  {numbers}"] if numbers else lines


def _number(entry: Statement) -> str:
    """Number of a study with its meaning, relation and unit as printed."""
    meaning = quantity(entry.quantity).meaning if entry.quantity else entry.meaning
    relation = "" if entry.relation == "=" else f"{entry.relation} "
    return f"{meaning} {relation}{entry.number.text} {entry.unit}".rstrip()


def _study_object(study: PreviousStudy) -> dict[str, Any]:
    """Study for JSON, its numbers by quantity."""
    return {
        "study": study.study,
        "section": study.section,
        "references": list(study.references),
        "direction": study.direction,
        "summary": study.summary,
        **{
            entry.quantity: {
                "value": entry.number.value,
                "relation": entry.relation,
                "printed": f"{entry.number.text} {entry.unit}".strip(),
                "unit": unit_of(entry.quantity),
            }
            for entry in study.numbers
            if entry.quantity
        },
    }
