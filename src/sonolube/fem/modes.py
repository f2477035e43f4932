"""Natural frequencies and mode shapes."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.fem.mesh import Mesh
from sonolube.fem.model import DIRECTIONS, Model
from sonolube.fem.system import Solve, System, on_nodes, shifted, system


class NotConverged(SonolubeError, ArithmeticError):
    """An iteration that did not reach its tolerance."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class NaturalModes:
    """Modes of a body with its drive short-circuited, in order of frequency.

    Parameters
    ----------
    natural_frequency : ndarray, shape (k,)
        Undamped natural frequencies, zero for rigid motions. [Hz]
    shapes : ndarray, shape (k, n, 3)
        Displacements of the nodes, of a modal mass of 1 kg.
    rigid : int
        How many rigid motions come first.
    """

    natural_frequency: Floats
    shapes: Floats
    rigid: int

    @property
    def elastic_frequency(self) -> Floats:
        """Natural frequencies of all but the rigid motions, in Hz."""
        return self.natural_frequency[self.rigid :]


def natural_modes(model: Model, *, count: int) -> NaturalModes:
    """Return the rigid motions and the lowest elastic modes of a body.

    Parameters
    ----------
    model : Model
        Driven electrodes are short-circuited; make them floating for the open circuit.
    count : int
        Number of elastic modes.

    Returns
    -------
    NaturalModes

    Raises
    ------
    InvalidInput
        If more modes are asked for than the mesh can have.
    NotConverged
        If the eigenvalue iteration does not converge.

    Notes
    -----
    Implicitly restarted Lanczos iteration about a negative shift, which keeps the factorised matrix definite though a
    free body has six zero frequencies; rigid motions are known and taken out beforehand. It is fastest with
    OPENBLAS_NUM_THREADS=1 in the environment: its products are small.

    References
    ----------
    .. [1] R. B. Lehoucq, D. C. Sorensen and C. Yang, ARPACK Users' Guide (1998). doi:10.1137/1.9780898719628
    """
    equations = system(model)
    return modes_of(model, equations, inverse=shifted(equations, shift=shift_for(model)), count=count)


def modes_of(model: Model, equations: System, *, inverse: Solve, count: int) -> NaturalModes:
    """Return the modes of equations already assembled and factorised.

    Parameters
    ----------
    model : Model
    equations : System
    inverse : callable
        What `shifted` returns for the shift of `shift_for`.
    count : int
        Number of elastic modes.

    Returns
    -------
    NaturalModes
    """
    rigid = _free_rigid_motions(model).reshape(-1, 3 * model.mesh.size)[:, equations.moving].T
    size, most = len(equations.moving), len(equations.moving) - rigid.shape[1] - 2
    if not 1 <= count <= most:
        raise InvalidInput(f"count must be from 1 to {most} on this mesh, got {count}")
    shift, still = shift_for(model), np.zeros(rigid.shape[1])
    known = _orthonormal(rigid, equations.mass)
    squares = still
    wanted = count
    # One Lanczos iteration can pass over a mode of the same frequency as another, so those found are taken out and
    # the iteration asked for one more, until it has none below.
    while wanted:
        fresh, vectors = _lowest(equations.mass, inverse, shift=shift, count=wanted, known=known)
        complete = len(squares) > len(still) and fresh.min() >= squares.max()
        if complete:
            break
        squares, known = np.concatenate([squares, fresh]), np.hstack([known, vectors])
        wanted = min(1, size - known.shape[1] - 2)
    order = np.argsort(squares)[: len(still) + count]
    return NaturalModes(
        natural_frequency=np.sqrt(np.maximum(squares[order], 0.0)) / (2 * np.pi),
        shapes=on_nodes(model, equations, known[:, order]),
        rigid=len(still),
    )


def _lowest(
    mass: sparse.csc_array, inverse: Solve, *, shift: float, count: int, known: Floats
) -> tuple[Floats, Floats]:
    """Return omega^2 and shapes of the lowest modes besides those known, which are orthonormal."""
    size = mass.shape[0]
    loaded = mass @ known

    def remaining(moves: Floats) -> Floats:
        return np.asarray(moves - known @ (loaded.T @ moves))

    start = remaining(np.random.default_rng(1 + known.shape[1]).standard_normal(size))
    try:
        squares, vectors = eigsh(
            mass,  # stands for the stiffness, of which only the shape is read
            k=count,
            M=mass,
            sigma=shift,
            OPinv=LinearOperator((size, size), matvec=lambda force: remaining(inverse(force)), dtype=np.float64),
            v0=start,
            ncv=min(size - 1, max(2 * count + 1, count + 20)),
            tol=1e-9,
        )
    except ArithmeticError as failure:
        raise NotConverged(f"the modes did not converge ({failure}); ask for fewer, or check the mesh") from None
    return squares, _orthonormal(remaining(vectors), mass)


def _orthonormal(vectors: Floats, mass: sparse.csc_array) -> Floats:
    triangle = np.linalg.cholesky(vectors.T @ (mass @ vectors)) if vectors.shape[1] else np.eye(0)
    return np.asarray(np.linalg.solve(triangle, vectors.T).T)


def shift_for(model: Model) -> float:
    """Return a negative shift of the size of the body's lowest resonances, in rad2/s2.

    Parameters
    ----------
    model : Model

    Returns
    -------
    float
    """
    extent = float(np.linalg.norm(np.ptp(model.mesh.nodes, axis=0)))
    speed = min(
        np.sqrt(medium.elastic_stiffness[3:, 3:].diagonal().min() / medium.density) for medium in model.media.values()
    )
    return -float((np.pi * speed / extent) ** 2)


def rigid_motions(model: Model) -> int:
    """Return how many of the six rigid motions of a body its supports leave free.

    Parameters
    ----------
    model : Model

    Returns
    -------
    int
    """
    return len(_free_rigid_motions(model))


def _free_rigid_motions(model: Model) -> Floats:
    """Return the rigid motions that no support resists, shape (r, n, 3)."""
    fields = rigid_fields(model.mesh)
    rows = [np.zeros((1, 6))]
    for support in model.fixed:
        nodes = np.arange(model.mesh.size) if support.face is None else model.mesh.face_nodes(support.face)
        rows += [fields[:, nodes, DIRECTIONS.index(letter)].T for letter in support.along]
    for spring in model.springs:
        held = np.eye(3) if spring.along is None else np.array([spring.along]) / np.linalg.norm(spring.along)
        rows += [(fields[:, model.mesh.face_nodes(spring.face)] @ direction).T for direction in held]
    stacked = np.concatenate(rows)
    resistance, combinations = np.linalg.eigh(stacked.T @ stacked / len(stacked))
    return np.asarray(np.einsum("fr,fni->rni", combinations[:, resistance < 1e-12], fields))


def rigid_fields(mesh: Mesh) -> Floats:
    """Return three translations and three rotations, shape (6, n, 3), the latter over the body's extent.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    ndarray, shape (6, n, 3)
    """
    arm = (mesh.nodes - mesh.nodes.mean(axis=0)) / np.ptp(mesh.nodes, axis=0).max()
    axes = np.eye(3)
    shifts = np.broadcast_to(axes[:, np.newaxis], (3, mesh.size, 3))
    return np.concatenate([shifts, np.cross(axes[:, np.newaxis], arm[np.newaxis])])
