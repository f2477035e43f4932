"""Motion of the cross-sections of a body along its axis: mean of a nodal field, nodal planes, ratio of the ends."""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats
from sonolube.models.fem.mesh.element_order import determinant, jacobian_matrices
from sonolube.models.fem.mesh.mesh import DIRECTIONS, Mesh, shape_functions, simplex_quadrature
from sonolube.models.fem.mode_analysis import ModeFamily

_SLICES = 48  # normal to the axis, over each of which a field is averaged
_END = 1e-6  # of the length, within which a node lies in an end face


def section_means(mesh: Mesh, field: Floats, *, axis: str) -> tuple[Floats, Floats]:
    """Mean of a nodal field over the cross-sections along an axis.

    `field` has shape (n,). Positions along the axis in m, and the means there, both over the volume of a thin slice.
    """
    along = DIRECTIONS.index(axis)
    points, weights = simplex_quadrature(2 * mesh.order, corners=4)
    value, gradient = shape_functions(mesh.order, points)
    volume = determinant(jacobian_matrices(mesh.nodes[mesh.elements], gradient)) * weights
    position, values = mesh.nodes[mesh.elements, along] @ value, field[mesh.elements] @ value
    edges = np.linspace(position.min(), position.max(), _SLICES + 1)
    slices = np.clip(np.digitize(position, edges) - 1, 0, _SLICES - 1).ravel()
    slice_volume = np.bincount(slices, volume.ravel(), minlength=_SLICES)
    filled = slice_volume > 0
    moments = [np.bincount(slices, (each * volume).ravel(), minlength=_SLICES)[filled] for each in (position, values)]
    return moments[0] / slice_volume[filled], moments[1] / slice_volume[filled]


def sign_changes(places: Floats, values: Floats) -> Floats:
    """Places at which values change their sign, by linear interpolation."""
    at = np.flatnonzero(np.diff(np.sign(values)))
    slope = (values[at + 1] - values[at]) / (places[at + 1] - places[at])
    return np.asarray(places[at] - values[at] / slope)


@dataclass(frozen=True, kw_only=True, slots=True)
class SectionMotion:
    """Motion of the cross-sections of a mode in the direction of its family.

    Parameters
    ----------
    end_ratio : float or None
        Mean displacement of the end at the highest coordinate over that of the other; of the turn, where a body twists;
        None where that end rests.
    nodal_planes : tuple of float
        Distances in m from the end at the lowest coordinate at which it changes its sign.
    """

    end_ratio: float | None
    nodal_planes: tuple[float, ...]


def mode_section_motion(mesh: Mesh, shape: Floats, *, axis: str, family: str) -> SectionMotion | None:
    """Motion of the cross-sections of a mode, of those families that move these as a whole.

    `shape` has shape (n, 3). Axial displacement of axial modes, deflection of bending ones, turn of torsional ones.
    """
    field = _field(mesh, shape, axis=axis, family=family)
    if field is None:
        return None
    coordinate = mesh.nodes[:, DIRECTIONS.index(axis)]
    low, high = float(coordinate.min()), float(coordinate.max())
    near = _END * (high - low)
    first, last = (float(field[np.abs(coordinate - end) <= near].mean()) for end in (low, high))
    position, means = section_means(mesh, field, axis=axis)
    rests = abs(first) <= _END * float(np.abs(field).max())
    return SectionMotion(
        end_ratio=None if rests else abs(last / first),
        nodal_planes=tuple((sign_changes(position, means) - low).tolist()),
    )


def _field(mesh: Mesh, shape: Floats, *, axis: str, family: str) -> Floats | None:
    """Nodal field by which the sections of a family of modes move."""
    along = DIRECTIONS.index(axis)
    across = [direction for direction in range(3) if direction != along]
    if family == ModeFamily.AXIAL:
        return shape[:, along]
    if family == ModeFamily.BENDING:
        means = np.array([section_means(mesh, shape[:, direction], axis=axis)[1] for direction in across])
        plane = np.linalg.svd(means)[0][:, 0]  # in which the sections move most
        return np.asarray(shape[:, across] @ plane)
    if family == ModeFamily.TORSIONAL:
        arm = mesh.nodes - mesh.nodes.mean(axis=0)
        return np.asarray(np.cross(arm, shape)[:, along])
    return None
