"""Stability of periodic vibrations: Floquet multipliers of the motion linearised about them."""

import numpy as np
from scipy.linalg import block_diag, expm

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.harmonic_balance.receptance import ContactPort, contact_port
from sonolube.dynamics.steady_friction import motion
from sonolube.dynamics.steady_state import Status, SteadyStates
from sonolube.errors import InvalidInput


def floquet_multipliers(states: SteadyStates, *, kicks: int = 512) -> Complexes:
    """Return the factors by which small disturbances multiply in one period.

    Parameters
    ----------
    states : SteadyStates
    kicks : int
        Instants a period at which the contact acts on the disturbance; errors fall with the fourth power.

    Returns
    -------
    ndarray of complex, shape (..., 2m)
        For each of the m pairs of states that drive or contact can see, largest modulus first. The vibration is stable
        where all moduli are below one.

    Raises
    ------
    InvalidInput
        If a state did not converge or kicks are fewer than 8.

    Notes
    -----
    Between instants the structure moves exactly; the contact's momentary stiffness and damping enter as kicks, which is
    second order, and two such periods are extrapolated. Where the force has corners, as at the loss of a linear
    contact, the order is lower.
    """
    if kicks < 8:
        raise InvalidInput(f"kicks must be at least 8, got {kicks!r}")
    if np.any(states.status == Status.NOT_CONVERGED):
        raise InvalidInput("states must have converged: a point without a vibration has no stability")
    port = contact_port(states.structure)
    shape = states.frequency.shape
    found = np.empty((states.frequency.size, 2 * port.trace.size), dtype=np.complex128)
    for point, index in enumerate(np.ndindex(shape)):
        coarse, fine = (_one_period(port, states, index, count) for count in (kicks, 2 * kicks))
        multipliers = np.linalg.eigvals((4 * fine - coarse) / 3)
        found[point] = multipliers[np.argsort(-np.abs(multipliers))]
    return found.reshape(*shape, -1)


def _one_period(port: ContactPort, states: SteadyStates, index: tuple[int, ...], kicks: int) -> Floats:
    """Return the matrix of one period on the pairs of states, from mid-kick to mid-kick."""
    pairs = port.trace.size
    step = 1 / states.frequency[index] / kicks
    free = block_diag(*(expm(step * generator) for generator in port.generator))
    contact = motion(states, index, samples=kicks)
    lag = states.gap_law.force_damping
    share = np.maximum(1 - lag * contact.velocity, 0.0)
    stiffness = share * states.gap_law.stiffness(contact.displacement, states.normal_load[index])
    damping = lag * (share > 0) * states.gap_law.force(contact.displacement, states.normal_load[index])
    push, feel, sense = port.push.reshape(-1), port.displacement.reshape(-1), port.velocity.reshape(-1)

    def kick(matrix: Floats, instant: int, duration: float) -> Floats:
        # the contact's velocity w becomes w exp(-g d t) - (1 - exp(-g d t)) k x / d, g its jump per impulse
        fade = float(sense @ push) * damping[instant] * duration
        held = duration * (-np.expm1(-fade) / fade if fade > 0 else 1.0)
        return matrix - np.outer(push, held * (stiffness[instant] * feel + damping[instant] * sense) @ matrix)

    period = kick(np.eye(2 * pairs), 0, step / 2)
    for instant in range(1, kicks):
        period = kick(free @ period, instant, step)
    return kick(free @ period, 0, step / 2)
