r"""Block-diagonal first-order (state-space) form of a structure: uncoupled pairs of states, for any damping.

Each pair of states belongs to two poles of the structure: a complex conjugate pair, or two real poles.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.linear import modes
from sonolube.models.dynamics.structure import Structure

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
