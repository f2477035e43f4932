"""Designs of the collar element of D 4.5, with the source of each dimension.

The first design and its two revisions have stacks above and below the inner ring; the final design has one stack and an
inner ring that is free at the top.
"""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from sonolube.dong2015.collar import Collar, Outline

_INCH = 0.0254

COLLAR_DIMENSION_SOURCES: Mapping[str, str] = MappingProxyType(
    {
        "frame_length": "printed: 3.9 in, D 4.5.2; that this side lies along the stacks is assumed",
        "frame_width": "printed: 3.7 in, D 4.5.2; that this side lies across the stacks is assumed",
        "frame_thickness": "printed: 1 in, D 4.5.2",
        "base_thickness": "assumed; with two stacks it follows from the other lengths",
        "top_thickness": "assumed; with two stacks equal to the base",
        "pillar_width": "assumed",
        "ring_width": "printed for the first design: 1 in, D 4.5.2, taken across flats; assumed for the others",
        "ring_thickness": "assumed",
        "bore_diameter": "printed: 0.5 in for the first design, D 4.5.2, across flats; of the others that of the rod, "
        "0.75 in, D 4.5.4",
        "bolt_diameter": "assumed",
        "stack_length": "printed: Table 4.7",
        "stack_outer_diameter": "printed: Table 4.7",
        "stack_inner_diameter": "printed: Table 4.7",
    }
)
"""Source of each dimension of the designs: `printed` with its place in D, or `assumed`."""

FIRST_COLLAR = Collar(
    outline=Outline.HEXAGON,
    hole_sides=6,
    stacks=2,
    frame_length=3.9 * _INCH,
    frame_width=3.7 * _INCH,
    frame_thickness=_INCH,
    base_thickness=_INCH,
    top_thickness=_INCH,
    pillar_width=0.5 * _INCH,
    ring_width=_INCH,
    ring_thickness=_INCH,
    bore_diameter=0.5 * _INCH,
    bolt_diameter=4e-3,
)
"""First design: two stacks on a hexagonal inner ring with a hexagonal bore."""

THIN_HEXAGON_COLLAR = replace(FIRST_COLLAR, hole_sides=0, bore_diameter=0.75 * _INCH)
"""Revision of the first design: the same ring with a circular bore for the rod of the tests."""

THIN_RING_COLLAR = replace(THIN_HEXAGON_COLLAR, outline=Outline.ROUND)
"""Other revision: a round inner ring with flats for the stacks, of the same wall."""

NOMINAL_COLLAR = replace(THIN_HEXAGON_COLLAR, stacks=1, ring_thickness=0.5 * _INCH)
"""Final design with nominal dimensions: one stack, and round inches for what D does not print."""

ASSUMED_RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "ring_width": (24e-3, 28e-3),
        "ring_thickness": (10e-3, 25.4e-3),
        "bolt_diameter": (2.5e-3, 4.9e-3),
        "base_thickness": (12e-3, 30e-3),
        "top_thickness": (12e-3, 30e-3),
        "pillar_width": (10e-3, 25e-3),
    }
)
"""Bounds of the assumed dimensions of the final design in m, which leave room for stack, rod and bolt."""

FINAL_COLLAR = replace(
    NOMINAL_COLLAR,
    ring_width=25.49e-3,
    ring_thickness=12.82e-3,
    bolt_diameter=4.11e-3,
    base_thickness=26.01e-3,
    top_thickness=25.11e-3,
    pillar_width=13.76e-3,
)
"""Final design: result of `tuned_collar` from the nominal one within these bounds, for 25 kHz closed, 24.4 kHz open."""
