"""Model order reduction of a driven piezoelectric body by a block Krylov subspace of its inputs.

Modes that neither the voltage nor a force on an output excites, such as bending of a straight stack, are not in the
subspace, so that far fewer vectors cover a frequency range than with all modes from the lowest upwards.
"""

from collections.abc import Mapping

import numpy as np
from scipy import sparse

from sonolube.checks import Floats
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import NotConverged, spectral_shift
from sonolube.models.fem.solver.reduction import Output, ReducedModel, input_vectors, project_system
from sonolube.models.fem.solver.system import assemble_system, nodal_displacements, shift_invert_solver

_RESIDUAL = 1e-2  # norm of a residual over its eigenvalue; the relative error of a frequency is of its square
_UNCOUPLED = 2e-3  # squared coupling factor up to which a mode need not converge
_MIN_STEPS, _MAX_STEPS = 3, 60  # solutions with a block of vectors
_DEPENDENT = 1e-20  # squared length of a unit vector's new component, below which it counts as rounding


def krylov_reduction(
    model: Model, *, outputs: Mapping[str, Output], highest_frequency: float
) -> tuple[ReducedModel, Floats]:
    r"""Reduced model in the coordinates that the drive and forces on the outputs excite, accurate up to a frequency.

    Parameters
    ----------
    model : Model
        With a driven electrode.
    outputs : mapping of str to Output
        Displacements to observe and points of application of forces.
    highest_frequency : float
        Frequency up to which the driven modes converge. [Hz]

    Returns
    -------
    reduction : ReducedModel
    shapes : ndarray, shape (k, n, 3)
        Displacements of the nodes for each coordinate.

    Raises
    ------
    InvalidInput
        If no piezoelectric region has a driven electrode.
    NotConverged
        If the driven modes do not converge.

    Notes
    -----
    Block Lanczos iteration as in `natural_modes`, on the subspace

    .. math::

        \mathrm{span}\{A^{-1} F,\; A^{-1} M A^{-1} F,\; \ldots\}, \qquad
        A = K + C P^{-1} C^\mathsf{T} - \sigma M

    of the inputs F, one volt and one newton on each output, instead of random vectors [1]_.

    See Also
    --------
    sonolube.models.fem.solver.reduction.reduce_model : All of the lowest modes with static correction.

    References
    ----------
    .. [1] R. R. Craig and A. L. Hale, J. Guid. Control Dyn. 11, 562 (1988). doi:10.2514/3.20353
    """
    highest = (2 * np.pi * highest_frequency) ** 2
    equations, shift = assemble_system(model), spectral_shift(model)
    inverse = shift_invert_solver(model, equations, shift=shift)
    forces, capacitance = input_vectors(model, equations, outputs)
    basis = np.zeros((len(forces), 0))
    images = mass_basis = basis
    block = _orthonormal_beside(inverse(forces), basis, mass_basis, equations.mass)
    for step in range(_MAX_STEPS):
        basis, mass_basis = np.hstack([basis, block]), np.hstack([mass_basis, equations.mass @ block])
        added = block.shape[1]
        image = inverse(mass_basis[:, -added:])
        images = np.hstack([images, image])
        projection = mass_basis.T @ images
        values, vectors = np.linalg.eigh((projection + projection.T) / 2)
        remainder = image - basis @ projection[:, -added:]
        last = vectors[-added:]
        residual = np.einsum("ik,ij,jk->k", last, remainder.T @ (equations.mass @ remainder), last)  # squared
        squares = shift + 1 / values
        drive = (forces[:, 0] @ basis @ vectors) ** 2
        wanted = (squares < highest) & (drive > _UNCOUPLED * capacitance * squares)
        block = _orthonormal_beside(remainder, basis, mass_basis, equations.mass)
        converged = step >= _MIN_STEPS and np.all(residual[wanted] < (_RESIDUAL * values[wanted]) ** 2)
        if not block.shape[1] or converged:
            reduction = project_system(model, equations, basis=basis, outputs=outputs)
            return reduction, nodal_displacements(model, equations, basis)
    raise NotConverged("the driven modes did not converge; ask for a lower frequency, or check the mesh")


def _orthonormal_beside(block: Floats, basis: Floats, mass_basis: Floats, mass: sparse.csc_array) -> Floats:
    """Mass-orthonormal basis of a block's component orthogonal to a given basis."""
    block = block / np.sqrt(np.einsum("nk,nk->k", block, mass @ block) + np.finfo(float).tiny)
    vectors = block
    for _ in range(2):  # twice is enough against rounding
        vectors = vectors - basis @ (mass_basis.T @ vectors)
        squares, rotation = np.linalg.eigh(vectors.T @ (mass @ vectors))
        independent = squares > _DEPENDENT
        vectors = vectors @ (rotation[:, independent] / np.sqrt(squares[independent]))
    return np.asarray(vectors)
