"""Response to a voltage, resonances and structure for dynamics of a reduced model, and response to a force."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from sonolube.checks import Complexes, Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.dynamics import Structure, modal_structure
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import rigid_body_mode_count
from sonolube.models.fem.solver.reduction import Output, ReducedModel, output_matrix
from sonolube.models.fem.solver.system import assemble_system, nodal_displacements, superlu_factor


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HarmonicResponse:
    """Admittance and displacements per volt over frequency.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Frequency of the voltage. [Hz]
    admittance : ndarray of complex, shape (n,)
        Current per volt. [S]
    displacement_per_volt : ndarray of complex, shape (o, n)
        Complex amplitude of each output per volt. [m/V]
    """

    frequency: Floats
    admittance: Complexes
    displacement_per_volt: Complexes


def harmonic_response(model: ReducedModel, *, frequency: ArrayLike) -> HarmonicResponse:
    r"""Frequency response of a reduced model: admittance and displacements per volt.

    Parameters
    ----------
    model : ReducedModel
    frequency : array_like, shape (n,)
        Frequency of the voltage. [Hz]

    Returns
    -------
    HarmonicResponse

    Raises
    ------
    InvalidInput
        If a frequency is not positive.

    Notes
    -----
    In the notation of `ReducedModel`

    .. math::

        Y = i\omega \left(C + b^\mathsf{T} (K - \omega^2)^{-1} b\right), \qquad
        \frac{x}{V} = d\, (K - \omega^2)^{-1} b
    """
    f = np.atleast_1d(require_positive(frequency=frequency))
    omega = 2 * np.pi * f
    dynamic_stiffness = model.stiffness - omega[:, np.newaxis, np.newaxis] ** 2 * np.eye(len(model.drive))
    forces = np.broadcast_to(model.drive[:, np.newaxis], (f.size, len(model.drive), 1))
    coordinates = np.linalg.solve(dynamic_stiffness, forces)[..., 0]
    return HarmonicResponse(
        frequency=f,
        admittance=1j * omega * (model.clamped_capacitance + coordinates @ model.drive),
        displacement_per_volt=np.asarray(model.participation @ coordinates.T, dtype=np.complex128),
    )


_RIGID = 1e-9  # squared frequency over the largest, up to which a mode counts as rigid-body mode
_UNCOUPLED = 1e-3  # squared coupling factor up to which a mode counts as not driven


def coupled_resonances(model: ReducedModel) -> tuple[Floats, Floats, Floats]:
    r"""Series and parallel resonances of each mode, without losses; modes that the voltage does not drive have one.

    Parameters
    ----------
    model : ReducedModel

    Returns
    -------
    series, parallel : ndarray, shape (k,)
        Short-circuit and open-circuit natural frequencies in Hz, in order of the former. Both are the same for a mode
        that is not driven, even where it lies between the two frequencies of one that is.
    coupling : ndarray, shape (k,)
        Effective coupling factors, zero for modes that are not driven.

    Notes
    -----
    Squared angular frequencies are the eigenvalues of K and, for the driven modes alone, those of a squared coupling
    factor above 0.001, of

    .. math:: K + \frac{b\, b^\mathsf{T}}{C}

    By interlacing, one parallel resonance lies between each series resonance and the next, and

    .. math:: k_\mathrm{eff} = \sqrt{1 - (f_s/f_p)^2}
    """
    squares, shapes = undamped_modes(model)
    drive = shapes.T @ model.drive.real
    capacitance = model.clamped_capacitance.real
    driven = drive**2 > _UNCOUPLED * capacitance * squares
    driven &= squares > 0
    own = drive[driven]
    opened = squares.copy()
    opened[driven] = np.linalg.eigvalsh(np.diag(squares[driven]) + np.outer(own, own) / capacitance)
    ratio = np.divide(squares, opened, out=np.ones_like(opened), where=opened > 0)
    coupling = np.sqrt(np.clip(1 - ratio, 0.0, 1.0))
    return np.sqrt(squares) / (2 * np.pi), np.sqrt(opened) / (2 * np.pi), coupling


def undamped_modes(model: ReducedModel) -> tuple[Floats, Floats]:
    """Squared angular frequencies of the modes without losses, zero for rigid-body ones, and shapes in columns."""
    squares, shapes = np.linalg.eigh(model.stiffness.real)
    return np.where(squares > _RIGID * squares.max(), squares, 0.0), shapes


def contact_structure(model: ReducedModel, *, contact: str, outwards: float = 1.0) -> Structure:
    r"""Modal structure of a reduced model that touches another body at one of its outputs.

    Parameters
    ----------
    model : ReducedModel
    contact : str
        Name of the output at the contact.
    outwards : float
        1 where the positive direction of the output leads away from the other body, -1 where towards it.

    Returns
    -------
    Structure

    Raises
    ------
    UnknownName
        If there is no such output.

    Notes
    -----
    With the eigenvalues and eigenvectors of the real part of the stiffness, the modal damping ratio is that of the
    hysteretic losses at the mode's own frequency,

    .. math:: \zeta_i = \frac{\phi_i^\mathsf{T}\, \mathrm{Im} K\, \phi_i}{2 \omega_i^2}

    Coupling of modes by losses and the dielectric loss are neglected. The coordinates of the static correction become
    modes of high frequency.
    """
    if contact not in model.outputs:
        raise UnknownName.among(model.outputs, kind="output", name=contact)
    squares, shapes = undamped_modes(model)
    loss = np.einsum("ki,kl,li->i", shapes, model.stiffness.imag, shapes)
    ratios = np.divide(np.maximum(loss, 0.0), 2 * squares, out=np.zeros_like(squares), where=squares > 0)
    return modal_structure(
        frequencies=np.sqrt(squares) / (2 * np.pi),
        damping_ratios=ratios,
        drive_participation=shapes.T @ model.drive.real,
        contact_participation=outwards * shapes.T @ model.participation[model.outputs.index(contact)],
        clamped_capacitance=model.clamped_capacitance.real,
    )


def with_free_body(structure: Structure, *, body_mass: float) -> Structure:
    """Structure extended by a rigid body that rests on its contact and is otherwise free.

    Parameters
    ----------
    structure : Structure
        The positive direction of its contact leads away from the body.
    body_mass : float
        Mass of the body. [kg]

    Returns
    -------
    Structure
        Its contact displacement is that of the body less that of the given structure: the change of the gap.

    Raises
    ------
    InvalidInput
        If the mass is not positive.
    """
    n = structure.coordinates
    mass = float(require_positive(body_mass=body_mass))

    def bordered(matrix: Floats, corner: float) -> Floats:
        extended = np.zeros((n + 1, n + 1))
        extended[:n, :n], extended[n, n] = matrix, corner
        return extended

    return Structure(
        mass_matrix=bordered(structure.mass_matrix, mass),
        damping_matrix=bordered(structure.damping_matrix, 0.0),
        stiffness_matrix=bordered(structure.stiffness_matrix, 0.0),
        drive_vector=np.append(structure.drive_vector, 0.0),
        contact_vector=np.append(structure.contact_vector, 1.0),
        clamped_capacitance=structure.clamped_capacitance,
    )


def forced_response(model: Model, *, load: Output, frequency: float) -> Complexes:
    r"""Nodal displacements per newton of a harmonic or static force distributed evenly over a face.

    Parameters
    ----------
    model : Model
        Without piezoelectric regions; for these use `reduce_model` and a voltage.
    load : Output
        Face on which the force acts, and its direction.
    frequency : float
        Frequency of the force; zero for a static one. [Hz]

    Returns
    -------
    ndarray of complex, shape (n, 3)
        Complex amplitudes in m/N, of displacements proportional to exp(i omega t) under a real force.

    Raises
    ------
    InvalidInput
        If a region is piezoelectric, or the force is static and the body not fully supported.

    Notes
    -----
    With hysteretic losses, stiffness :math:`c(1 + i\eta)`, one factorisation without modal truncation solves

    .. math:: \left(K(1 + i\eta) - \omega^2 M\right) u = F

    See Also
    --------
    sonolube.models.fem.solver.response.harmonic_response : Response to a voltage.
    """
    require_non_negative(frequency=frequency)
    if model.is_piezoelectric:
        raise InvalidInput("the body is piezoelectric; drive it by a voltage instead of a force")
    free = rigid_body_mode_count(model)
    if frequency == 0 and free:
        raise InvalidInput(
            f"a static force needs a fully supported body; {free} rigid-body modes are free: hold a face"
        )
    equations = assemble_system(model)
    force = output_matrix(model, equations, {"load": load})[0]
    dynamic = equations.stiffness + 1j * equations.stiffness_loss - (2 * np.pi * frequency) ** 2 * equations.mass
    displacement = superlu_factor(sparse.csc_array(dynamic))(force.astype(np.complex128))
    return np.asarray(nodal_displacements(model, equations, displacement[:, np.newaxis])[0], dtype=np.complex128)
