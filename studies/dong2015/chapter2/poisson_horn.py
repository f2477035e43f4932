"""Finite-element model of the Poisson horn of section 2.1: axial mode, driven face, and friction along it.

D prints the three dimensions of the block, and of tapers and rounded edges only that they exist. The printed shape is
the plain block with the moduli of D and data-sheet densities; the assumed shape with the assumed solids is the one set
of assumptions that has both printed frequencies. A quarter of the horn is meshed: y = 0 and z = 0 are symmetry planes.

Motor region: the friction of a block that slides towards the node of the motion, at the speed of the tests of D, is
reversed, so that the face drives the block. Transition region: friction resists in both directions. The contact has
normal and tangential springs with the ratio of Mindlin and the stiffness of the rough contact at its load; nothing is
fitted.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from dong2015.published_rigs import Horn
from sonolube.checks import Complexes, Floats
from sonolube.design.horns.face import FaceFriction
from sonolube.facts.materials import material
from sonolube.facts.published import si_value
from sonolube.models import fem
from sonolube.models.contact import decay_length
from sonolube.models.friction import SpringContact, combined_oscillation_ratio
from sonolube.validation.contacts import Bodies, poisson_contact

_ALLOYS: Final = {"aluminium": "aluminium_2024", "steel": "stainless_steel_316"}
_SYMMETRY: Final = (fem.FixedSupport(face="-y", along="y"), fem.FixedSupport(face="+z", along="z"))
INCH: Final = 0.0254
"""Unit of the sizes of D 2.1. [m]"""
_TAPER_CELLS: Final = 2  # elements along either taper
_DIVISIONS: Final = (10, 2, 2)
_MODE_COUNT: Final = 5  # elastic modes of this symmetry; the first axial one is among the lowest three
ELASTIC_LOSS: Final = 1e-3
"""Loss tangent of the horns, assumed: a quality factor of 1000. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class HornSolid:
    """Isotropic elastic solid of a horn.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus. [Pa]
    poisson_ratio : float
        Poisson's ratio. []
    density : float
        Mass density. [kg/m3]
    """

    youngs_modulus: float
    poisson_ratio: float
    density: float


@dataclass(frozen=True, kw_only=True, slots=True)
class HornShape:
    """Dimensions of a horn.

    Parameters
    ----------
    length, width, thickness : float
        Extent along, across, and across the sliding face. [m]
    taper_length : float
        Length of either end over which the thickness falls symmetrically. [m]
    end_thickness_ratio : float
        Thickness of the ends over that of the middle.
    wedge : float
        Width of the right end minus that of the left end, over the width in the middle.
    """

    length: float
    width: float
    thickness: float
    taper_length: float = INCH
    end_thickness_ratio: float = 1.0
    wedge: float = 0.0


def printed_shape() -> HornShape:
    """Plain block of D 2.1.2."""
    return HornShape(
        length=si_value("2.1.2-waveguide-length"),
        width=si_value("2.1.2-waveguide-width"),
        thickness=si_value("2.1.2-waveguide-thickness"),
    )


def assumed_shape() -> HornShape:
    """Block whose last inch at either end tapers from 1 in to 3/4 in."""
    return replace(printed_shape(), end_thickness_ratio=0.75)


def printed_solid(horn: Horn) -> HornSolid:
    """Elastic constants of a horn from Table 3.1, its density from the data sheet of its alloy."""
    return HornSolid(
        youngs_modulus=si_value(f"table-3.1-youngs_modulus_{horn}-1"),
        poisson_ratio=si_value(f"table-3.1-poisson_ratio_{horn}-1"),
        density=material(_ALLOYS[horn]).value("density"),
    )


ASSUMED_SOLIDS: Final[Mapping[Horn, HornSolid]] = {
    "aluminium": HornSolid(youngs_modulus=70e9, poisson_ratio=0.33, density=2700.0),
    "steel": HornSolid(youngs_modulus=205e9, poisson_ratio=0.28, density=7850.0),
}
"""Handbook constants of plain aluminium and of a low-alloy steel, the defaults of general finite-element programs."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class AxialMode:
    """First axial mode of a horn.

    Parameters
    ----------
    natural_frequency : float
        Natural frequency. [Hz]
    position : ndarray, shape (k,)
        Position along the middle line of the sliding face, from the centre. [m]
    axial, normal : ndarray, shape (k,)
        Mode shape along the horn and out of its face; the axial one is 1 at the middle of the right end.
    """

    natural_frequency: float
    position: Floats
    axial: Floats
    normal: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FaceMotion:
    """Motion of the middle line of the sliding face under a force on the right end.

    Parameters
    ----------
    frequency : float
        Frequency of the force. [Hz]
    position : ndarray, shape (k,)
        Position along the line, from the centre. [m]
    axial, normal : ndarray of complex, shape (k,)
        Complex amplitudes along the horn and out of its face in m, the mean axial one of the driven end being real.
    """

    frequency: float
    position: Floats
    axial: Complexes
    normal: Complexes

    def at(self, position: ArrayLike) -> tuple[Complexes, Complexes]:
        """Complex amplitudes along the horn and out of its face at positions in m, by cubic splines. [m]"""
        return CubicSpline(self.position, self.axial)(position), CubicSpline(self.position, self.normal)(position)


def horn_model(
    shape: HornShape, solid: HornSolid, *, elastic_loss: float = 0.0, divisions: tuple[int, int, int] = _DIVISIONS
) -> fem.Model:
    """Finite-element model of a quarter of a horn.

    The sliding face is "-z", its middle line the edge with "-y".
    """
    medium = fem.isotropic_medium(**asdict(solid), elastic_loss=elastic_loss)
    return fem.Model(mesh=_quarter(shape, divisions), media={"block": medium}, fixed=_SYMMETRY)


@cache
def axial_mode(shape: HornShape, solid: HornSolid, *, divisions: tuple[int, int, int] = _DIVISIONS) -> AxialMode:
    """First axial mode: of the lowest symmetric modes the one with the largest axial fraction."""
    return axial_mode_of(horn_model(shape, solid, divisions=divisions))


def axial_mode_of(model: fem.Model) -> AxialMode:
    """First axial mode of the model of a quarter of a horn."""
    modes = fem.natural_modes(model, count=_MODE_COUNT)
    x = model.mesh.nodes[:, 0]
    stretch = np.sign(x - x.mean())
    elastic = modes.shapes[modes.rigid_body_count :]
    axial_fractions = np.abs((elastic[:, :, 0] * stretch).mean(axis=1)) / np.sqrt((elastic**2).sum(axis=2).mean(axis=1))
    best = int(np.argmax(axial_fractions))
    line = fem.edge_nodes(model.mesh, "-z", "-y", along="x")
    shape = elastic[best] / elastic[best][line[-1], 0]
    return AxialMode(
        natural_frequency=float(modes.elastic_frequency[best]),
        position=x[line],
        axial=shape[line, 0],
        normal=-shape[line, 2],
    )


@cache
def face_motion(
    shape: HornShape, solid: HornSolid, *, frequency: float, axial_amplitude: float, elastic_loss: float = ELASTIC_LOSS
) -> FaceMotion:
    """Motion of the sliding face under a force along the horn on its right end."""
    model = horn_model(shape, solid, elastic_loss=elastic_loss)
    displacement = fem.forced_response(model, load=fem.Output(face="+x", along="x"), frequency=frequency)
    end = displacement[model.mesh.face_nodes("+x"), 0].mean()
    line = fem.edge_nodes(model.mesh, "-z", "-y", along="x")
    scaled = displacement[line] * axial_amplitude / end
    return FaceMotion(frequency=frequency, position=model.mesh.nodes[line, 0], axial=scaled[:, 0], normal=-scaled[:, 2])


def node_position(*, position: Floats, axial: Floats) -> float:
    """Position of the node of an axial motion; of several nodes, of the one nearest to the centre. [m]"""
    return float(min(CubicSpline(position, axial).roots(extrapolate=False), key=abs))


def _quarter(shape: HornShape, divisions: tuple[int, int, int]) -> fem.Mesh:
    """Mesh of a quarter of a horn: a box mapped to tapers and wedge."""
    half, step = shape.length / 2, shape.length / divisions[0]
    flat = half - shape.taper_length
    columns = [-half, -half + _TAPER_CELLS * step, half - _TAPER_CELLS * step, half]
    corners = [-half, -flat, flat, half]
    ends = shape.end_thickness_ratio

    def tapered(nodes: Floats) -> Floats:
        x = np.interp(nodes[:, 0], columns, corners)
        y = (nodes[:, 1] + shape.width / 4) * (1 + shape.wedge * x / shape.length)
        z = (nodes[:, 2] - shape.thickness / 4) * np.interp(x, corners, [ends, 1.0, 1.0, ends])
        return np.column_stack([x, y, z])

    block = fem.box_mesh(length=shape.length, width=shape.width / 2, thickness=shape.thickness / 2, divisions=divisions)
    return fem.transform_nodes(block, tapered)


_COEFFICIENT: Final = {"aluminium": "3.1.4-coefficient-1", "steel": "3.1.4-coefficient-2"}
_POSITIONS: Final = 61  # on either side of the node
_STEPS: Final = 256
FACE_END: Final = 1.5 * INCH
"""Distance from the centre to the ends of the flat face, the range of Table 2.1. [m]"""

FACE_ASSUMPTIONS: Final = {
    "horn": "ends tapered to 3/4 in over their last inch, handbook constants, by which both have the printed mode",
    "contact": "springs of the contact of Table 3.1 with Mindlin's ratio, of the load of the dissertation's section"
    " 3.1.4; nothing is fitted",
    "elastic_loss": "loss factor 0.001",
}
"""What the friction along the face rests on that D does not print."""


def driven_face(
    horn: Horn, *, frequency: float, axial_amplitude: float | None = None, elastic_loss: float = ELASTIC_LOSS
) -> FaceMotion:
    """Motion of the face of a horn by the assumed shape and solid."""
    return face_motion(
        assumed_shape(),
        ASSUMED_SOLIDS[horn],
        frequency=frequency,
        axial_amplitude=si_value("2.1.2-welder-amplitude") if axial_amplitude is None else axial_amplitude,
        elastic_loss=elastic_loss,
    )


def spring_contact(horn: Horn, *, bodies: Bodies = "aluminium_steel") -> tuple[SpringContact, float]:
    """Spring-coupled contact under a horn, and the approach at which its springs carry the load. [m]"""
    rough = poisson_contact(bodies=bodies)
    springs = SpringContact(friction_coefficient=si_value(_COEFFICIENT[horn]), mindlin_ratio=rough.pair.mindlin_ratio)
    return springs, float(decay_length(rough))


def friction_on_face(
    horn: Horn, *, frequency: float, axial_amplitude: float | None = None, sliding_speed: float | None = None
) -> FaceFriction:
    """Friction along the face of a driven horn."""
    contact, approach = spring_contact(horn)
    motion = driven_face(horn, frequency=frequency, axial_amplitude=axial_amplitude)
    return friction_along(motion, contact, approach=approach, sliding_speed=sliding_speed)


def friction_along(
    motion: FaceMotion, contact: SpringContact, *, approach: float, sliding_speed: float | None = None
) -> FaceFriction:
    """Friction of a block that slides along a moving face towards its node."""
    node = node_position(position=motion.position, axial=motion.axial.real)
    sides = [np.linspace(-FACE_END, node, _POSITIONS), np.linspace(node, FACE_END, _POSITIONS)[1:]]
    position = np.concatenate(sides)
    axial, normal = motion.at(position)
    towards = np.repeat([1, -1], [len(side) for side in sides])
    ratio = combined_oscillation_ratio(
        contact,
        approach=approach,
        frequency=motion.frequency,
        sliding_speed=si_value("2.1.2-sliding-speed") if sliding_speed is None else sliding_speed,
        normal_amplitude=np.abs(normal),
        in_plane_amplitude=np.abs(axial),
        in_plane_phase=np.angle(normal / (towards * axial)),  # of the block relative to the face
        steps=_STEPS,
    )
    return FaceFriction(position=position, ratio=ratio, node=node)
