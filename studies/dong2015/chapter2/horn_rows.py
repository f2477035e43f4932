"""Rows of the Poisson horn by finite elements, its sensitivity to single assumptions, and its bending.

A block that slides away from the middle climbs the slope of the bent face, so that the load has a component against the
sliding. Distance and stiffness of the pads are not printed: 4 in, half an inch long, of a soft plastic, are assumed.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import cache, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dong2015.chapter2 import poisson_horn as horn_friction
from dong2015.chapter2.poisson_horn import (
    ASSUMED_SOLIDS,
    INCH,
    AxialMode,
    HornShape,
    HornSolid,
    assumed_shape,
    axial_mode,
    axial_mode_of,
    driven_face,
    horn_model,
    node_position,
    printed_shape,
    printed_solid,
)
from dong2015.published_rigs import HORNS, Horn
from dong2015.row import Row, default_model_row
from sonolube.checks import Floats
from sonolube.design.horns.face import transition_region
from sonolube.facts.published import si_value
from sonolube.models import fem
from sonolube.models.fem import FaceSpring, Model
from sonolube.validation.contacts import Bodies

PAD_DISTANCE: Final = 4 * INCH
"""Distance between the centres of the pads, assumed. [m]"""

_PAD_LENGTH: Final = 0.5 * INCH
PAD_STIFFNESS: Final = 1e8
"""Stiffness of each pad, assumed: of half a gigapascal, a square inch wide and an eighth of an inch thick. [N/m]"""

_CELL: Final = 0.25 * INCH
_ACROSS, _THROUGH = 3, 4  # elements


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BendingLine:
    """Bending line of the horn's middle plane under a load on the middle of its face.

    Parameters
    ----------
    position : ndarray, shape (k,)
        Position along the horn from the centre. [m]
    deflection : ndarray, shape (k,)
        Displacement along the load minus that at the pads, in m.
    largest_slope : float
        Largest slope between the pads.
    """

    position: Floats
    deflection: Floats
    largest_slope: float


@cache
def bending_line(shape: HornShape, solid: HornSolid, *, normal_load: float) -> BendingLine:
    """Bending line of the plain block of a horn under a load across its middle."""
    cells = round(shape.length / _CELL)
    mesh = fem.box_mesh(
        length=shape.length, width=shape.width / 2, thickness=shape.thickness, divisions=(cells, _ACROSS, _THROUGH)
    )
    for name, face, centre, half_length in (
        ("left pad", "+z", -PAD_DISTANCE / 2, _PAD_LENGTH / 2),
        ("right pad", "+z", PAD_DISTANCE / 2, _PAD_LENGTH / 2),
        ("contact", "-z", 0.0, _CELL),
    ):
        mesh = fem.add_face_patch(mesh, name, of=face, where=partial(_within, centre=centre, half_length=half_length))
    pads = tuple(
        # half the stiffness of each pad for the modelled half of the horn
        fem.FaceSpring(face=f"{side} pad", spring_stiffness=PAD_STIFFNESS / 2, along=(0.0, 0.0, 1.0))
        for side in ("left", "right")
    )
    supports = (fem.FixedSupport(face="-y", along="y"), fem.FixedSupport(face="left pad", along="x"))
    model = fem.Model(mesh=mesh, media={"block": fem.isotropic_medium(**asdict(solid))}, fixed=supports, springs=pads)
    moves = fem.forced_response(model, load=fem.Output(face="contact", along="z"), frequency=0.0).real * normal_load / 2
    line = np.flatnonzero(np.isclose(mesh.nodes[:, 1], -shape.width / 4) & np.isclose(mesh.nodes[:, 2], 0.0, atol=1e-9))
    line = line[np.argsort(mesh.nodes[line, 0])]
    x, z = mesh.nodes[line, 0], moves[line, 2]
    deflection = z - np.interp([-PAD_DISTANCE / 2, PAD_DISTANCE / 2], x, z).mean()
    between = np.abs(x) <= PAD_DISTANCE / 2
    return BendingLine(position=x, deflection=deflection, largest_slope=float(np.abs(np.gradient(z, x))[between].max()))


def _within(centres: Floats, *, centre: float, half_length: float) -> NDArray[np.bool_]:
    """Which element faces have their centres within a length along the horn."""
    return np.asarray(np.abs(centres[:, 0] - centre) < half_length)


REGION_ROWS: Final = {"aluminium": 1, "steel": 4}
"""Row of the transition region of each horn in Table 2.1, counted from 1."""


def measured_region(horn: Horn) -> tuple[float, float]:
    """Limits of the transition region of a horn in Table 2.1. [m]"""
    start, end = (si_value(f"table-2.1-{side}-{REGION_ROWS[horn]}") for side in ("start", "end"))
    return start, end


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
    return [(float(limit), note) for limit in transition_region(friction)]


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


_TIP_MASS: Final = 0.02  # kg, about that of a steel stud of 1/2 in
_WEDGE: Final = 0.1


@cache
def frequency_changes() -> dict[str, float]:
    """Relative changes of the first axial frequency of the plain steel block by single assumptions. []

    By the assumption in words.
    """
    solid = printed_solid("steel")
    plain = axial_mode(printed_shape(), solid).natural_frequency
    return {assumption: frequency / plain - 1 for assumption, frequency in _varied(printed_shape(), solid)}


def _varied(shape: HornShape, solid: HornSolid) -> Iterator[tuple[str, float]]:
    """Yield assumptions with the first axial frequency of a horn that differs in each alone. [Hz]"""

    def of(shape: HornShape = shape, solid: HornSolid = solid) -> float:
        return axial_mode(shape, solid).natural_frequency

    yield "ends tapered to 3/4 in over 1 in", of(replace(shape, end_thickness_ratio=0.75))
    yield "the same over 1/2 in", of(replace(shape, end_thickness_ratio=0.75, taper_length=INCH / 2))
    yield "ends tapered to 1/2 in over 1 in", of(replace(shape, end_thickness_ratio=0.5))
    yield "one end 10 % wider than the other", of(replace(shape, wedge=_WEDGE))
    yield "1 % shorter", of(replace(shape, length=0.99 * shape.length))
    yield "10 % narrower", of(replace(shape, width=0.9 * shape.width))
    yield "10 % thinner", of(replace(shape, thickness=0.9 * shape.thickness))
    yield "Poisson's ratio 0.01 lower", of(solid=replace(solid, poisson_ratio=solid.poisson_ratio - 0.01))
    yield "Young's modulus 2.5 % higher", of(solid=replace(solid, youngs_modulus=1.025 * solid.youngs_modulus))
    yield "density 7850 kg/m³", of(solid=replace(solid, density=7850.0))
    yield ("two pads of 10⁸ N/m on either face", axial_mode_of(_on_pads(horn_model(shape, solid))).natural_frequency)
    yield ("20 g on one end", axial_mode_of(with_tip(horn_model(shape, solid), tip_mass=_TIP_MASS)).natural_frequency)


@cache
def node_positions() -> dict[str, float]:
    """Nodes of the axial motion of the steel horn of the printed frequency under single asymmetries. [m]

    Position from the centre, by the asymmetry in words.
    """
    return dict(_asymmetric())


def _asymmetric() -> Iterator[tuple[str, float]]:
    """Yield asymmetries with the position of the node under each alone. [m]"""
    shape, solid = assumed_shape(), ASSUMED_SOLIDS["steel"]
    resonance = axial_mode(shape, solid).natural_frequency

    def driven(frequency: float, elastic_loss: float) -> float:
        motion = driven_face("steel", frequency=frequency, elastic_loss=elastic_loss)
        return node_position(position=motion.position, axial=motion.axial.real)

    def free(mode: AxialMode) -> float:
        return node_position(position=mode.position, axial=mode.axial)

    yield "driven at its own 20.8 kHz", driven(resonance, 1e-3)
    yield "the same, loss factor 0.04", driven(resonance, 0.04)
    yield "driven at 20.0 kHz", driven(20.0e3, 1e-3)
    yield "driven at 19.6 kHz", driven(19.6e3, 1e-3)
    yield "right end 10 % wider than left", free(axial_mode(replace(shape, wedge=_WEDGE), solid))
    yield ("20 g on the right end", free(axial_mode_of(with_tip(horn_model(shape, solid), tip_mass=_TIP_MASS))))


def with_tip(model: Model, *, tip_mass: float) -> Model:
    """Model of a horn with a mass on its right end, distributed over the last layer of elements."""
    mesh, medium = model.mesh, model.media["block"]
    corners = mesh.nodes[mesh.elements[:, :4]]
    last = corners[:, :, 0].mean(axis=1) > np.unique(mesh.nodes[:, 0].round(9))[-3]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    layer = replace(medium, density=medium.density + tip_mass / 4 / float(volumes[last].sum()))
    return replace(
        model,
        mesh=replace(mesh, region_of_element=last.astype(np.int64), regions=("block", "tip")),
        media={"block": medium, "tip": layer},
    )


def _on_pads(model: Model) -> Model:
    """Model of a horn on two pads on either face."""
    spring = FaceSpring(face="-z", spring_stiffness=2 * PAD_STIFFNESS / 2, along=(0.0, 0.0, 1.0))
    return replace(model, springs=(spring,))
