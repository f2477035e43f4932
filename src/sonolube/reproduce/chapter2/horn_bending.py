"""Bending of the horn between the two pads that press it, section 2.1.6, and what it adds to friction.

A block that leaves the middle slides up the sag of the face: each newton of load then resists by the slope. The
distance of the pads and their stiffness are not printed: 4 in, half an inch long, of a soft plastic, are assumed.
"""

from dataclasses import dataclass
from functools import cache, partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.fem import (
    FaceSpring,
    FixedSupport,
    Model,
    Output,
    add_face_patch,
    box_mesh,
    forced_response,
    isotropic_medium,
)
from sonolube.reproduce.chapter2.poisson_horn import HornShape, HornSolid

PAD_DISTANCE: Final = 4 * 0.0254
"""Distance of the middles of both pads, assumed. [m]"""

_PAD_LENGTH: Final = 0.5 * 0.0254
PAD_STIFFNESS: Final = 1e8
"""Stiffness of each pad, assumed: of half a gigapascal, a square inch wide and an eighth of an inch thick. [N/m]"""

_CELL: Final = 0.25 * 0.0254
_ACROSS, _THROUGH = 3, 4


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Sag:
    """Bending of the horn's middle plane under a load on the middle of its face.

    Parameters
    ----------
    position : ndarray, shape (k,)
        Places along the horn, from the centre. [m]
    deflection : ndarray, shape (k,)
        Displacement along the load less that above the pads, in m.
    climb : float
        Greatest slope between the pads, in m/m.
    """

    position: Floats
    deflection: Floats
    climb: float


@cache
def sag(shape: HornShape, solid: HornSolid, *, normal_load: float) -> Sag:
    """Return how the plain block of a horn bends under a load across its middle.

    Parameters
    ----------
    shape : HornShape
    solid : HornSolid
    normal_load : float
        Load across the middle of the face. [N]

    Returns
    -------
    Sag
    """
    cells = round(shape.length / _CELL)
    mesh = box_mesh(
        length=shape.length,
        width=shape.width / 2,
        thickness=shape.thickness,
        divisions=(cells, _ACROSS, _THROUGH),
    )
    for name, face, middle, half in (
        ("left pad", "+z", -PAD_DISTANCE / 2, _PAD_LENGTH / 2),
        ("right pad", "+z", PAD_DISTANCE / 2, _PAD_LENGTH / 2),
        ("contact", "-z", 0.0, _CELL),
    ):
        mesh = add_face_patch(mesh, name, of=face, where=partial(_within, middle=middle, half=half))
    medium = isotropic_medium(
        youngs_modulus=solid.youngs_modulus, poisson_ratio=solid.poisson_ratio, density=solid.density
    )
    pads = tuple(
        # half of each pad, for half of the horn
        FaceSpring(face=f"{side} pad", spring_stiffness=PAD_STIFFNESS / 2, along=(0.0, 0.0, 1.0))
        for side in ("left", "right")
    )
    held = (FixedSupport(face="-y", along="y"), FixedSupport(face="left pad", along="x"))
    model = Model(mesh=mesh, media={"block": medium}, fixed=held, springs=pads)
    moves = forced_response(model, load=Output(face="contact", along="z"), frequency=0.0).real * normal_load / 2
    line = np.flatnonzero(np.isclose(mesh.nodes[:, 1], -shape.width / 4) & np.isclose(mesh.nodes[:, 2], 0.0, atol=1e-9))
    line = line[np.argsort(mesh.nodes[line, 0])]
    x, z = mesh.nodes[line, 0], moves[line, 2]
    deflection = z - np.interp([-PAD_DISTANCE / 2, PAD_DISTANCE / 2], x, z).mean()
    between = np.abs(x) <= PAD_DISTANCE / 2
    return Sag(position=x, deflection=deflection, climb=float(np.abs(np.gradient(z, x))[between].max()))


def _within(middles: Floats, *, middle: float, half: float) -> NDArray[np.bool_]:
    return np.asarray(np.abs(middles[:, 0] - middle) < half)
