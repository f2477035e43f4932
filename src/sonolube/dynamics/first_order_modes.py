"""A structure as pairs of states that do not know of each other, whatever its damping."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import schur
from scipy.sparse.csgraph import connected_components

from sonolube.checks import Floats
from sonolube.dynamics.linear import modes
from sonolube.dynamics.structure import Structure
from sonolube.errors import InvalidInput

_UNCOUPLED = 1e-12  # damping between two modes, over the largest, that rounding may have made
_WORST_CONDITION = 1e7  # of the change of basis, which costs as many digits


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StatePairs:
    """The state s of a structure in pairs: s' = A s + b V + c (F_n - F_N), each pair with an A of its own.

    Parameters
    ----------
    generator : ndarray, shape (n, 2, 2)
        A of each pair, in 1/s.
    drive : ndarray, shape (n, 2)
        b of each pair.
    contact : ndarray, shape (n, 2)
        c of each pair.
    to_displacement : ndarray, shape (coordinates, n, 2)
        Coordinates of the structure per state.
    to_velocity : ndarray, shape (coordinates, n, 2)
        Their rates per state.
    from_displacement : ndarray, shape (n, 2, coordinates)
        States per coordinate.
    from_velocity : ndarray, shape (n, 2, coordinates)
        States per rate.
    """

    generator: Floats
    drive: Floats
    contact: Floats
    to_displacement: Floats
    to_velocity: Floats
    from_displacement: Floats
    from_velocity: Floats


def state_pairs(structure: Structure) -> StatePairs:
    """Return the structure as pairs of states.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    StatePairs

    Raises
    ------
    InvalidInput
        If damping makes modes coincide that it also couples, so that no pairs exist.

    Notes
    -----
    Modes that damping leaves uncoupled, rigid ones among them, are pairs as they stand. The others are sorted into
    pairs of exponents, each with an orthonormal basis of its own plane from a Schur form, which a critically damped
    pair does not disturb.
    """
    natural, n = modes(structure), structure.coordinates
    omega, shapes = 2 * np.pi * natural.natural_frequency, natural.shapes
    rate = np.where(natural.rigid, omega.max() or 1.0, omega)  # velocities are measured in it, to balance the state
    damping = shapes.T @ structure.damping_matrix @ shapes
    damping[np.abs(damping) <= _UNCOUPLED * np.abs(damping).max(initial=0.0)] = 0.0
    modal_generator = np.zeros((n, 2, n, 2))
    modal = np.arange(n)
    modal_generator[modal, 0, modal, 1], modal_generator[modal, 1, modal, 0] = rate, -(omega**2) / rate
    modal_generator[:, 1, :, 1] = -damping * rate / rate[:, np.newaxis]
    basis = np.zeros((n, 2, n, 2))
    coupled, member_of = connected_components(damping != 0, directed=False)
    for component in range(coupled):
        members = np.flatnonzero(member_of == component)
        inside = np.ix_(members, np.arange(2), members, np.arange(2))
        side = 2 * members.size
        planes = np.eye(2) if side == 2 else _invariant_planes(modal_generator[inside].reshape(side, side))
        basis[inside] = planes.reshape(members.size, 2, members.size, 2)
    flat = basis.reshape(2 * n, 2 * n)
    inverse = np.linalg.inv(flat)
    generator = (inverse @ modal_generator.reshape(2 * n, 2 * n) @ flat).reshape(n, 2, n, 2)[modal, :, modal, :]
    position, velocity = np.zeros((n, n, 2)), np.zeros((n, n, 2))
    position[:, :, 0], velocity[:, :, 1] = shapes, shapes * rate
    into = inverse.reshape(n, 2, n, 2)
    pull = shapes.T / rate[:, np.newaxis]  # rate of the second state of each mode per force on the coordinates
    force = np.einsum("paq,qj->paj", into[..., 1], pull)
    momenta = shapes.T @ structure.mass_matrix
    return StatePairs(
        generator=generator,
        drive=force @ structure.drive_vector,
        contact=force @ structure.contact_vector,
        to_displacement=np.einsum("jma,mapb->jpb", position, basis),
        to_velocity=np.einsum("jma,mapb->jpb", velocity, basis),
        from_displacement=np.einsum("paq,qj->paj", into[..., 0], momenta),
        from_velocity=np.einsum("paq,qj->paj", into[..., 1], momenta / rate[:, np.newaxis]),
    )


def _invariant_planes(generator: Floats) -> Floats:
    """Return as columns the orthonormal bases of planes that the generator maps onto themselves."""
    exponents = np.linalg.eigvals(generator)
    swinging = exponents[exponents.imag > 0]
    creeping = np.sort(exponents[exponents.imag == 0].real)
    pairs = [(one, one.conjugate()) for one in swinging] + list(zip(creeping[::2], creeping[1::2], strict=True))
    planes = np.hstack([_plane(generator, pair) for pair in pairs])
    condition = float(np.linalg.cond(planes))
    if condition > _WORST_CONDITION:
        raise InvalidInput(
            "damping_matrix makes modes coincide that it couples (condition of their separation"
            f" {condition:.1g}); change a damper by a part in a thousand"
        )
    return planes


def _plane(generator: Floats, pair: tuple[complex, complex]) -> Floats:
    # the nearest two: reordering a real Schur form moves conjugates together and disturbs exponents by rounding
    nearest = np.sort(np.abs(np.linalg.eigvals(generator)[:, np.newaxis] - np.array(pair)).min(axis=1))
    bound = (nearest[1] + nearest[2]) / 2

    def chosen(real: float, imaginary: float = 0.0) -> bool:
        return bool(min(abs(complex(real, imaginary) - one) for one in pair) <= bound)

    _, vectors, count = schur(generator, sort=chosen)
    if count != 2:
        raise InvalidInput(f"damping_matrix makes {count} exponents of the motion coincide; change a damper slightly")
    return np.asarray(vectors[:, :2], dtype=np.float64)
