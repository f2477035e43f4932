"""Linear analysis of a structure: natural modes, poles, equivalent circuit, static stiffness, first-order form.

The first-order form is block-diagonal: each pair of states belongs to two poles of the structure, a complex conjugate
pair, or two real poles.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.models.actuator import ButterworthVanDyke, MotionalBranch
from sonolube.models.dynamics.structure import Structure

_RIGID = 1e-12  # omega^2 over that of the highest mode below which a mode is rigid but for rounding
_UNDRIVEN = 1e-12  # motional over clamped capacitance below which a mode is not driven but for rounding


@dataclass(frozen=True, kw_only=True, slots=True)
class Modes:
    """Natural modes with the stack short-circuited and the contact free, in order of frequency.

    Parameters
    ----------
    natural_frequency : ndarray, shape (n,)
        Frequency without damping, zero for rigid-body modes. [Hz]
    damped_frequency : ndarray, shape (n,)
        Frequency of free decay; zero for an overdamped mode. [Hz]
    damping_ratio : ndarray, shape (n,)
        Damping over critical damping; zero for rigid-body modes. []
    shapes : ndarray, shape (n, n)
        One mode per column, of unit modal mass, signed such that the displacement of the contact is not negative.
    rigid : ndarray of bool, shape (n,)
        Whether a mode is a rigid-body mode, which no spring resists.
    """

    natural_frequency: Floats
    damped_frequency: Floats
    damping_ratio: Floats
    shapes: Floats
    rigid: NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, slots=True)
class StaticContact:
    """Static stiffness and static displacement of a structure at its contact.

    Parameters
    ----------
    static_stiffness : float
        Force per displacement of the contact; zero for a floating structure, infinite for a rigid support. [N/m]
    displacement_per_volt : float or None
        Static displacement of the free contact per volt; None for a floating structure, where it is undetermined. [m/V]
    """

    static_stiffness: float
    displacement_per_volt: float | None


def modes(structure: Structure) -> Modes:
    r"""Natural modes of a structure, by the generalised symmetric eigenvalue problem of K and M.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    Modes

    Notes
    -----
    Frequencies and shapes are those without damping,

    .. math:: K\phi = \omega^2 M\phi, \qquad \phi^T M \phi = 1, \qquad \zeta = \frac{\phi^T C \phi}{2\omega} .

    The damping ratios are exact for modal (classical) damping and otherwise correct to first order in the damping;
    `poles` are exact for any damping.

    Examples
    --------
    >>> from sonolube.models.dynamics import modes
    >>> from sonolube.rig import read_rig
    >>> tribometer = read_rig("examples/rigs/tribometer.toml").structure
    >>> modes(tribometer).natural_frequency.round().tolist()  # rigid body, arm, transducer
    [0.0, 154.0, 21998.0]
    """
    squares, shapes = _generalised_eigh(structure.stiffness_matrix, structure.mass_matrix)
    rigid = squares <= _RIGID * squares[-1]
    omega = np.sqrt(np.where(rigid, 0.0, squares))
    shapes = shapes * np.where(structure.contact_vector @ shapes < 0, -1.0, 1.0)
    damping = np.einsum("im,ij,jm->m", shapes, structure.damping_matrix, shapes)
    ratio = np.divide(damping, 2 * omega, out=np.zeros_like(omega), where=~rigid)
    return Modes(
        natural_frequency=omega / (2 * np.pi),
        damped_frequency=omega * np.sqrt(np.maximum(1 - ratio**2, 0.0)) / (2 * np.pi),
        damping_ratio=ratio,
        shapes=shapes,
        rigid=rigid,
    )


def _generalised_eigh(stiffness: Floats, mass: Floats) -> tuple[Floats, Floats]:
    """Eigenvalues and eigenvectors of K and M, of unit modal mass, with the Cholesky factor of M."""
    factor = np.linalg.cholesky(mass)
    reduced = np.linalg.solve(factor, np.linalg.solve(factor, stiffness).T)
    squares, vectors = np.linalg.eigh((reduced + reduced.T) / 2)
    return squares, np.linalg.solve(factor.T, vectors)


def poles(structure: Structure) -> Complexes:
    r"""Poles of a structure, the exponents of its free motions, complex, in 1/s.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    ndarray of complex, shape (2n,)
        In order of modulus, conjugate poles adjacent; two for each rigid-body mode, one or both zero.

    Notes
    -----
    The roots :math:`\lambda` of

    .. math:: \det(\lambda^2 M + \lambda C + K) = 0 .
    """
    natural = modes(structure)
    omega = np.diag(2 * np.pi * natural.natural_frequency)
    damping = natural.shapes.T @ structure.damping_matrix @ natural.shapes
    # state: omega times modal displacements, then modal velocities, whose squared norm is twice the energy
    exponents = np.linalg.eigvals(np.block([[np.zeros_like(omega), omega], [-omega, -damping]]))
    order = np.lexsort((exponents.imag, exponents.real.round(9), np.abs(exponents).round(9)))
    return np.asarray(exponents[order], dtype=np.complex128)


def static_contact(structure: Structure) -> StaticContact:
    r"""Static stiffness at the contact and the static displacement of the contact per volt.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    StaticContact

    Notes
    -----
    .. math:: S_0 = \left(c^T K^{-1} c\right)^{-1}, \qquad \bar x/V = c^T K^{-1} b

    evaluated over the elastic modes; a rigid-body mode that moves the contact makes the structure floating.
    """
    natural = modes(structure)
    contact = structure.contact_vector @ natural.shapes
    drive = structure.drive_vector @ natural.shapes
    if np.any(np.abs(contact[natural.rigid]) > 1e-9 * np.abs(contact).max()):
        return StaticContact(static_stiffness=0.0, displacement_per_volt=None)
    elastic = ~natural.rigid
    response = contact[elastic] / (2 * np.pi * natural.natural_frequency[elastic]) ** 2
    compliance = float(response @ contact[elastic])
    return StaticContact(
        static_stiffness=1 / compliance if compliance > 0 else float("inf"),
        displacement_per_volt=float(response @ drive[elastic]),
    )


def equivalent_circuit(structure: Structure) -> ButterworthVanDyke:
    r"""Butterworth-Van Dyke equivalent circuit of a structure with its contact free.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    ButterworthVanDyke
        One motional branch for each mode that the stack drives.

    Raises
    ------
    InvalidInput
        If the clamped capacitance is zero.

    Notes
    -----
    With the modal participation :math:`p = \phi^T b` of the stack,

    .. math:: L = \frac{1}{p^2}, \qquad C = \frac{p^2}{\omega^2}, \qquad R = \frac{2\zeta\omega}{p^2} .

    Exact for modal (classical) damping; otherwise each branch has its mode's damping ratio to first order.
    """
    natural = modes(structure)
    participation = structure.drive_vector @ natural.shapes
    omega = 2 * np.pi * natural.natural_frequency
    branches = [
        MotionalBranch(
            resistance=2 * natural.damping_ratio[i] * omega[i] / participation[i] ** 2,
            inductance=1 / participation[i] ** 2,
            capacitance=participation[i] ** 2 / omega[i] ** 2,
        )
        for i in np.flatnonzero(~natural.rigid)
        if participation[i] ** 2 > _UNDRIVEN * omega[i] ** 2 * structure.clamped_capacitance
    ]
    return ButterworthVanDyke(parallel_capacitance=structure.clamped_capacitance, branches=tuple(branches))


_UNCOUPLED = 1e-12  # modal damping between two modes, over the largest, that is rounding
_COINCIDENT = 1e-9  # relative distance of poles that cannot be told apart
_SHIFT, _ITERATIONS = 1e-4, 5  # of inverse iteration; each iteration divides the error by the shift at least once
_WORST_CONDITION = 1e7  # largest condition number of the change of basis, which costs as many digits


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FirstOrderModes:
    r"""A structure as n uncoupled pairs of states.

    Parameters
    ----------
    state_matrix : ndarray, shape (n, 2, 2)
        State matrix A of each pair, in 1/s.
    drive_input : ndarray, shape (n, 2)
        Input vector b of the drive voltage of each pair.
    contact_input : ndarray, shape (n, 2)
        Input vector c of the contact force of each pair.
    to_displacement : ndarray, shape (coordinates, n, 2)
        Coordinates of the structure per state.
    to_velocity : ndarray, shape (coordinates, n, 2)
        Velocities of the coordinates per state.
    from_displacement : ndarray, shape (n, 2, coordinates)
        States per coordinate.
    from_velocity : ndarray, shape (n, 2, coordinates)
        States per velocity of a coordinate.

    Notes
    -----
    The pair s of states obeys

    .. math:: \dot s = A s + b V + c\,(F_n - F_N) .
    """

    state_matrix: Floats
    drive_input: Floats
    contact_input: Floats
    to_displacement: Floats
    to_velocity: Floats
    from_displacement: Floats
    from_velocity: Floats


def first_order_modes(structure: Structure) -> FirstOrderModes:
    r"""Block-diagonal first-order form of a structure.

    A mode that the damping does not couple to others (a rigid-body mode for example) is a pair by itself, with its
    modal displacement and velocity as states. The coupled modes are sorted into pairs of poles; the invariant plane of
    each pair is spanned by an orthonormal basis, which stays well conditioned for critically damped pairs.
    """
    natural, n = modes(structure), structure.coordinates
    omega, shapes = 2 * np.pi * natural.natural_frequency, natural.shapes
    rate = np.where(natural.rigid, omega.max() or 1.0, omega)  # unit of velocities, which balances the state
    damping = shapes.T @ structure.damping_matrix @ shapes
    damping[np.abs(damping) <= _UNCOUPLED * np.abs(damping).max(initial=0.0)] = 0.0
    modal_matrix = np.zeros((n, 2, n, 2))
    modal = np.arange(n)
    modal_matrix[modal, 0, modal, 1], modal_matrix[modal, 1, modal, 0] = rate, -(omega**2) / rate
    modal_matrix[:, 1, :, 1] = -damping * rate / rate[:, np.newaxis]
    basis = np.zeros((n, 2, n, 2))
    for members in _coupled_groups(damping != 0):
        inside = np.ix_(members, np.arange(2), members, np.arange(2))
        side = 2 * members.size
        planes = np.eye(2) if side == 2 else _invariant_planes(modal_matrix[inside].reshape(side, side))
        basis[inside] = planes.reshape(members.size, 2, members.size, 2)
    flat = basis.reshape(2 * n, 2 * n)
    inverse = np.linalg.inv(flat)
    blocks = (inverse @ modal_matrix.reshape(2 * n, 2 * n) @ flat).reshape(n, 2, n, 2)[modal, :, modal, :]
    position, velocity = np.zeros((n, n, 2)), np.zeros((n, n, 2))
    position[:, :, 0], velocity[:, :, 1] = shapes, shapes * rate
    into = inverse.reshape(n, 2, n, 2)
    acceleration = shapes.T / rate[:, np.newaxis]  # of the second state of each mode, per generalised force
    force = np.einsum("paq,qj->paj", into[..., 1], acceleration)
    modal_mass = shapes.T @ structure.mass_matrix
    return FirstOrderModes(
        state_matrix=blocks,
        drive_input=force @ structure.drive_vector,
        contact_input=force @ structure.contact_vector,
        to_displacement=np.einsum("jma,mapb->jpb", position, basis),
        to_velocity=np.einsum("jma,mapb->jpb", velocity, basis),
        from_displacement=np.einsum("paq,qj->paj", into[..., 0], modal_mass),
        from_velocity=np.einsum("paq,qj->paj", into[..., 1], modal_mass / rate[:, np.newaxis]),
    )


def _coupled_groups(coupled: NDArray[np.bool_]) -> list[NDArray[np.intp]]:
    """Groups of modes that are coupled, directly or through others, in the order of their first modes."""
    reached = coupled | coupled.T | np.eye(len(coupled), dtype=bool)
    for _ in range(len(coupled).bit_length()):  # each product doubles the length of the paths
        reached = reached @ reached
    first = reached.argmax(axis=1)
    return [np.flatnonzero(first == each) for each in np.unique(first)]


def _invariant_planes(matrix: Floats) -> Floats:
    """Orthonormal bases of two-dimensional invariant subspaces of a state matrix, as columns."""
    poles = np.linalg.eigvals(matrix)
    oscillating = poles[poles.imag > 0]
    overdamped = np.sort(poles[poles.imag == 0].real)
    pairs = [(pole, pole.conjugate()) for pole in oscillating]
    pairs += list(zip(overdamped[::2], overdamped[1::2], strict=True))
    planes = np.hstack([_invariant_plane(matrix, pair) for pair in pairs])
    condition = float(np.linalg.cond(planes))
    if condition > _WORST_CONDITION:
        raise InvalidInput(
            "damping_matrix couples modes whose poles nearly coincide (condition number of their separation"
            f" {condition:.1g}); change a damper by a part in a thousand"
        )
    return planes


def _invariant_plane(matrix: Floats, pair: tuple[complex, complex]) -> Floats:
    """Orthonormal basis of the invariant subspace of one pair of poles, by inverse iteration with both."""
    # the two nearest poles of the matrix are the pair, and the next one must be another
    nearest = np.sort(np.abs(np.linalg.eigvals(matrix)[:, np.newaxis] - np.array(pair)).min(axis=1))
    if nearest[2] <= _COINCIDENT * np.abs(pair).max():
        raise InvalidInput("damping_matrix makes poles of the structure coincide; change a damper slightly")
    side = len(matrix)
    offset = _SHIFT * nearest[2]  # from the poles, at which the matrix is singular
    shifted = [matrix - (pole + offset) * np.eye(side) for pole in pair]
    plane = np.linalg.qr(np.cos(np.multiply.outer(np.arange(1.0, side + 1), [1.0, 2.0])))[0]
    for _ in range(_ITERATIONS):
        plane = np.linalg.qr(np.linalg.solve(shifted[0], np.linalg.solve(shifted[1], plane)).real)[0]
    return plane
