"""Matrices of tetrahedra: mass, stiffness, piezoelectric coupling and permittivity.

All stiffnesses contract one array, the integrals of products of gradients, G_akbl = int dN_a/dx_k dN_b/dx_l dV, with
the tensor of the medium: c_ikjl for displacements, e_lik for the coupling, eps_kl for potentials.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.fem.mesh import Mesh
from sonolube.fem.model import Model
from sonolube.fem.simplex import Integers, quadrature, shape_functions

POTENTIAL_SCALE = 1e10
"""Volts to the unit of potential, so that elastic and dielectric stiffnesses are of one size."""

_VOIGT = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
_CHUNK = 2**22  # gradients at a time, which bounds the memory taken


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Matrices:
    """Matrices of a body before it is held or wired; unknowns of node n are 3n to 3n+2, its potential is n.

    Parameters
    ----------
    mass : sparse matrix, shape (3n, 3n)
    stiffness, stiffness_loss : sparse matrix, shape (3n, 3n)
        Real and imaginary part at constant field.
    coupling : sparse matrix, shape (3n, n)
        Force per unit of potential.
    dielectric, dielectric_loss : sparse matrix, shape (n, n)
        Charge per potential at constant strain, real part and negated imaginary part, in units of the scaled potential.
    """

    mass: sparse.csc_array
    stiffness: sparse.csc_array
    stiffness_loss: sparse.csc_array
    coupling: sparse.csc_array
    dielectric: sparse.csc_array
    dielectric_loss: sparse.csc_array


def assemble(model: Model) -> Matrices:
    """Return the matrices of a body, springs included.

    Parameters
    ----------
    model : Model

    Returns
    -------
    Matrices

    Raises
    ------
    InvalidInput
        If a curved element is turned inside out.
    """
    mesh = model.mesh
    n = mesh.size
    sums = {
        "mass": _Sum((n, n)),
        "stiffness": _Sum((3 * n, 3 * n)),
        "stiffness_loss": _Sum((3 * n, 3 * n)),
        "coupling": _Sum((3 * n, n)),
        "dielectric": _Sum((n, n)),
        "dielectric_loss": _Sum((n, n)),
    }
    for index, region in enumerate(mesh.regions):
        medium = model.media[region]
        own = mesh.elements[mesh.region_of_element == index]
        c = medium.elastic_stiffness[_VOIGT[:, :, np.newaxis, np.newaxis], _VOIGT]  # c_ikjl
        for cells in _chunks(own, mesh.order):
            moves = _moves(cells)
            masses, products = _integrals(mesh.nodes[cells], mesh.order)
            stiffness = _contracted(products, c.transpose(1, 3, 0, 2).reshape(9, 9), (3, 3))
            sums["mass"].add(cells, cells, medium.density * masses)  # alike in all directions
            sums["stiffness"].add(moves, moves, stiffness)
            if medium.elastic_loss:
                sums["stiffness_loss"].add(moves, moves, medium.elastic_loss * stiffness)
            if medium.stress_constants is not None and medium.permittivity is not None:
                e = POTENTIAL_SCALE * medium.stress_constants[:, _VOIGT]  # e_lik
                sums["coupling"].add(moves, cells, _contracted(products, e.transpose(2, 0, 1).reshape(9, 3), (3, 1)))
                eps = POTENTIAL_SCALE**2 * medium.permittivity.reshape(9, 1)
                dielectric = _contracted(products, eps, (1, 1))
                sums["dielectric"].add(cells, cells, dielectric)
                if medium.loss_tangent:
                    sums["dielectric_loss"].add(cells, cells, medium.loss_tangent * dielectric)
    for spring in model.springs:
        sums["stiffness"].add(*_spring(mesh, spring.face, spring.spring_stiffness, spring.along))
    matrices = {name: total.matrix() for name, total in sums.items()}
    matrices["mass"] = sparse.csc_array(sparse.kron(matrices["mass"], sparse.eye_array(3)))
    return Matrices(**matrices)


def mass_matrix(model: Model) -> sparse.csc_array:
    """Return the mass matrix of a body in one direction, shape (n, n).

    Parameters
    ----------
    model : Model

    Returns
    -------
    sparse matrix, shape (n, n)
    """
    mesh = model.mesh
    places, weights = quadrature(2 * mesh.order, corners=4)
    value, slope = shape_functions(mesh.order, places)
    density = np.array([model.media[region].density for region in mesh.regions])[mesh.region_of_element]
    jacobian = np.einsum("eax,adq->eqdx", mesh.nodes[mesh.elements], slope, optimize=True)
    mass = np.linalg.det(jacobian) * weights * density[:, np.newaxis]
    total = _Sum((mesh.size, mesh.size))
    total.add(mesh.elements, mesh.elements, (value * mass[:, np.newaxis]) @ value.T)
    return total.matrix()


def face_weights(mesh: Mesh, name: str) -> Floats:
    """Return the area each node stands for on a face, which sums to the face's area, in m2, shape (n,).

    Raises
    ------
    UnknownName
        If no face has this name.
    """
    mesh.face_nodes(name)
    triangles = mesh.faces[name]
    weights = np.zeros(mesh.size)
    np.add.at(weights, triangles, _face_masses(mesh, triangles).sum(axis=2))
    return weights


class _Sum:
    """Element matrices on their way into one sparse matrix."""

    def __init__(self, shape: tuple[int, int]) -> None:
        self.shape = shape
        self.parts: list[tuple[Integers, Integers, Floats]] = []

    def add(self, rows: Integers, columns: Integers, values: Floats) -> None:
        full = (len(rows), rows.shape[1], columns.shape[1])
        self.parts.append(
            (
                np.broadcast_to(rows[:, :, np.newaxis], full).ravel().astype(np.int32),
                np.broadcast_to(columns[:, np.newaxis], full).ravel().astype(np.int32),
                values.reshape(-1),
            )
        )

    def matrix(self) -> sparse.csc_array:
        if not self.parts:
            return sparse.csc_array(self.shape)
        rows, columns, values = (np.concatenate(part) for part in zip(*self.parts, strict=True))
        return sparse.coo_array((values, (rows, columns)), shape=self.shape).tocsc()


def _chunks(cells: Integers, order: int) -> list[Integers]:
    places, _ = quadrature(2 * order, corners=4)
    return np.array_split(cells, 1 + cells.size * len(places) * 3 // _CHUNK)


def _moves(cells: Integers) -> Integers:
    """Return the displacement unknowns of elements or triangles, node by node."""
    return (3 * cells[:, :, np.newaxis] + np.arange(3)).reshape(len(cells), -1)


def _integrals(nodes: Floats, order: int) -> tuple[Floats, Floats]:
    """Return int N_a N_b, shape (e, a, a), and int dN_a/dx_k dN_b/dx_l, shape (e, a, a, 9), of elements."""
    places, weights = quadrature(2 * order, corners=4)
    value, slope = shape_functions(order, places)
    count, size = nodes.shape[:2]
    jacobian = np.einsum("eax,adq->eqdx", nodes, slope, optimize=True)
    volume = np.linalg.det(jacobian) * weights
    if not np.all(volume > 0):
        raise InvalidInput("a curved element is turned inside out; mesh the body with smaller elements")
    masses = (value * volume[:, np.newaxis]) @ value.T
    inverse = np.linalg.inv(jacobian) * np.sqrt(volume)[:, :, np.newaxis, np.newaxis]
    gradient = (inverse @ slope.transpose(2, 1, 0)).reshape(count, len(weights), 3 * size)  # (e, q, ka)
    products = (gradient.transpose(0, 2, 1) @ gradient).reshape(count, 3, size, 3, size)
    return masses, products.transpose(0, 2, 4, 1, 3).reshape(count, size, size, 9)


def _contracted(products: Floats, tensor: Floats, components: tuple[int, int]) -> Floats:
    """Return element matrices from products of gradients and a tensor of shape (9, components)."""
    (count, size), (left, right) = products.shape[:2], components
    matrices = (products @ tensor).reshape(count, size, size, left, right)
    return matrices.transpose(0, 1, 3, 2, 4).reshape(count, size * left, size * right)


def _face_masses(mesh: Mesh, triangles: Integers) -> Floats:
    """Return int N_a N_b dA of triangles, shape (t, b, b)."""
    places, weights = quadrature(2 * mesh.order, corners=3)
    value, slope = shape_functions(mesh.order, places)
    tangents = np.einsum("tax,adq->tqdx", mesh.nodes[triangles], slope, optimize=True)
    area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=-1) * weights
    return np.asarray((value * area[:, np.newaxis]) @ value.T)


def _spring(
    mesh: Mesh, face: str, stiffness: float, along: tuple[float, float, float] | None
) -> tuple[Integers, Integers, Floats]:
    triangles = mesh.faces[face]
    masses = _face_masses(mesh, triangles)
    direction = np.eye(3) if along is None else np.outer(along, along) / np.dot(along, along)
    matrices = stiffness / masses.sum() * np.einsum("tab,ij->taibj", masses, direction)
    moves = _moves(triangles)
    return moves, moves, matrices.reshape(len(triangles), moves.shape[1], moves.shape[1])
