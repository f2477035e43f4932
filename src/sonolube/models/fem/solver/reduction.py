"""Model order reduction of a driven piezoelectric body, by modes with static correction or by a Krylov subspace.

The reduced coordinates are the lowest natural modes and the quasi-static responses to each input, the voltage and a
force on each output, with the first correction to these; or those that the inputs excite. Modes that neither the
voltage nor a force on an output excites, such as bending of a straight stack, are not in the Krylov subspace, so that
far fewer vectors cover a frequency range than with all modes from the lowest upwards. Losses are hysteretic, stiffness
c (1 + i eta) and permittivity eps (1 - i tan delta) for fields proportional to exp(i omega t). They are projected onto
the coordinates, not assumed to be modal.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.mesh import DIRECTIONS
from sonolube.models.fem.solver.assembly import tributary_areas
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import NaturalModes, NotConverged, lanczos_modes, spectral_shift
from sonolube.models.fem.solver.system import (
    LinearSolver,
    SystemMatrices,
    assemble_system,
    nodal_displacements,
    shift_invert_solver,
    superlu_factor,
)

_KRYLOV_VECTORS = 2  # for each input: its quasi-static response and the first correction to it
_INDEPENDENT = 1e-7  # length of a unit vector's component beside the basis, from which it is added


@dataclass(frozen=True, kw_only=True, slots=True)
class Output:
    """Mean displacement of a face in one direction; as an input, a force distributed evenly over the face.

    Parameters
    ----------
    face : str
        Name of the face.
    along : str
        Direction: "x", "y" or "z".

    Raises
    ------
    InvalidInput
        If the direction is none of these.
    """

    face: str
    along: str

    def __post_init__(self) -> None:
        if len(self.along) != 1 or self.along not in DIRECTIONS:
            raise InvalidInput(f"an output must be along x, y or z, got {self.along!r}")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ReducedModel:
    r"""Piezoelectric body in a few generalised coordinates of unit mass.

    Parameters
    ----------
    stiffness : ndarray of complex, shape (k, k)
        K in rad2/s2, with hysteretic losses as imaginary part.
    drive : ndarray of complex, shape (k,)
        b: generalised force per volt.
    clamped_capacitance : complex
        C: charge per volt with all coordinates held; its imaginary part is the dielectric loss. [F]
    participation : ndarray, shape (o, k)
        d: outputs per coordinate.
    outputs : tuple of str
        Names of the outputs.

    Notes
    -----
    For the coordinates q, the voltage V, the charge Q, the outputs x and forces F on them

    .. math:: (K - \omega^2) q = b V + d^\mathsf{T} F, \qquad x = d q, \qquad Q = C V + b \cdot q
    """

    stiffness: Complexes
    drive: Complexes
    clamped_capacitance: complex
    participation: Floats
    outputs: tuple[str, ...]


def reduce_model(model: Model, *, count: int, outputs: Mapping[str, Output]) -> ReducedModel:
    """Reduced model of a driven body: its lowest natural modes and the static correction for all others.

    Parameters
    ----------
    model : Model
        With a driven electrode.
    count : int
        Number of elastic modes; accurate up to about two thirds of the highest of their frequencies.
    outputs : mapping of str to Output
        Displacements to observe and points of application of forces; may be empty. Those on a supported face are zero.

    Returns
    -------
    ReducedModel

    Raises
    ------
    InvalidInput
        If no piezoelectric region has a driven electrode.
    NotConverged
        If the eigenvalue iteration does not converge.

    See Also
    --------
    sonolube.models.fem.solver.reduction.krylov_reduction : Coordinates that drive and outputs excite, for a frequency
    range. sonolube.models.fem.solver.response.harmonic_response : Frequency response of the reduced model.
    """
    equations = assemble_system(model)
    inverse = shift_invert_solver(model, equations, shift=spectral_shift(model))
    modes = lanczos_modes(model, equations, inverse=inverse, count=count)
    vectors, _ = input_vectors(model, equations, outputs)
    return project_system(
        model, equations, basis=_corrected_basis(modes, equations, vectors=vectors, inverse=inverse), outputs=outputs
    )


def input_vectors(model: Model, equations: SystemMatrices, outputs: Mapping[str, Output]) -> tuple[Floats, float]:
    """Nodal forces per volt of the drive and per newton on each output, and the clamped capacitance, without losses.

    `forces` has shape (m, 1 + o). `capacitance`: Charge per volt with all displacements held. [F]
    """
    if not model.is_piezoelectric or not model.electrodes.driven:
        raise InvalidInput("nothing is driven: a piezoelectric region with a driven electrode is needed")
    force, capacitance = _drive(equations, _potential_solver(equations, lossless=True), lossless=True)
    return np.column_stack([force.real, output_matrix(model, equations, outputs).T]), capacitance.real


def project_system(
    model: Model, equations: SystemMatrices, *, basis: Floats, outputs: Mapping[str, Output]
) -> ReducedModel:
    r"""Galerkin projection of the lossy system onto a mass-orthonormal basis.

    `basis` has shape (m, k).

    With the complex stiffness K and permittivity matrix P of `sonolube.models.fem.solver.system`, potentials being
    condensed,

    .. math::

        K_q = \Phi^\mathsf{T} \left(K + C P^{-1} C^\mathsf{T}\right) \Phi, \qquad
        b = \Phi^\mathsf{T} \left(C P^{-1} p_V - c\right)
    """
    solve = _potential_solver(equations, lossless=False)
    force, capacitance = _drive(equations, solve, lossless=False)
    coupling = equations.coupling.T @ basis
    electric = coupling.T @ solve(coupling.astype(np.complex128)) if solve else 0.0
    elastic = basis.T @ (equations.stiffness @ basis) + 1j * (basis.T @ (equations.stiffness_loss @ basis))
    stiffness = elastic + electric
    return ReducedModel(
        stiffness=np.asarray((stiffness + stiffness.T) / 2, dtype=np.complex128),
        drive=np.asarray(basis.T @ force, dtype=np.complex128),
        clamped_capacitance=capacitance,
        participation=output_matrix(model, equations, outputs) @ basis,
        outputs=tuple(outputs),
    )


def output_matrix(model: Model, equations: SystemMatrices, outputs: Mapping[str, Output]) -> Floats:
    """Matrix of the outputs per displacement unknown: area-weighted means over faces.

    Shape (o, m). Its transpose has the nodal forces of a unit force on each output.
    """
    rows = np.zeros((len(outputs), model.mesh.node_count, 3))
    for row, output in zip(rows, outputs.values(), strict=True):
        areas = tributary_areas(model.mesh, output.face)
        row[:, DIRECTIONS.index(output.along)] = areas / areas.sum()
    return np.asarray(rows.reshape(len(outputs), 3 * model.mesh.node_count)[:, equations.free_dofs])


def _potential_solver(equations: SystemMatrices, *, lossless: bool) -> LinearSolver | None:
    """Solver for the unknown potentials at given displacements; None where there are none."""
    if not equations.potential_count:
        return None
    if lossless:
        return superlu_factor(equations.dielectric)
    return superlu_factor(sparse.csc_array(equations.dielectric - 1.0j * equations.dielectric_loss))


def _drive(equations: SystemMatrices, solve: LinearSolver | None, *, lossless: bool) -> tuple[Complexes, complex]:
    """Nodal forces per volt and clamped capacitance, with the unknown potentials condensed."""
    loss = 0.0 if lossless else equations.drive_dielectric_loss
    charge = equations.drive_dielectric - 1j * loss
    capacitance = equations.drive_capacitance.real if lossless else equations.drive_capacitance
    if solve is None:
        return -equations.drive_coupling.astype(np.complex128), complex(capacitance)
    potential = solve(charge.real if lossless else charge)
    force = np.asarray(equations.coupling @ potential - equations.drive_coupling)
    return force, complex(capacitance - charge @ potential)


def _corrected_basis(
    modes: NaturalModes, equations: SystemMatrices, *, vectors: Floats, inverse: LinearSolver
) -> Floats:
    """Mass-orthonormal basis of mode shapes and of the Krylov vectors of each input."""
    basis = modes.shapes.reshape(len(modes.shapes), -1)[:, equations.free_dofs].T
    for _ in range(_KRYLOV_VECTORS):
        vectors = inverse(vectors)
        basis = _extended_basis(basis, vectors, equations.mass)
        vectors = equations.mass @ vectors
    return basis


def _extended_basis(basis: Floats, vectors: Floats, mass: sparse.csc_array) -> Floats:
    """Basis extended by vectors, orthonormalised with respect to mass by repeated Gram-Schmidt."""
    for vector in vectors.T:
        length = np.sqrt(vector @ (mass @ vector))
        if not length:  # of an output on a supported face
            continue
        rest = vector / length
        for _ in range(2):  # twice is enough against rounding
            rest = rest - basis @ (basis.T @ (mass @ rest))
        remaining = np.sqrt(rest @ (mass @ rest))
        if remaining > _INDEPENDENT:
            basis = np.column_stack([basis, rest / remaining])
    return basis


_RESIDUAL = 1e-2  # norm of a residual over its eigenvalue; the relative error of a frequency is of its square
_UNCOUPLED = 2e-3  # squared coupling factor up to which a mode need not converge
_MIN_STEPS, _MAX_STEPS = 3, 60  # solutions with a block of vectors
_DEPENDENT = 1e-20  # squared length of a unit vector's new component, below which it counts as rounding


def krylov_reduction(
    model: Model, *, outputs: Mapping[str, Output], highest_frequency: float
) -> tuple[ReducedModel, Floats]:
    r"""Reduced model in the coordinates that the drive and forces on the outputs excite, accurate up to a frequency.

    Parameters
    ----------
    model : Model
        With a driven electrode.
    outputs : mapping of str to Output
        Displacements to observe and points of application of forces.
    highest_frequency : float
        Frequency up to which the driven modes converge. [Hz]

    Returns
    -------
    reduction : ReducedModel
    shapes : ndarray, shape (k, n, 3)
        Displacements of the nodes for each coordinate.

    Raises
    ------
    InvalidInput
        If no piezoelectric region has a driven electrode.
    NotConverged
        If the driven modes do not converge.

    Notes
    -----
    Block Lanczos iteration as in `natural_modes`, on the subspace

    .. math::

        \mathrm{span}\{A^{-1} F,\; A^{-1} M A^{-1} F,\; \ldots\}, \qquad
        A = K + C P^{-1} C^\mathsf{T} - \sigma M

    of the inputs F, one volt and one newton on each output, instead of random vectors [1]_.

    See Also
    --------
    sonolube.models.fem.solver.reduction.reduce_model : All of the lowest modes with static correction.

    References
    ----------
    .. [1] R. R. Craig and A. L. Hale, J. Guid. Control Dyn. 11, 562 (1988). doi:10.2514/3.20353
    """
    highest = (2 * np.pi * highest_frequency) ** 2
    equations, shift = assemble_system(model), spectral_shift(model)
    inverse = shift_invert_solver(model, equations, shift=shift)
    forces, capacitance = input_vectors(model, equations, outputs)
    basis = np.zeros((len(forces), 0))
    images = mass_basis = basis
    block = _orthonormal_beside(inverse(forces), basis, mass_basis, equations.mass)
    for step in range(_MAX_STEPS):
        basis, mass_basis = np.hstack([basis, block]), np.hstack([mass_basis, equations.mass @ block])
        added = block.shape[1]
        image = inverse(mass_basis[:, -added:])
        images = np.hstack([images, image])
        projection = mass_basis.T @ images
        values, vectors = np.linalg.eigh((projection + projection.T) / 2)
        remainder = image - basis @ projection[:, -added:]
        last = vectors[-added:]
        residual = np.einsum("ik,ij,jk->k", last, remainder.T @ (equations.mass @ remainder), last)  # squared
        squares = shift + 1 / values
        drive = (forces[:, 0] @ basis @ vectors) ** 2
        wanted = (squares < highest) & (drive > _UNCOUPLED * capacitance * squares)
        block = _orthonormal_beside(remainder, basis, mass_basis, equations.mass)
        converged = step >= _MIN_STEPS and np.all(residual[wanted] < (_RESIDUAL * values[wanted]) ** 2)
        if not block.shape[1] or converged:
            reduction = project_system(model, equations, basis=basis, outputs=outputs)
            return reduction, nodal_displacements(model, equations, basis)
    raise NotConverged("the driven modes did not converge; ask for a lower frequency, or check the mesh")


def _orthonormal_beside(block: Floats, basis: Floats, mass_basis: Floats, mass: sparse.csc_array) -> Floats:
    """Mass-orthonormal basis of a block's component orthogonal to a given basis."""
    block = block / np.sqrt(np.einsum("nk,nk->k", block, mass @ block) + np.finfo(float).tiny)
    vectors = block
    for _ in range(2):  # twice is enough against rounding
        vectors = vectors - basis @ (mass_basis.T @ vectors)
        squares, rotation = np.linalg.eigh(vectors.T @ (mass @ vectors))
        independent = squares > _DEPENDENT
        vectors = vectors @ (rotation[:, independent] / np.sqrt(squares[independent]))
    return np.asarray(vectors)
