"""Piezoelectric response to a harmonic voltage: few coordinates for many frequencies, and the full equations to check.

Coordinates are modes, and what the drive and each output do below all resonances. Losses are hysteretic, stiffness
c (1 + i eta) and permittivity eps (1 - i tan delta), for motions as exp(i omega t), and are projected, not assumed
modal.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.solver.assembly import tributary_areas
from sonolube.fem.solver.model import DIRECTIONS, Model
from sonolube.fem.solver.modes import NaturalModes, lanczos_modes, spectral_shift
from sonolube.fem.solver.system import (
    LinearSolver,
    SystemMatrices,
    assemble_system,
    shift_invert_solver,
    superlu_factor,
)

_KRYLOV = 2  # vectors for each input: its response far below resonance and the first correction to it
_RIGID = 1e-9  # square of frequency over the largest, below which a motion is rigid


@dataclass(frozen=True, kw_only=True, slots=True)
class Output:
    """Mean displacement of a face in one direction, which is also where a force on it acts.

    Parameters
    ----------
    face : str
        Name of the face.
    along : str
        "x", "y" or "z".
    """

    face: str
    along: str

    def __post_init__(self) -> None:
        if len(self.along) != 1 or self.along not in DIRECTIONS:
            raise InvalidInput(f"an output must be along x, y or z, got {self.along!r}")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ReducedModel:
    """A piezoelectric body in few coordinates q: (K - omega^2) q = b V + d^T F, x = d q, Q = C V + b.q.

    Parameters
    ----------
    stiffness : ndarray of complex, shape (k, k)
        K in rad2/s2, for coordinates of unit mass.
    drive : ndarray of complex, shape (k,)
        b, force per volt.
    clamped_capacitance : complex
        C, charge per volt with all coordinates held; the imaginary part is the dielectric loss. [F]
    participation : ndarray, shape (o, k)
        d, outputs per coordinate.
    outputs : tuple of str
        Names of the outputs.
    """

    stiffness: Complexes
    drive: Complexes
    clamped_capacitance: complex
    participation: Floats
    outputs: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HarmonicResponse:
    """Response to one volt.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Frequency of the voltage. [Hz]
    admittance : ndarray of complex, shape (n,)
        Current per volt. [S]
    displacement_per_volt : ndarray of complex, shape (o, n)
        Outputs, amplitude over amplitude. [m/V]
    """

    frequency: Floats
    admittance: Complexes
    displacement_per_volt: Complexes


def reduce_model(model: Model, *, count: int, outputs: Mapping[str, Output]) -> ReducedModel:
    """Return a body in the coordinates of its lowest modes and of the static share of all others.

    Parameters
    ----------
    model : Model
        With a driven electrode.
    count : int
        Number of elastic modes; frequencies up to about two thirds of the last are well described.
    outputs : mapping of str to Output
        What to observe, and where forces act; may be empty, and those on a face that is held stay at zero.

    Returns
    -------
    ReducedModel

    Raises
    ------
    InvalidInput
        If nothing is driven.
    """
    equations = assemble_system(model)
    inverse = shift_invert_solver(model, equations, shift=spectral_shift(model))
    modes = lanczos_modes(model, equations, inverse=inverse, count=count)
    return reduce_system(model, equations, inverse=inverse, modes=modes, outputs=outputs)


def reduce_system(
    model: Model,
    equations: SystemMatrices,
    *,
    inverse: LinearSolver,
    modes: NaturalModes,
    outputs: Mapping[str, Output],
) -> ReducedModel:
    """Return what `reduce_model` does, of equations already assembled and factorised and of modes already known.

    Parameters
    ----------
    model : Model
    equations : System
    inverse : callable
        What `shift_invert_solver` returns for the shift of `spectral_shift`.
    modes : NaturalModes
    outputs : mapping of str to Output
        What to observe, and where forces act.

    Returns
    -------
    ReducedModel

    Raises
    ------
    InvalidInput
        If nothing is driven.
    """
    shapes = modes.shapes.reshape(len(modes.shapes), -1)[:, equations.moving].T
    vectors, _ = input_vectors(model, equations, outputs)
    basis = shapes
    for _ in range(_KRYLOV):
        vectors = inverse(vectors)
        basis = _extended(basis, vectors, equations.mass)
        vectors = equations.mass @ vectors
    return project_system(model, equations, basis=basis, outputs=outputs)


def input_vectors(model: Model, equations: SystemMatrices, outputs: Mapping[str, Output]) -> tuple[Floats, float]:
    """Return forces per volt of the drive and per newton on each output, and the capacitance with all motion held.

    Parameters
    ----------
    model : Model
    equations : System
    outputs : mapping of str to Output

    Returns
    -------
    tuple of ndarray, shape (m, 1 + o), and float
        Losses left out; the capacitance in F.

    Raises
    ------
    InvalidInput
        If nothing is driven.
    """
    if not model.is_piezoelectric or not model.electrodes.driven:
        raise InvalidInput("nothing is driven: a piezoelectric region with a driven electrode is needed")
    force, capacitance = _drive(equations, _electric(equations, lossless=True), lossless=True)
    return np.column_stack([force.real, output_matrix(model, equations, outputs).T]), capacitance.real


def project_system(
    model: Model, equations: SystemMatrices, *, basis: Floats, outputs: Mapping[str, Output]
) -> ReducedModel:
    """Return a body in the coordinates of some shapes, losses and all.

    Parameters
    ----------
    model : Model
    equations : System
    basis : ndarray, shape (m, k)
        Shapes, orthonormal in the metric of mass.
    outputs : mapping of str to Output

    Returns
    -------
    ReducedModel
    """
    inner = _electric(equations, lossless=False)
    force, capacitance = _drive(equations, inner, lossless=False)
    coupling = equations.coupling.T @ basis
    electric = coupling.T @ inner(coupling.astype(np.complex128)) if inner else 0.0
    elastic = basis.T @ (equations.stiffness @ basis) + 1j * (basis.T @ (equations.stiffness_loss @ basis))
    stiffness = elastic + electric
    return ReducedModel(
        stiffness=np.asarray((stiffness + stiffness.T) / 2, dtype=np.complex128),
        drive=np.asarray(basis.T @ force, dtype=np.complex128),
        clamped_capacitance=capacitance,
        participation=output_matrix(model, equations, outputs) @ basis,
        outputs=tuple(outputs),
    )


def harmonic_response(model: ReducedModel, *, frequency: ArrayLike) -> HarmonicResponse:
    """Return current and displacements per volt.

    Parameters
    ----------
    model : ReducedModel
    frequency : array_like, shape (n,)
        Frequency of the voltage. [Hz]

    Returns
    -------
    HarmonicResponse
    """
    f = np.atleast_1d(require_positive(frequency=frequency))
    omega = 2 * np.pi * f
    dynamic = model.stiffness - omega[:, np.newaxis, np.newaxis] ** 2 * np.eye(len(model.drive))
    forces = np.broadcast_to(model.drive[:, np.newaxis], (f.size, len(model.drive), 1))
    moved = np.linalg.solve(dynamic, forces)[..., 0]
    return HarmonicResponse(
        frequency=f,
        admittance=1j * omega * (model.clamped_capacitance + moved @ model.drive),
        displacement_per_volt=np.asarray(model.participation @ moved.T, dtype=np.complex128),
    )


def direct_response(model: Model, *, frequency: ArrayLike, outputs: Mapping[str, Output]) -> HarmonicResponse:
    """Return the same by solving the full equations at each frequency: slow, and free of the reduction's error.

    Parameters
    ----------
    model : Model
    frequency : array_like, shape (n,)
        Frequency of the voltage. [Hz]
    outputs : mapping of str to Output
        What to observe.

    Returns
    -------
    HarmonicResponse
    """
    f = np.atleast_1d(require_positive(frequency=frequency))
    equations = assemble_system(model)
    observed = output_matrix(model, equations, outputs)
    size = len(equations.moving)
    charges, moves = [], []
    dielectric, (right, charge) = _dielectric(equations), _driven(equations)
    for omega in 2 * np.pi * f:
        elastic = equations.stiffness + 1j * equations.stiffness_loss - omega**2 * equations.mass
        blocks = [[elastic, equations.coupling], [equations.coupling.T, -dielectric]]
        solution = superlu_factor(sparse.csc_array(sparse.block_array(blocks, format="csc")))(right)
        moved, potential = solution[:size], solution[size:]
        charges.append(equations.drive_capacitance + charge @ potential - equations.drive_coupling @ moved)
        moves.append(observed @ moved)
    return HarmonicResponse(
        frequency=f,
        admittance=np.asarray(2j * np.pi * f * np.array(charges), dtype=np.complex128),
        displacement_per_volt=np.array(moves, dtype=np.complex128).T,
    )


def series_parallel_resonances(model: ReducedModel) -> tuple[Floats, Floats, Floats]:
    """Return series and parallel resonances in Hz and the effective coupling factor of each, losses left out.

    Parameters
    ----------
    model : ReducedModel

    Returns
    -------
    tuple of three ndarray, shape (k,)
        Rigid motions have a frequency of zero. Beyond the modes asked for they are only bounds.

    Notes
    -----
    Between each series resonance and the next lies one parallel one; k_eff = sqrt(1 - (f_s/f_p)^2).
    """
    b, stiffness = model.drive.real, model.stiffness.real
    shorted, opened = (
        np.linalg.eigvalsh(matrix)
        for matrix in (stiffness, stiffness + np.outer(b, b) / model.clamped_capacitance.real)
    )
    rigid = shorted < _RIGID * shorted.max()
    shorted, opened = np.where(rigid, 0.0, shorted), np.where(rigid, 0.0, opened)
    ratio = np.divide(shorted, opened, out=np.ones_like(opened), where=opened > 0)
    coupling = np.sqrt(np.clip(1 - ratio, 0.0, 1.0))
    return np.sqrt(shorted) / (2 * np.pi), np.sqrt(opened) / (2 * np.pi), coupling


def output_matrix(model: Model, equations: SystemMatrices, outputs: Mapping[str, Output]) -> Floats:
    """Return what turns displacements of the unknowns into outputs, shape (o, m).

    Parameters
    ----------
    model : Model
    equations : System
    outputs : mapping of str to Output

    Returns
    -------
    ndarray, shape (o, m)
    """
    rows = np.zeros((len(outputs), model.mesh.node_count, 3))
    for row, output in zip(rows, outputs.values(), strict=True):
        weights = tributary_areas(model.mesh, output.face)
        row[:, DIRECTIONS.index(output.along)] = weights / weights.sum()
    return np.asarray(rows.reshape(len(outputs), 3 * model.mesh.node_count)[:, equations.moving])


def _dielectric(equations: SystemMatrices) -> sparse.csc_array:
    """Return the permittivity of the unknown potentials, losses and all."""
    return sparse.csc_array(equations.dielectric - 1.0j * equations.dielectric_loss)


def _driven(equations: SystemMatrices, *, lossless: bool = False) -> tuple[Complexes, Complexes]:
    """Return the right side per volt of the coupled equations, and its dielectric part."""
    loss = 0.0 if lossless else equations.drive_dielectric_loss
    charge = np.asarray(equations.drive_dielectric - 1j * loss, dtype=np.complex128)
    return np.concatenate([-equations.drive_coupling, charge]).astype(np.complex128), charge


def _electric(equations: SystemMatrices, *, lossless: bool) -> LinearSolver | None:
    """Return what solves for potentials inside, None where there are none."""
    if not equations.potentials:
        return None
    return superlu_factor(equations.dielectric if lossless else _dielectric(equations))


def _drive(equations: SystemMatrices, inner: LinearSolver | None, *, lossless: bool) -> tuple[Complexes, complex]:
    """Return force per volt, the potentials inside following it, and the capacitance with all motion held."""
    _, charge = _driven(equations, lossless=lossless)
    whole = equations.drive_capacitance.real if lossless else equations.drive_capacitance
    if inner is None:
        return -equations.drive_coupling.astype(np.complex128), complex(whole)
    potential = inner(charge.real if lossless else charge)
    return np.asarray(equations.coupling @ potential - equations.drive_coupling), complex(whole - charge @ potential)


def _extended(basis: Floats, vectors: Floats, mass: sparse.csc_array) -> Floats:
    """Return the basis with what is new in the vectors, orthonormal in the metric of mass."""
    for vector in vectors.T:
        length = np.sqrt(vector @ (mass @ vector))
        if not length:  # of an output that is held
            continue
        rest = vector / length
        for _ in range(2):  # once more against rounding
            rest = rest - basis @ (basis.T @ (mass @ rest))
        left = np.sqrt(rest @ (mass @ rest))
        if left > 1e-7:
            basis = np.column_stack([basis, rest / left])
    return basis
