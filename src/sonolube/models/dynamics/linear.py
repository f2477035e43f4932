"""Linear analysis of a structure: natural modes, poles, equivalent circuit and static stiffness at the contact."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
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
