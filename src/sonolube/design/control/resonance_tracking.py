"""Drive of the vibration: resonance tracking by a phase-locked loop, and the limits of the amplifier."""

from dataclasses import asdict, dataclass
from math import inf, pi

from sonolube.checks import require_positive, require_within
from sonolube.design.control.vibration_envelope import VibrationMode, capture_limit, impedance_phase

_STEP = 1e-6  # relative, of the finite difference of the phase
_TIME_CONSTANTS = 20.0  # of the vibration, the default closed-loop time constant
_MIN_INTERVALS = 10.0  # of that time constant


@dataclass(frozen=True, kw_only=True, slots=True)
class FrequencyTracker:
    """Integrating controller of the impedance phase by the drive frequency, within a frequency band.

    Parameters
    ----------
    phase : float
        Set-point of the impedance phase, positive where the voltage leads the current. [rad]
    frequency : float
        Initial frequency. [Hz]
    frequency_gain : float
        Change of frequency per interval and phase error, in Hz per radian.
    lowest_frequency, highest_frequency : float
        Ends of the frequency band. [Hz]
    """

    phase: float
    frequency: float
    frequency_gain: float
    lowest_frequency: float
    highest_frequency: float


def tuned_tracker(
    mode: VibrationMode, *, sample_interval: float, closed_loop_time: float | None = None, band: float = 0.05
) -> FrequencyTracker:
    r"""Frequency tracker that holds the phase of the nominal drive frequency, by lambda tuning.

    Parameters
    ----------
    mode : VibrationMode
    sample_interval : float
        Sampling interval. [s]
    closed_loop_time : float, optional
        Desired closed-loop time constant; by default 20 time constants of the vibration and at least 10 intervals, so
        that the phase settles between changes. [s]
    band : float
        Relative half-width of the frequency band.

    Returns
    -------
    FrequencyTracker
        Its band ends at the capture limit, where that is lower.

    Raises
    ------
    InvalidInput
        If the phase decreases with frequency at the nominal one, or the band does not lie between 0 and 1.

    See Also
    --------
    capture_limit, next_frequency

    Notes
    -----
    For an integrating controller with the slope of the phase :math:`\partial\varphi/\partial f`, the closed loop has
    the time constant :math:`\tau_c` with the gain

    .. math:: k_f = \frac{T}{\tau_c} \Bigl(\frac{\partial \varphi}{\partial f}\Bigr)^{-1}
    """
    interval = float(require_positive(sample_interval=sample_interval))
    if closed_loop_time is None:
        closed_loop_time = max(_TIME_CONSTANTS * mode.time_constant, _MIN_INTERVALS * interval)
    tau_c = float(require_positive(closed_loop_time=closed_loop_time))
    half_width, f = float(require_within(0.0, 1.0, band=band)), mode.frequency
    upper_limit = capture_limit(mode)
    above, below = (impedance_phase(mode, frequency=f * (1 + step)) for step in (_STEP, -_STEP))
    return FrequencyTracker(
        phase=impedance_phase(mode, frequency=f),
        frequency=f,
        frequency_gain=interval / tau_c * 2 * _STEP * f / (above - below),
        lowest_frequency=f * (1 - half_width),
        highest_frequency=min(f * (1 + half_width), upper_limit),
    )


def next_frequency(tracker: FrequencyTracker, *, frequency: float, phase: float) -> float:
    r"""Drive frequency of the next interval. [Hz]

    Parameters
    ----------
    tracker : FrequencyTracker
    frequency : float
        Drive frequency of the last interval. [Hz]
    phase : float
        Measured phase of the impedance, positive where the voltage leads the current. [rad]

    Returns
    -------
    float

    Notes
    -----
    .. math:: f \leftarrow \operatorname{clip}\bigl(f + k_f (\varphi_0 - \varphi),\ f_{low},\ f_{high}\bigr)
    """
    unlimited = frequency + tracker.frequency_gain * (tracker.phase - phase)
    return min(max(unlimited, tracker.lowest_frequency), tracker.highest_frequency)


@dataclass(frozen=True, kw_only=True, slots=True)
class Amplifier:
    """Limits of an amplifier that drives a stack with a sine.

    Parameters
    ----------
    voltage_maximum : float
        Largest peak-to-peak voltage (swing). [V]
    current_maximum : float
        Largest absolute current; infinite for no limit. [A]
    slew_rate_maximum : float
        Slew rate; infinite for no limit. [V/s]

    Raises
    ------
    InvalidInput
        If a limit is not positive, or the voltage not finite.
    """

    voltage_maximum: float
    current_maximum: float = inf
    slew_rate_maximum: float = inf

    def __post_init__(self) -> None:
        limits = {name: limit for name, limit in asdict(self).items() if name == "voltage_maximum" or limit != inf}
        require_positive(**limits)


def swing_limit(amplifier: Amplifier, *, admittance: complex, frequency: float) -> float:
    r"""Largest peak-to-peak voltage of a sine within the limits of an amplifier. [V]

    Parameters
    ----------
    amplifier : Amplifier
    admittance : complex
        Admittance of the load. [S]
    frequency : float
        Frequency of the sine. [Hz]

    Returns
    -------
    float

    See Also
    --------
    active_limit

    Notes
    -----
    A sine of the peak-to-peak voltage :math:`U` has the current amplitude :math:`|Y| U/2` and the largest slope
    :math:`\pi f U`, so that

    .. math:: U \le \min\Bigl(U_{max},\ \frac{2 I_{max}}{|Y|},\ \frac{S_{max}}{\pi f}\Bigr)
    """
    require_positive(frequency=frequency)
    by_current = 2 * amplifier.current_maximum / abs(admittance) if admittance else inf
    return min(amplifier.voltage_maximum, by_current, amplifier.slew_rate_maximum / (pi * frequency))


def active_limit(amplifier: Amplifier, *, admittance: complex, frequency: float) -> str:
    """Name of the limit that determines `swing_limit`: "voltage", "current" or "slew rate".

    Parameters
    ----------
    amplifier : Amplifier
    admittance : complex
        Admittance of the load. [S]
    frequency : float
        Frequency of the sine. [Hz]

    Returns
    -------
    str

    See Also
    --------
    swing_limit
    """
    swing = swing_limit(amplifier, admittance=admittance, frequency=frequency)
    if swing == amplifier.voltage_maximum:
        return "voltage"
    return "slew rate" if swing == amplifier.slew_rate_maximum / (pi * frequency) else "current"
