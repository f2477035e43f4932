"""A structure as the kernels of the steady state see it: pairs of states between an electrical port and a contact."""

from functools import lru_cache
from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.first_order_modes import state_pairs
from sonolube.dynamics.kernels.simd import INSIDE, LANES
from sonolube.dynamics.linear import modes, static_contact
from sonolube.dynamics.structure import Structure
from sonolube.errors import InvalidInput

_NEGLIGIBLE = 1e-9  # share of a mode in the contact or the drive, relative to the largest, that rounding leaves


class ContactPort(NamedTuple):
    """Pairs of states s' = A s + b V + c (F_n - F_N) that contact or drive can see, m of them.

    A receptance is a sum over pairs of (constant + i omega slope)/(determinant - omega^2 - i omega trace).
    """

    generator: Floats  # (m, 2, 2): A, in 1/s
    push: Floats  # (m, 2): c
    displacement: Floats  # (m, 2): of the contact per state
    velocity: Floats  # (m, 2): likewise
    determinant: Floats  # (m,) of A
    trace: Floats  # (m,) of A
    constant: Floats  # (3, m): of contact per force, contact per volt (and charge per force), charge per volt
    slope: Floats  # (3, m): likewise
    static_stiffness: float  # at the contact, in N/m; zero where the structure floats
    displacement_per_volt: float  # of the free contact at rest, in m/V; zero where the structure floats
    clamped_capacitance: float  # in F

    def poles(self) -> Floats:
        """Return determinant, trace, constant and slope of the contact's own receptance, shape (4, m)."""
        return np.array([self.determinant, self.trace, self.constant[0], self.slope[0]])


@lru_cache(maxsize=16)
def contact_port(structure: Structure) -> ContactPort:
    """Return the structure as its contact and its drive see it.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    ContactPort

    Raises
    ------
    InvalidInput
        If a voltage would push a rigid mode away for ever, or the contact can never move.
    """
    natural = modes(structure)
    contact = np.abs(structure.contact_vector @ natural.shapes)
    drive = np.abs(structure.drive_vector @ natural.shapes)
    if not np.any(contact):
        raise InvalidInput("contact_vector must not be zero: the contact would never move")
    if np.any(drive[natural.rigid] > _NEGLIGIBLE * drive.max()):
        raise InvalidInput("drive_vector pushes a rigid motion of the structure, which then has no steady state")
    pairs, static = state_pairs(structure), static_contact(structure)
    displacement = np.einsum("j,jpa->pa", structure.contact_vector, pairs.to_displacement)
    charge = np.einsum("j,jpa->pa", structure.drive_vector, pairs.to_displacement)
    seen = _above_rounding(pairs.contact) | _above_rounding(pairs.drive)
    trace = np.trace(pairs.generator, axis1=1, axis2=2)
    adjugate = pairs.generator - trace[:, np.newaxis, np.newaxis] * np.eye(2)
    ports = ((displacement, pairs.contact), (displacement, pairs.drive), (charge, pairs.drive))
    return ContactPort(
        generator=np.ascontiguousarray(pairs.generator[seen]),
        push=np.ascontiguousarray(pairs.contact[seen]),
        displacement=np.ascontiguousarray(displacement[seen]),
        velocity=np.einsum("j,jpa->pa", structure.contact_vector, pairs.to_velocity)[seen],
        determinant=np.linalg.det(pairs.generator)[seen],
        trace=trace[seen],
        constant=np.array([np.einsum("pa,pab,pb->p", out, adjugate, into)[seen] for out, into in ports]),
        slope=np.array([np.einsum("pa,pa->p", out, into)[seen] for out, into in ports]),
        static_stiffness=static.static_stiffness,
        displacement_per_volt=static.displacement_per_volt or 0.0,
        clamped_capacitance=structure.clamped_capacitance,
    )


def _above_rounding(shares: Floats) -> np.ndarray:
    size = np.abs(shares).max(axis=1)
    return np.asarray(size > _NEGLIGIBLE * size.max(initial=0.0))


def receptance(port: ContactPort, which: int, omega: Floats) -> Complexes:
    """Return a receptance at angular frequencies.

    Parameters
    ----------
    port : ContactPort
    which : {0, 1, 2}
        Row of `ContactPort.constant` and `ContactPort.slope`.
    omega : ndarray
        Angular frequency, in rad/s.

    Returns
    -------
    ndarray of complex
    """
    real, imaginary = np.zeros((2, *omega.shape))
    square = np.square(omega)
    for constant, slope, determinant, trace in zip(
        port.constant[which], port.slope[which], port.determinant, port.trace, strict=True
    ):
        re, im, rise = determinant - square, -trace * omega, slope * omega
        below = 1 / (re * re + im * im)
        real += (constant * re + rise * im) * below
        imaginary += (rise * re - constant * im) * below
    return np.asarray(real + 1j * imaginary)


@numba.njit(**INSIDE)
def receptances(poles: Floats, omega: Floats, order: float, answer: Floats) -> None:
    """Write the receptance of the contact at a multiple of each lane's angular frequency.

    Parameters
    ----------
    poles : ndarray, shape (4, m)
        As by `ContactPort.poles`.
    omega : ndarray, shape (lanes,)
        Angular frequency, in rad/s.
    order : float
        The multiple.
    answer : ndarray, shape (2, lanes)
        Real and imaginary part, in m/N.
    """
    for lane in range(LANES):
        answer[0, lane], answer[1, lane] = 0.0, 0.0
    for pair in range(poles.shape[1]):
        determinant, trace = poles[0, pair], poles[1, pair] * order
        still, rising = poles[2, pair], poles[3, pair] * order
        for lane in range(LANES):
            re = determinant - order * omega[lane] * order * omega[lane]
            im = -trace * omega[lane]
            inverse = 1 / (re * re + im * im)
            rise = rising * omega[lane]
            answer[0, lane] += (still * re + rise * im) * inverse
            answer[1, lane] += (rise * re - still * im) * inverse
