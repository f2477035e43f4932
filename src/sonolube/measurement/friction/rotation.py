"""Turns of a disc from the pulses that magnets at its rim give a Hall probe."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator
from scipy.signal import find_peaks

from sonolube.checks import Floats, require_finite, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.measurement.statistics.autocorrelation import correlated_mean
from sonolube.measurement.time_series import require_time_series
from sonolube.metrics import linear_speed

_FIT = 0.25  # by which an interval may miss a multiple of its neighbours and still mean lost pulses
_MOST_LOST = 5  # pulses in a row


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DiscRotation:
    """The turning of a disc, turn by turn.

    Parameters
    ----------
    time : ndarray, shape (pulses,)
        When each pulse peaks. [s]
    revolutions : ndarray, shape (pulses,)
        Turns since the first pulse. []
    interpolated : ndarray of bool, shape (pulses,)
        Which pulses were missing and put where the others say.
    rotation_speed : ndarray, shape (turns,)
        Turns per time, from each pulse to the next of the same magnet. [1/s]
    sliding_speed : ndarray, shape (turns,)
        Speed at the groove. [m/s]
    mean_rotation_speed : float
        Turns over time from first to last pulse, in 1/s.
    rotation_speed_uncertainty : float
        Standard error of the mean over the turns; 0 for a single one. [1/s]
    """

    time: Floats
    revolutions: Floats
    interpolated: NDArray[np.bool_]
    rotation_speed: Floats
    sliding_speed: Floats
    mean_rotation_speed: float
    rotation_speed_uncertainty: float


def hall_pulse_times(*, time: ArrayLike, magnetic_flux_density: ArrayLike, prominence: float = 0.25) -> Floats:
    """Return when the pulses of a Hall probe peak. [s]

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    magnetic_flux_density : array_like, shape (samples,)
        Reading of the probe, of either sign; any unit serves. [T]
    prominence : float
        Height of the weakest pulse that counts, as a share of the strongest: lower it for unequal magnets.

    Returns
    -------
    ndarray, shape (pulses,)
        Between samples, by a parabola through the highest three.

    Raises
    ------
    InvalidInput
        If the reading does not vary, or no pulse stands out.
    """
    require_within(0.01, 1.0, prominence=prominence)
    t, b = require_time_series(time=time, magnetic_flux_density=magnetic_flux_density)
    known = np.isfinite(b)
    t, b = t[known], b[known] - np.median(b[known])
    b = b if b.max() >= -b.min() else -b  # the field of a magnet turned round peaks downwards
    if b.max() <= 0:
        raise InvalidInput("magnetic_flux_density does not vary")
    peaks = find_peaks(b, prominence=prominence * float(b.max()), plateau_size=1)[0]
    if not peaks.size:
        raise InvalidInput("magnetic_flux_density shows no pulse")
    return _refined(t, b, peaks)


def _refined(t: Floats, b: Floats, peaks: NDArray[np.int64]) -> Floats:
    before, at, after = b[peaks - 1], b[peaks], b[peaks + 1]
    left, right = t[peaks] - t[peaks - 1], t[peaks + 1] - t[peaks]
    rise, fall = (at - before) / left, (at - after) / right
    shift = 0.5 * (rise * right - fall * left) / np.where(rise + fall > 0, rise + fall, np.inf)
    return np.asarray(t[peaks] + shift)


def disc_rotation(*, time: ArrayLike, groove_diameter: float, magnets: int = 1) -> DiscRotation:
    """Return the turning of a disc from the times of its pulses.

    Parameters
    ----------
    time : array_like, shape (pulses,)
        When the pulses peak, as `hall_pulse_times` gives them. [s]
    groove_diameter : float
        Diameter of the circle under the pin. [m]
    magnets : int
        Magnets at the rim; they need be equal neither in strength nor in spacing.

    Returns
    -------
    Rotation

    Raises
    ------
    InvalidInput
        If the times do not increase, there are fewer pulses than a turn needs, or `magnets` is not positive.

    Notes
    -----
    With one magnet, an interval that is a whole multiple of both its neighbours, within 25 %, has lost pulses: a
    change of speed differs from one neighbour only. With several, the shares of a turn between them are learned where
    two turns look most alike, and an interval that matches the sum of several shares has lost those between. Each turn
    is timed from a magnet to the same magnet, so unequal spacing does not matter.

    References
    ----------
    .. [1] D 4.1.1 and appendix A 2.1.8.
    """
    t = require_finite(time=time)
    require_positive(groove_diameter=groove_diameter)
    if magnets < 1:
        raise InvalidInput(f"magnets must be positive, got {magnets}")
    if t.ndim != 1 or t.size < magnets + 1:
        raise InvalidInput(f"a turn needs {magnets + 1} pulses, got {t.size}")
    if np.any(np.diff(t) <= 0):
        raise InvalidInput("time of the pulses must increase")
    shares, steps = (np.ones(1), _single_steps(t)) if magnets == 1 else _pattern(t, magnets)
    times, interpolated = _repaired(t, steps, shares)
    position = np.concatenate([[0.0], np.cumsum(np.resize(shares, times.size - 1))])
    speed = 1 / (times[magnets:] - times[:-magnets])
    return DiscRotation(
        time=times,
        revolutions=position,
        interpolated=interpolated,
        rotation_speed=speed,
        sliding_speed=linear_speed(rotation_speed=speed, groove_diameter=groove_diameter),
        mean_rotation_speed=float(position[-1] / (times[-1] - times[0])),
        rotation_speed_uncertainty=correlated_mean(speed).uncertainty if speed.size > 1 else 0.0,
    )


def _single_steps(t: Floats) -> NDArray[np.int64]:
    """How many turns lie between neighbouring pulses of one magnet."""
    interval = np.diff(t)
    if interval.size < 2:
        return np.ones(interval.size, dtype=np.int64)
    before = np.concatenate([interval[1:2], interval[:-1]])
    after = np.concatenate([interval[1:], interval[-2:-1]])
    multiple = np.round(interval / np.maximum(before, after)).astype(np.int64)
    fits = [np.abs(interval / other - multiple) <= _FIT * multiple for other in (before, after)]
    lost = fits[0] & fits[1] & (multiple > 1) & (multiple <= _MOST_LOST + 1)
    return np.where(lost, multiple, 1)


def _pattern(t: Floats, magnets: int) -> tuple[Floats, NDArray[np.int64]]:
    """Shares of a turn from the first pulse's magnet on, and how many magnets lie between neighbouring pulses."""
    interval = np.diff(t)
    first = 0
    turn = interval[:magnets]
    if interval.size >= 2 * magnets:  # learn where two turns look most alike
        turns = np.lib.stride_tricks.sliding_window_view(interval, magnets)
        now, then = turns[:-magnets], turns[magnets:]
        first = int(np.argmin(np.max(np.abs(now - then) / (now + then), axis=1)))
        turn = (now[first] + then[first]) / 2
    duration = float(turn.sum())
    shares = turn / duration
    back = _follow(interval[:first][::-1], shares[::-1], duration)[::-1]
    steps = np.concatenate([back, _follow(interval[first:], shares, duration)])
    return np.roll(shares, int(back.sum()) % magnets), steps


def _follow(interval: Floats, shares: Floats, duration: float) -> NDArray[np.int64]:
    """How many magnets each interval passes, the turn lasting about as long as it did at the one before."""
    steps = np.ones(interval.size, dtype=np.int64)
    magnet = 0
    for i, dt in enumerate(interval):
        passed = np.cumsum(np.resize(np.roll(shares, -magnet), _MOST_LOST + 1))
        steps[i] = int(np.argmin(np.abs(np.log(dt / duration / passed)))) + 1
        duration = float(dt / passed[steps[i] - 1])
        magnet = (magnet + int(steps[i])) % shares.size
    return steps


def _repaired(t: Floats, steps: NDArray[np.int64], shares: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    index = np.concatenate([[0], np.cumsum(steps)])
    every = np.arange(index[-1] + 1)
    position = np.concatenate([[0.0], np.cumsum(np.resize(shares, every.size - 1))])
    return np.asarray(np.interp(position, position[index], t)), ~np.isin(every, index)


def revolutions_at(turning: DiscRotation, *, time: ArrayLike) -> Floats:
    """Return the turns made since the first pulse, between pulses by a monotone cubic. []

    Parameters
    ----------
    turning : Rotation
    time : array_like, any shape
        When; before the first and after the last pulse at the speed of the nearest turn. [s]

    Returns
    -------
    ndarray, shape of `time`
    """
    t = require_finite(time=time)
    known_time, known = turning.time, turning.revolutions
    within = PchipInterpolator(known_time, known)(np.clip(t, known_time[0], known_time[-1]))
    early = known[0] + (t - known_time[0]) * turning.rotation_speed[0]
    late = known[-1] + (t - known_time[-1]) * turning.rotation_speed[-1]
    return np.asarray(np.where(t < known_time[0], early, np.where(t > known_time[-1], late, within)))
