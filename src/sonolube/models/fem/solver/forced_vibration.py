"""Forced vibration: harmonic or static response to a force on a face, by direct solution of the full equations."""

import numpy as np
from scipy import sparse

from sonolube.checks import Complexes, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import rigid_body_mode_count
from sonolube.models.fem.solver.reduction import Output, output_matrix
from sonolube.models.fem.solver.system import assemble_system, nodal_displacements, superlu_factor


def forced_response(model: Model, *, load: Output, frequency: float) -> Complexes:
    r"""Nodal displacements per newton of a harmonic or static force distributed evenly over a face.

    Parameters
    ----------
    model : Model
        Without piezoelectric regions; for these use `reduce_model` and a voltage.
    load : Output
        Face on which the force acts, and its direction.
    frequency : float
        Frequency of the force; zero for a static one. [Hz]

    Returns
    -------
    ndarray of complex, shape (n, 3)
        Complex amplitudes in m/N, of displacements proportional to exp(i omega t) under a real force.

    Raises
    ------
    InvalidInput
        If a region is piezoelectric, or the force is static and the body not fully supported.

    Notes
    -----
    With hysteretic losses, stiffness :math:`c(1 + i\eta)`, one factorisation without modal truncation solves

    .. math:: \left(K(1 + i\eta) - \omega^2 M\right) u = F

    See Also
    --------
    sonolube.models.fem.solver.harmonic_analysis.harmonic_response : Response to a voltage.
    """
    require_non_negative(frequency=frequency)
    if model.is_piezoelectric:
        raise InvalidInput("the body is piezoelectric; drive it by a voltage instead of a force")
    free = rigid_body_mode_count(model)
    if frequency == 0 and free:
        raise InvalidInput(
            f"a static force needs a fully supported body; {free} rigid-body modes are free: hold a face"
        )
    equations = assemble_system(model)
    force = output_matrix(model, equations, {"load": load})[0]
    dynamic = equations.stiffness + 1j * equations.stiffness_loss - (2 * np.pi * frequency) ** 2 * equations.mass
    displacement = superlu_factor(sparse.csc_array(dynamic))(force.astype(np.complex128))
    return np.asarray(nodal_displacements(model, equations, displacement[:, np.newaxis])[0], dtype=np.complex128)
