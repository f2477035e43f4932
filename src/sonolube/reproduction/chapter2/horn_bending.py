"""Bending of the Poisson horn between its pads by finite elements, section 2.1.6, and its contribution to friction.

A block that slides away from the middle climbs the slope of the bent face, so that the load has a component against the
sliding. Distance and stiffness of the pads are not printed: 4 in, half an inch long, of a soft plastic, are assumed.
"""

from dataclasses import asdict, dataclass
from functools import cache, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.models import fem
from sonolube.reproduction.chapter2.poisson_horn import INCH, HornShape, HornSolid

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
