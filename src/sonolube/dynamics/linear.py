"""Free and static behaviour of a structure: its modes, its poles, its circuit, its static stiffness."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from sonolube.actuator import ButterworthVanDyke, CircuitResonances, MotionalBranch, circuit_resonances
from sonolube.checks import Complexes, Floats
from sonolube.dynamics.structure import Structure

_RIGID = 1e-12  # square of a frequency over that of the highest mode below which rounding made it
_SILENT = 1e-12  # share of a mode in the capacitance below which it leaves no trace in the current


@dataclass(frozen=True, kw_only=True, slots=True)
class Modes:
    """Natural modes with the stack short-circuited and the contact free, in order of frequency.

    Parameters
    ----------
    natural_frequency : ndarray, shape (n,)
        Frequency without damping, zero for rigid modes. [Hz]
    damped_frequency : ndarray, shape (n,)
        Frequency of free decay; zero where the mode creeps back. [Hz]
    damping_ratio : ndarray, shape (n,)
        Damping over critical damping; zero for rigid modes. []
    shapes : ndarray, shape (n, n)
        One mode a column, of unit modal mass; the contact's displacement is not negative.
    rigid : ndarray of bool, shape (n,)
        Modes that no spring resists.
    """

    natural_frequency: Floats
    damped_frequency: Floats
    damping_ratio: Floats
    shapes: Floats
    rigid: NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, slots=True)
class StaticContact:
    """How the structure meets its contact at rest.

    Parameters
    ----------
    static_stiffness : float
        Force per displacement of the contact; zero where it floats, infinite where it is held. [N/m]
    displacement_per_volt : float or None
        Displacement of the free contact per volt; None where the structure floats and has no place of its own. [m/V]
    """

    static_stiffness: float
    displacement_per_volt: float | None


def modes(structure: Structure) -> Modes:
    """Return the natural modes.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    Modes

    Notes
    -----
    Frequencies and shapes are those without damping. Damping ratios are phi.C.phi/(2 omega), exact where damping leaves
    the modes uncoupled and otherwise right to first order in it; `poles` has no such limit.
    """
    squares, shapes = eigh(structure.stiffness_matrix, structure.mass_matrix)
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


def poles(structure: Structure) -> Complexes:
    """Return the exponents lambda of all free motions exp(lambda t), complex, in 1/s.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    ndarray, shape (2n,)
        In order of their modulus, those of a pair beside each other; two for each rigid mode, one or both zero.
    """
    natural = modes(structure)
    omega = np.diag(2 * np.pi * natural.natural_frequency)
    damping = natural.shapes.T @ structure.damping_matrix @ natural.shapes
    # the state is omega times modal displacements, and modal velocities: its squared length is twice the energy
    exponents = np.linalg.eigvals(np.block([[np.zeros_like(omega), omega], [-omega, -damping]]))
    order = np.lexsort((exponents.imag, exponents.real.round(9), np.abs(exponents).round(9)))
    return np.asarray(exponents[order], dtype=np.complex128)


def static_contact(structure: Structure) -> StaticContact:
    """Return the static stiffness at the contact, and where a constant voltage puts it.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    StaticContact
    """
    natural = modes(structure)
    contact = structure.contact_vector @ natural.shapes
    drive = structure.drive_vector @ natural.shapes
    if np.any(np.abs(contact[natural.rigid]) > 1e-9 * np.abs(contact).max()):
        return StaticContact(static_stiffness=0.0, displacement_per_volt=None)
    sprung = ~natural.rigid
    compliance = contact[sprung] / (2 * np.pi * natural.natural_frequency[sprung]) ** 2
    own = float(compliance @ contact[sprung])
    return StaticContact(
        static_stiffness=1 / own if own > 0 else float("inf"),
        displacement_per_volt=float(compliance @ drive[sprung]),
    )


def equivalent_branches(structure: Structure) -> ButterworthVanDyke:
    """Return the circuit that draws the structure's current, the contact free.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    ButterworthVanDyke
        One branch for each mode that the stack drives.

    Raises
    ------
    InvalidInput
        If the clamped capacitance is zero.

    Notes
    -----
    Exact where damping leaves the modes uncoupled; otherwise each branch has its mode's damping ratio to first order.
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
        if participation[i] ** 2 > _SILENT * omega[i] ** 2 * structure.clamped_capacitance
    ]
    return ButterworthVanDyke(parallel_capacitance=structure.clamped_capacitance, branches=tuple(branches))


def resonance_frequencies(structure: Structure) -> CircuitResonances:
    """Return where the electrical admittance and impedance of the structure peak, the contact free.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    CircuitResonances
        Of the modes that the stack drives, without damping; the quality factors have it.

    Raises
    ------
    InvalidInput
        If the clamped capacitance is zero.
    """
    return circuit_resonances(equivalent_branches(structure))
