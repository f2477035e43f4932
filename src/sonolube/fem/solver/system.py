"""The equations of a held and wired body, and their factors.

K u + C p + c V = omega^2 M u + F,   C^T u - P p - p_V V = 0,   Q = P_VV V + p_V.p - c.u

with displacements u of what may move, potentials p of nodes without electrode and of floating electrodes, the drive
voltage V and its charge Q.
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
from sonolube.fem.solver.assembly import POTENTIAL_SCALE, assemble_matrices
from sonolube.fem.solver.model import DIRECTIONS, Model
from sonolube.fem.solver.multifrontal import multifrontal_factor, nested_dissection

LinearSolver = Callable[[NDArray[Any]], NDArray[Any]]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SystemMatrices:
    """Matrices of a held and wired body.

    Parameters
    ----------
    moving : ndarray of int, shape (m,)
        Displacement unknowns that may move: 3 times the node plus the direction.
    mass, stiffness, stiffness_loss : sparse matrix, shape (m, m)
    coupling : sparse matrix, shape (m, p)
    dielectric, dielectric_loss : sparse matrix, shape (p, p)
    drive_coupling : ndarray, shape (m,)
        Restoring force per volt with all potentials but the driven electrodes' at zero.
    drive_dielectric, drive_dielectric_loss : ndarray, shape (p,)
        Charge per volt of the drive on the nodes without electrode.
    drive_capacitance : complex
        Charge per volt on the driven electrodes, all else at zero.
    potential_nodes : ndarray of int, shape (p,)
        Node of each unknown potential, -1 for those of floating electrodes.
    """

    moving: Integers
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
    def potentials(self) -> int:
        """Number of unknown potentials, p."""
        return int(self.dielectric.shape[0])


def assemble_system(model: Model) -> SystemMatrices:
    """Return the equations of a body.

    Parameters
    ----------
    model : Model

    Returns
    -------
    System

    Raises
    ------
    InvalidInput
        If nothing may move.
    """
    raw = assemble_matrices(model)
    moving = _moving(model)
    potential, drive, potential_nodes = _wiring(model)
    return SystemMatrices(
        moving=moving,
        mass=_square(raw.mass, moving),
        stiffness=_square(raw.stiffness, moving),
        stiffness_loss=_square(raw.stiffness_loss, moving),
        coupling=sparse.csc_array(raw.coupling[moving] @ potential),
        dielectric=sparse.csc_array(potential.T @ raw.dielectric @ potential),
        dielectric_loss=sparse.csc_array(potential.T @ raw.dielectric_loss @ potential),
        drive_coupling=raw.coupling[moving] @ drive,
        drive_dielectric=potential.T @ (raw.dielectric @ drive),
        drive_dielectric_loss=potential.T @ (raw.dielectric_loss @ drive),
        drive_capacitance=complex(drive @ (raw.dielectric @ drive), -(drive @ (raw.dielectric_loss @ drive))),
        potential_nodes=potential_nodes,
    )


def superlu_factor(matrix: sparse.csc_array) -> LinearSolver:
    """Return what solves with a symmetric matrix that needs no pivoting: definite, or definite in two blocks.

    Parameters
    ----------
    matrix : sparse matrix, shape (n, n)

    Returns
    -------
    callable
        From the right side to the solution.

    Raises
    ------
    InvalidInput
        If the matrix is singular: the body is under-constrained.
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
    """Return what solves (K + C P^-1 C^T - shift M) u = f, the drive short-circuited.

    Parameters
    ----------
    model : Model
    equations : System
        Its equations.
    shift : float
        Square of the angular frequency, negative to stay off all resonances.

    Returns
    -------
    callable
        From real forces to displacements, both of shape (m,) or (m, k).
    """
    elastic = sparse.csc_array(equations.stiffness - shift * equations.mass)
    groups, signs = _groups(model, equations)
    if not equations.potentials:
        return multifrontal_factor(elastic, groups=groups, signs=signs)
    size = len(equations.moving)
    blocks = [[elastic, equations.coupling], [equations.coupling.T, -equations.dielectric]]
    coupled = sparse.csc_array(sparse.block_array(blocks, format="csc"))
    solve = multifrontal_factor(coupled, groups=groups, signs=signs)

    def condensed(right: NDArray[Any]) -> NDArray[Any]:
        padded = np.zeros((size + equations.potentials, *right.shape[1:]))
        padded[:size] = right
        return solve(padded)[:size]

    return condensed


def _groups(model: Model, equations: SystemMatrices) -> tuple[list[Integers], list[int]]:
    """Return the unknowns in the order of elimination, and whether the matrix is positive or negative there."""
    size, nodes = len(equations.moving), model.mesh.node_count
    moves = np.full(3 * nodes, -1)
    moves[equations.moving] = np.arange(size)
    potentials = np.full(nodes, -1)
    free = equations.potential_nodes >= 0
    potentials[equations.potential_nodes[free]] = size + np.flatnonzero(free)
    pairs = []
    for group in nested_dissection(model.mesh):
        pairs += [(moves.reshape(-1, 3)[group].ravel(), 1), (potentials[group], -1)]
    pairs.append((size + np.flatnonzero(~free), -1))
    kept = [(unknowns[unknowns >= 0], sign) for unknowns, sign in pairs if np.any(unknowns >= 0)]
    return [unknowns for unknowns, _ in kept], [sign for _, sign in kept]


def nodal_displacements(model: Model, equations: SystemMatrices, moves: NDArray[Any]) -> NDArray[Any]:
    """Return displacements of all nodes, shape (k, n, 3), from those of the unknowns, shape (m, k)."""
    full = np.zeros((3 * model.mesh.node_count, moves.shape[1]), dtype=moves.dtype)
    full[equations.moving] = moves
    return np.ascontiguousarray(full.T.reshape(moves.shape[1], model.mesh.node_count, 3))


def _square(matrix: sparse.csc_array, kept: Integers) -> sparse.csc_array:
    return matrix if len(kept) == matrix.shape[0] else sparse.csc_array(matrix[kept][:, kept])


def _moving(model: Model) -> Integers:
    free = np.ones((model.mesh.node_count, 3), dtype=bool)
    for support in model.fixed:
        nodes = np.arange(model.mesh.node_count) if support.face is None else model.mesh.face_nodes(support.face)
        held = np.array([DIRECTIONS.index(letter) for letter in support.along])
        free[nodes[:, np.newaxis], held] = False
    moving = np.flatnonzero(free)
    if not moving.size:
        raise InvalidInput("nothing may move: every direction of every node is fixed")
    return moving


def _wiring(model: Model) -> tuple[sparse.csc_array, Floats, Integers]:
    """Return how node potentials follow from the unknown ones, shape (n, p), and from the drive voltage, shape (n,).

    And the nodes of the unknown ones, shape (p,), -1 for floating electrodes.
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
    loose = [mesh.face_nodes(face) for face in electrodes.floating if poled]
    for nodes in loose:
        unknown[nodes] = -1
    free = np.flatnonzero(unknown == 0)
    rows = np.concatenate([free, *loose])
    columns = np.concatenate([np.arange(len(free)), *(np.full(len(own), len(free) + k) for k, own in enumerate(loose))])
    shape = (mesh.node_count, len(free) + len(loose))
    known = np.concatenate([free, np.full(len(loose), -1)])
    return sparse.csc_array((np.ones(len(rows)), (rows, columns)), shape=shape), drive, known
