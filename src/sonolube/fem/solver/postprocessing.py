"""What displacements of nodes mean elsewhere: at points of the body, and as stress."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput
from sonolube.fem.solver.mesh import Mesh
from sonolube.fem.solver.model import Model
from sonolube.fem.solver.simplex import lagrange_nodes, shape_functions

_NEIGHBOURS = 24  # elements near a point among which the one that holds it is sought
_OUTSIDE = 0.35  # of an element: points this far beyond it count as on the surface


def interpolate_at_points(mesh: Mesh, field: ArrayLike, *, points: ArrayLike) -> Floats:
    """Return a field of the nodes at points of the body, such as those a vibrometer scans.

    Parameters
    ----------
    mesh : Mesh
    field : array_like, shape (k, n, 3) or (n, 3)
        Such as mode shapes.
    points : array_like, shape (p, 3)
        Coordinates in m, in the body or on its surface.

    Returns
    -------
    ndarray, shape (k, p, 3) or (p, 3)

    Raises
    ------
    InvalidInput
        If a point lies outside the body.

    Notes
    -----
    By the shape functions of the elements, their edges taken as straight; a point just outside, as one on a curved
    side can be, takes the value the nearest element extends to it.
    """
    values, places = require_finite(field=field), np.atleast_2d(require_finite(points=points))
    if places.shape[1] != 3 or values.shape[-2:] != (mesh.node_count, 3):
        raise InvalidInput(f"points must have shape (p, 3) and the field that of the nodes, got {places.shape}")
    corner = mesh.nodes[mesh.elements[:, :4]]
    count = min(_NEIGHBOURS, len(corner))
    near = cKDTree(corner.mean(axis=1)).query(places, k=count)[1].reshape(len(places), count)
    edges = np.moveaxis(corner[near][:, :, 1:] - corner[near][:, :, :1], -1, -2)
    inner = np.linalg.solve(edges, (places[:, np.newaxis] - corner[near][:, :, 0])[..., np.newaxis])[..., 0]
    shares = np.concatenate([1 - inner.sum(axis=-1, keepdims=True), inner], axis=-1)
    best = shares.min(axis=-1).argmax(axis=1)
    row = np.arange(len(places))
    share, holder = shares[row, best], mesh.elements[near[row, best]]
    if share.min() < -_OUTSIDE:
        outside = places[int(share.min(axis=1).argmin())]
        raise InvalidInput(f"the point {tuple(round(float(x), 6) for x in outside)} m lies outside the body")
    weights, _ = shape_functions(mesh.order, share)
    return np.asarray(np.einsum("ap,...pai->...pi", weights, values[..., holder, :]))


def gauss_point_stress(model: Model, shape: ArrayLike) -> Floats:
    """Return the elastic stress in Pa in the elements, the fields in ceramics left out.

    Parameters
    ----------
    model : Model
    shape : array_like, shape (n, 3)
        Displacements in m.

    Returns
    -------
    ndarray, shape (m, 4, 6)
        At four points of each element, the one nearest its first corner first; xx, yy, zz, yz, xz, xy.

    Notes
    -----
    The points are those of Gauss, where the strain of quadratic elements is most accurate; at the corners of curved
    elements it scatters.
    """
    mesh, moves = model.mesh, require_finite(shape=shape)
    inside = np.full((4, 4), (5 - np.sqrt(5)) / 20)
    np.fill_diagonal(inside, (5 + 3 * np.sqrt(5)) / 20)
    _, slope = shape_functions(mesh.order, inside)  # (a, d, q)
    jacobian = np.einsum("eax,adq->eqdx", mesh.nodes[mesh.elements], slope, optimize=True)
    local = np.einsum("eai,adq->eqdi", moves[mesh.elements], slope, optimize=True)
    gradient = np.linalg.solve(jacobian, local)  # du_i/dx_k as (e, q, k, i)
    strain = gradient + np.swapaxes(gradient, -1, -2)
    pairs = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
    voigt = np.stack([strain[..., k, i] / (2 if k == i else 1) for k, i in pairs], axis=-1)
    stiffness = np.array([model.media[region].elastic_stiffness for region in mesh.regions])
    return np.asarray(np.einsum("eij,eqj->eqi", stiffness[mesh.region_of_element], voigt, optimize=True))


def von_mises_stress(stress: ArrayLike) -> Floats:
    """Return the equivalent stress of von Mises.

    Parameters
    ----------
    stress : array_like, shape (..., 6)
        Ordered xx, yy, zz, yz, xz, xy.

    Returns
    -------
    ndarray, shape (...)
        In the unit of the stress.
    """
    s = require_finite(stress=stress)
    normal, shear = s[..., :3], s[..., 3:]
    apart = normal - np.roll(normal, 1, axis=-1)
    return np.asarray(np.sqrt(0.5 * np.sum(apart**2, axis=-1) + 3 * np.sum(shear**2, axis=-1)))


def nodal_average(mesh: Mesh, at_corners: Floats) -> Floats:
    """Return the mean over all elements that meet in a node of values at their corners, straight between corners.

    Parameters
    ----------
    mesh : Mesh
    at_corners : ndarray, shape (m, 4)

    Returns
    -------
    ndarray, shape (n,)
    """
    total, count = np.zeros(mesh.node_count), np.zeros(mesh.node_count)
    np.add.at(total, mesh.elements[:, :4], at_corners)
    np.add.at(count, mesh.elements[:, :4], 1.0)
    mean = np.divide(total, count, out=np.zeros_like(total), where=count > 0)
    shares = lagrange_nodes(mesh.order, corners=4) / mesh.order
    mean[mesh.elements] = mean[mesh.elements[:, :4]] @ shares.T
    return mean
