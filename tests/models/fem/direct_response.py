"""Frequency response of a driven body by direct solution of the full equations: slow, without reduction error."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from sonolube.models.fem import HarmonicResponse, Model, Output
from sonolube.models.fem.solver.reduction import output_matrix
from sonolube.models.fem.solver.system import assemble_system, superlu_factor


def direct_response(model: Model, *, frequency: ArrayLike, outputs: Mapping[str, Output]) -> HarmonicResponse:
    """Admittance and displacements per volt at each frequency in Hz."""
    f = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    equations = assemble_system(model)
    observed = output_matrix(model, equations, outputs)
    size = len(equations.free_dofs)
    charges, displacements = [], []
    dielectric = sparse.csc_array(equations.dielectric - 1.0j * equations.dielectric_loss)
    charge = equations.drive_dielectric - 1j * equations.drive_dielectric_loss
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
