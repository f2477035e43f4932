"""Floquet multipliers of periodic vibrations, all of them, by eigenvalues of the monodromy matrix."""

import numpy as np
from scipy.linalg import block_diag, expm

from sonolube.checks import Complexes, Floats
from sonolube.models.dynamics.harmonic_balance.equations import PoleResidueModel, pole_residue_model
from sonolube.models.dynamics.motions import SteadyStates, contact_motion


def floquet_multipliers(states: SteadyStates, *, kicks: int = 512) -> Complexes:
    """Floquet multipliers of steady states, largest modulus first, by kick-drift splitting; shape (..., 2 m).

    The splitting is of second order; monodromy matrices with n and 2n kicks are extrapolated.
    """
    model = pole_residue_model(states.structure)
    shape = states.frequency.shape
    multipliers = np.empty((states.frequency.size, 2 * model.trace.size), dtype=np.complex128)
    for point, index in enumerate(np.ndindex(shape)):
        coarse, fine = (_monodromy_matrix(model, states, index, count) for count in (kicks, 2 * kicks))
        eigenvalues = np.linalg.eigvals((4 * fine - coarse) / 3)
        multipliers[point] = eigenvalues[np.argsort(-np.abs(eigenvalues))]
    return multipliers.reshape(*shape, -1)


def _monodromy_matrix(model: PoleResidueModel, states: SteadyStates, index: tuple[int, ...], kicks: int) -> Floats:
    """Monodromy matrix of one steady state on the pairs of states, from mid-kick to mid-kick."""
    pairs = model.trace.size
    step = 1 / states.frequency[index] / kicks
    drift = block_diag(*(expm(step * matrix) for matrix in model.state_matrix))
    contact = contact_motion(states, index, samples=kicks)
    tau = states.gap_law.force_damping
    factor = np.maximum(1 - tau * contact.velocity, 0.0)
    stiffness = factor * states.gap_law.stiffness(contact.displacement, states.normal_load[index])
    damping = tau * (factor > 0) * states.gap_law.force(contact.displacement, states.normal_load[index])
    contact_input, displacement, velocity = (
        each.reshape(-1) for each in (model.contact_input, model.displacement_output, model.velocity_output)
    )

    def kick(matrix: Floats, instant: int, duration: float) -> Floats:
        # velocity w of the contact becomes w exp(-g d t) - (1 - exp(-g d t)) k x / d, g its change per impulse
        decay = float(velocity @ contact_input) * damping[instant] * duration
        held = duration * (-np.expm1(-decay) / decay if decay > 0 else 1.0)
        impulse = held * (stiffness[instant] * displacement + damping[instant] * velocity) @ matrix
        return matrix - np.outer(contact_input, impulse)

    period = kick(np.eye(2 * pairs), 0, step / 2)
    for instant in range(1, kicks):
        period = kick(drift @ period, instant, step)
    return kick(drift @ period, 0, step / 2)
