"""Natural frequencies and mode shapes."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.fem.solver.mesh import Mesh
from sonolube.fem.solver.model import DIRECTIONS, Model
from sonolube.fem.solver.system import (
    LinearSolver,
    SystemMatrices,
    assemble_system,
    nodal_displacements,
    shift_invert_solver,
)

_BLOCK = 8  # vectors to a step: modes of one frequency are all found up to as many
_RESIDUAL = 1e-5  # of a mode over its eigenvalue; the frequency is right to its square
_MOST_STEPS = 60
_SAME = 1e-14  # square of the smallest over the largest length that can be told apart in a block
_ROUNDING = 1e-26  # square of what rounding leaves of a vector


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
    rigid_body_count : int
        How many rigid motions come first.
    """

    natural_frequency: Floats
    shapes: Floats
    rigid_body_count: int

    @property
    def elastic_frequency(self) -> Floats:
        """Natural frequencies of all but the rigid motions, in Hz."""
        return self.natural_frequency[self.rigid_body_count :]


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
    Block Lanczos iteration about a negative shift, which keeps the factorised matrix definite though a free body has
    six zero frequencies; rigid motions are known and taken out beforehand. Eight vectors drawn at random begin it, so
    that no mode is passed over where up to eight frequencies coincide. It is fastest with OPENBLAS_NUM_THREADS=1 in
    the environment: its products are small.

    References
    ----------
    .. [1] R. G. Grimes, J. G. Lewis and H. D. Simon, SIAM J. Matrix Anal. Appl. 15, 228 (1994).
       doi:10.1137/S0895479888151111
    """
    equations = assemble_system(model)
    return lanczos_modes(
        model, equations, inverse=shift_invert_solver(model, equations, shift=spectral_shift(model)), count=count
    )


def lanczos_modes(model: Model, equations: SystemMatrices, *, inverse: LinearSolver, count: int) -> NaturalModes:
    """Return the modes of equations already assembled and factorised.

    Parameters
    ----------
    model : Model
    equations : System
    inverse : callable
        What `shift_invert_solver` returns for the shift of `spectral_shift`.
    count : int
        Number of elastic modes.

    Returns
    -------
    NaturalModes
    """
    rigid = _free_rigid_motions(model).reshape(-1, 3 * model.mesh.node_count)[:, equations.moving].T
    most = len(equations.moving) - rigid.shape[1] - 2
    if not 1 <= count <= most:
        raise InvalidInput(f"count must be from 1 to {most} on this mesh, got {count}")
    still, _ = _orthonormal(rigid, equations.mass, rounding=0.0)
    squares, moving = _lowest(equations.mass, inverse, shift=spectral_shift(model), count=count, known=still)
    squares = np.concatenate([np.zeros(still.shape[1]), squares])
    return NaturalModes(
        natural_frequency=np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi),
        shapes=nodal_displacements(model, equations, np.hstack([still, moving])),
        rigid_body_count=still.shape[1],
    )


def _lowest(
    mass: sparse.csc_array, inverse: LinearSolver, *, shift: float, count: int, known: Floats
) -> tuple[Floats, Floats]:
    """Return omega^2 and shapes of the lowest modes besides those known, which are orthonormal."""
    size, first = len(known), known.shape[1]
    random = np.random.default_rng(1)
    basis, projected = known, np.zeros((0, 0))  # the latter the inverse times mass, on the basis
    fresh = loaded = np.zeros((size, 0))
    for _ in range(_MOST_STEPS + count):
        if not fresh.shape[1]:  # at first, or where a space of its own is found whole
            drawn = inverse(mass @ random.standard_normal((size, _BLOCK)))
            fresh, loaded = _beside(basis, drawn, mass)
        basis = np.hstack([basis, fresh])
        block = inverse(loaded)
        columns, added = basis.T @ (mass @ block), fresh.shape[1]
        fresh, loaded = _beside(basis, block - basis @ columns, mass, rounding=_ROUNDING * np.sum(columns**2))
        columns, beyond = columns[first:], loaded.T @ block
        projected = np.block([[projected, columns[:-added]], [columns[:-added].T, columns[-added:]]])
        values, mixtures = (part[..., : -count - 1 : -1] for part in np.linalg.eigh((projected + projected.T) / 2))
        residual = np.linalg.norm(beyond @ mixtures[-added:], axis=0)
        if basis.shape[1] == size or (len(values) == count and np.all(residual < _RESIDUAL * values)):
            return shift + 1 / values, basis[:, first:] @ mixtures
    raise NotConverged("the modes did not converge; ask for fewer, or check the mesh")


def _beside(basis: Floats, block: Floats, mass: sparse.csc_array, *, rounding: float = 0.0) -> tuple[Floats, Floats]:
    """Return what is new in a block beside a basis, orthonormal in the metric of mass, and its product with mass."""
    fresh, loaded = _orthonormal(block, mass, rounding=rounding)
    return _orthonormal(fresh - basis @ (basis.T @ loaded), mass, rounding=0.0)  # once more against rounding


def _orthonormal(block: Floats, mass: sparse.csc_array, *, rounding: float) -> tuple[Floats, Floats]:
    loaded = mass @ block
    squares, turns = np.linalg.eigh(block.T @ loaded)
    told = squares > max(_SAME * squares.max(initial=0.0), rounding)
    scaled = turns[:, told] / np.sqrt(squares[told])
    return np.asarray(block @ scaled), np.asarray(loaded @ scaled)


def spectral_shift(model: Model) -> float:
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


def rigid_body_mode_count(model: Model) -> int:
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
    fields = rigid_body_displacements(model.mesh)
    rows = [np.zeros((1, 6))]
    for support in model.fixed:
        nodes = np.arange(model.mesh.node_count) if support.face is None else model.mesh.face_nodes(support.face)
        rows += [fields[:, nodes, DIRECTIONS.index(letter)].T for letter in support.along]
    for spring in model.springs:
        held = np.eye(3) if spring.along is None else np.array([spring.along]) / np.linalg.norm(spring.along)
        rows += [(fields[:, model.mesh.face_nodes(spring.face)] @ direction).T for direction in held]
    stacked = np.concatenate(rows)
    resistance, combinations = np.linalg.eigh(stacked.T @ stacked / len(stacked))
    return np.asarray(np.einsum("fr,fni->rni", combinations[:, resistance < 1e-12], fields))


def rigid_body_displacements(mesh: Mesh) -> Floats:
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
    shifts = np.broadcast_to(axes[:, np.newaxis], (3, mesh.node_count, 3))
    return np.concatenate([shifts, np.cross(axes[:, np.newaxis], arm[np.newaxis])])
