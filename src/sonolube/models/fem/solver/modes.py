"""Natural frequencies and mode shapes by block Lanczos iteration with a shift-inverted operator."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.models.fem.mesh.mesh import DIRECTIONS, Mesh
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.system import (
    LinearSolver,
    SystemMatrices,
    assemble_system,
    nodal_displacements,
    shift_invert_solver,
)

_BLOCK_SIZE = 8  # vectors in a block: highest multiplicity of an eigenvalue that is certain to be resolved
_RESIDUAL = 1e-5  # norm of a residual over the eigenvalue; the relative error of a frequency is of its square
_MAX_STEPS = 60
_RANK_TOLERANCE = 1e-14  # square of the smallest over the largest length of independent vectors in a block
_ROUNDING = 1e-26  # square of the length of a unit vector that remains as rounding of zero
_Basis = tuple[Floats, Floats]  # mass-orthonormal vectors, and their products with the mass matrix


class NotConverged(SonolubeError, ArithmeticError):
    """An iteration did not reach its tolerance."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class NaturalModes:
    """Natural modes of a body with short-circuited drive, in order of frequency.

    Parameters
    ----------
    natural_frequency : ndarray, shape (k,)
        Undamped natural frequencies, zero for rigid-body modes. [Hz]
    shapes : ndarray, shape (k, n, 3)
        Mode shapes: displacements of the nodes, normalised to a modal mass of 1 kg.
    rigid_body_count : int
        Number of rigid-body modes, which come first.
    """

    natural_frequency: Floats
    shapes: Floats
    rigid_body_count: int

    @property
    def elastic_frequency(self) -> Floats:
        """Natural frequencies without those of the rigid-body modes, in Hz."""
        return self.natural_frequency[self.rigid_body_count :]


def natural_modes(model: Model, *, count: int) -> NaturalModes:
    r"""Rigid-body modes and lowest elastic modes of a body, by block Lanczos iteration.

    Parameters
    ----------
    model : Model
        Driven electrodes are short-circuited; declare them floating for the open circuit.
    count : int
        Number of elastic modes.

    Returns
    -------
    NaturalModes

    Raises
    ------
    InvalidInput
        If the number is not positive, or above that of the degrees of freedom.
    NotConverged
        If the eigenvalue iteration does not converge.

    Notes
    -----
    Solves the generalised eigenvalue problem

    .. math:: \left(K + C P^{-1} C^\mathsf{T}\right) u = \omega^2 M u

    through the largest eigenvalues :math:`1/(\omega^2 - \sigma)` of the operator shifted by :math:`\sigma` and
    inverted. The shift is negative, which keeps the factorised matrix definite although a free body has six zero
    frequencies. Rigid-body modes are known in closed form and projected out. The initial block has eight random
    vectors, so that modes of up to eight coincident frequencies are all found. It is fastest with
    OPENBLAS_NUM_THREADS=1 in the environment, as its matrix products are small.

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
    """Natural modes from system matrices already assembled and factorised; see `natural_modes`."""
    rigid = _rigid_body_modes(model).reshape(-1, 3 * model.mesh.node_count)[:, equations.free_dofs].T
    most = len(equations.free_dofs) - rigid.shape[1] - 2
    if not 1 <= count <= most:
        raise InvalidInput(f"count must be from 1 to {most} on this mesh, got {count}")
    rigid, mass_rigid = _mass_orthonormal(rigid, equations.mass @ rigid)
    squares, elastic = _block_lanczos(
        equations.mass, inverse, shift=spectral_shift(model), count=count, deflated=(rigid, mass_rigid)
    )
    squares = np.concatenate([np.zeros(rigid.shape[1]), squares])
    return NaturalModes(
        natural_frequency=np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi),
        shapes=nodal_displacements(model, equations, np.hstack([rigid, elastic])),
        rigid_body_count=rigid.shape[1],
    )


def _block_lanczos(
    mass: sparse.csc_array, inverse: LinearSolver, *, shift: float, count: int, deflated: _Basis
) -> tuple[Floats, Floats]:
    """Squared angular frequencies and mass-orthonormal shapes of the lowest modes besides the deflated ones."""
    size, first = deflated[0].shape
    random = np.random.default_rng(1)
    basis, projection = deflated, np.zeros((0, 0))  # the latter of the inverse times the mass matrix
    block = mass_block = np.zeros((size, 0))
    for _ in range(_MAX_STEPS + count):
        if not block.shape[1]:  # at the start, or after an invariant subspace
            start = inverse(mass @ random.standard_normal((size, _BLOCK_SIZE)))
            block, mass_block = _orthonormal_beside(basis, start, mass)
        basis = np.hstack([basis[0], block]), np.hstack([basis[1], mass_block])
        image = inverse(mass_block)
        columns, added = basis[1].T @ image, block.shape[1]
        remainder = image - basis[0] @ columns
        block, mass_block = _orthonormal_beside(basis, remainder, mass, rounding=_ROUNDING * np.sum(columns**2))
        columns, coupling = columns[first:], mass_block.T @ image
        projection = np.block([[projection, columns[:-added]], [columns[:-added].T, columns[-added:]]])
        values, vectors = (part[..., : -count - 1 : -1] for part in np.linalg.eigh((projection + projection.T) / 2))
        residual = np.linalg.norm(coupling @ vectors[-added:], axis=0)
        if basis[0].shape[1] == size or (len(values) == count and np.all(residual < _RESIDUAL * values)):
            return shift + 1 / values, basis[0][:, first:] @ vectors
    raise NotConverged("the modes did not converge; ask for fewer, or check the mesh")


def _orthonormal_beside(basis: _Basis, block: Floats, mass: sparse.csc_array, *, rounding: float = 0.0) -> _Basis:
    """Mass-orthonormal basis of a block's component orthogonal to a given basis, and its product with mass."""
    vectors, mass_vectors = _mass_orthonormal(block, mass @ block, rounding=rounding)
    overlap = basis[1].T @ vectors
    return _mass_orthonormal(vectors - basis[0] @ overlap, mass_vectors - basis[1] @ overlap)  # twice is enough


def _mass_orthonormal(block: Floats, mass_block: Floats, *, rounding: float = 0.0) -> _Basis:
    """Mass-orthonormal basis of the numerically independent span of a block, and its product with mass."""
    squares, rotation = np.linalg.eigh(block.T @ mass_block)
    independent = squares > max(_RANK_TOLERANCE * squares.max(initial=0.0), rounding)
    scaled = rotation[:, independent] / np.sqrt(squares[independent])
    return block @ scaled, mass_block @ scaled


def spectral_shift(model: Model) -> float:
    r"""Negative spectral shift of the magnitude of the lowest squared angular frequencies.

    In rad2/s2.

    With the diagonal d of the bounding box and the lowest shear-wave speed :math:`c_s` of the media

    .. math:: \sigma = -\left(\frac{\pi c_s}{d}\right)^2
    """
    extent = float(np.linalg.norm(np.ptp(model.mesh.nodes, axis=0)))
    speed = min(
        np.sqrt(medium.elastic_stiffness[3:, 3:].diagonal().min() / medium.density) for medium in model.media.values()
    )
    return -float((np.pi * speed / extent) ** 2)


def rigid_body_mode_count(model: Model) -> int:
    """Number of rigid-body modes, out of six, that supports and foundations leave free.

    Parameters
    ----------
    model : Model

    Returns
    -------
    int
    """
    return len(_rigid_body_modes(model))


def _rigid_body_modes(model: Model) -> Floats:
    """Rigid-body displacements that no support or foundation resists, shape (r, n, 3)."""
    fields = _rigid_body_displacements(model.mesh)
    rows = [np.zeros((1, 6))]
    for support in model.fixed:
        nodes = np.arange(model.mesh.node_count) if support.face is None else model.mesh.face_nodes(support.face)
        rows += [fields[:, nodes, DIRECTIONS.index(letter)].T for letter in support.along]
    for spring in model.springs:
        directions = np.eye(3) if spring.along is None else np.array([spring.along]) / np.linalg.norm(spring.along)
        rows += [(fields[:, model.mesh.face_nodes(spring.face)] @ direction).T for direction in directions]
    stacked = np.concatenate(rows)
    resistance, combinations = np.linalg.eigh(stacked.T @ stacked / len(stacked))
    return np.asarray(np.einsum("fr,fni->rni", combinations[:, resistance < 1e-12], fields))


def _rigid_body_displacements(mesh: Mesh) -> Floats:
    """Nodal displacements of three unit translations and three rotations scaled by the extent of the body.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    ndarray, shape (6, n, 3)
    """
    arm = (mesh.nodes - mesh.nodes.mean(axis=0)) / np.ptp(mesh.nodes, axis=0).max()
    axes = np.eye(3)
    translations = np.broadcast_to(axes[:, np.newaxis], (3, mesh.node_count, 3))
    return np.concatenate([translations, np.cross(axes[:, np.newaxis], arm[np.newaxis])])
