r"""Discrete equations of a body with its boundary conditions, and direct solvers of them.

.. math::

    K u + C p + c V = \omega^2 M u + F, \qquad
    C^\mathsf{T} u - P p - p_V V = 0, \qquad
    Q = P_{VV} V + p_V \cdot p - c \cdot u

with the free displacement unknowns u, the potentials p of nodes without electrode and of floating electrodes, the
forces F, the drive voltage V and the charge Q on the driven electrodes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.mesh import DIRECTIONS
from sonolube.models.fem.solver.assembly import POTENTIAL_SCALE, assemble_matrices
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.multifrontal import multifrontal_factor, nested_dissection

LinearSolver = Callable[[NDArray[Any]], NDArray[Any]]
"""Action of an inverse matrix: from right-hand sides, shape (m,) or (m, k), to solutions of that shape."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SystemMatrices:
    """Matrices of a body with its supports and electrodes applied.

    Parameters
    ----------
    free_dofs : ndarray of int, shape (m,)
        Degrees of freedom without support: 3 times the node plus the direction.
    mass, stiffness, stiffness_loss : sparse matrix, shape (m, m)
        M, and the real and imaginary part of K.
    coupling : sparse matrix, shape (m, p)
        C.
    dielectric, dielectric_loss : sparse matrix, shape (p, p)
        Real part and negated imaginary part of P.
    drive_coupling : ndarray, shape (m,)
        c: restoring force per volt with all potentials but that of the driven electrodes at zero.
    drive_dielectric, drive_dielectric_loss : ndarray, shape (p,)
        Real part and negated imaginary part of p_V: charge at the nodes without electrode per volt of the drive.
    drive_capacitance : complex
        P_VV: charge on the driven electrodes per volt with all other unknowns at zero.
    potential_nodes : ndarray of int, shape (p,)
        Node of each unknown potential, -1 for those of floating electrodes.
    """

    free_dofs: Integers
    mass: sparse.csc_array
    stiffness: sparse.csc_array
    stiffness_loss: sparse.csc_array
    coupling: sparse.csc_array
    dielectric: sparse.csc_array
    dielectric_loss: sparse.csc_array
    drive_coupling: Floats
    drive_dielectric: Floats
    drive_dielectric_loss: Floats
    drive_capacitance: complex
    potential_nodes: Integers

    @property
    def potential_count(self) -> int:
        """Number of unknown potentials, p."""
        return int(self.dielectric.shape[0])


def assemble_system(model: Model) -> SystemMatrices:
    """System matrices of a model: global matrices with supports and electrodes applied."""
    matrices = assemble_matrices(model)
    free = _free_dofs(model)
    potential, drive, potential_nodes = _electrical_constraints(model)
    dielectric, dielectric_loss = matrices.dielectric, matrices.dielectric_loss
    return SystemMatrices(
        free_dofs=free,
        mass=_principal_submatrix(matrices.mass, free),
        stiffness=_principal_submatrix(matrices.stiffness, free),
        stiffness_loss=_principal_submatrix(matrices.stiffness_loss, free),
        coupling=sparse.csc_array(matrices.coupling[free] @ potential),
        dielectric=sparse.csc_array(potential.T @ dielectric @ potential),
        dielectric_loss=sparse.csc_array(potential.T @ dielectric_loss @ potential),
        drive_coupling=matrices.coupling[free] @ drive,
        drive_dielectric=potential.T @ (dielectric @ drive),
        drive_dielectric_loss=potential.T @ (dielectric_loss @ drive),
        drive_capacitance=complex(drive @ (dielectric @ drive), -(drive @ (dielectric_loss @ drive))),
        potential_nodes=potential_nodes,
    )


def superlu_factor(matrix: sparse.csc_array) -> LinearSolver:
    """Direct solver of a symmetric sparse matrix by SuperLU with minimum-degree ordering and diagonal pivots.

    `matrix` has shape (n, n).

    From the right-hand side to the solution.

    See Also
    --------
    sonolube.models.fem.solver.multifrontal.multifrontal_factor : Faster on large meshes, for real matrices.

    Source: J. W. Demmel, S. C. Eisenstat, J. R. Gilbert, X. S. Li and J. W. H. Liu, SIAM J. Matrix Anal. Appl. 20, 720
    (1999). doi:10.1137/S0895479895291765
    """
    try:
        factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as failure:
        raise InvalidInput(
            f"the equations have no unique solution ({failure}); hold the body, or ground an electrode of every "
            "piezoelectric part"
        ) from None
    return lambda right: np.asarray(factors.solve(right))


def shift_invert_solver(model: Model, equations: SystemMatrices, *, shift: float) -> LinearSolver:
    r"""Solver of the shifted elastic problem with the drive short-circuited, by multifrontal factorisation.

    From real forces to displacements, both of shape (m,) or (m, k).

    Solves, for the shift :math:`\sigma` and the forces f,

    .. math:: \left(K + C P^{-1} C^\mathsf{T} - \sigma M\right) u = f

    by the factorisation of the symmetric quasi-definite matrix

    .. math:: \begin{pmatrix} K - \sigma M & C \\ C^\mathsf{T} & -P \end{pmatrix}

    Source: R. J. Vanderbei, SIAM J. Optim. 5, 100 (1995). doi:10.1137/0805005
    """
    elastic = sparse.csc_array(equations.stiffness - shift * equations.mass)
    groups, signs = _elimination_order(model, equations)
    if not equations.potential_count:
        return multifrontal_factor(elastic, groups=groups, signs=signs)
    size = len(equations.free_dofs)
    coupled = _symmetric_block_matrix(elastic, equations.coupling, -equations.dielectric)
    solve = multifrontal_factor(coupled, groups=groups, signs=signs)

    def condensed(right: NDArray[Any]) -> NDArray[Any]:
        padded = np.zeros((size + equations.potential_count, *right.shape[1:]))
        padded[:size] = right
        return solve(padded)[:size]

    return condensed


def _symmetric_block_matrix(first: sparse.csc_array, coupling: sparse.csc_array, last: sparse.csc_array) -> Any:
    """Matrix of two symmetric blocks and their coupling, by rows, which scipy stacks several times as fast."""
    upper, lower = (sparse.csr_array((each.data, each.indices, each.indptr), each.shape) for each in (first, last))
    rows = sparse.block_array([[upper, coupling.tocsr()], [sparse.csr_array(coupling.T), lower]], format="csr")
    return sparse.csc_array((rows.data, rows.indices, rows.indptr), shape=rows.shape)  # symmetric


def _elimination_order(model: Model, equations: SystemMatrices) -> tuple[list[Integers], list[int]]:
    """Groups of unknowns in the order of elimination, and the sign of the pivots in each group."""
    size, nodes = len(equations.free_dofs), model.mesh.node_count
    displacements = np.full(3 * nodes, -1)
    displacements[equations.free_dofs] = np.arange(size)
    potentials = np.full(nodes, -1)
    at_node = equations.potential_nodes >= 0
    potentials[equations.potential_nodes[at_node]] = size + np.flatnonzero(at_node)
    pairs = []
    for group in nested_dissection(model.mesh):
        pairs += [(displacements.reshape(-1, 3)[group].ravel(), 1), (potentials[group], -1)]
    pairs.append((size + np.flatnonzero(~at_node), -1))
    nonempty = [(unknowns[unknowns >= 0], sign) for unknowns, sign in pairs if np.any(unknowns >= 0)]
    return [unknowns for unknowns, _ in nonempty], [sign for _, sign in nonempty]


def nodal_displacements(model: Model, equations: SystemMatrices, unknowns: NDArray[Any]) -> NDArray[Any]:
    """Displacements of all nodes from those of the free degrees of freedom.

    `unknowns` has shape (m, k).

    Shape (k, n, 3). Zero at supports.
    """
    full = np.zeros((3 * model.mesh.node_count, unknowns.shape[1]), dtype=unknowns.dtype)
    full[equations.free_dofs] = unknowns
    return np.ascontiguousarray(full.T.reshape(unknowns.shape[1], model.mesh.node_count, 3))


def _principal_submatrix(matrix: sparse.csc_array, kept: Integers) -> sparse.csc_array:
    """Rows and columns of a square matrix that are kept."""
    return matrix if len(kept) == matrix.shape[0] else sparse.csc_array(matrix[kept][:, kept])


def _free_dofs(model: Model) -> Integers:
    """Degrees of freedom that no support holds."""
    free = np.ones((model.mesh.node_count, 3), dtype=bool)
    for support in model.fixed:
        nodes = np.arange(model.mesh.node_count) if support.face is None else model.mesh.face_nodes(support.face)
        held = np.array([DIRECTIONS.index(letter) for letter in support.along])
        free[nodes[:, np.newaxis], held] = False
    dofs = np.flatnonzero(free)
    if not dofs.size:
        raise InvalidInput("no degree of freedom is free: every direction of every node is fixed; remove a support")
    return dofs


def _electrical_constraints(model: Model) -> tuple[sparse.csc_array, Floats, Integers]:
    """Nodal potentials in terms of the unknown ones, shape (n, p), and of the drive voltage, shape (n,).

    The third item is the node of each unknown potential, shape (p,), -1 for floating electrodes.
    """
    mesh, electrodes = model.mesh, model.electrodes
    unknown = np.full(mesh.node_count, -1)
    poled = [region for region in mesh.regions if model.media[region].is_piezoelectric]
    for region in poled:
        unknown[mesh.region_nodes(region)] = 0
    drive = np.zeros(mesh.node_count)
    for face in electrodes.driven:
        drive[mesh.face_nodes(face)] = 1 / POTENTIAL_SCALE
    for face in (*electrodes.driven, *electrodes.grounded):
        unknown[mesh.face_nodes(face)] = -1
    floating = [mesh.face_nodes(face) for face in electrodes.floating if poled]
    for nodes in floating:
        unknown[nodes] = -1
    free = np.flatnonzero(unknown == 0)
    rows = np.concatenate([free, *floating])
    columns = [np.arange(len(free)), *(np.full(len(nodes), len(free) + k) for k, nodes in enumerate(floating))]
    shape = (mesh.node_count, len(free) + len(floating))
    potential = sparse.csc_array((np.ones(len(rows)), (rows, np.concatenate(columns))), shape=shape)
    return potential, drive, np.concatenate([free, np.full(len(floating), -1)])
