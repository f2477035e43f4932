"""Natural frequencies and mode shapes by block Lanczos iteration, on one mesh or to an accuracy by hp-refinement."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.models.fem.mesh.element_order import change_order
from sonolube.models.fem.mesh.grading import grade_reentrant_edges
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


_ORDERS = range(2, 7)  # of the elements on one mesh, before it is refined
_REFINEMENT = 0.62  # ratio of the element sizes of successive meshes: some four times the unknowns
_MIN_TOLERANCE = 1e-8  # below it, changes are rounding and the residual of the eigenvalue iteration
_NEEDED_ORDERS = 3  # on a mesh, before its error can be estimated
_RATIOS = (0.25, 0.6)  # least and greatest factor between successive changes assumed in the error estimate
_SINGULAR_RATIO = 1 / 3  # least such factor on bodies with re-entrant edges
_MIN_CHANGE = 0.1  # of the change before, as which an accidentally small last change counts


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ConvergedModes:
    """Natural modes on the last mesh, with frequencies extrapolated to infinite element order.

    Parameters
    ----------
    model : Model
        Finite-element model on the last mesh, with the highest element order.
    modes : NaturalModes
    natural_frequency : ndarray, shape (k,)
        Extrapolated natural frequencies, zero for rigid-body modes. [Hz]
    frequency_error : ndarray, shape (k,)
        Estimated relative error of the extrapolated frequencies. []
    nodes : tuple of int
        Number of nodes of each mesh, in order of computation.
    history : ndarray, shape (meshes, k)
        Natural frequencies in Hz on each mesh, likewise.
    """

    model: Model
    modes: NaturalModes
    natural_frequency: Floats
    frequency_error: Floats
    nodes: tuple[int, ...]
    history: Floats


def converged_modes(
    model_at: Callable[[float], Model],
    *,
    count: int,
    element_size: float,
    relative_tolerance: float = 1e-3,
    most_nodes: int = 60_000,
    required_modes: Callable[[Model, NaturalModes], Sequence[int]] | None = None,
    advance: Callable[[str, int, int], None] | None = None,
) -> ConvergedModes:
    """Natural modes whose estimated relative error of the frequency is within a tolerance, by hp-refinement.

    Parameters
    ----------
    model_at : callable
        From the largest element edge in m to the finite-element model on such a mesh, of any order.
    count : int
        Number of elastic modes.
    element_size : float
        Largest element edge of the first mesh; as large as the body is thick is the fastest. [m]
    relative_tolerance : float
        Largest estimated relative error of any frequency.
    most_nodes : int
        Largest admissible number of nodes.
    required_modes : callable, optional
        From model and modes to the indices of the modes that must be within the tolerance; all where absent.
    advance : callable, optional
        Progress callback, called with a description, the number of completed steps and the expected number.

    Returns
    -------
    ConvergedModes

    Raises
    ------
    InvalidInput
        If the tolerance is below 1e-8.
    NotConverged
        If the next mesh would have more than `most_nodes` nodes; the message states the error reached.

    Notes
    -----
    On one mesh the element order rises from two to six. In smooth bodies each order reduces the error by a factor of
    five to ten, and by less at re-entrant corners and where bodies are bonded. Elements of each order approximate the
    curved geometry to that order, so that the geometrical error falls likewise; next to re-entrant edges they are thin
    across them. If order six is not sufficient, the mesh is refined and graded once more.

    References
    ----------
    .. [1] I. Babuška and M. Suri, SIAM Rev. 36, 578 (1994). doi:10.1137/1036141
    """
    require_positive(element_size=element_size, relative_tolerance=relative_tolerance)
    if not relative_tolerance >= _MIN_TOLERANCE:
        raise InvalidInput(
            f"relative_tolerance must be at least {_MIN_TOLERANCE:g}, got {relative_tolerance:g}: smaller errors are "
            "hidden by rounding; no material's constants are known to better than 1e-6"
        )
    history: list[Floats] = []
    nodes: list[int] = []
    size, level, largest_error = element_size, 1, np.inf
    while True:
        base = model_at(size)
        mesh = grade_reentrant_edges(base.mesh, levels=level)
        for step, order in enumerate(_ORDERS, start=1):
            model = replace(base, mesh=change_order(mesh, order=order))
            if nodes and model.mesh.node_count > most_nodes:
                raise NotConverged(
                    f"the estimated error of the frequencies is {largest_error:.2g}, not {relative_tolerance:.2g}, "
                    f"on {nodes[-1]} nodes; the next mesh has {model.mesh.node_count}: allow more, "
                    "or request fewer modes or a larger tolerance"
                )
            modes = natural_modes(model, count=count)
            history.append(modes.natural_frequency)
            nodes.append(model.mesh.node_count)
            if advance:
                advance(f"{model.mesh.node_count} nodes", len(nodes), len(nodes) + 1)
            if step < _NEEDED_ORDERS:
                continue
            frequency, error = extrapolate_frequencies(np.array(history[-step:]), singular=mesh is not base.mesh)
            required = error[list(required_modes(model, modes))] if required_modes else error
            largest_error = float(required.max())
            if largest_error <= relative_tolerance:
                return ConvergedModes(
                    model=model,
                    modes=modes,
                    natural_frequency=frequency,
                    frequency_error=error,
                    nodes=tuple(nodes),
                    history=np.array(history),
                )
        size, level = size * _REFINEMENT, level + 1


def extrapolate_frequencies(history: Floats, *, singular: bool = False) -> tuple[Floats, Floats]:
    r"""Natural frequencies extrapolated to infinite element order, and their estimated relative errors.

    Parameters
    ----------
    history : ndarray, shape (orders, k)
        Natural frequencies in Hz at three or more successive element orders.
    singular : bool
        Whether the body has re-entrant edges.

    Returns
    -------
    frequency : ndarray, shape (k,)
        Extrapolated natural frequencies. [Hz]
    error : ndarray, shape (k,)
        Estimated relative errors.

    Raises
    ------
    InvalidInput
        If there are fewer than three orders.

    Notes
    -----
    With the last two changes, :math:`\Delta_n = f_{n-1} - f_n` and the one before, and the ratio
    :math:`r = |\Delta_n/\Delta_{n-1}|`, the changes to come are assumed to form a geometric series:

    .. math::

        f_\infty = f_n - \Delta_n \frac{r}{1 - r}, \qquad
        \epsilon = \frac{\max(|\Delta_n|,\, 0.1\, |\Delta_{n-1}|)}{f_\infty} \frac{r'}{1 - r'}

    In the error the ratio r' is at least a quarter. Near re-entrant edges, whose singularity dominates after a few
    orders, both ratios are at least a third: between orders five and six of a collar the changes fell by factors of
    0.21 to 0.31, whereas between four and five they had been 0.07 to 0.28. No ratio is taken above 0.6.
    """
    if len(history) < _NEEDED_ORDERS:
        raise InvalidInput(f"extrapolation needs three orders or more, got {len(history)}")
    before, last = np.abs(np.diff(history[-_NEEDED_ORDERS:], axis=0))
    ratio = np.divide(last, before, out=np.zeros_like(last), where=before > 0)
    least, conservative_least = (_SINGULAR_RATIO, _SINGULAR_RATIO) if singular else (0.0, _RATIOS[0])
    expected, conservative = np.clip(ratio, least, _RATIOS[1]), np.clip(ratio, conservative_least, _RATIOS[1])
    frequency = history[-1] - (history[-2] - history[-1]) * expected / (1 - expected)
    error = np.maximum(last, _MIN_CHANGE * before) * conservative / (1 - conservative)
    return frequency, np.divide(error, frequency, out=np.zeros_like(error), where=frequency > 0)
