"""Accuracy and stability of the time steps of a march, with advice on the number of steps."""

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.models.dynamics.gap_laws.protocol import damped_force
from sonolube.models.dynamics.time_marching.batch import MarchingProblem, MarchingSolution

_LARGEST_FORCE = 1e12  # over the load, beyond which a solution has diverged
_LARGEST_DISPLACEMENT = 1.0  # in m, likewise
_LARGEST_ERROR = 1e-3  # of the force in a step, over the largest force, beyond which steps are coarse
_LARGEST_FEEDBACK = 0.1  # relative change of the force by its own effect in a step, above which it may be unstable


def assess_steps(
    problem: MarchingProblem, solution: MarchingSolution
) -> tuple[NDArray[np.str_], NDArray[np.str_], Floats]:
    """Status, advice and error of the steps of each point, by two errors of the force and by its feedback on itself.

    One error is the difference of the predicted force and the force of the corrected state; the other is the effect on
    the mean of aliased harmonics beyond half the steps per period, if these decay like those of a pulse. The feedback
    is the relative change of the force through its own effect over a step, at the stiffest instant of the whole march:
    above a tenth an explicit step can be unstable, with spurious loss of contact.
    """
    gap_law, load, steps = problem.gap_law, problem.normal_load, problem.schedule.steps
    last = solution.recorded[-steps:]
    x, v = (np.einsum("m,tml->lt", row.ravel(), last[:, :-1]) for row in problem.contact_output)
    predicted = last[:, -1].T + load[:, np.newaxis]
    farthest, closest, strongest, weakest = solution.statistics[:, [0, 1, 6, 7]].transpose(1, 2, 0)
    with np.errstate(over="ignore", invalid="ignore"):
        bounded = strongest < _LARGEST_FORCE * load[:, np.newaxis]
        bounded &= np.maximum(farthest, -closest) < _LARGEST_DISPLACEMENT
        diverged = ~(np.all(bounded, axis=1) & np.all(np.isfinite(x), axis=1))
        largest = np.maximum(predicted.max(axis=1), load)
        corrected = np.abs(damped_force(gap_law, x, v, load[:, np.newaxis]) - predicted).max(axis=1) / largest
        harmonics = np.abs(np.fft.rfft(predicted, axis=1))
        aliased = 2 * (harmonics[:, -1] / np.maximum(harmonics[:, 0], 1e-9 * load)) ** 4
        feedback = gap_law.stiffness(closest.min(axis=1), load) * np.abs(solution.step_response[0])
        feedback += gap_law.force_damping * strongest.max(axis=1) * np.abs(solution.step_response[1])
    error = np.where(diverged, np.inf, np.maximum(corrected, aliased))
    unstable, coarse = ~(2 * feedback <= _LARGEST_FEEDBACK), error > _LARGEST_ERROR
    finer = 4 * np.ceil(steps / 4 * np.clip(np.sqrt(4 * feedback / _LARGEST_FEEDBACK), 2.0, 4.0))
    corner = np.any(weakest == 0, axis=1) & (gap_law.has_corner or gap_law.force_damping > 0)
    advice = [""] * load.size
    for i in np.flatnonzero(diverged | unstable | coarse | corner):
        advice[i] = _advice(diverged[i], unstable[i], coarse[i], corner[i], finer[i], steps)
    return np.where(diverged, "diverged", np.where(unstable | coarse, "coarse", "marched")), np.array(advice), error


def _advice(diverged: bool, unstable: bool, coarse: bool, corner: bool, finer: float, steps: int) -> str:
    """Advice for one point: the foremost failure with its remedy, and the order at corners of the force."""
    remedy = f"take {finer:.0f} steps a period, or less voltage" if np.isfinite(finer) else "take less voltage"
    reasons = {
        f"the solution grew without bound; {remedy}": diverged,
        f"{steps} steps a period are too few for the contact at its stiffest; take {finer:.0f}": unstable,
        f"{steps} steps a period leave an error of the force above {_LARGEST_ERROR:g}; take {finer:.0f}": coarse,
    }
    foremost = [text for text, true in reasons.items() if true][:1]
    order = ["the force has a corner at the loss of contact, where the error falls only as the square of the step"]
    return "; ".join(foremost + (order if corner else []))
