"""The command on earlier studies, with the user's own rig among them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sonolube.cli.operate import Changes, Json

if TYPE_CHECKING:
    from sonolube.published import PreviousStudy, Statement
    from sonolube.validation.study_map import MapPoint


def literature(
    rig: Annotated[
        Path | None, typer.Argument(metavar="RIG.toml", help="A rig to draw among the studies; none where absent.")
    ] = None,
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for the map.")] = Path("out"),
    json: Json = False,
) -> None:
    """Earlier studies the dissertation reviews, as a list and a map over speed and pressure, with your rig on it.

    Example: sonolube literature examples/rigs/tribometer.toml
    """
    import json as json_module

    from sonolube.figure import publication_style, write_figure
    from sonolube.published import previous_studies
    from sonolube.validation.study_map import study_map

    mine = _point(rig, list(changes or ())) if rig else None
    with publication_style():
        written = write_figure(study_map(mine), folder=out, name="map-of-studies")
    studies = previous_studies()
    if json:
        answer = {"studies": [_object(study) for study in studies], "files": [str(path) for path in written]}
        typer.echo(json_module.dumps(answer | ({"rig": _own(mine)} if mine else {}), indent=2, allow_nan=False))
    else:
        typer.echo("\n".join([*_lines(studies), *_own_line(mine), *[f"  {path}" for path in written]]))


def _point(rig: Path, changes: list[str]) -> "MapPoint":
    from sonolube.errors import InvalidInput
    from sonolube.rig import friction_point, read_rig
    from sonolube.validation.study_map import MapPoint

    known = read_rig(rig, changes=changes)
    speed = known.sliding_speed
    if not speed > 0:
        raise InvalidInput(f"{rig}: the map needs a sliding.sliding_speed above 0")
    return MapPoint(
        label=rig.stem,
        direction="perpendicular",
        friction_reduction=friction_point(known).friction_reduction,
        sliding_speed=(speed, speed),
        nominal_pressure=known.normal_load / known.contact.nominal_area,
    )


def _lines(studies: "tuple[PreviousStudy, ...]") -> list[str]:
    lines = []
    for study in studies:
        numbers = "; ".join(_told(entry) for entry in study.numbers)
        where = f"D {study.section} {list(study.references)}"
        lines += [f"{study.study}, {study.direction or 'direction not stated'}, {where}", f"  {study.told}"]
        lines += [f"  {numbers}"] if numbers else []
    return lines


def _told(entry: "Statement") -> str:
    from sonolube.vocabulary import quantity

    meaning = quantity(entry.quantity).meaning if entry.quantity else entry.meaning
    relation = "" if entry.relation == "=" else f"{entry.relation} "
    return f"{meaning} {relation}{entry.number.text} {entry.unit}".rstrip()


def _object(study: "PreviousStudy") -> dict[str, Any]:
    from sonolube.vocabulary import unit_of

    return {
        "study": study.study,
        "section": study.section,
        "references": list(study.references),
        "direction": study.direction,
        "told": study.told,
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


def _own(mine: "MapPoint") -> dict[str, Any]:
    assert mine.sliding_speed
    return {
        "sliding_speed": {"value": mine.sliding_speed[0], "unit": "m/s"},
        "nominal_pressure": {"value": mine.nominal_pressure, "unit": "Pa"},
        "friction_reduction": {"value": mine.friction_reduction, "unit": ""},
    }


def _own_line(mine: "MapPoint | None") -> list[str]:
    from sonolube.units import format_si

    if mine is None or mine.sliding_speed is None or mine.nominal_pressure is None:
        return []
    place = f"{format_si(mine.sliding_speed[0], 'm/s')}, {format_si(mine.nominal_pressure, 'Pa')}"
    return [f"{mine.label}: {place}, computed friction reduction {100 * mine.friction_reduction:.0f} %"]
