"""Whether the steps of a march resolved the contact, and what to do where they did not."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw
from sonolube.dynamics.time_marching.batch import Marched

_RUNAWAY = 1e12  # force over load beyond which nothing physical has happened
_FAR_AWAY = 1.0  # displacement likewise, in m
_COARSE = 1e-3  # error of a step, over the largest force, beyond which results are not to be trusted
_FEEDBACK = 0.1  # relative change of the force by its own effect over a step, beyond which steps may be unstable


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Resolution:
    """How well the steps of each point follow its contact.

    Parameters
    ----------
    status : ndarray of str, shape (points,)
        "marched", "coarse" or "diverged".
    advice : ndarray of str, shape (points,)
    step_error : ndarray, shape (points,)
        Estimated error of the contact force over its largest value; infinite where diverged.
    """

    status: NDArray[np.str_]
    advice: NDArray[np.str_]
    step_error: Floats


def resolution(marched: Marched, contact_rows: Floats, gap_law: GapLaw, load: Floats, steps: int) -> Resolution:
    """Judge the steps by two errors of the force in the last period and by the feedback of the force on itself.

    Parameters
    ----------
    marched : Marched
    contact_rows : ndarray, shape (2, n, 2)
        Displacement and velocity of the contact per state.
    gap_law : GapLaw
    load : ndarray, shape (points,)
        Dead load in N.
    steps : int
        Steps a period.

    Returns
    -------
    Resolution

    Notes
    -----
    One error is the difference of the force foreseen and the force of the corrected state; the other is what aliasing
    of harmonics beyond half the steps a period does to the mean, if they fall off like those of a pulse. The feedback
    is the relative change of the force through its own effect over a step, at the stiffest instant of the whole march:
    above a tenth an explicit step can be unstable, and what it throws off may look like hopping.
    """
    last = marched.recorded[-steps:]
    x, v = (np.einsum("m,tml->lt", row.ravel(), last[:, :-1]) for row in contact_rows)
    made_with = last[:, -1].T + load[:, np.newaxis]
    farthest, closest, strongest, weakest = marched.statistics[:, [0, 1, 6, 7]].transpose(1, 2, 0)
    with np.errstate(over="ignore", invalid="ignore"):
        kept = (strongest < _RUNAWAY * load[:, np.newaxis]) & (np.maximum(farthest, -closest) < _FAR_AWAY)
        ran_away = ~(np.all(kept, axis=1) & np.all(np.isfinite(x), axis=1))
        largest = np.maximum(made_with.max(axis=1), load)
        corrected = np.abs(force_in_motion(gap_law, x, v, load[:, np.newaxis]) - made_with).max(axis=1) / largest
        harmonics = np.abs(np.fft.rfft(made_with, axis=1))
        aliased = 2 * (harmonics[:, -1] / np.maximum(harmonics[:, 0], 1e-9 * load)) ** 4
        feedback = gap_law.stiffness(closest.min(axis=1), load) * np.abs(marched.yielded[0])
        feedback += gap_law.force_damping * strongest.max(axis=1) * np.abs(marched.yielded[1])
    error = np.where(ran_away, np.inf, np.maximum(corrected, aliased))
    unstable, coarse = ~(2 * feedback <= _FEEDBACK), error > _COARSE
    finer = 4 * np.ceil(steps / 4 * np.clip(np.sqrt(4 * feedback / _FEEDBACK), 2.0, 4.0))
    corner = np.any(weakest == 0, axis=1) & (not isinstance(gap_law, ExponentialGap) or gap_law.force_damping > 0)
    advice = [""] * load.size
    for i in np.flatnonzero(ran_away | unstable | coarse | corner):
        advice[i] = _advice(ran_away[i], unstable[i], coarse[i], corner[i], finer[i], steps)
    return Resolution(
        status=np.where(ran_away, "diverged", np.where(unstable | coarse, "coarse", "marched")),
        advice=np.array(advice),
        step_error=error,
    )


def force_in_motion(gap_law: GapLaw, x: Floats, v: Floats, load: Floats) -> Floats:
    """Return the contact force of an instant in N, damping included.

    Parameters
    ----------
    gap_law : GapLaw
    x, v : ndarray
        Displacement and velocity of the contact, in m and m/s.
    load : ndarray
        Dead load in N.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return gap_law.force(x, load) * np.maximum(1 - gap_law.force_damping * v, 0.0)


def _advice(ran_away: bool, unstable: bool, coarse: bool, corner: bool, finer: float, steps: int) -> str:
    remedy = f"take {finer:.0f} steps a period, or less voltage" if np.isfinite(finer) else "take less voltage"
    reasons = {
        f"the contact ran away; {remedy}": ran_away,
        f"{steps} steps a period are too few to follow the contact at its stiffest; take {finer:.0f}": unstable,
        f"{steps} steps a period leave more than {_COARSE:g} of error in the force; take {finer:.0f}": coarse,
    }
    foremost = [text for text, true in reasons.items() if true][:1]
    cut = ["the force reaches zero at a corner, where the error falls only with the square of the step"]
    return "; ".join(foremost + (cut if corner else []))
