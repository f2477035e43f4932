"""Sampled control loop of a first-order lag, a dead time and a PI controller: SIMC tuning and stability margins."""

from dataclasses import dataclass
from math import ceil, exp

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, require_non_negative, require_positive

_GRID = 20_000  # frequencies of the loop's response, in geometric and in linear spacing each
_ROUNDING = 1e-9  # of an interval, by which a dead time may exceed whole intervals


@dataclass(frozen=True, kw_only=True, slots=True)
class Process:
    r"""First-order lag plus dead time (FOPDT) of unit gain, under a zero-order hold.

    Parameters
    ----------
    time_constant : float
        Time constant of the lag. [s]
    dead_time : float
        Dead time of the measurement; rounded up to whole sampling intervals. [s]
    sample_interval : float
        Sampling interval of the controller. [s]

    Raises
    ------
    InvalidInput
        If a time constant or interval is not positive, or the dead time negative.

    Notes
    -----
    With the time constant :math:`\tau`, the interval :math:`T` and the dead time of :math:`d` intervals, the sampled
    process is

    .. math:: G(z) = \frac{1 - p}{z - p} z^{-d}, \qquad p = e^{-T/\tau}
    """

    time_constant: float
    dead_time: float
    sample_interval: float

    def __post_init__(self) -> None:
        require_positive(time_constant=self.time_constant, sample_interval=self.sample_interval)
        require_non_negative(dead_time=self.dead_time)

    @property
    def dead_time_samples(self) -> int:
        """Dead time in sampling intervals, rounded up."""
        return ceil(self.dead_time / self.sample_interval - _ROUNDING)

    @property
    def pole(self) -> float:
        """Pole of the sampled lag, the factor by which a deviation decays in an interval."""
        return exp(-self.sample_interval / self.time_constant)

    @property
    def effective_dead_time(self) -> float:
        """Dead time of the measurement and half an interval of the zero-order hold, in s."""
        return (self.dead_time_samples + 0.5) * self.sample_interval


@dataclass(frozen=True, kw_only=True, slots=True)
class PIGains:
    """Gains of a PI controller in the standard (ISA) form, for a process of unit gain.

    Parameters
    ----------
    proportional_gain : float
        Change of the command per error. []
    integral_time : float
        Time in which the integral part repeats the proportional part. [s]
    """

    proportional_gain: float
    integral_time: float

    def __post_init__(self) -> None:
        require_positive(proportional_gain=self.proportional_gain, integral_time=self.integral_time)


@dataclass(frozen=True, kw_only=True, slots=True)
class StabilityMargins:
    r"""Stability margins of a control loop.

    Parameters
    ----------
    gain_margin : float
        Factor by which the loop gain may rise. []
    phase_margin : float
        Additional phase lag at the gain crossover that destabilises the loop. [rad]
    delay_margin : float
        Additional dead time that destabilises the loop. [s]
    sensitivity_peak : float
        Maximum of the sensitivity function, Ms. []

    Notes
    -----
    With the open-loop response :math:`L`, the sensitivity and its maximum are

    .. math:: S = \frac{1}{1 + L}, \qquad M_s = \max_\omega |S|
    """

    gain_margin: float
    phase_margin: float
    delay_margin: float
    sensitivity_peak: float


def simc_gains(process: Process, *, closed_loop_time: float | None = None) -> PIGains:
    r"""PI gains by Skogestad's internal model control rule (SIMC), in a form that is exact for the sampled loop.

    Parameters
    ----------
    process : Process
    closed_loop_time : float, optional
        Desired closed-loop time constant; by default the effective dead time, which the rule recommends. [s]

    Returns
    -------
    PIGains

    Raises
    ------
    InvalidInput
        If the desired time constant is not positive.

    See Also
    --------
    stability_margins

    Notes
    -----
    The rule is (equations 23 and 24 of [1]_)

    .. math:: K_c = \frac{\tau}{\tau_c + \theta}, \qquad \tau_I = \min\bigl(\tau,\ 4 (\tau_c + \theta)\bigr)

    with :math:`\tau` replaced by :math:`T/(1 - e^{-T/\tau})`, so that the zero of the controller cancels the pole of
    the sampled lag at any interval :math:`T`. The loop is then

    .. math:: L(z) = \frac{T}{\tau_c + \theta} \frac{z^{-d}}{z - 1}

    References
    ----------
    .. [1] S. Skogestad, J. Process Control 13, 291 (2003). doi:10.1016/S0959-1524(02)00062-8

    Examples
    --------
    >>> from sonolube.design.control import Process, simc_gains
    >>> gains = simc_gains(Process(time_constant=2e-3, dead_time=1e-3, sample_interval=0.2e-3))
    >>> round(gains.proportional_gain, 3), round(1e3 * gains.integral_time, 3)
    (0.955, 2.102)
    """
    theta = process.effective_dead_time
    tau_c = theta if closed_loop_time is None else float(require_positive(closed_loop_time=closed_loop_time))
    tau = process.sample_interval / (1 - process.pole)
    return PIGains(proportional_gain=tau / (tau_c + theta), integral_time=min(tau, 4 * (tau_c + theta)))


def open_loop_response(process: Process, gains: PIGains, *, frequency: Floats) -> Complexes:
    r"""Frequency response of the open loop, from error to measurement.

    Parameters
    ----------
    process : Process
    gains : PIGains
    frequency : array_like, any shape
        Frequency, below half the sampling rate. [Hz]

    Returns
    -------
    ndarray of complex, shape of `frequency`

    See Also
    --------
    stability_margins

    Notes
    -----
    .. math::

        L(z) = K_c \Bigl(1 + \frac{T}{\tau_I} \frac{1}{z - 1}\Bigr) \frac{1 - p}{z - p} z^{-d}, \qquad
        z = e^{2 \pi i f T}
    """
    z = np.exp(2j * np.pi * require_positive(frequency=frequency) * process.sample_interval)
    lag = (1 - process.pole) / (z - process.pole) * z**-process.dead_time_samples
    controller = gains.proportional_gain * (1 + process.sample_interval / gains.integral_time / (z - 1))
    return np.asarray(controller * lag, dtype=np.complex128)


def stability_margins(process: Process, gains: PIGains) -> StabilityMargins:
    """Gain, phase and delay margin and sensitivity peak of a sampled loop, from its frequency response.

    Parameters
    ----------
    process : Process
    gains : PIGains

    Returns
    -------
    StabilityMargins
        For an unstable loop with a gain margin below one and a negative phase margin.

    See Also
    --------
    open_loop_response, simc_gains

    Notes
    -----
    The response extends to half the sampling rate and includes hold and dead time, so that the margins are those of
    the loop as it runs.

    Examples
    --------
    >>> from sonolube.design.control import Process, simc_gains, stability_margins
    >>> process = Process(time_constant=2e-3, dead_time=1e-3, sample_interval=0.2e-3)
    >>> margins = stability_margins(process, simc_gains(process))
    >>> round(margins.gain_margin, 2), round(margins.sensitivity_peak, 2)
    (3.13, 1.59)
    """
    nyquist = 0.5 / process.sample_interval
    lowest = 1e-4 / (process.time_constant + process.effective_dead_time + gains.integral_time)
    f = np.unique(np.append(np.geomspace(min(lowest, 1e-4 * nyquist), nyquist, _GRID), np.linspace(0, nyquist, _GRID)))
    f = f[(f > 0) & (f <= nyquist)]
    response = open_loop_response(process, gains, frequency=f)
    log_gain, phase = np.log(np.abs(response)), np.unwrap(np.angle(response))
    # without dead time the phase reaches -pi only at the Nyquist frequency
    phase_crossover_gain = max(_at_downward_crossings(phase + np.pi, log_gain), default=log_gain[-1])
    crossover_phase = _at_downward_crossings(log_gain, phase)
    crossover_frequency = _at_downward_crossings(log_gain, f)
    # a gain above one at all frequencies leaves the margin at the Nyquist frequency
    phase_margin, crossover = (
        (np.pi + crossover_phase[0], crossover_frequency[0]) if crossover_phase.size else (np.pi + phase[-1], f[-1])
    )
    return StabilityMargins(
        gain_margin=float(np.exp(-phase_crossover_gain)),
        phase_margin=float(phase_margin),
        delay_margin=float(phase_margin / (2 * np.pi * crossover)),
        sensitivity_peak=float(np.max(1 / np.abs(1 + response))),
    )


def _at_downward_crossings(values: Floats, ordinate: Floats) -> NDArray[np.float64]:
    """Ordinate where values cross zero downwards, by linear interpolation."""
    i = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
    fraction = values[i] / (values[i] - values[i + 1])
    return np.asarray(ordinate[i] + fraction * (ordinate[i + 1] - ordinate[i]))
