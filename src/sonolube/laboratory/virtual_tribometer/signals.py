"""Signals of a virtual test over time, closed forms and recursions that go on from block to block."""

from dataclasses import dataclass, field

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel

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
