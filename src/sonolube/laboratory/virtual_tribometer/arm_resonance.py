"""Resonance of the arm that loads the pin, by the structure of a rig."""

import numpy as np

from sonolube.models.dynamics import Structure


def arm_resonance(structure: Structure) -> tuple[float, float] | None:
    """Lowest natural frequency of a structure whose pin rests on the disc, and its damping ratio.

    Frequency in Hz, and damping ratio by the diagonal of the modal damping; None where nothing swings.
    """
    from scipy.linalg import eigh, null_space

    held = null_space(structure.contact_vector[np.newaxis, :])
    if not held.size:
        return None
    mass, damping, stiffness = (
        held.T @ each @ held for each in (structure.mass_matrix, structure.damping_matrix, structure.stiffness_matrix)
    )
    squares, shapes = eigh(stiffness, mass)
    swings = np.flatnonzero(squares > 1e-9 * squares[-1])
    if not swings.size:
        return None
    shape, angular = shapes[:, swings[0]], float(np.sqrt(squares[swings[0]]))
    return angular / (2 * np.pi), float(shape @ damping @ shape) / (2 * angular)
