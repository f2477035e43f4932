"""Earlier studies and a rig among them: lines and objects for JSON."""

from typing import Any

from sonolube.errors import InvalidInput
from sonolube.facts.published import PreviousStudy, Statement
from sonolube.report.results.record_object import picked
from sonolube.rig import Rig, friction_point
from sonolube.text.units import format_si
from sonolube.validation.previous_study_map import StudyPoint
from sonolube.vocabulary import quantity, unit_of


def point_of_rig(rig: Rig) -> tuple[StudyPoint, str | None]:
    """Rig as a point of the map of studies, and why its reduction has no number."""
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


def own_point_line(point: StudyPoint) -> str:
    """Friction reduction of a point of an own table, with direction, speed and pressure as far as known."""
    parts = [f"friction reduction {100 * point.friction_reduction:.0f} %", point.direction or "direction not stated"]
    if point.sliding_speed is not None:
        parts.append(format_si(point.sliding_speed[1], "m/s"))
    if point.nominal_pressure is not None:
        parts.append(format_si(point.nominal_pressure, "Pa"))
    return f"{point.label}, own table: {', '.join(parts)}"


def study_lines(study: PreviousStudy) -> list[str]:
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


def study_object(study: PreviousStudy) -> dict[str, Any]:
    """Study with its numbers by quantity."""
    return {
        **picked(study, "study", "section"),
        "references": list(study.references),
        **picked(study, "direction", "summary"),
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
