"""Stick-slip of a mass on a spring that is drawn over a surface whose friction at rest is above that of sliding."""

from bisect import bisect_right
from dataclasses import dataclass, field
from math import atan, expm1, pi, sqrt

import numpy as np

from sonolube.checks import Floats


@dataclass(frozen=True, kw_only=True, slots=True)
class StickSlip:
    r"""Steady stick-slip of a mass on a weakly damped spring.

    Parameters
    ----------
    excess_force : float
        Friction at rest less that of sliding, dF, in N.
    stiffness : float
        Of the spring, k, in N/m.
    mass : float
        In kg.
    damping_ratio : float
        Of the mass on the spring. []
    sliding_speed : float
        At which the spring is drawn, v. [m/s]

    Notes
    -----
    The mass sticks until the spring pulls with the friction at rest, and then swings about the friction of sliding,
    from the deviation :math:`\Delta F` at the speed of the surface. With :math:`\omega^2 = k/m`, without damping, it
    has that speed again, and sticks, after

    .. math:: t_s = \frac{2}{\omega} \Bigl(\pi - \arctan\frac{\omega\,\Delta F}{k v}\Bigr) ,

    with the force fallen by :math:`2\Delta F`, which takes :math:`2 \Delta F / (k v)` to rise again: a sawtooth at
    low speed, a sine near the natural frequency at high speed. The damping decides where it ends: one swing loses
    so much that the speed is not reached again above

    .. math:: v_c = \frac{\Delta F}{\sqrt{k m\,(e^{4\pi\zeta} - 1)}} .
    """

    excess_force: float
    stiffness: float
    mass: float
    damping_ratio: float
    sliding_speed: float

    @property
    def highest_speed(self) -> float:
        """Speed from which sliding is steady; infinite without damping. [m/s]"""
        loss = expm1(4 * pi * self.damping_ratio)
        return self.excess_force / sqrt(self.stiffness * self.mass * loss) if loss else float("inf")

    @property
    def occurs(self) -> bool:
        """Whether the mass sticks at all."""
        return self.excess_force > 0 and 0 < self.sliding_speed < self.highest_speed

    @property
    def slip_time(self) -> float:
        """Duration of a slip. [s]"""
        frequency, rate = self._frequency, self.stiffness * self.sliding_speed
        return 2 / frequency * (pi - atan(frequency * self.excess_force / rate))

    @property
    def period(self) -> float:
        """Duration of slip and stick. [s]"""
        return self.slip_time + 2 * self.excess_force / (self.stiffness * self.sliding_speed)

    @property
    def comes_in_bursts(self) -> bool:
        """Whether a disturbance of a swing may end it: above half the highest speed."""
        return self.occurs and self.sliding_speed > self.highest_speed / 2

    @property
    def fall(self) -> float:
        """Fall of the force in a slip; 0 where sliding is steady. [N]"""
        if not self.occurs:
            return 0.0
        overshoot = self.stiffness * self.sliding_speed / self._frequency
        return 2 * sqrt(self.excess_force**2 + overshoot**2)

    @property
    def _frequency(self) -> float:
        return sqrt(self.stiffness / self.mass)

    def force(self, time: Floats) -> Floats:
        """Force of the spring less its mean, which is the friction of sliding, from a slip on.

        Zero where the sliding is steady.
        """
        if not self.occurs:
            return np.zeros_like(time)
        since, slipped, rate = time % self.period, self.slip_time, self.stiffness * self.sliding_speed
        angle = self._frequency * since
        slip = self.excess_force * np.cos(angle) + rate / self._frequency * np.sin(angle)
        return np.where(since < slipped, slip, rate * (since - slipped) - self.excess_force)


@dataclass(slots=True)
class Bursts:
    """Bursts and pauses in turn, of durations that are drawn from an exponential distribution.

    Parameters
    ----------
    generator : numpy.random.Generator
    mean : float
        Of a burst and of a pause, in s; 0 for one burst without end.
    """

    generator: np.random.Generator
    mean: float
    _ends: list[float] = field(default_factory=list)

    def are_on(self, time: Floats) -> np.ndarray:
        """Whether there is a burst at times, the same whatever is asked before."""
        if self.mean == 0 or not time.size:
            return np.ones(time.shape, bool)
        self._draw_until(float(time[-1]))
        first = bisect_right(self._ends, float(time[0]))
        ended = first + np.searchsorted(self._ends[first:], time, side="right")
        return np.asarray(ended % 2 == 0)

    def share(self, first: float, last: float) -> float:
        """Share of a span with a burst. []"""
        if self.mean == 0 or last <= first:
            return 1.0
        self._draw_until(last)
        edges = np.clip([0.0, *self._ends, *([] if len(self._ends) % 2 else [last])], first, last)
        return float(np.sum(np.diff(edges)[::2])) / (last - first)

    def _draw_until(self, time: float) -> None:
        """Draw bursts and pauses beyond a time."""
        while not self._ends or self._ends[-1] <= time:
            last = self._ends[-1] if self._ends else 0.0
            self._ends.append(last + float(self.generator.exponential(self.mean)))
