r"""Model order reduction of a driven piezoelectric body by modal truncation with static correction.

The reduced coordinates are the lowest natural modes and the quasi-static responses to each input, the voltage and a
force on each output, with the first correction to these. Losses are hysteretic, stiffness :math:`c(1 + i\eta)` and
permittivity :math:`\varepsilon(1 - i\tan\delta)` for fields proportional to :math:`\exp(i\omega t)`. They are
projected onto the coordinates, not assumed to be modal.
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
from sonolube.models.fem.solver.modes import NaturalModes, lanczos_modes, spectral_shift
from sonolube.models.fem.solver.system import (
    LinearSolver,
    SystemMatrices,
    assemble_system,
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
    sonolube.models.fem.solver.krylov.krylov_reduction : Coordinates that drive and outputs excite, for a frequency
    range. sonolube.models.fem.solver.harmonic_analysis.harmonic_response : Frequency response of the reduced model.
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
