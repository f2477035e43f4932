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
from sonolube.fem.assembly import face_weights
from sonolube.fem.model import DIRECTIONS, Model
from sonolube.fem.modes import NaturalModes, modes_of, shift_for
from sonolube.fem.system import Solve, System, factorised, shifted, system

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


def reduced(model: Model, *, count: int, outputs: Mapping[str, Output]) -> ReducedModel:
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
    equations = system(model)
    inverse = shifted(equations, shift=shift_for(model))
    modes = modes_of(model, equations, inverse=inverse, count=count)
    return reduction_of(model, equations, inverse=inverse, modes=modes, outputs=outputs)


def reduction_of(
    model: Model, equations: System, *, inverse: Solve, modes: NaturalModes, outputs: Mapping[str, Output]
) -> ReducedModel:
    """Return what `reduced` does, of equations already assembled and factorised and of modes already known.

    Parameters
    ----------
    model : Model
    equations : System
    inverse : callable
        What `shifted` returns for the shift of `shift_for`.
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
    if not model.is_piezoelectric or not model.electrodes.driven:
        raise InvalidInput("nothing is driven: a piezoelectric region with a driven electrode is needed")
    shapes = modes.shapes.reshape(len(modes.shapes), -1)[:, equations.moving].T
    observed = observers(model, equations, outputs)
    vectors = np.column_stack([_drive(equations, lossless=True)[0].real, observed.T])
    basis = shapes
    for _ in range(_KRYLOV):
        vectors = inverse(vectors)
        basis = _extended(basis, vectors, equations.mass)
        vectors = equations.mass @ vectors
    force, capacitance = _drive(equations, lossless=False)
    coupling = equations.coupling.T @ basis
    softened = _dielectric(equations, lossless=False)
    electric = coupling.T @ factorised(softened)(coupling.astype(np.complex128)) if equations.potentials else 0.0
    elastic = basis.T @ (equations.stiffness @ basis) + 1j * (basis.T @ (equations.stiffness_loss @ basis))
    stiffness = elastic + electric
    return ReducedModel(
        stiffness=np.asarray((stiffness + stiffness.T) / 2, dtype=np.complex128),
        drive=np.asarray(basis.T @ force, dtype=np.complex128),
        clamped_capacitance=capacitance,
        participation=observed @ basis,
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
    equations = system(model)
    observed = observers(model, equations, outputs)
    size = len(equations.moving)
    charges, moves = [], []
    dielectric, (right, charge) = _dielectric(equations, lossless=False), _driven(equations)
    for omega in 2 * np.pi * f:
        elastic = equations.stiffness + 1j * equations.stiffness_loss - omega**2 * equations.mass
        blocks = [[elastic, equations.coupling], [equations.coupling.T, -dielectric]]
        solution = factorised(sparse.csc_array(sparse.block_array(blocks, format="csc")))(right)
        moved, potential = solution[:size], solution[size:]
        charges.append(equations.drive_capacitance + charge @ potential - equations.drive_coupling @ moved)
        moves.append(observed @ moved)
    return HarmonicResponse(
        frequency=f,
        admittance=np.asarray(2j * np.pi * f * np.array(charges), dtype=np.complex128),
        displacement_per_volt=np.array(moves, dtype=np.complex128).T,
    )


def resonances_of(model: ReducedModel) -> tuple[Floats, Floats, Floats]:
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


def observers(model: Model, equations: System, outputs: Mapping[str, Output]) -> Floats:
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
    rows = np.zeros((len(outputs), model.mesh.size, 3))
    for row, output in zip(rows, outputs.values(), strict=True):
        weights = face_weights(model.mesh, output.face)
        row[:, DIRECTIONS.index(output.along)] = weights / weights.sum()
    return np.asarray(rows.reshape(len(outputs), 3 * model.mesh.size)[:, equations.moving])


def _dielectric(equations: System, *, lossless: bool) -> sparse.csc_array:
    return sparse.csc_array(equations.dielectric - (0.0 if lossless else 1.0j) * equations.dielectric_loss)


def _driven(equations: System, *, lossless: bool = False) -> tuple[Complexes, Complexes]:
    """Return the right side per volt of the coupled equations, and its dielectric part."""
    loss = 0.0 if lossless else equations.drive_dielectric_loss
    charge = np.asarray(equations.drive_dielectric - 1j * loss, dtype=np.complex128)
    return np.concatenate([-equations.drive_coupling, charge]).astype(np.complex128), charge


def _drive(equations: System, *, lossless: bool) -> tuple[Complexes, complex]:
    """Return force per volt, the potentials inside following it, and the capacitance with all motion held."""
    _, charge = _driven(equations, lossless=lossless)
    whole = equations.drive_capacitance.real if lossless else equations.drive_capacitance
    if not equations.potentials:
        return -equations.drive_coupling.astype(np.complex128), complex(whole)
    inner = factorised(_dielectric(equations, lossless=lossless).astype(np.complex128))(charge.astype(np.complex128))
    return equations.coupling @ inner - equations.drive_coupling, complex(whole - charge @ inner)


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
