"""Frequency response of a piezoelectric body to a harmonic voltage, from a reduced model or from the full equations."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.reduction import Output, ReducedModel, drive_charge, lossy_dielectric, output_matrix
from sonolube.models.fem.solver.system import assemble_system, superlu_factor


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


def direct_response(model: Model, *, frequency: ArrayLike, outputs: Mapping[str, Output]) -> HarmonicResponse:
    """Frequency response by direct solution of the full equations at each frequency: slow, without reduction error.

    Parameters
    ----------
    model : Model
    frequency : array_like, shape (n,)
        Frequency of the voltage. [Hz]
    outputs : mapping of str to Output
        Displacements to observe.

    Returns
    -------
    HarmonicResponse

    Raises
    ------
    InvalidInput
        If a frequency is not positive.

    See Also
    --------
    harmonic_response : The same from a reduced model, for many frequencies.
    sonolube.models.fem.solver.forced_vibration.forced_response : Response to a force instead of a voltage.
    """
    f = np.atleast_1d(require_positive(frequency=frequency))
    equations = assemble_system(model)
    observed = output_matrix(model, equations, outputs)
    size = len(equations.free_dofs)
    charges, displacements = [], []
    dielectric, charge = lossy_dielectric(equations), drive_charge(equations)
    right = np.concatenate([-equations.drive_coupling, charge]).astype(np.complex128)
    for omega in 2 * np.pi * f:
        elastic = equations.stiffness + 1j * equations.stiffness_loss - omega**2 * equations.mass
        blocks = [[elastic, equations.coupling], [equations.coupling.T, -dielectric]]
        solution = superlu_factor(sparse.csc_array(sparse.block_array(blocks, format="csc")))(right)
        displacement, potential = solution[:size], solution[size:]
        charges.append(equations.drive_capacitance + charge @ potential - equations.drive_coupling @ displacement)
        displacements.append(observed @ displacement)
    return HarmonicResponse(
        frequency=f,
        admittance=np.asarray(2j * np.pi * f * np.array(charges), dtype=np.complex128),
        displacement_per_volt=np.array(displacements, dtype=np.complex128).T,
    )
