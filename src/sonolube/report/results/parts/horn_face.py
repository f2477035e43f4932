"""Friction along the face of a Poisson horn, and its regions beside those of Table 2.1, as text and JSON."""

from math import isnan
from typing import Any

from sonolube.facts.published import si_value
from sonolube.report.blocks import Block, Rows
from sonolube.reproduction.chapter2.horn_friction import FACE_END, FaceFriction, transition_region
from sonolube.reproduction.chapter2.horn_rows import REGION_ROWS
from sonolube.reproduction.cube import Horn
from sonolube.text.units import format_like
from sonolube.vocabulary import si


def face_blocks(horn: Horn, friction: FaceFriction) -> list[Block]:
    """Node, regions, and the greatest motor force."""
    ends = (-FACE_END, FACE_END)  # where the face drives nowhere
    low, high = (end if isnan(at) else at for at, end in zip(transition_region(friction), ends, strict=True))
    measured = _measured(horn)
    node, *known = format_like((friction.node, low, high, *measured, *ends), "m")
    rows = [
        ("Node of the axial motion", node),
        ("Friction at the node, of that at rest", f"{friction.at(friction.node):.0%}"),
        ("Transition region", f"{known[0]} to {known[1]}"),
        ("the same, measured", f"{known[2]} to {known[3]} (Table 2.1)"),
        ("Motor region, left", f"{known[4]} to {known[0]}"),
        ("Motor region, right", f"{known[1]} to {known[5]}"),
        ("Greatest motor force, of the friction at rest", f"{max(0.0, -friction.ratio.min()):.0%}"),
    ]
    return [f"Poisson horn of {horn}, positions from the centre of the face", Rows(rows)]


def face_object(horn: Horn, friction: FaceFriction) -> dict[str, Any]:
    """Node, limits of the transition region computed and measured, least friction ratio, for JSON."""
    low, high = (None if isnan(limit) else limit for limit in transition_region(friction))
    start, end = _measured(horn)
    return {
        "horn": horn,
        **si({"node_position": friction.node}, unit="m"),
        "transition_region": si({"start": low, "end": high}, unit="m"),
        "measured_transition_region": si({"start": start, "end": end}, unit="m"),
        **si({"friction_ratio_at_node": friction.at(friction.node)}, unit=""),
        **si({"least_friction_ratio": float(friction.ratio.min())}, unit=""),
    }


def _measured(horn: Horn) -> tuple[float, float]:
    """Limits of the transition region in Table 2.1."""
    start, end = (si_value(f"table-2.1-{side}-{REGION_ROWS[horn]}") for side in ("start", "end"))
    return start, end
