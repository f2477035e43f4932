"""Decomposition of the motion of a bore in a mode into breathing, ovalling, translation and rotation."""

from collections.abc import Mapping, Sequence
from enum import StrEnum

import numpy as np

from sonolube.checks import Floats
from sonolube.models.fem.mesh.mesh import Mesh
from sonolube.models.fem.solver.assembly import tributary_areas


class BoreMotion(StrEnum):
    """Kinds of motion of a bore along z, in a body symmetric about the plane x = 0.

    In modes even about that plane the bore breathes, becomes oval along x and y or is displaced along y. In odd modes
    it rotates about its axis, becomes oval along the diagonals or is displaced along x. Both can have motion out of the
    x-y plane.
    """

    BREATHING = "breathing"
    OVAL = "oval"
    TRANSLATION_ALONG_Y = "translation along y"
    TORSIONAL = "torsional"
    DIAGONAL_OVAL = "diagonal oval"
    TRANSLATION_ALONG_X = "translation along x"
    OUT_OF_PLANE = "out of plane"


def bore_motion(
    mesh: Mesh, shapes: Floats, *, faces: Sequence[str], centre: tuple[float, float], odd_across: bool
) -> tuple[Mapping[BoreMotion, Floats], Floats]:
    r"""Fraction of the mean square displacement of a bore that is motion of each kind, and that mean square.

    Parameters
    ----------
    mesh : Mesh
        The whole body, or its half of positive x.
    shapes : ndarray, shape (k, n, 3)
        Mode shapes: displacements of the nodes.
    faces : sequence of str
        Names of the faces that form the bore.
    centre : tuple of two float
        Coordinates x and y of its axis, in m.
    odd_across : bool
        Whether the modes are odd about x = 0.

    Returns
    -------
    fractions : mapping of BoreMotion to ndarray, shape (k,)
        They sum to one except for three and more waves around the circumference, and motion that varies along the bore.
    mean_square : ndarray, shape (k,)
        In the square of the unit of the shapes.

    Notes
    -----
    With the mean :math:`\langle\cdot\rangle` over the area of the bore, the fraction of a kind with the displacement
    field w in the motion u is

    .. math:: \frac{\langle u \cdot w \rangle^2}{\langle w^2 \rangle \langle u^2 \rangle}

    With the angle a from x, the fields of even modes are :math:`e_r` (breathing),
    :math:`\cos 2a\, e_r - \tfrac12 \sin 2a\, e_t` (oval) and :math:`e_y` (translation); those of odd modes
    :math:`e_t` (torsional), :math:`\sin 2a\, e_r + \tfrac12 \cos 2a\, e_t` (diagonal oval) and :math:`e_x`. The ovals
    are inextensional bending of a ring with two waves around its circumference.

    References
    ----------
    .. [1] W. Soedel, Vibrations of Shells and Plates, 3rd ed., Marcel Dekker (2004).
    """
    areas = np.sum([tributary_areas(mesh, face) for face in faces], axis=0)
    nodes = np.flatnonzero(areas)
    weight = areas[nodes] / areas.sum()
    arm = mesh.nodes[nodes, :2] - centre
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
    displacement = shapes[:, nodes]
    mean_square = np.einsum("n,knd->k", weight, displacement**2)
    fractions = {
        kind: np.einsum("n,knd,nd->k", weight, displacement[..., :2], field) ** 2
        / (np.einsum("n,nd->", weight, field**2) * mean_square)
        for kind, field in fields.items()
    }
    fractions[BoreMotion.OUT_OF_PLANE] = np.einsum("n,kn->k", weight, displacement[..., 2] ** 2) / mean_square
    return fractions, mean_square
