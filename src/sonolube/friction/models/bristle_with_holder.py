"""Friction of one bristle under a vibrating load, coupled to the normal motion, the holder and in-plane motion."""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numba
import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import expm

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.contact.cube import mindlin_stiffness
from sonolube.contact.motion import GapMotion, converged_mean, open_separation, shifted
from sonolube.contact.rough import RoughContact
from sonolube.errors import InvalidInput, ModelRangeWarning

__all__ = ["Holder", "coupled"]  # the rest is of use in this room only
_NEWTON, _PERIODS = 60, 4000


@dataclass(frozen=True, kw_only=True, slots=True)
class Holder:
    """What holds the slider back, along the sliding direction.

    Parameters
    ----------
    holder_stiffness : float
        Stiffness that the slider feels; infinite for a rigid holder. [N/m]
    holder_mass : float
        Mass that moves with the slider; zero for a spring alone. [kg]
    holder_damping : float
        Damping between slider and ground; only of a holder with mass. [N s/m]

    Raises
    ------
    InvalidInput
        If the stiffness is not positive, another value negative or not finite, or a holder without mass is damped or
        one with mass rigid.
    """

    holder_stiffness: float = math.inf
    holder_mass: float = 0.0
    holder_damping: float = 0.0

    def __post_init__(self) -> None:
        if not self.holder_stiffness > 0:
            raise InvalidInput(f"holder_stiffness must be positive, got {self.holder_stiffness!r} N/m")
        require_non_negative(holder_mass=self.holder_mass, holder_damping=self.holder_damping)
        if self.holder_mass == 0 and self.holder_damping > 0:
            raise InvalidInput(f"holder_damping needs a holder_mass, got {self.holder_damping!r} N s/m without")
        if self.holder_mass > 0 and math.isinf(self.holder_stiffness):
            raise InvalidInput(f"holder_mass of {self.holder_mass!r} kg cannot move on an infinite holder_stiffness")


RIGID = Holder()
"""A holder that does not yield."""


def coupled(
    contact: RoughContact,
    motion: GapMotion,
    *,
    sliding_speed: ArrayLike,
    friction_coefficient: ArrayLike,
    holder: Holder = RIGID,
    in_plane_fraction: ArrayLike = 0.0,
    phase: ArrayLike = 0.0,
    stiffness: Callable[..., Floats] = mindlin_stiffness,
    dahl_exponent: Literal[0, 1] = 0,
) -> Floats:
    """Return friction under any periodic motion over friction without, one bristle carried along the motion. []

    Parameters
    ----------
    contact : RoughContact
    motion : GapMotion
    sliding_speed : array_like, any shape
        Mean speed of the sliding. [m/s]
    friction_coefficient : float
        Coefficient of steady sliding, which limits friction at every instant's normal force. []
    holder : Holder
    in_plane_fraction : float
        Motion along the sliding direction over that along the normal. []
    phase : float
        Lag of the in-plane motion behind the normal one. [rad]
    stiffness : callable
        Gives the bristle's stiffness for a contact and its `separation`.
    dahl_exponent : {0, 1}
        How the bristle nears its limit: 0 elastic up to it, as spring and slider in series; 1 gradually, after Dahl.

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed or the coefficient is not positive, the fraction negative, or a value not finite.
    OutsideRange
        If the motion closes the gap.

    Warns
    -----
    ModelRangeWarning
        If slider and holder found no steady period; the mean over the last of many periods is given.

    Notes
    -----
    dF/dt = k_t(t) v (1 - sgn(v) F/(mu F_n))^i, and abs(F) <= mu F_n(t) always; v = v_r + du/dt - dy/dt with u the
    in-plane motion and y the holder's, m y'' + c y' + K y = F. Friction grows by what the bristle is stretched, so that
    a stiffness which only multiplies the stretch, F = k_t(t) delta, is not meant: with k_t in proportion to F_n that
    would leave friction as it is.

    With a rigid holder, exponent 0, Mindlin's stiffness and a balanced sine the ratio is exactly 1 from
    v_r = mu omega a k_n/k_t on, and exp(-beta)/I0(beta) in the limit of slow sliding: no vibration along the normal
    alone can push it below that plateau. A yielding holder without mass stands in series with the bristle.

    One bristle keeps its force while parts of the contact open and close. With in-plane motion in step with the normal
    one a stiffness that varies therefore pumps force into it; `stick_slip`, where every asperity starts anew, does not.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    .. [2] P. R. Dahl, AIAA J. 14, 1675 (1976). doi:10.2514/3.61511
    """
    v_r = require_positive(sliding_speed=sliding_speed)
    mu = float(require_positive(friction_coefficient=friction_coefficient))
    fraction = float(require_non_negative(in_plane_fraction=in_plane_fraction))
    lag = float(require_finite(phase=phase))
    d = open_separation(contact, motion)
    settled = True

    def friction(sampled: GapMotion) -> Floats:
        nonlocal settled
        order = np.roll(np.arange(sampled.displacement.size), -int(np.argmin(sampled.normal_force)))
        limit = mu * sampled.normal_force[order]
        k = stiffness(contact, separation=d + sampled.displacement[order])
        u = fraction * shifted(sampled.displacement, phase=lag)[order]
        step = 1 / (motion.frequency * order.size)
        slides = np.roll(u, -1) - u, v_r.ravel() * step
        if holder.holder_mass == 0:
            k = k / (1 + k / holder.holder_stiffness)
            return _with_spring(k, limit, *slides, float(dahl_exponent))
        rigid = _with_spring(k, limit, *slides, float(dahl_exponent))
        forces, settled = with_mass(
            k, limit, *slides, step, float(dahl_exponent), *propagators(holder, step), rigid / holder.holder_stiffness
        )
        return forces

    forces = converged_mean(lambda sampled: friction(sampled) / (mu * motion.normal_load), motion)
    if not settled:
        warnings.warn(
            f"slider and holder found no steady period in {_PERIODS}; the mean over the last of them is given."
            " More holder_damping lets them settle",
            ModelRangeWarning,
            stacklevel=2,
        )
    return forces.reshape(v_r.shape)


def propagators(holder: Holder, step: float) -> tuple[Floats, Floats, Floats]:
    """Return how state (y, dy/dt) of the holder, and a force rising linearly over a step, make its next state."""
    m, c, K = holder.holder_mass, holder.holder_damping, holder.holder_stiffness
    rates = np.zeros((4, 4))
    rates[:2] = np.array([[0, 1, 0, 0], [-K / m, -c / m, 1 / m, 0]])
    rates[2, 3] = 1 / step
    moved = expm(rates * step)
    return np.ascontiguousarray(moved[:2, :2]), moved[:2, 2] - moved[:2, 3], np.ascontiguousarray(moved[:2, 3])


@numba.njit(cache=True)
def _grown(force: float, k: float, limit: float, slide: float, exponent: float) -> float:
    """Return the force after a slide at one stiffness and limit, before the next limit cuts it."""
    if exponent == 0.0 or slide == 0.0:
        return force + k * slide
    if limit <= 0.0:
        return 0.0
    goal = math.copysign(limit, slide)
    return goal + (force - goal) * math.exp(-k * abs(slide) / limit)


@numba.njit(cache=True)
def _with_spring(k: Floats, limit: Floats, slides: Floats, steady: Floats, exponent: float) -> Floats:
    n = k.size
    means = np.empty(steady.size)
    for i in range(steady.size):
        force = limit[0]  # it slips where the load is least, unless the in-plane motion turns it back
        for _ in range(_PERIODS):
            begun, total = force, 0.0
            for j in range(n):
                following = j + 1 if j + 1 < n else 0
                mid_limit = (limit[j] + limit[following]) / 2
                force = _grown(force, (k[j] + k[following]) / 2, mid_limit, slides[j] + steady[i], exponent)
                force = min(max(force, -limit[following]), limit[following])
                total += force
            if abs(force - begun) <= 1e-12 * limit.max():
                break
        means[i] = total / n
    return means


@numba.njit(cache=True)
def with_mass(
    k: Floats,
    limit: Floats,
    slides: Floats,
    steady: Floats,
    step: float,
    exponent: float,
    free: Floats,
    by_first: Floats,
    by_last: Floats,
    pulled: Floats,
) -> tuple[Floats, bool]:
    """Find the steady period of force and holder by Newton's method on the map of one period, else by marching."""
    means = np.empty(steady.size)
    settled = True
    for i in range(steady.size):
        state = np.array([limit[0], pulled[i], 0.0])  # force, y, dy/dt
        found = False
        for _ in range(_NEWTON):
            end, slope, mean = _period(state, k, limit, slides, steady[i], exponent, free, by_first, by_last)
            miss = end - state
            # a stiff holder's velocity may be mere rounding beside the sliding speed, which is what it adds to
            scale = np.abs(end) + np.array([limit.max(), 1e-12, 1e-3 * steady[i] / step])
            if np.all(np.abs(miss) <= 1e-10 * scale):
                means[i], found = mean, True
                break
            state = state + np.linalg.solve(np.eye(3) - slope, miss)
            state[0] = min(max(state[0], -limit[0]), limit[0])
        if not found:
            total, kept = 0.0, _PERIODS // 4
            for period in range(_PERIODS):
                state, slope, mean = _period(state, k, limit, slides, steady[i], exponent, free, by_first, by_last)
                if period >= _PERIODS - kept:
                    total += mean
            means[i], settled = total / kept, False
    return means, settled


@numba.njit(cache=True)
def _period(
    state: Floats,
    k: Floats,
    limit: Floats,
    slides: Floats,
    steady: float,
    exponent: float,
    free: Floats,
    by_first: Floats,
    by_last: Floats,
) -> tuple[Floats, Floats, float]:
    """Return the state after a period, its derivative by the state before, and the mean force."""
    n = k.size
    force, y, w = state
    slope = np.eye(3)
    total = 0.0
    for j in range(n):
        following = j + 1 if j + 1 < n else 0
        stiff, mid_limit, next_limit = (k[j] + k[following]) / 2, (limit[j] + limit[following]) / 2, limit[following]
        y_free = free[0, 0] * y + free[0, 1] * w + by_first[0] * force
        w_free = free[1, 0] * y + free[1, 1] * w + by_first[1] * force
        by_state = free[:, :1] * slope[1] + free[:, 1:] * slope[2] + by_first.reshape(2, 1) * slope[0]
        # the part of the slide that does not depend on the force at the step's end
        slide = slides[j] + steady - (y_free - y)
        if exponent == 1.0 and mid_limit > 0:
            stiff *= max(1.0 - math.copysign(force, force * slide) / mid_limit, 0.0)
        last = (force + stiff * slide) / (1 + stiff * by_last[0])
        if abs(last) <= next_limit:
            slope[0] = (slope[0] - stiff * (by_state[0] - slope[1])) / (1 + stiff * by_last[0])
        else:
            last = math.copysign(next_limit, last)
            slope[0] = 0.0
        y, w, force = y_free + by_last[0] * last, w_free + by_last[1] * last, last
        slope[1] = by_state[0] + by_last[0] * slope[0]
        slope[2] = by_state[1] + by_last[1] * slope[0]
        total += force
    return np.array([force, y, w]), slope, total / n
