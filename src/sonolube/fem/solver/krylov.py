"""A driven body in the coordinates that its drive and its outputs move, and no others: a Krylov reduction.

Modes that neither the voltage nor a force on an output moves, such as bending of a straight stack, are never met, so
that far fewer vectors reach as high as with modes from the lowest upwards.
"""

from collections.abc import Mapping

import numpy as np
from scipy import sparse

from sonolube.checks import Floats
from sonolube.fem.solver.harmonic_analysis import Output, ReducedModel, input_vectors, project_system
from sonolube.fem.solver.model import Model
from sonolube.fem.solver.modes import NotConverged, spectral_shift
from sonolube.fem.solver.system import assemble_system, nodal_displacements, shift_invert_solver

_RESIDUAL = 1e-2  # of a shape over its eigenvalue; the frequency is right to its square
_UNMOVED = 2e-3  # square of the coupling factor below which a shape need not converge
_FEWEST, _MOST = 3, 60  # solves with all inputs
_NOTHING_NEW = 1e-20  # square of what is new in a vector over its square, below which it is rounding


def krylov_reduction(
    model: Model, *, outputs: Mapping[str, Output], highest_frequency: float
) -> tuple[ReducedModel, Floats]:
    """Return a body in coordinates that its drive and outputs move, exact enough up to a frequency.

    Parameters
    ----------
    model : Model
        With a driven electrode.
    outputs : mapping of str to Output
        What to observe, and where forces act.
    highest_frequency : float
        Frequency up to which modes that the drive moves are to be right. [Hz]

    Returns
    -------
    tuple of ReducedModel and ndarray, shape (k, n, 3)
        The latter has displacements of the nodes for each coordinate.

    Raises
    ------
    InvalidInput
        If nothing is driven.
    NotConverged
        If the modes are not found.

    Notes
    -----
    Block Lanczos iteration about a negative shift as in `natural_modes`, begun with the responses to one volt and to
    one newton on each output instead of random vectors. [1]_

    References
    ----------
    .. [1] R. R. Craig and A. L. Hale, J. Guid. Control Dyn. 11, 562 (1988). doi:10.2514/3.20353
    """
    highest = (2 * np.pi * highest_frequency) ** 2
    equations, shift = assemble_system(model), spectral_shift(model)
    inverse = shift_invert_solver(model, equations, shift=shift)
    forces, capacitance = input_vectors(model, equations, outputs)
    basis = np.zeros((len(forces), 0))
    images = loaded = basis
    fresh = _new_in(inverse(forces), basis, loaded, equations.mass)
    for step in range(_MOST):
        basis, loaded = np.hstack([basis, fresh]), np.hstack([loaded, equations.mass @ fresh])
        added = fresh.shape[1]
        image = inverse(loaded[:, -added:])
        images = np.hstack([images, image])
        turned = loaded.T @ images
        values, mixtures = np.linalg.eigh((turned + turned.T) / 2)
        rest = image - basis @ turned[:, -added:]
        ends = mixtures[-added:]
        missed = np.einsum("ik,ij,jk->k", ends, rest.T @ (equations.mass @ rest), ends)
        squares = shift + 1 / values
        pulled = (forces[:, 0] @ basis @ mixtures) ** 2
        watched = (squares < highest) & (pulled > _UNMOVED * capacitance * squares)
        fresh = _new_in(rest, basis, loaded, equations.mass)
        if not fresh.shape[1] or (step >= _FEWEST and np.all(missed[watched] < (_RESIDUAL * values[watched]) ** 2)):
            reduction = project_system(model, equations, basis=basis, outputs=outputs)
            return reduction, nodal_displacements(model, equations, basis)
    raise NotConverged("the driven modes did not converge; ask for a lower frequency, or check the mesh")


def _new_in(block: Floats, basis: Floats, loaded: Floats, mass: sparse.csc_array) -> Floats:
    """Return what is new in a block beside a basis, orthonormal in the metric of mass."""
    block = block / np.sqrt(np.einsum("nk,nk->k", block, mass @ block) + np.finfo(float).tiny)
    fresh = block
    for _ in range(2):  # once more against rounding
        fresh = fresh - basis @ (loaded.T @ fresh)
        squares, turns = np.linalg.eigh(fresh.T @ (mass @ fresh))
        told = squares > _NOTHING_NEW
        fresh = fresh @ (turns[:, told] / np.sqrt(squares[told]))
    return np.asarray(fresh)
