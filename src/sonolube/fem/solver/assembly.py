"""Matrices of tetrahedra: mass, stiffness, piezoelectric coupling and permittivity.

All stiffnesses contract one array, the integrals of products of gradients, G_akbl = int dN_a/dx_k dN_b/dx_l dV, with
the tensor of the medium: c_ikjl for displacements, e_lik for the coupling, eps_kl for potentials.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.fem.solver.mesh import Mesh
from sonolube.fem.solver.model import Model
from sonolube.fem.solver.simplex import lagrange_nodes, shape_functions, simplex_quadrature

POTENTIAL_SCALE = 1e10
"""Volts to the unit of potential, so that elastic and dielectric stiffnesses are of one size."""

_VOIGT = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
_CHUNK = 2**22  # gradients at a time, which bounds the memory taken


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class GlobalMatrices:
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


def assemble_matrices(model: Model) -> GlobalMatrices:
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
    pairs = _Pairs.of(mesh)
    mass, dielectric, dielectric_loss = (_Sum(pairs, (1, 1)) for _ in range(3))
    stiffness, stiffness_loss, coupling = _Sum(pairs, (3, 3)), _Sum(pairs, (3, 3)), _Sum(pairs, (3, 1))
    for index, region in enumerate(mesh.regions):
        medium = model.media[region]
        c = medium.elastic_stiffness[_VOIGT[:, :, np.newaxis, np.newaxis], _VOIGT]  # c_ikjl
        for own in _chunks(np.flatnonzero(mesh.region_of_element == index), mesh.order):
            cells = mesh.elements[own]
            masses, products = _integrals(mesh.nodes[cells], mesh.order)
            elastic = products @ c.transpose(1, 3, 0, 2).reshape(9, 9)
            mass.add(cells, medium.density * masses)  # alike in all directions
            stiffness.add(cells, elastic)
            if medium.elastic_loss:
                stiffness_loss.add(cells, medium.elastic_loss * elastic)
            if medium.stress_constants is not None and medium.permittivity is not None:
                e = POTENTIAL_SCALE * medium.stress_constants[:, _VOIGT]  # e_lik
                coupling.add(cells, products @ e.transpose(2, 0, 1).reshape(9, 3))
                storing = products @ (POTENTIAL_SCALE**2 * medium.permittivity.ravel())
                dielectric.add(cells, storing)
                if medium.loss_tangent:
                    dielectric_loss.add(cells, medium.loss_tangent * storing)
    for spring in model.springs:
        stiffness.add(mesh.faces[spring.face], _spring(mesh, spring.face, spring.spring_stiffness, spring.along))
    return GlobalMatrices(
        mass=_in_three_directions(mass.matrix()),
        stiffness=stiffness.matrix(),
        stiffness_loss=stiffness_loss.matrix(),
        coupling=coupling.matrix(),
        dielectric=dielectric.matrix(),
        dielectric_loss=dielectric_loss.matrix(),
    )


def scalar_mass_matrix(model: Model) -> sparse.csc_array:
    """Return the mass matrix of a body in one direction, shape (n, n).

    Parameters
    ----------
    model : Model

    Returns
    -------
    sparse matrix, shape (n, n)
    """
    mesh = model.mesh
    places, weights = simplex_quadrature(2 * mesh.order, corners=4)
    value, slope = shape_functions(mesh.order, places)
    density = np.array([model.media[region].density for region in mesh.regions])[mesh.region_of_element]
    jacobian = np.einsum("eax,adq->eqdx", mesh.nodes[mesh.elements], slope, optimize=True)
    mass = np.linalg.det(jacobian) * weights * density[:, np.newaxis]
    total = _Sum(_Pairs.of(mesh), (1, 1))
    total.add(mesh.elements, (value * mass[:, np.newaxis]) @ value.T)
    return total.matrix()


def tributary_areas(mesh: Mesh, name: str) -> Floats:
    """Return the area each node stands for on a face, which sums to the face's area, in m2, shape (n,).

    Raises
    ------
    UnknownName
        If no face has this name.
    """
    mesh.face_nodes(name)
    triangles = mesh.faces[name]
    weights = np.zeros(mesh.node_count)
    np.add.at(weights, triangles, _face_masses(mesh, triangles).sum(axis=2))
    return weights


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Pairs:
    """Pairs of nodes that share an element, as keys in order.

    Parameters
    ----------
    keys : ndarray of int, shape (p,)
        First node times the number of nodes, plus the second.
    size : int
        Number of nodes.
    """

    keys: Integers
    size: int

    @classmethod
    def of(cls, mesh: Mesh) -> "_Pairs":
        keys = np.sort(_keys(mesh.elements, mesh.node_count))  # several times as fast as numpy's unique
        return cls(keys=keys[np.diff(keys, prepend=-1) > 0], size=mesh.node_count)

    def of_cells(self, cells: Integers) -> Integers:
        """Return the places of the pairs of nodes of elements or triangles."""
        return np.searchsorted(self.keys, _keys(cells, self.size))


def _keys(cells: Integers, size: int) -> Integers:
    return (cells[:, :, np.newaxis] * size + cells[:, np.newaxis]).ravel()


class _Sum:
    """Element matrices on their way into one sparse matrix."""

    def __init__(self, pairs: _Pairs, components: tuple[int, int]) -> None:
        self.pairs, self.components = pairs, components
        self.blocks: Floats | None = None

    def add(self, cells: Integers, values: Floats) -> None:
        """Add matrices of elements, shape (e, a, a, left * right), or of one component (e, a, a)."""
        places = self.pairs.of_cells(cells)
        columns = values.reshape(places.size, -1).T
        if self.blocks is None:
            self.blocks = np.zeros((len(columns), len(self.pairs.keys)))
        for block, column in zip(self.blocks, columns, strict=True):
            block += np.bincount(places, weights=column, minlength=block.size)

    def matrix(self) -> sparse.csc_array:
        size, (left, right) = self.pairs.size, self.components
        shape = (left * size, right * size)
        if self.blocks is None:
            return sparse.csc_array(shape)
        starts = np.searchsorted(self.pairs.keys, size * np.arange(size + 1))
        blocks = np.ascontiguousarray(self.blocks.T).reshape(-1, left, right)
        rows = sparse.bsr_array((blocks, self.pairs.keys % size, starts), shape=shape).tocsr()
        if left != right:
            return sparse.csc_array(rows.tocsc())
        return sparse.csc_array((rows.data, rows.indices, rows.indptr), shape=shape)  # symmetric


def _in_three_directions(matrix: sparse.csc_array) -> sparse.csc_array:
    """Return the matrix of all displacements from that of one direction."""
    return sparse.csc_array(sparse.kron(matrix, sparse.eye_array(3)))


def _chunks(elements: Integers, order: int) -> list[Integers]:
    places, _ = simplex_quadrature(2 * order, corners=4)
    nodes = len(lagrange_nodes(order, corners=4))
    return np.array_split(elements, 1 + elements.size * nodes * len(places) * 3 // _CHUNK)


def _integrals(nodes: Floats, order: int) -> tuple[Floats, Floats]:
    """Return int N_a N_b, shape (e, a, a), and int dN_a/dx_k dN_b/dx_l, shape (e, a, a, 9), of elements."""
    places, weights = simplex_quadrature(2 * order, corners=4)
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


def _face_masses(mesh: Mesh, triangles: Integers) -> Floats:
    """Return int N_a N_b dA of triangles, shape (t, b, b)."""
    places, weights = simplex_quadrature(2 * mesh.order, corners=3)
    value, slope = shape_functions(mesh.order, places)
    tangents = np.einsum("tax,adq->tqdx", mesh.nodes[triangles], slope, optimize=True)
    area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=-1) * weights
    return np.asarray((value * area[:, np.newaxis]) @ value.T)


def _spring(mesh: Mesh, face: str, stiffness: float, along: tuple[float, float, float] | None) -> Floats:
    """Return the stiffness of the triangles of a face, shape (t, b, b, 9)."""
    masses = _face_masses(mesh, mesh.faces[face])
    direction = np.eye(3) if along is None else np.outer(along, along) / np.dot(along, along)
    return np.asarray(stiffness / masses.sum() * masses[..., np.newaxis] * direction.ravel())
