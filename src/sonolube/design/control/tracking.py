"""Resonance tracking: a loop that holds the phase of the impedance by the drive's frequency."""

from dataclasses import dataclass

from sonolube.checks import require_positive, require_within
from sonolube.design.control.vibration import VibrationMode, capture_edge, impedance_phase

_STEP = 1e-6  # of the frequency, over which the phase's slope is taken
_UNHURRIED = 20.0  # times the vibration's time constant that a tracker takes unless asked otherwise
_INTERVALS = 10.0  # and the fewest intervals


@dataclass(frozen=True, kw_only=True, slots=True)
class FrequencyTracker:
    """A phase-locked loop: the frequency goes up while the impedance's phase is below the wanted one.

    Parameters
    ----------
    phase : float
        Phase of the impedance wanted, voltage ahead of current. [rad]
    frequency : float
        Frequency to start from. [Hz]
    frequency_gain : float
        Change of frequency an interval per error of phase, in Hz per radian.
    lowest_frequency, highest_frequency : float
        Ends of the band it keeps to. [Hz]
    """

    phase: float
    frequency: float
    frequency_gain: float
    lowest_frequency: float
    highest_frequency: float


def designed_tracker(
    mode: VibrationMode, *, sample_interval: float, closed_loop_time: float | None = None, band: float = 0.05
) -> FrequencyTracker:
    """Return the tracker that holds the phase which a drive has at the frequency it is meant to run at.

    Parameters
    ----------
    mode : VibrationMode
    sample_interval : float
        Time between its steps. [s]
    closed_loop_time : float, optional
        Time constant with which it closes on the resonance; where absent 20 of the vibration's, and 10 intervals at
        least, so that the phase has settled when it is looked at. [s]
    band : float
        Share of its frequency by which it may leave it either way.

    Returns
    -------
    FrequencyTracker

    Raises
    ------
    InvalidInput
        If the phase falls with frequency there, or the band does not lie between 0 and 1.

    Notes
    -----
    Lambda tuning of an integrating controller: the phase's slope at the frequency meant times the gain is the interval
    over the closed loop's time. The band ends where the phase would lead astray.
    """
    interval = float(require_positive(sample_interval=sample_interval))
    if closed_loop_time is None:
        closed_loop_time = max(_UNHURRIED * mode.time_constant, _INTERVALS * interval)
    wanted_time = float(require_positive(closed_loop_time=closed_loop_time))
    share, f = float(require_within(0.0, 1.0, band=band)), mode.frequency
    edge = capture_edge(mode)
    above, below = (impedance_phase(mode, frequency=f * (1 + step)) for step in (_STEP, -_STEP))
    return FrequencyTracker(
        phase=impedance_phase(mode, frequency=f),
        frequency=f,
        frequency_gain=interval / wanted_time * 2 * _STEP * f / (above - below),
        lowest_frequency=f * (1 - share),
        highest_frequency=min(f * (1 + share), edge),
    )


def next_frequency(tracker: FrequencyTracker, *, frequency: float, phase: float) -> float:
    """Return the frequency of the next interval. [Hz]

    Parameters
    ----------
    tracker : FrequencyTracker
    frequency : float
        Frequency of the last. [Hz]
    phase : float
        Phase of the impedance as sensed, voltage ahead of current. [rad]
    """
    moved = frequency + tracker.frequency_gain * (tracker.phase - phase)
    return min(max(moved, tracker.lowest_frequency), tracker.highest_frequency)
