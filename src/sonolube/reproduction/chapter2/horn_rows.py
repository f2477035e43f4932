"""Poisson horn by finite elements: rows of its first axial mode, its regions, friction at the node, and bending."""

from collections.abc import Iterator
from typing import Final

from sonolube.facts.published import si_value
from sonolube.reproduction.chapter2 import horn_friction
from sonolube.reproduction.chapter2.horn_bending import PAD_DISTANCE, bending_line
from sonolube.reproduction.chapter2.poisson_horn import (
    ASSUMED_SOLIDS,
    INCH,
    assumed_shape,
    axial_mode,
    printed_shape,
    printed_solid,
)
from sonolube.reproduction.cube import HORNS, Horn
from sonolube.reproduction.row import Row, default_model_row
from sonolube.validation.contacts import Bodies

REGION_ROWS: Final = {"aluminium": 1, "steel": 4}
"""Row of the transition region of each horn in Table 2.1, counted from 1."""

_BENDING_LOAD: Final = 240.0  # N, the largest of D 2.1.2
_ASSUMED: Final = "ends tapered to 3/4 in over their last inch, handbook moduli and densities"


def horn_rows() -> Iterator[Row]:
    """Yield the rows of the Poisson horn by finite elements."""
    yield from _modes()
    yield from _transition_regions()
    yield from _friction()
    yield _bending()


def _modes() -> Iterator[Row]:
    """Yield the first axial modes of the assumed horns, with those of plain blocks beside them."""
    for horn in HORNS:
        plain, assumed = printed_solid(horn), ASSUMED_SOLIDS[horn]
        plain_note = (
            f"Finite elements, a free plain block with E and nu of Table 3.1 and {plain.density:g} kg/m3; the next "
            "modes, bending 3 and 4, lie 2.2 kHz away or more."
        )
        yield default_model_row(
            f"2.1.3-first-mode-{horn}",
            axial_mode(assumed_shape(), assumed).natural_frequency,
            f"Finite elements; assumed, and chosen so that both horns agree: {_ASSUMED} "
            f"({assumed.youngs_modulus / 1e9:g} GPa, {assumed.poisson_ratio:g}, {assumed.density:g} kg/m3).",
            suffix="assumed",
            fitted="taper and moduli, with the mode of the other horn",
            alternatives={"plain block": (axial_mode(printed_shape(), plain).natural_frequency, plain_note)},
        )


def _transition_regions() -> Iterator[Row]:
    """Yield the limits of the transition regions of Table 2.1, driven at 20 kHz and, beside that, at resonance."""
    for horn in HORNS:
        resonance = axial_mode(assumed_shape(), ASSUMED_SOLIDS[horn]).natural_frequency
        driven = _transition_limits(
            horn, si_value("2.1.2-welder-frequency"), "driven on its right end at 20 kHz, below its own resonance"
        )
        resonant = _transition_limits(horn, resonance, f"driven at its own {resonance / 1e3:.1f} kHz")
        for side, (limit, note), alternative in zip(("start", "end"), driven, resonant, strict=True):
            yield default_model_row(
                f"table-2.1-{side}-{REGION_ROWS[horn]}", limit, note, alternatives={"driven at resonance": alternative}
            )


def _transition_limits(horn: Horn, frequency: float, drive: str) -> list[tuple[float, str]]:
    """Limits of the transition region of a driven horn in m, each with its note."""
    friction = horn_friction.friction_on_face(horn, frequency=frequency)
    note = (
        "Position at which the friction of a block at 5 mm/s towards the node reverses: finite elements, "
        f"the horn of the printed mode ({_ASSUMED}), {drive}; springs of the contact of Table 3.1 with "
        f"Mindlin's ratio. The node lies at {friction.node / INCH:+.2f} in."
    )
    return [(float(limit), note) for limit in horn_friction.transition_region(friction)]


def _friction() -> Iterator[Row]:
    """Yield the friction reductions of section 2.1.5 at the node of the driven horns."""
    tests: tuple[tuple[str, Horn, Bodies], ...] = (
        ("2.1.5-reduction-aluminium-horn", "aluminium", "aluminium_steel"),
        ("2.1.5-reduction-steel-on-aluminium", "steel", "aluminium_steel"),
        ("2.1.5-reduction-steel-on-steel", "steel", "steel_steel"),
    )
    inch = si_value("2.1.3-outer-points")
    for published, horn, bodies in tests:
        motion = horn_friction.driven_face(horn, frequency=si_value("2.1.2-welder-frequency"))
        contact, approach = horn_friction.spring_contact(horn, bodies=bodies)
        friction = horn_friction.friction_along(motion, contact, approach=approach)
        driving = ", ".join(f"{-100 * friction.at(x):.0f} % at {name}" for name, x in (("-1", -inch), ("+1", inch)))
        note = (
            "Springs of the contact of Table 3.1 with Mindlin's ratio, at the node of the motion by finite elements, "
            f"the same at every load. The motor force over the intrinsic friction is {driving}."
        )
        yield default_model_row(published, 1 - friction.at(friction.node), note, suffix="springs")


def _bending() -> Row:
    """Coefficient of friction of the aluminium horn from that of steel and the bending of both."""
    slopes = {
        horn: bending_line(printed_shape(), printed_solid(horn), normal_load=_BENDING_LOAD).largest_slope
        for horn in HORNS
    }
    return default_model_row(
        "2.1.5-coefficient-off",
        si_value("3.1.4-coefficient-2") + slopes["aluminium"] - slopes["steel"],
        "Coefficient of the steel horn with the contribution of bending between the pads, by which section 2.1.6 "
        f"explains the difference: the bent face rises by {1e6 * slopes['aluminium']:.0f} um/m under {_BENDING_LOAD:g} "
        f"N, that of steel by {1e6 * slopes['steel']:.0f}; pads {1e3 * PAD_DISTANCE:.1f} mm apart are assumed.",
        suffix="bending",
    )
