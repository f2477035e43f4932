r"""Mean force of one elastoplastic bristle over the steady period of a vibration, on a rigid or an elastic holder.

The force F of a bristle of stiffness k_t under the normal force F_n follows

.. math:: \frac{\mathrm{d}F}{\mathrm{d}t} = k_t(t)\, v \left( 1 - \mathrm{sgn}(v)\, \frac{F}{\mu F_n} \right)^i, \qquad
          |F| \le \mu F_n(t)

with the exponent i of Dahl, 0 (elastic up to the limit) or 1 (gradual). The slider is held by a spring without mass, or
by a spring, mass and damper, whose displacement adds to the relative velocity v.
"""

import math
from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import INNER, kernel

__all__ = ["RIGID", "Holder"]  # the kernels serve this room only
MAXIMUM_PERIODS = 4000
"""Largest number of periods integrated towards a steady period."""

_MAXIMUM_ITERATIONS = 60  # of Newton's method


Propagators = tuple[Floats, Floats, Floats]
"""Matrices of one time step of a holder: of its state, and of the force at the start and at the end of the step."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Holder:
    """Spring, mass and damper that hold a slider along the sliding direction.

    Parameters
    ----------
    holder_stiffness : float
        Stiffness between slider and ground; infinite for a rigid holder. [N/m]
    holder_mass : float
        Mass that moves with the slider; zero for a spring alone. [kg]
    holder_damping : float
        Damping between slider and ground; requires a mass. [N s/m]

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
            raise InvalidInput(f"holder_damping requires a holder_mass, got {self.holder_damping!r} N s/m without one")
        if self.holder_mass > 0 and math.isinf(self.holder_stiffness):
            raise InvalidInput(f"holder_mass of {self.holder_mass!r} kg requires a finite holder_stiffness")


RIGID = Holder()
"""Rigid holder: infinite stiffness, without mass and damping."""


def holder_propagators(holder: Holder, step: float) -> Propagators:
    r"""Matrices of one exact time step of a holder with mass under a force linear in time.

    `transition`: Matrix of the state (y, dy/dt). `by_first, by_last`: Response of the state to the force at the start
    and at the end of the step.

    .. math:: m \ddot y + c \dot y + K y = F(t)

    by the exponential of the augmented matrix of state, force and rate of the force.
    """
    m, c, K = holder.holder_mass, holder.holder_damping, holder.holder_stiffness
    rates = np.zeros((4, 4))
    rates[:2] = np.array([[0, 1, 0, 0], [-K / m, -c / m, 1 / m, 0]])
    rates[2, 3] = 1 / step
    from scipy.linalg import expm

    propagator = expm(rates * step)
    by_last = np.ascontiguousarray(propagator[:2, 3])
    return np.ascontiguousarray(propagator[:2, :2]), propagator[:2, 2] - by_last, by_last


@kernel(**INNER)
def _force_after_slide(force: float, k: float, limit: float, slide: float, exponent: float) -> float:
    """Force after a slide at constant stiffness and limit, before the clipping to the next limit."""
    if exponent == 0.0 or slide == 0.0:
        return force + k * slide
    if limit <= 0.0:
        return 0.0
    asymptote = math.copysign(limit, slide)
    return asymptote + (force - asymptote) * math.exp(-k * abs(slide) / limit)


@kernel(cache=True, no_cfunc_wrapper=True)
def mean_force_massless_holder(k: Floats, limit: Floats, slides: Floats, steady: Floats, exponent: float) -> Floats:
    """Mean force of a bristle on a holder without mass over its steady period, for each sliding speed; shape (m,)."""
    n = k.size
    largest = 0.0
    for j in range(n):
        largest = max(largest, limit[j])
    means = np.empty(steady.size)
    for i in range(steady.size):
        force = limit[0]  # slip at the smallest load, unless the in-plane motion reverses it
        for _ in range(MAXIMUM_PERIODS):
            start, total = force, 0.0
            for j in range(n):
                following = j + 1 if j + 1 < n else 0
                mid_limit = (limit[j] + limit[following]) / 2
                force = _force_after_slide(force, (k[j] + k[following]) / 2, mid_limit, slides[j] + steady[i], exponent)
                force = min(max(force, -limit[following]), limit[following])
                total += force
            if abs(force - start) <= 1e-12 * largest:
                break
        means[i] = total / n
    return means


@kernel(cache=True, no_cfunc_wrapper=True)
def mean_force_inertial_holder(
    k: Floats,
    limit: Floats,
    slides: Floats,
    steady: Floats,
    step: float,
    exponent: float,
    propagators: Propagators,
    deflection: Floats,
) -> tuple[Floats, bool]:
    """Mean force of a bristle on a holder with mass over its steady period, for each sliding speed.

    `means` has shape (m,). `settled`: False where Newton's method on the map of one period did not converge; the mean
    is then that of the last periods of a time integration.
    """
    means = np.empty(steady.size)
    settled = True
    for i in range(steady.size):
        state = np.array([limit[0], deflection[i], 0.0])  # force, y, dy/dt
        converged = False
        for _ in range(_MAXIMUM_ITERATIONS):
            end, jacobian, mean = _period(state, k, limit, slides, steady[i], exponent, propagators)
            residual = end - state
            # the velocity of a stiff holder may be rounding error beside the sliding speed, to which it adds
            scale = np.abs(end) + np.array([limit.max(), 1e-12, 1e-3 * steady[i] / step])
            if np.all(np.abs(residual) <= 1e-10 * scale):
                means[i], converged = mean, True
                break
            state = state + np.linalg.solve(np.eye(3) - jacobian, residual)
            state[0] = min(max(state[0], -limit[0]), limit[0])
        if not converged:
            total, averaged = 0.0, MAXIMUM_PERIODS // 4
            for period in range(MAXIMUM_PERIODS):
                state, jacobian, mean = _period(state, k, limit, slides, steady[i], exponent, propagators)
                if period >= MAXIMUM_PERIODS - averaged:
                    total += mean
            means[i], settled = total / averaged, False
    return means, settled


@kernel(cache=True, no_cfunc_wrapper=True)
def _period(
    state: Floats, k: Floats, limit: Floats, slides: Floats, steady: float, exponent: float, propagators: Propagators
) -> tuple[Floats, Floats, float]:
    """State after one period, its derivative with respect to the state before, and the mean force."""
    n = k.size
    force, y, w = state
    transition, by_first, by_last = propagators
    jacobian = np.eye(3)
    total = 0.0
    for j in range(n):
        after = j + 1 if j + 1 < n else 0
        stiff, mid_limit, next_limit = (k[j] + k[after]) / 2, (limit[j] + limit[after]) / 2, limit[after]
        y_free = transition[0, 0] * y + transition[0, 1] * w + by_first[0] * force
        w_free = transition[1, 0] * y + transition[1, 1] * w + by_first[1] * force
        by_state = (
            transition[:, :1] * jacobian[1] + transition[:, 1:] * jacobian[2] + by_first.reshape(2, 1) * jacobian[0]
        )
        # part of the slide that is independent of the force at the end of the step
        slide = slides[j] + steady - (y_free - y)
        if exponent == 1.0 and mid_limit > 0:
            stiff *= max(1.0 - math.copysign(force, force * slide) / mid_limit, 0.0)
        last = (force + stiff * slide) / (1 + stiff * by_last[0])
        if abs(last) <= next_limit:
            jacobian[0] = (jacobian[0] - stiff * (by_state[0] - jacobian[1])) / (1 + stiff * by_last[0])
        else:
            last = math.copysign(next_limit, last)
            jacobian[0] = 0.0
        y, w, force = y_free + by_last[0] * last, w_free + by_last[1] * last, last
        jacobian[1] = by_state[0] + by_last[0] * jacobian[0]
        jacobian[2] = by_state[1] + by_last[1] * jacobian[0]
        total += force
    return np.array([force, y, w]), jacobian, total / n
