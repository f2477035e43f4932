"""A sampled loop of a lag, a delay and a PI controller: its tuning and its margins."""

from dataclasses import dataclass
from math import ceil, exp

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, require_non_negative, require_positive

_GRID = 20_000  # frequencies at which a loop is looked at, crowded towards zero
_ROUNDING = 1e-9  # of an interval, by which a delay may exceed whole intervals


@dataclass(frozen=True, kw_only=True, slots=True)
class Process:
    """What a controller acts on: a first-order lag of gain one, held over each interval and measured late.

    Parameters
    ----------
    time_constant : float
        Time in which the lag covers 63 % of a step. [s]
    dead_time : float
        Delay of the measurement; taken up to whole intervals. [s]
    sample_interval : float
        Time between decisions of the controller. [s]

    Raises
    ------
    InvalidInput
        If a time constant or interval is not positive, or the delay negative.
    """

    time_constant: float
    dead_time: float
    sample_interval: float

    def __post_init__(self) -> None:
        require_positive(time_constant=self.time_constant, sample_interval=self.sample_interval)
        require_non_negative(dead_time=self.dead_time)

    @property
    def delayed_samples(self) -> int:
        """Whole intervals by which the measurement is late."""
        return ceil(self.dead_time / self.sample_interval - _ROUNDING)

    @property
    def decay(self) -> float:
        """What one interval leaves of a deviation."""
        return exp(-self.sample_interval / self.time_constant)

    @property
    def effective_dead_time(self) -> float:
        """Delay of the measurement and of the hold, half an interval, in s."""
        return (self.delayed_samples + 0.5) * self.sample_interval


@dataclass(frozen=True, kw_only=True, slots=True)
class PIGains:
    """A PI controller of a process of gain one.

    Parameters
    ----------
    proportional_gain : float
        Change of the command per error. []
    integral_time : float
        Time in which the integral repeats the proportional part. [s]
    """

    proportional_gain: float
    integral_time: float

    def __post_init__(self) -> None:
        require_positive(proportional_gain=self.proportional_gain, integral_time=self.integral_time)


@dataclass(frozen=True, kw_only=True, slots=True)
class Margins:
    """How far a loop is from instability.

    Parameters
    ----------
    gain_margin : float
        Factor by which the gain may rise. []
    phase_margin : float
        Lag that may come where the loop gain is one. [rad]
    delay_margin : float
        Delay that may come. [s]
    sensitivity_peak : float
        Largest amplification of a disturbance at any frequency, Ms. []
    """

    gain_margin: float
    phase_margin: float
    delay_margin: float
    sensitivity_peak: float


def simc_gains(process: Process, *, closed_loop_time: float | None = None) -> PIGains:
    """Return gains by Skogestad's rule, in the form that is exact for a sampled loop.

    Parameters
    ----------
    process : Process
    closed_loop_time : float, optional
        Time constant wanted of the closed loop; the effective delay where absent, the rule's own advice. [s]

    Returns
    -------
    PIGains

    Raises
    ------
    InvalidInput
        If the time wanted is not positive.

    Notes
    -----
    The rule is K_c = tau/(tau_c + theta), tau_I = min(tau, 4 (tau_c + theta)). Here T/(1 - exp(-T/tau)) stands for tau,
    so that the controller's zero cancels the pole of the held lag at any interval T; the loop is then
    T/(tau_c + theta) z^-d/(z - 1).

    References
    ----------
    .. [1] S. Skogestad, J. Process Control 13, 291 (2003). doi:10.1016/S0959-1524(02)00062-8
    """
    theta = process.effective_dead_time
    wanted = theta if closed_loop_time is None else float(require_positive(closed_loop_time=closed_loop_time))
    tau = process.sample_interval / (1 - process.decay)
    return PIGains(proportional_gain=tau / (wanted + theta), integral_time=min(tau, 4 * (wanted + theta)))


def loop_response(process: Process, gains: PIGains, *, frequency: Floats) -> Complexes:
    """Return the gain around the loop, from error to measurement, complex.

    Parameters
    ----------
    process : Process
    gains : PIGains
    frequency : array_like, any shape
        Frequency of the error, below half the sample rate. [Hz]

    Returns
    -------
    ndarray, shape of `frequency`
    """
    z = np.exp(2j * np.pi * require_positive(frequency=frequency) * process.sample_interval)
    lag = (1 - process.decay) / (z - process.decay) * z**-process.delayed_samples
    controller = gains.proportional_gain * (1 + process.sample_interval / gains.integral_time / (z - 1))
    return np.asarray(controller * lag, dtype=np.complex128)


def loop_margins(process: Process, gains: PIGains) -> Margins:
    """Return the margins of a sampled loop.

    Parameters
    ----------
    process : Process
    gains : PIGains

    Returns
    -------
    Margins
        Of an unstable loop, a gain margin below one and a negative phase margin.

    Notes
    -----
    From the frequency response to half the sample rate, which is that of the loop as it runs: hold and delay included.
    """
    nyquist = 0.5 / process.sample_interval
    slowest = 1e-4 / (process.time_constant + process.effective_dead_time + gains.integral_time)
    f = np.unique(np.append(np.geomspace(min(slowest, 1e-4 * nyquist), nyquist, _GRID), np.linspace(0, nyquist, _GRID)))
    f = f[(f > 0) & (f <= nyquist)]
    gain = loop_response(process, gains, frequency=f)
    log_gain, phase = np.log(np.abs(gain)), np.unwrap(np.angle(gain))
    # a loop without delay reaches -pi only where the frequencies end
    reversed_gain = max(_crossings(phase + np.pi, log_gain), default=log_gain[-1])
    at_one, where = _crossings(log_gain, phase), _crossings(log_gain, f)
    # gain above one at all frequencies leaves no margin at the last
    phase_margin, crossover = (np.pi + at_one[0], where[0]) if at_one.size else (np.pi + phase[-1], f[-1])
    return Margins(
        gain_margin=float(np.exp(-reversed_gain)),
        phase_margin=float(phase_margin),
        delay_margin=float(phase_margin / (2 * np.pi * crossover)),
        sensitivity_peak=float(np.max(1 / np.abs(1 + gain))),
    )


def _crossings(values: Floats, of: Floats) -> NDArray[np.float64]:
    """Return `of` where `values` falls through zero, by straight lines between points."""
    i = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
    share = values[i] / (values[i] - values[i + 1])
    return np.asarray(of[i] + share * (of[i + 1] - of[i]))
