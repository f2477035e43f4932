"""Chapter 2, the Poisson horn by finite elements: its first axial mode, its regions, friction and bending."""

from collections.abc import Iterator
from typing import Final

from sonolube.published.values import Published, cell, stated
from sonolube.reproduce.chapter2.horn_bending import PAD_DISTANCE, sag
from sonolube.reproduce.chapter2.horn_regions import (
    driven_face,
    friction_along,
    friction_on_face,
    spring_contact,
    transition_region,
)
from sonolube.reproduce.chapter2.poisson_horn import (
    ASSUMED_SOLIDS,
    HORNS,
    Horn,
    assumed_shape,
    axial_mode,
    printed_shape,
    printed_solid,
)
from sonolube.reproduce.row import Row, compare
from sonolube.validation.contacts import Bodies
from sonolube.validation.inputs import named, said

_REGION_ROW: Final = {"aluminium": 0, "steel": 3}  # of each horn's transition region in Table 2.1
_BENDING_LOAD: Final = 240.0  # N, the largest of D 2.1.2
_INCH: Final = 0.0254
_ASSUMED: Final = "ends tapered to 3/4 in over their last inch, handbook moduli and densities"


def rows() -> Iterator[Row]:
    """Yield the rows of the horn."""
    yield from _modes()
    yield from _regions()
    yield from _friction()
    yield from _bending()


def _modes() -> Iterator[Row]:
    for horn in HORNS:
        published = stated(f"2.1.3-first-mode-{horn}")
        plain = printed_solid(horn)
        yield compare(
            named(published, "block"),
            axial_mode(printed_shape(), plain).natural_frequency,
            f"Finite elements, a free plain block with E and nu of Table 3.1 and {plain.density:g} kg/m3; the next "
            "modes, bending 3 and 4, lie 2.2 kHz away or more.",
        )
        own = ASSUMED_SOLIDS[horn]
        yield compare(
            named(published, "assumed"),
            axial_mode(assumed_shape(), own).natural_frequency,
            f"Finite elements; assumed, and chosen so that both horns agree: {_ASSUMED} ({own.youngs_modulus / 1e9:g} "
            f"GPa, {own.poisson_ratio:g}, {own.density:g} kg/m3).",
        )


def _regions() -> Iterator[Row]:
    for horn in HORNS:
        resonance = axial_mode(assumed_shape(), ASSUMED_SOLIDS[horn]).natural_frequency
        welder = said("2.1.2-welder-frequency").value
        for suffix, frequency, how in (
            ("", welder, "driven on its right end at the welder's 20 kHz, below its own resonance"),
            ("on-resonance", resonance, f"driven at its own {resonance / 1e3:.1f} kHz"),
        ):
            friction = friction_on_face(horn, frequency=frequency)
            ends = transition_region(friction)
            for side, end in zip(("start", "end"), ends, strict=True):
                published = cell("2.1", side, _REGION_ROW[horn])
                yield compare(
                    named(published, suffix) if suffix else published,
                    end,
                    f"Where the friction of a block at 5 mm/s towards the node reverses: finite elements, the horn of "
                    f"the printed mode ({_ASSUMED}), {how}; springs of the contact of Table 3.1 with Mindlin's ratio. "
                    f"The node lies at {friction.node / _INCH:+.2f} in.",
                )


def _friction() -> Iterator[Row]:
    tests: tuple[tuple[Published, Horn, Bodies], ...] = (
        (stated("2.1.5-reduction-aluminium-horn"), "aluminium", "aluminium_steel"),
        (stated("2.1.5-reduction-steel-on-aluminium"), "steel", "aluminium_steel"),
        (stated("2.1.5-reduction-steel-on-steel"), "steel", "steel_steel"),
    )
    for published, horn, bodies in tests:
        motion = driven_face(horn, frequency=said("2.1.2-welder-frequency").value)
        contact, approach = spring_contact(horn, bodies=bodies)
        friction = friction_along(motion, contact, approach=approach)
        inch = said("2.1.3-outer-points").value
        driven = ", ".join(
            f"{-100 * friction.at(place):.0f} % at {name}" for name, place in (("-1", -inch), ("+1", inch))
        )
        yield compare(
            named(published, "springs"),
            1 - friction.at(friction.node),
            "Springs of the contact of Table 3.1 with Mindlin's ratio, at the node of the motion by finite elements, "
            f"the same at every load. The motor force over the intrinsic friction is {driven}.",
        )


def _bending() -> Iterator[Row]:
    slopes = {horn: sag(printed_shape(), printed_solid(horn), normal_load=_BENDING_LOAD).climb for horn in HORNS}
    intrinsic = said("3.1.4-coefficient-2").value
    yield compare(
        named(stated("2.1.5-coefficient-off"), "bending"),
        intrinsic + slopes["aluminium"] - slopes["steel"],
        f"The steel horn's coefficient and what bending between the pads adds, as section 2.1.6 explains the "
        f"difference: the sagging face rises by {1e6 * slopes['aluminium']:.0f} um/m under {_BENDING_LOAD:g} N, "
        f"that of steel by {1e6 * slopes['steel']:.0f}; pads {1e3 * PAD_DISTANCE:.1f} mm apart are assumed.",
    )
