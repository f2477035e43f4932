"""Command `literature`: earlier studies that the dissertation reviews, and a rig among them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver, si
from sonolube.cli.console.options import OUT, Amplitude, Changes, Json, Out, loaded_rig
from sonolube.cli.console.outputs import OutputFolder
from sonolube.errors import InvalidInput
from sonolube.published import PreviousStudy, Statement, previous_studies
from sonolube.report import Drawing
from sonolube.rig import Rig, friction_point
from sonolube.units import format_si
from sonolube.validation.previous_study_map import StudyPoint, study_map
from sonolube.vocabulary import quantity, unit_of


def literature(
    rig: Annotated[
        Path | None, typer.Argument(metavar="RIG.toml", help="A rig to draw among the studies; none by default.")
    ] = None,
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("map-of-studies.*")] = OUT,
    json: Json = False,
) -> None:
    """Earlier studies the dissertation reviews, as a list and a map over speed and pressure, with your rig on it.

    Example: sonolube literature examples/rigs/tribometer.toml
    """
    if rig is None and (changes or amplitude):
        raise InvalidInput(
            "--set changes a rig, and --amplitude is of one: name one, such as examples/rigs/tribometer.toml"
        )
    known = point = outside = None
    if rig is not None:
        known = loaded_rig(rig, changes=changes, amplitude=amplitude)
        speed = known.sliding_speed
        if not speed > 0:
            raise InvalidInput(f"{rig}: the map needs a sliding.sliding_speed above 0")
        friction = friction_point(known)
        outside = friction.reason
        point = StudyPoint(
            label=rig.stem,
            direction="perpendicular",
            friction_reduction=friction.friction_reduction,
            sliding_speed=(speed, speed),
            nominal_pressure=known.normal_load / known.contact.nominal_area,
        )
    answer = LiteratureAnswer(studies=previous_studies(), rig=known, point=point, outside=outside)
    deliver(answer, folder=out, as_json=json)


@dataclass(frozen=True, kw_only=True)
class LiteratureAnswer(Answer):
    """Earlier studies with their printed numbers, and the friction reduction of a rig beside them."""

    studies: tuple[PreviousStudy, ...]
    rig: Rig | None
    point: StudyPoint | None
    outside: str | None

    def lines(self) -> list[str]:
        """Studies with their text and numbers, and the rig."""
        lines = [line for study in self.studies for line in _study_lines(study)]
        for point in [self.point] if self.point else []:
            place = f"{format_si(_speed(point), 'm/s')}, {format_si(point.nominal_pressure or 0.0, 'Pa')}"
            reduction = self.outside or f"computed friction reduction {100 * point.friction_reduction:.0f} %"
            lines.append(f"{point.label}: {place}, {reduction}")
        return lines

    def object(self) -> dict[str, Any]:
        """Studies, and speed, pressure and friction reduction of the rig."""
        content: dict[str, Any] = {"studies": [_study_object(study) for study in self.studies]}
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
        return {"map-of-studies": Drawing(draw=lambda: study_map(point))}


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
