"""Signals of a virtual test over time: closed forms, recursions from block to block, stick-slip and arm resonance."""

from bisect import bisect_right
from dataclasses import dataclass, field
from math import atan, expm1, pi, sqrt

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics import Structure

_PULL_LOOPS = 5
_PULL_PERIOD = 30.0  # s
_HALL_WIDTH = 0.06  # of the distance of two magnets, standard deviation of a pulse


@dataclass(frozen=True, slots=True)
class Approach:
    """Exponential approach of a value to its target, from a time on.

    Parameters
    ----------
    start : float
        Time, in s.
    value : float
        At that time.
    target : float
        Reached in the end.
    time_constant : float
        [s]
    """

    start: float
    value: float
    target: float
    time_constant: float

    def at(self, time: Floats) -> Floats:
        """Value at times at or after the start."""
        return np.asarray(self.target + (self.value - self.target) * np.exp(-(time - self.start) / self.time_constant))

    def integral(self, time: Floats) -> Floats:
        """Integral of the value from the start to times after it."""
        since = time - self.start
        left = -np.expm1(-since / self.time_constant)
        return np.asarray(self.target * since + (self.value - self.target) * self.time_constant * left)

    def towards(self, target: float, *, time: float) -> "Approach":
        """Approach to another target from a time on."""
        return Approach(time, float(self.at(np.asarray(time))), target, self.time_constant)


@dataclass(frozen=True, slots=True)
class Lagged:
    """Reading of a first-order sensor of a value that approaches its target.

    Parameters
    ----------
    source : Approach
        The value.
    reading : float
        At the start of `source`.
    time_constant : float
        Of the sensor, other than that of `source`. [s]
    """

    source: Approach
    reading: float
    time_constant: float

    def at(self, time: Floats) -> Floats:
        """Reading at times at or after the start."""
        source = self.source
        since = time - source.start
        carried = source.time_constant / (source.time_constant - self.time_constant) * (source.value - source.target)
        left = self.reading - source.target - carried
        return np.asarray(
            source.target + carried * np.exp(-since / source.time_constant) + left * np.exp(-since / self.time_constant)
        )

    def towards(self, target: float, *, time: float) -> "Lagged":
        """Reading of the value that approaches another target from a time on."""
        reading = float(self.at(np.asarray(time)))
        return Lagged(self.source.towards(target, time=time), reading, self.time_constant)


def hall_pulses(*, revolutions: Floats, magnets: int) -> Floats:
    """Signal of a Hall probe by magnets at the rim of a disc, of height 1."""
    from_centre = (revolutions * magnets) % 1.0 - 0.5
    return np.asarray(np.exp(-0.5 * (from_centre / _HALL_WIDTH) ** 2))


def pulled(*, since: Floats, greatest: float) -> Floats:
    """Force with which an operator pulls at the pin: five loops of 30 s, each further than the one before."""
    loop, within = np.divmod(since / _PULL_PERIOD, 1.0)
    share = np.where(loop < _PULL_LOOPS, (loop + 1) / _PULL_LOOPS, 0.0)
    return np.asarray(greatest * share * (1 - np.abs(2 * within - 1)))


@dataclass(slots=True)
class ColouredNoise:
    """Noise of unit variance by a recursion over white noise, which goes on from block to block.

    Parameters
    ----------
    generator : numpy.random.Generator
    feedback : tuple of float
        Coefficients a_1, a_2 of x_n = a_1 x_(n-1) + a_2 x_(n-2) + w_n.
    """

    generator: np.random.Generator
    feedback: tuple[float, float] = (0.0, 0.0)
    _state: Floats = field(default_factory=lambda: np.zeros(2))

    def next(self, samples: int) -> Floats:
        """Next samples."""
        from scipy.signal import lfilter

        white = self.generator.standard_normal(samples)
        first, second = self.feedback
        if (first, second) == (0.0, 0.0):
            return white
        variance = (1 - second) / ((1 + second) * ((1 - second) ** 2 - first**2))
        found, self._state = lfilter([1 / np.sqrt(variance)], [1.0, -first, -second], white, zi=self._state)
        return np.asarray(found)


def correlated(*, time_constant: float, sample_rate: float) -> tuple[float, float]:
    """Feedback of noise whose correlation falls exponentially."""
    return float(np.exp(-1 / (time_constant * sample_rate))), 0.0


def resonant(*, frequency: float, damping_ratio: float, sample_rate: float) -> tuple[float, float]:
    """Feedback of noise at the natural frequency of a damped oscillator; white where it is not resolved."""
    if frequency > 0.4 * sample_rate:
        return 0.0, 0.0
    angle = 2 * np.pi * frequency / sample_rate
    decay = np.exp(-damping_ratio * angle)
    return float(2 * decay * np.cos(angle * np.sqrt(1 - damping_ratio**2))), float(-(decay**2))


@kernel(cache=True)
def play(values: Floats, half_width: float, state: float) -> Floats:
    """Backlash: the output stays until the input has gone half its width away; from a state on."""
    found = np.empty(values.size)
    for index in range(values.size):
        state = min(max(state, values[index] - half_width), values[index] + half_width)
        found[index] = state
    return found


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
