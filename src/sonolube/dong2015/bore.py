"""How a hole moves in a mode: widening, turning oval, moving as a whole, or turning about its axis."""

from collections.abc import Mapping, Sequence
from enum import StrEnum

import numpy as np

from sonolube.checks import Floats
from sonolube.fem.solver.assembly import tributary_areas
from sonolube.fem.solver.mesh import Mesh


class BoreMotion(StrEnum):
    """Kinds of motion of a hole along z, in a body that is alike on both sides of x = 0.

    Even about that plane it widens, turns oval along y or moves along y; odd about it, it turns about its axis, turns
    oval along the diagonals or moves along x. Either way it can leave the x-y plane.
    """

    BREATHING = "breathing"
    OVAL = "oval"
    TRANSLATION_ALONG_Y = "translation along y"
    TORSIONAL = "torsional"
    DIAGONAL_OVAL = "diagonal oval"
    TRANSLATION_ALONG_X = "translation along x"
    OUT_OF_PLANE = "out of plane"


def bore_motion(
    mesh: Mesh, shapes: Floats, *, faces: Sequence[str], middle: tuple[float, float], odd_across: bool
) -> tuple[Mapping[BoreMotion, Floats], Floats]:
    """Return how much of a bore's mean square motion is of each kind, and that mean square.

    Parameters
    ----------
    mesh : Mesh
        A whole body, or its part of positive x.
    shapes : ndarray, shape (k, n, 3)
        Displacements of the nodes in each mode.
    faces : sequence of str
        Names of the faces that make the bore.
    middle : tuple of two float
        Where its axis crosses the x-y plane, in m.
    odd_across : bool
        Whether the modes are odd about x = 0.

    Returns
    -------
    shares : mapping of BoreMotion to ndarray, shape (k,)
        They sum to one but for waves of three and more to the circumference, and motions that vary along the bore.
    mean_square : ndarray, shape (k,)

    Notes
    -----
    A share is the square of the mean product with a field over the field's own mean square: e_r, cos 2a e_r -
    sin 2a e_t/2 and e_y, or e_t, sin 2a e_r + cos 2a e_t/2 and e_x, a the angle from x. The ovals are those of a ring
    that bends without stretching.
    """
    weight = np.sum([tributary_areas(mesh, face) for face in faces], axis=0)
    on = np.flatnonzero(weight)
    weight = weight[on] / weight.sum()
    arm = mesh.nodes[on, :2] - middle
    radial = arm / np.linalg.norm(arm, axis=1, keepdims=True)
    tangential = np.column_stack([-radial[:, 1], radial[:, 0]])
    twice = 2 * np.arctan2(arm[:, 1], arm[:, 0])[:, np.newaxis]
    if odd_across:
        fields = {
            BoreMotion.TORSIONAL: tangential,
            BoreMotion.DIAGONAL_OVAL: np.sin(twice) * radial + np.cos(twice) / 2 * tangential,
            BoreMotion.TRANSLATION_ALONG_X: np.broadcast_to([1.0, 0.0], radial.shape),
        }
    else:
        fields = {
            BoreMotion.BREATHING: radial,
            BoreMotion.OVAL: np.cos(twice) * radial - np.sin(twice) / 2 * tangential,
            BoreMotion.TRANSLATION_ALONG_Y: np.broadcast_to([0.0, 1.0], radial.shape),
        }
    moves = shapes[:, on]
    mean_square = np.einsum("n,knd->k", weight, moves**2)
    shares = {
        kind: np.einsum("n,knd,nd->k", weight, moves[..., :2], field) ** 2
        / (np.einsum("n,nd->", weight, field**2) * mean_square)
        for kind, field in fields.items()
    }
    shares[BoreMotion.OUT_OF_PLANE] = np.einsum("n,kn->k", weight, moves[..., 2] ** 2) / mean_square
    return shares, mean_square
