"""One bristle under a varying normal force: the holder behind it, and the mean force over its steady period."""

import math
from dataclasses import dataclass

import numba
import numpy as np
from scipy.linalg import expm

from sonolube.checks import Floats, require_non_negative
from sonolube.errors import InvalidInput

__all__ = ["RIGID", "Holder"]  # the kernels are for the models of this room
MOST_PERIODS = 4000
"""Periods after which a steady period is no longer expected."""

_NEWTON = 60


@dataclass(frozen=True, kw_only=True, slots=True)
class Holder:
    """Spring, mass and damper that hold the slider along the sliding direction.

    Parameters
    ----------
    holder_stiffness : float
        Stiffness between slider and ground; infinite for a rigid holder. [N/m]
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


def holder_propagators(holder: Holder, step: float) -> tuple[Floats, Floats, Floats]:
    """Return the matrices of one time step of the holder: of its state (y, dy/dt), and of the force at both ends."""
    m, c, K = holder.holder_mass, holder.holder_damping, holder.holder_stiffness
    rates = np.zeros((4, 4))
    rates[:2] = np.array([[0, 1, 0, 0], [-K / m, -c / m, 1 / m, 0]])
    rates[2, 3] = 1 / step
    moved = expm(rates * step)
    return np.ascontiguousarray(moved[:2, :2]), moved[:2, 2] - moved[:2, 3], np.ascontiguousarray(moved[:2, 3])


@numba.njit(cache=True)
def _grown(force: float, k: float, limit: float, slide: float, exponent: float) -> float:
    """Return the force after a slide at one stiffness and limit, before it is cut at the next limit."""
    if exponent == 0.0 or slide == 0.0:
        return force + k * slide
    if limit <= 0.0:
        return 0.0
    goal = math.copysign(limit, slide)
    return goal + (force - goal) * math.exp(-k * abs(slide) / limit)


@numba.njit(cache=True)
def bristle_on_spring(k: Floats, limit: Floats, slides: Floats, steady: Floats, exponent: float) -> Floats:
    """Return the mean force of a bristle on a holder without mass, at each of the steady slides a step."""
    n = k.size
    means = np.empty(steady.size)
    for i in range(steady.size):
        force = limit[0]  # it slips where the load is least, unless the in-plane motion turns it back
        for _ in range(MOST_PERIODS):
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
def bristle_on_mass(
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
    """Return the mean force at the steady period, by Newton's method on the map of one period, else by marching."""
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
            total, kept = 0.0, MOST_PERIODS // 4
            for period in range(MOST_PERIODS):
                state, slope, mean = _period(state, k, limit, slides, steady[i], exponent, free, by_first, by_last)
                if period >= MOST_PERIODS - kept:
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
