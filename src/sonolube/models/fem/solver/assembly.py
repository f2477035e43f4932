r"""Assembly of the global matrices: mass, stiffness, piezoelectric coupling and permittivity.

With shape functions :math:`N_a` and the integrals of products of their gradients

.. math:: G_{akbl} = \int \frac{\partial N_a}{\partial x_k} \frac{\partial N_b}{\partial x_l}\, dV

the element matrices of nodes a and b and displacement components i and j are

.. math::

    M_{aibj} = \delta_{ij} \int \rho N_a N_b\, dV, \quad
    K_{aibj} = c^E_{ikjl} G_{akbl}, \quad
    C_{aib} = e_{lik} G_{akbl}, \quad
    P_{ab} = \varepsilon^S_{kl} G_{akbl}
"""

from typing import NamedTuple

import numpy as np
from scipy import sparse

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.element_order import adjugate, determinant, jacobian_matrices
from sonolube.models.fem.mesh.mesh import Mesh, lagrange_nodes, shape_functions, simplex_quadrature
from sonolube.models.fem.solver.model import FaceSpring, Model

POTENTIAL_SCALE = 1e10
"""Volts per unit of the scaled potential, which makes elastic and dielectric matrices of comparable size."""

_VOIGT = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])  # row in Voigt notation of a pair of indices
_CHUNK = 2**22  # gradients evaluated at a time, which bounds the memory


class GlobalMatrices(NamedTuple):
    """Global matrices without boundary conditions; node n has the displacement unknowns 3n to 3n+2 and potential n.

    Parameters
    ----------
    mass : sparse matrix, shape (3n, 3n)
    stiffness, stiffness_loss : sparse matrix, shape (3n, 3n)
        Real and imaginary part at constant electric field.
    coupling : sparse matrix, shape (3n, n)
        Force per unit of the scaled potential.
    dielectric, dielectric_loss : sparse matrix, shape (n, n)
        Charge per potential at constant strain, real part and negated imaginary part, in the scaled potential.
    """

    mass: sparse.csc_array
    stiffness: sparse.csc_array
    stiffness_loss: sparse.csc_array
    coupling: sparse.csc_array
    dielectric: sparse.csc_array
    dielectric_loss: sparse.csc_array


def assemble_matrices(model: Model) -> GlobalMatrices:
    """Global matrices of a model, its elastic foundations included.

    See Also
    --------
    sonolube.models.fem.solver.system.assemble_system : The same with boundary conditions applied.
    """
    mesh = model.mesh
    pattern = _SparsityPattern(mesh)
    mass, dielectric, dielectric_loss = (_Accumulator(pattern, (1, 1)) for _ in range(3))
    stiffness, stiffness_loss = (_Accumulator(pattern, (3, 3)) for _ in range(2))
    coupling = _Accumulator(pattern, (3, 1))
    for index, region in enumerate(mesh.regions):
        medium = model.media[region]
        c = medium.elastic_stiffness[_VOIGT[:, :, np.newaxis, np.newaxis], _VOIGT]  # c_ikjl
        for own in _chunks(np.flatnonzero(mesh.region_of_element == index), mesh.order):
            elements = mesh.elements[own]
            masses, gradient_products = _integrals(mesh.nodes[elements], mesh.order)
            at = pattern.positions_of_elements[own].ravel()
            elastic = c.transpose(0, 2, 1, 3).reshape(9, 9) @ gradient_products
            mass.add(at, medium.density * masses)  # of one direction
            stiffness.add(at, elastic)
            if medium.elastic_loss:
                stiffness_loss.add(at, medium.elastic_loss * elastic)
            if medium.stress_constants is not None and medium.permittivity is not None:
                e = POTENTIAL_SCALE * medium.stress_constants[:, _VOIGT]  # e_lik
                coupling.add(at, e.transpose(1, 2, 0).reshape(3, 9) @ gradient_products)
                capacitance = POTENTIAL_SCALE**2 * medium.permittivity.reshape(1, 9) @ gradient_products
                dielectric.add(at, capacitance)
                if medium.loss_tangent:
                    dielectric_loss.add(at, medium.loss_tangent * capacitance)
    for spring in model.springs:
        stiffness.add(pattern.positions(mesh.faces[spring.face]), _foundation_matrices(mesh, spring))
    others = (stiffness, stiffness_loss, coupling, dielectric, dielectric_loss)
    return GlobalMatrices(_repeated_in_three_directions(mass.matrix()), *(each.matrix() for each in others))


def scalar_mass_matrix(model: Model) -> sparse.csc_array:
    """Mass matrix of one displacement component, the same for all three.

    Parameters
    ----------
    model : Model

    Returns
    -------
    csc_array, shape (n, n)
        Over the nodes. [kg]
    """
    mesh = model.mesh
    points, weights = simplex_quadrature(2 * mesh.order, corners=4)
    value, gradient = shape_functions(mesh.order, points)
    density = np.array([model.media[region].density for region in mesh.regions])[mesh.region_of_element]
    volume = determinant(jacobian_matrices(mesh.nodes[mesh.elements], gradient)) * weights
    pattern = _SparsityPattern(mesh)
    total = _Accumulator(pattern, (1, 1))
    total.add(pattern.positions_of_elements.ravel(), _mass_integrals(value, volume * density[:, np.newaxis]))
    return total.matrix()


def tributary_areas(mesh: Mesh, face: str) -> Floats:
    r"""Tributary area of each node on a face: integrals of the shape functions over the face.

    .. math:: A_a = \int N_a\, dA

    Divided by their sum they are the weights of the mean of a nodal field over the face, and the nodal forces of a unit
    force distributed evenly over it.

    Parameters
    ----------
    mesh : Mesh
    face : str

    Returns
    -------
    ndarray, shape (n,)
        In m2, zero off the face; they sum to the area of the face.

    Raises
    ------
    UnknownName
        If the mesh has no such face.
    """
    mesh.face_nodes(face)
    triangles = mesh.faces[face]
    weights = np.zeros(mesh.node_count)
    np.add.at(weights, triangles, _face_masses(mesh, triangles).sum(axis=2))
    return weights


class _SparsityPattern:
    """Pairs of nodes that share an element, as sorted integer keys.

    Attributes
    ----------
    keys : ndarray of int, shape (p,)
        First node times the number of nodes, plus the second.
    size : int
        Number of nodes.
    positions_of_elements : ndarray of int, shape (e, a a)
        Positions in `keys` of the pairs of nodes of each element.
    """

    def __init__(self, mesh: Mesh) -> None:
        keys = _pair_keys(mesh.elements, mesh.node_count)
        order = np.argsort(keys)  # several times as fast as numpy.unique
        ordered = keys[order]
        is_first = np.diff(ordered, prepend=-1) > 0
        positions = np.empty_like(keys)
        positions[order] = np.cumsum(is_first) - 1
        self.keys, self.size = ordered[is_first], mesh.node_count
        self.positions_of_elements = positions.reshape(len(mesh.elements), -1)

    def positions(self, cells: Integers) -> Integers:
        """Positions in `keys` of the pairs of nodes of some triangles."""
        return np.searchsorted(self.keys, _pair_keys(cells, self.size))


def _pair_keys(cells: Integers, size: int) -> Integers:
    """Key of each ordered pair of nodes of each element or triangle."""
    return (cells[:, :, np.newaxis] * size + cells[:, np.newaxis]).ravel()


class _Accumulator:
    """Sum of element matrices in one sparse matrix of blocks of components."""

    def __init__(self, pattern: _SparsityPattern, components: tuple[int, int]) -> None:
        self.pattern, self.components = pattern, components
        self.blocks: Floats | None = None

    def add(self, positions: Integers, values: Floats) -> None:
        """Add the entries of element matrices at their positions, one row for each component."""
        if self.blocks is None:
            self.blocks = np.zeros((len(values), len(self.pattern.keys)))
        for block, entries in zip(self.blocks, values, strict=True):
            np.add.at(block, positions, entries)

    def matrix(self) -> sparse.csc_array:
        """Assembled sparse matrix."""
        size, (left, right) = self.pattern.size, self.components
        shape = (left * size, right * size)
        if self.blocks is None:
            return sparse.csc_array(shape)
        starts = np.searchsorted(self.pattern.keys, size * np.arange(size + 1))
        blocks = np.ascontiguousarray(self.blocks.T).reshape(-1, left, right)
        rows = sparse.bsr_array((blocks, self.pattern.keys % size, starts), shape=shape).tocsr()
        if left != right:
            return sparse.csc_array(rows.tocsc())
        return sparse.csc_array((rows.data, rows.indices, rows.indptr), shape=shape)  # symmetric


def _repeated_in_three_directions(matrix: sparse.csc_array) -> sparse.csc_array:
    """Matrix of all displacement components from that of one component."""
    size, lengths = matrix.shape[0], np.repeat(np.diff(matrix.indptr), 3)
    ends = np.cumsum(lengths)
    shift = np.repeat(matrix.indptr[:-1], 3) - ends + lengths  # from the entries of each column to those repeated
    column = np.repeat(np.arange(3 * size), lengths)
    entries = np.arange(len(column)) + shift[column]
    rows = 3 * matrix.indices[entries] + column % 3
    return sparse.csc_array((matrix.data[entries], rows, np.append(0, ends)), shape=(3 * size, 3 * size))


def _chunks(elements: Integers, order: int) -> list[Integers]:
    """Element numbers in chunks of bounded memory."""
    points, _ = simplex_quadrature(2 * order, corners=4)
    nodes = len(lagrange_nodes(order, corners=4))
    return np.array_split(elements, 1 + elements.size * nodes * len(points) * 3 // _CHUNK)


def _integrals(nodes: Floats, order: int) -> tuple[Floats, Floats]:
    """Element integrals of N_a N_b, shape (1, e a a), and of dN_a/dx_k dN_b/dx_l, shape (9, e a a)."""
    points, weights = simplex_quadrature(2 * order, corners=4)
    value, local_gradient = shape_functions(order, points)
    count, size = nodes.shape[:2]
    jacobian = jacobian_matrices(nodes, local_gradient)
    scale = determinant(jacobian)
    if not np.all(scale > 0):
        raise InvalidInput("a curved element is turned inside out; mesh the body with smaller elements")
    inverse = (adjugate(jacobian) * np.sqrt(weights / scale)).transpose(3, 2, 0, 1).reshape(len(weights), -1, 3)
    gradient = (inverse @ local_gradient.transpose(2, 1, 0)).reshape(len(weights), count, -1).swapaxes(0, 1)
    products = (gradient.swapaxes(1, 2) @ gradient).reshape(count, 3, size, 3, size)  # of (e, q, ka)
    return _mass_integrals(value, scale * weights), products.transpose(1, 3, 0, 2, 4).reshape(9, -1)


def _mass_integrals(value: Floats, weights: Floats) -> Floats:
    """Element integrals of N_a N_b, shape (1, e a a), from the weights of each element's points."""
    products = (value[:, np.newaxis] * value).reshape(-1, value.shape[1])
    return (weights @ products.T).reshape(1, -1)


def _face_masses(mesh: Mesh, triangles: Integers) -> Floats:
    """Integrals of N_a N_b over triangles, shape (t, b, b)."""
    points, weights = simplex_quadrature(2 * mesh.order, corners=3)
    value, gradient = shape_functions(mesh.order, points)
    tangents = np.einsum("tax,adq->tqdx", mesh.nodes[triangles], gradient, optimize=True)
    area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=-1) * weights
    return np.asarray((value * area[:, np.newaxis]) @ value.T)


def _foundation_matrices(mesh: Mesh, spring: FaceSpring) -> Floats:
    """Stiffness matrices of the triangles of an elastic foundation, shape (9, t b b)."""
    masses = _face_masses(mesh, mesh.faces[spring.face])
    n = spring.along
    direction = np.eye(3) if n is None else np.outer(n, n) / np.dot(n, n)
    return np.outer(direction, spring.spring_stiffness / masses.sum() * masses)
