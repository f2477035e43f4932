"""Motion under a harmonic or a steady force, from the full equations."""

import numpy as np
from scipy import sparse

from sonolube.checks import Complexes, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.fem.solver.harmonic_analysis import Output, output_matrix
from sonolube.fem.solver.model import Model
from sonolube.fem.solver.modes import rigid_body_mode_count
from sonolube.fem.solver.system import assemble_system, nodal_displacements, superlu_factor


def forced_response(model: Model, *, load: Output, frequency: float) -> Complexes:
    """Return the displacements of all nodes per newton of a force spread evenly over a face.

    Parameters
    ----------
    model : Model
        Without piezoelectric regions; drive those by a voltage, `reduced`.
    load : Output
        The face on which the force acts, and its direction.
    frequency : float
        Frequency of the force; zero for a steady one. [Hz]

    Returns
    -------
    ndarray of complex, shape (n, 3)
        Amplitudes of motions as exp(i omega t), in m/N, of a force that is real.

    Raises
    ------
    InvalidInput
        If a region is piezoelectric, or a steady force meets a body that is not held.

    Notes
    -----
    Losses are hysteretic, stiffness c (1 + i eta). One factorisation of the full equations: no modes are left out.
    """
    require_non_negative(frequency=frequency)
    if model.is_piezoelectric:
        raise InvalidInput("the body is piezoelectric; drive it by a voltage instead of a force")
    free = rigid_body_mode_count(model)
    if frequency == 0 and free:
        raise InvalidInput(f"a steady force needs a body that is held; {free} rigid motions are free")
    equations = assemble_system(model)
    force = output_matrix(model, equations, {"load": load})[0]
    dynamic = equations.stiffness + 1j * equations.stiffness_loss - (2 * np.pi * frequency) ** 2 * equations.mass
    moves = superlu_factor(sparse.csc_array(dynamic))(force.astype(np.complex128))
    return np.asarray(nodal_displacements(model, equations, moves[:, np.newaxis])[0], dtype=np.complex128)
