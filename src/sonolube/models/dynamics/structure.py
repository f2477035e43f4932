"""Linear structure with one electrical port and one contact point: its matrices and its frequency responses."""

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, eq=False)
class Structure:
    r"""Linear structure with a piezoelectric stack that touches another body at one point.

    Parameters
    ----------
    mass_matrix : ndarray, shape (n, n)
        Symmetric, positive definite; the identity for modes.
    damping_matrix : ndarray, shape (n, n)
        Symmetric, positive semidefinite.
    stiffness_matrix : ndarray, shape (n, n)
        Symmetric, positive semidefinite, with the stack short-circuited; singular where the structure floats.
    drive_vector : ndarray, shape (n,)
        Generalised force per volt b, which is also charge per displacement (reciprocity).
    contact_vector : ndarray, shape (n,)
        Displacement of the contact per coordinate c, which is also generalised force per contact force.
    clamped_capacitance : float
        Capacitance C_S of the stack with all coordinates clamped. [F]
    load_vector : ndarray, shape (n,), optional
        Displacement of the weights of the dead load per coordinate, where it is known where they hang.

    Raises
    ------
    InvalidInput
        If shapes disagree, a matrix is not symmetric, the mass matrix is not positive definite, or another one not
        positive semidefinite.

    Notes
    -----
    The generalised coordinates x obey

    .. math:: M\ddot x + C\dot x + K x = b V + c\,(F_n - F_N)

    with the drive voltage V, the contact force :math:`F_n` and the dead load :math:`F_N`. The displacement of the
    contact, positive away from the other body, is :math:`c^T x`; the charge on the stack is
    :math:`q = C_S V + b^T x`. Displacements count from the static equilibrium under the dead load without voltage.

    Structures are equal where all their numbers are.
    """

    mass_matrix: Floats
    damping_matrix: Floats
    stiffness_matrix: Floats
    drive_vector: Floats
    contact_vector: Floats
    clamped_capacitance: float
    load_vector: Floats | None = None

    def __post_init__(self) -> None:
        require_non_negative(clamped_capacitance=self.clamped_capacitance)
        n = len(self.mass_matrix)
        for name in ("mass_matrix", "damping_matrix", "stiffness_matrix"):
            matrix = require_finite(**{name: getattr(self, name)})
            if matrix.shape != (n, n) or not np.allclose(matrix, matrix.T, rtol=1e-9, atol=0):
                raise InvalidInput(f"{name} must be symmetric of shape ({n}, {n}), got shape {matrix.shape}")
            scale = float(np.abs(matrix).max()) if n else 0.0
            lowest = float(np.linalg.eigvalsh(matrix)[0])
            if lowest < -1e-9 * scale or (name == "mass_matrix" and lowest <= 0):
                demand = "positive definite" if name == "mass_matrix" else "positive semidefinite"
                raise InvalidInput(f"{name} must be {demand}, got an eigenvalue of {lowest:.4g}")
        for name in ("drive_vector", "contact_vector", *(("load_vector",) if self.load_vector is not None else ())):
            vector = require_finite(**{name: getattr(self, name)})
            if vector.shape != (n,):
                raise InvalidInput(f"{name} must have shape ({n},), got {vector.shape}")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Structure) and self._numbers == other._numbers

    def __hash__(self) -> int:
        return hash(self._numbers)

    @cached_property
    def _numbers(self) -> tuple[bytes | None, ...]:
        """Bits of every field, in which two structures are compared."""
        values = (getattr(self, part.name) for part in fields(self))
        return tuple(None if each is None else np.asarray(each, dtype=np.float64).tobytes() for each in values)

    @property
    def coordinates(self) -> int:
        """Number of generalised coordinates, n."""
        return len(self.mass_matrix)


def dynamic_stiffness(structure: Structure, *, frequency: ArrayLike) -> Complexes:
    r"""Dynamic stiffness matrix, complex, in N/m.

    Parameters
    ----------
    structure : Structure
    frequency : array_like, any shape
        Frequency of the motion. [Hz]

    Returns
    -------
    ndarray, shape of `frequency` with (n, n) appended

    Raises
    ------
    InvalidInput
        If a frequency is not positive.

    Notes
    -----
    .. math:: D(\omega) = K + i\omega C - \omega^2 M
    """
    omega = 2 * np.pi * require_positive(frequency=frequency)[..., np.newaxis, np.newaxis]
    stiffness = structure.stiffness_matrix - omega**2 * structure.mass_matrix
    return np.asarray(stiffness + 1j * omega * structure.damping_matrix, dtype=np.complex128)


def contact_receptance(structure: Structure, *, frequency: ArrayLike) -> Complexes:
    r"""Receptance of the contact: displacement per contact force, stack short-circuited, in m/N.

    Parameters
    ----------
    structure : Structure
    frequency : array_like, any shape
        Frequency of the force. [Hz]

    Returns
    -------
    ndarray of complex, shape of `frequency`

    Raises
    ------
    InvalidInput
        If a frequency is not positive.

    See Also
    --------
    drive_receptance, dynamic_stiffness

    Notes
    -----
    .. math:: G(\omega) = c^T D(\omega)^{-1} c
    """
    return _response(structure, frequency, structure.contact_vector) @ structure.contact_vector


def drive_receptance(structure: Structure, *, frequency: ArrayLike) -> Complexes:
    r"""Displacement of the free contact per volt of the drive, complex, in m/V.

    Parameters
    ----------
    structure : Structure
    frequency : array_like, any shape
        Frequency of the voltage. [Hz]

    Returns
    -------
    ndarray of complex, shape of `frequency`

    Raises
    ------
    InvalidInput
        If a frequency is not positive.

    See Also
    --------
    contact_receptance, electrical_admittance

    Notes
    -----
    .. math:: H(\omega) = c^T D(\omega)^{-1} b
    """
    return _response(structure, frequency, structure.drive_vector) @ structure.contact_vector


def electrical_admittance(structure: Structure, *, frequency: ArrayLike) -> Complexes:
    r"""Electrical admittance of the stack with the contact free, complex, in siemens.

    Parameters
    ----------
    structure : Structure
    frequency : array_like, any shape
        Frequency of the voltage. [Hz]

    Returns
    -------
    ndarray of complex, shape of `frequency`

    Raises
    ------
    InvalidInput
        If a frequency is not positive.

    Notes
    -----
    .. math:: Y(\omega) = i\omega\,\left[C_S + b^T D(\omega)^{-1} b\right]
    """
    omega = 2 * np.pi * require_positive(frequency=frequency)
    motional = _response(structure, frequency, structure.drive_vector) @ structure.drive_vector
    return 1j * omega * (structure.clamped_capacitance + motional)


def with_contact_spring(structure: Structure, *, normal_stiffness: float, contact_damping: float = 0.0) -> Structure:
    r"""Structure with a linear spring and damper at its contact: the contact linearised about equilibrium.

    Parameters
    ----------
    structure : Structure
    normal_stiffness : float
        Stiffness of the contact. [N/m]
    contact_damping : float
        Damping of the contact. [N s/m]

    Returns
    -------
    Structure

    Raises
    ------
    InvalidInput
        If the stiffness or the damping is negative.

    Notes
    -----
    .. math:: K + k\,c c^T, \qquad C + d\,c c^T
    """
    k = require_non_negative(normal_stiffness=normal_stiffness)
    d = require_non_negative(contact_damping=contact_damping)
    projector = np.multiply.outer(structure.contact_vector, structure.contact_vector)
    return replace(
        structure,
        damping_matrix=structure.damping_matrix + d * projector,
        stiffness_matrix=structure.stiffness_matrix + k * projector,
    )


def _response(structure: Structure, frequency: ArrayLike, force: Floats) -> Complexes:
    """Complex coordinates under a harmonic generalised force, shape of `frequency` with (n,) appended."""
    stiffness = dynamic_stiffness(structure, frequency=frequency)
    forces = np.broadcast_to(force.astype(np.complex128)[:, np.newaxis], (*stiffness.shape[:-1], 1))
    return np.asarray(np.linalg.solve(stiffness, forces)[..., 0], dtype=np.complex128)
