r"""Receptances of a structure in pole-residue form, between its electrical port and its contact.

All that a contact at one point and a drive at one port require of a linear structure are three frequency responses:
displacement per contact force, displacement per volt (equal to charge per force), and charge per volt. Each is a sum
over the uncoupled pairs of states of `FirstOrderModes`.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.first_order_modes import first_order_modes
from sonolube.models.dynamics.kernels.simd import INNER, LANES
from sonolube.models.dynamics.linear import modes, static_contact
from sonolube.models.dynamics.structure import Structure

_NEGLIGIBLE = 1e-9  # participation of a mode in contact or drive, over the largest, that is rounding

CONTACT_PER_FORCE, CONTACT_PER_VOLT, CHARGE_PER_VOLT = range(3)
"""Rows of the numerators of `PoleResidueModel`; displacement per volt is also charge per contact force. []"""


class PoleResidueModel(NamedTuple):
    r"""Pairs of states of a structure that its contact or its drive excites or observes, m of them.

    Notes
    -----
    The pair s of states obeys :math:`\dot s = A s + b V + c\,(F_n - F_N)`. A receptance is

    .. math:: G(\omega) = \sum_j \frac{n_j + i\omega\, r_j}{\det A_j - \omega^2 - i\omega\,\mathrm{tr} A_j} .
    """

    state_matrix: Floats  # (m, 2, 2): A, in 1/s
    contact_input: Floats  # (m, 2): c
    displacement_output: Floats  # (m, 2): displacement of the contact per state
    velocity_output: Floats  # (m, 2): velocity of the contact per state
    determinant: Floats  # (m,) of A
    trace: Floats  # (m,) of A
    numerator_constant: Floats  # (3, m): n, rows CONTACT_PER_FORCE to CHARGE_PER_VOLT
    numerator_slope: Floats  # (3, m): r, likewise
    static_stiffness: float  # at the contact, in N/m; zero for a floating structure
    displacement_per_volt: float  # static, of the free contact, in m/V; zero for a floating structure
    clamped_capacitance: float  # in F

    def contact_poles(self) -> Floats:
        """Determinant, trace, numerator constant and slope of the contact receptance, shape (4, m)."""
        constant, slope = self.numerator_constant[CONTACT_PER_FORCE], self.numerator_slope[CONTACT_PER_FORCE]
        return np.array([self.determinant, self.trace, constant, slope])


@lru_cache(maxsize=16)
def pole_residue_model(structure: Structure) -> PoleResidueModel:
    """Receptances of a structure in pole-residue form."""
    natural = modes(structure)
    contact = np.abs(structure.contact_vector @ natural.shapes)
    drive = np.abs(structure.drive_vector @ natural.shapes)
    if not np.any(contact):
        raise InvalidInput("contact_vector must not be zero: the contact would never move")
    if np.any(drive[natural.rigid] > _NEGLIGIBLE * drive.max()):
        raise InvalidInput("drive_vector drives a rigid-body mode of the structure, which then has no steady state")
    pairs, static = first_order_modes(structure), static_contact(structure)
    displacement = np.einsum("j,jpa->pa", structure.contact_vector, pairs.to_displacement)
    charge = np.einsum("j,jpa->pa", structure.drive_vector, pairs.to_displacement)
    kept = _participates(pairs.contact_input) | _participates(pairs.drive_input)
    trace = np.trace(pairs.state_matrix, axis1=1, axis2=2)
    minus_adjugate = pairs.state_matrix - trace[:, np.newaxis, np.newaxis] * np.eye(2)
    ports = (  # output and input vectors, in the order of the rows
        (displacement, pairs.contact_input),
        (displacement, pairs.drive_input),
        (charge, pairs.drive_input),
    )
    return PoleResidueModel(
        state_matrix=np.ascontiguousarray(pairs.state_matrix[kept]),
        contact_input=np.ascontiguousarray(pairs.contact_input[kept]),
        displacement_output=np.ascontiguousarray(displacement[kept]),
        velocity_output=np.einsum("j,jpa->pa", structure.contact_vector, pairs.to_velocity)[kept],
        determinant=np.linalg.det(pairs.state_matrix)[kept],
        trace=trace[kept],
        numerator_constant=np.array(
            [np.einsum("pa,pab,pb->p", out, minus_adjugate, into)[kept] for out, into in ports]
        ),
        numerator_slope=np.array([np.einsum("pa,pa->p", out, into)[kept] for out, into in ports]),
        static_stiffness=static.static_stiffness,
        displacement_per_volt=static.displacement_per_volt or 0.0,
        clamped_capacitance=structure.clamped_capacitance,
    )


def _participates(inputs: Floats) -> np.ndarray:
    """Which pairs of states an input excites, beyond rounding."""
    size = np.abs(inputs).max(axis=1)
    return np.asarray(size > _NEGLIGIBLE * size.max(initial=0.0))


def receptance(model: PoleResidueModel, response: int, omega: Floats) -> Complexes:
    """Receptance at angular frequencies, by its pole-residue form; in m/N, m/V (which is C/N) or C/V."""
    real, imaginary = np.zeros((2, *omega.shape))
    square = np.square(omega)
    for constant, slope, determinant, trace in zip(
        model.numerator_constant[response], model.numerator_slope[response], model.determinant, model.trace, strict=True
    ):
        re, im, rise = determinant - square, -trace * omega, slope * omega
        inverse = 1 / (re * re + im * im)
        real += (constant * re + rise * im) * inverse
        imaginary += (rise * re - constant * im) * inverse
    return np.asarray(real + 1j * imaginary)


@kernel(**INNER)
def contact_receptances(poles: Floats, omega: Floats, order: float, receptances: Floats) -> None:
    """Write the contact receptance at a multiple of the angular frequency of each SIMD lane.

    `poles` has shape (4, m). `receptances` has shape (2, lanes).
    """
    for lane in range(LANES):
        receptances[0, lane], receptances[1, lane] = 0.0, 0.0
    for pair in range(poles.shape[1]):
        determinant, trace = poles[0, pair], poles[1, pair] * order
        constant, slope = poles[2, pair], poles[3, pair] * order
        for lane in range(LANES):
            re = determinant - order * omega[lane] * order * omega[lane]
            im = -trace * omega[lane]
            inverse = 1 / (re * re + im * im)
            rise = slope * omega[lane]
            receptances[0, lane] += (constant * re + rise * im) * inverse
            receptances[1, lane] += (rise * re - constant * im) * inverse
