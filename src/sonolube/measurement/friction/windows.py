"""Mean, standard deviation and fluctuation of a signal in consecutive windows, and the onset of steady-state friction.

Windows are of arrays or of streamed files; the onset after running-in is told by the friction of consecutive windows.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import recording_blocks
from sonolube.measurement.statistics.autocorrelation import correlated_mean, statistical_inefficiency
from sonolube.measurement.time_series import require_time_series

DEFAULT_WINDOW_DURATION = 2.0
"""Duration of a window of D 2.3.2, in seconds."""

Signals = dict[str, Floats]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WindowStatistics:
    """Statistics of a signal in consecutive windows.

    Parameters
    ----------
    time : ndarray, shape (windows,)
        Middle of each window. [s]
    mean : ndarray, shape (windows,)
        Mean in each window, in `unit`; NaN where it holds no value. The next two likewise.
    deviation : ndarray, shape (windows,)
        Standard deviation of the samples; NaN where there are fewer than two.
    fluctuation : ndarray, shape (windows,)
        Root mean square of the deviation from the window's mean.
    samples : ndarray of int, shape (windows,)
        Number of samples that are not missing.
    window_duration : float
        Duration of each window. [s]
    channel : str
        Name of the signal.
    unit : str
        Unit of the signal.
    """

    time: Floats
    mean: Floats
    deviation: Floats
    fluctuation: Floats
    samples: NDArray[np.int64]
    window_duration: float
    channel: str
    unit: str


def window_statistics(
    signal: ArrayLike,
    *,
    time: ArrayLike,
    window_duration: float = DEFAULT_WINDOW_DURATION,
    channel: str = "",
    unit: str = "",
) -> WindowStatistics:
    r"""Mean, standard deviation and fluctuation in consecutive windows, the last of which may be shorter.

    Parameters
    ----------
    signal : array_like, shape (samples,)
        In any unit; NaN is left out.
    time : array_like, shape (samples,)
        Increasing; gaps are allowed, and windows without a sample left out. [s]
    window_duration : float
        Duration of each window. [s]
    channel : str
        Name of the signal, for the record.
    unit : str
        Unit of the signal, for the record.

    Returns
    -------
    WindowStatistics

    Raises
    ------
    InvalidInput
        If the time does not increase, the signal has another length or no value, or the window is not positive.

    See Also
    --------
    streamed_window_statistics : the same of a file that exceeds the memory.

    Notes
    -----
    For the n samples of a window,

    .. math::

        \bar x = \frac1n \sum x_i , \qquad
        s^2 = \frac{1}{n - 1} \sum (x_i - \bar x)^2 , \qquad
        x_\mathrm{rms}^2 = \frac1n \sum (x_i - \bar x)^2 .

    References
    ----------
    .. [1] D 2.3.2 and 2.3.3: windows of 2 s at 400 Hz; their RMS is that of the variation, not of the force.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.measurement import window_statistics
    >>> time = np.arange(0, 10, 0.01)
    >>> found = window_statistics(np.where(time < 5, 1.0, 0.4), time=time, window_duration=5.0)
    >>> found.mean.round(3).tolist()
    [1.0, 0.4]
    """
    require_positive(window_duration=window_duration)
    t, x = require_time_series(time=time, **{channel or "signal": signal})
    return _statistics([_moments(x, t, t[0], window_duration)], channel, unit, t[0], window_duration)


def streamed_window_statistics(
    path: Path,
    *,
    channels: Sequence[str] | None = None,
    mapping: RecordingMapping | Path | None = None,
    window_duration: float = DEFAULT_WINDOW_DURATION,
    block_samples: int = 1 << 18,
) -> Mapping[str, WindowStatistics]:
    """Window statistics of a file's channels, read in blocks without holding the file in memory.

    Parameters
    ----------
    path : Path
        A recording; only TDMS is streamed, other formats are read whole.
    channels : sequence of str or None
        Names of the channels; without it all of them.
    mapping : RecordingMapping, Path or None
        Assignment of the columns.
    window_duration : float
        Duration of each window. [s]
    block_samples : int
        Samples read at a time.

    Returns
    -------
    mapping of str to WindowStatistics
        Equal to `window_statistics` of the whole recording.

    Raises
    ------
    InvalidInput
        As `recording_blocks`, or if the recording lacks a channel.
    """
    require_positive(window_duration=window_duration)
    parts: dict[str, list[Floats]] = {}
    units: dict[str, str] = {}
    origin = None
    for t, signals, units_of_block in _complete_windows(path, channels, mapping, window_duration, block_samples):
        origin = t[0] if origin is None else origin
        units = units_of_block
        for name, x in signals.items():
            parts.setdefault(name, []).append(_moments(x, t, origin, window_duration))
    if origin is None:
        raise InvalidInput(f"{path}: holds no samples")
    for name, moments in parts.items():
        if not any(part[1].any() for part in moments):
            raise InvalidInput(f"{path}: channel {name!r} holds no value")
    return {name: _statistics(own, name, units[name], origin, window_duration) for name, own in parts.items()}


def _complete_windows(
    path: Path, channels: Sequence[str] | None, mapping: RecordingMapping | Path | None, window: float, size: int
) -> Iterator[tuple[Floats, Signals, dict[str, str]]]:
    """Yield time, signals and units in parts that hold whole windows; the samples of a cut window are carried over."""
    carried_time, carried, origin = np.empty(0), Signals(), None
    units: dict[str, str] = {}
    for block in recording_blocks(path, mapping=mapping, block_samples=size):
        names = list(channels) if channels is not None else [str(name) for name in block]
        for name in names:
            if name not in block:
                raise InvalidInput(f"{path}: has no channel {name!r}; it has {', '.join(map(str, block))}")
        units = {name: str(block[name].attrs["units"]) for name in names}
        t = np.concatenate([carried_time, block["time"].to_numpy()])
        signals = {
            name: np.concatenate([carried[name], block[name].to_numpy()]) if carried else block[name].to_numpy()
            for name in names
        }
        origin = t[0] if origin is None else origin
        last = _window_numbers(t[-1:], origin, window)[0]
        complete = int(np.searchsorted(t, origin + last * window - 1e-9 * window))
        if complete:
            yield t[:complete], {name: x[:complete] for name, x in signals.items()}, units
        carried_time, carried = t[complete:], {name: x[complete:] for name, x in signals.items()}
    if carried_time.size:
        yield carried_time, carried, units


def _window_numbers(t: Floats, origin: float, window: float) -> NDArray[np.int64]:
    """Number of the window of each sample, with a tolerance for rounded times."""
    return np.floor((t - origin) / window + 1e-9).astype(np.int64)


def _moments(x: Floats, t: Floats, origin: float, window: float) -> Floats:
    """Number, count, mean and sum of squared deviations of a signal in each window, without missing values; rows."""
    numbers = _window_numbers(t, origin, window)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(numbers)) + 1])
    sizes = np.diff(np.append(starts, t.size))
    missing = np.isnan(x)
    some_missing = bool(missing.any())
    count = sizes - np.add.reduceat(missing.astype(np.int64), starts) if some_missing else sizes
    filled = np.where(missing, 0.0, x) if some_missing else x
    mean = np.add.reduceat(filled, starts) / np.where(count, count, np.nan)
    residual = filled - np.repeat(mean, sizes)
    if some_missing:
        residual[missing] = 0.0
    squares = np.add.reduceat(np.square(residual, out=residual), starts)
    return np.stack([numbers[starts], count, mean, squares])


def _statistics(parts: Sequence[Floats], channel: str, unit: str, origin: float, window: float) -> WindowStatistics:
    """Statistics of one channel from the moments of consecutive parts."""
    number, count, mean, squares = np.concatenate(parts, axis=1)
    known = np.where(count > 0, count, np.nan)
    return WindowStatistics(
        time=origin + (number + 0.5) * window,
        mean=mean,
        deviation=np.sqrt(squares / np.where(count > 1, count - 1, np.nan)),
        fluctuation=np.sqrt(squares / known),
        samples=count.astype(np.int64),
        window_duration=window,
        channel=channel,
        unit=unit,
    )


_TAIL_FRACTION = 1 / 3  # of the test, at its end, that determines level and scatter
_CONSECUTIVE = 5  # windows that must stay within the band
_MIN_WINDOWS = 12
_NORMAL_CONSISTENCY = 1.4826  # standard deviation of a normal variable over its median absolute deviation


@dataclass(frozen=True, kw_only=True, slots=True)
class SteadyStateOnset:
    """Onset and level of steady-state friction.

    Parameters
    ----------
    steady : bool
        Whether the friction became steady.
    reason : str
        Why it did not; empty where it did.
    start_time : float
        Time of the onset, since the first window. [s]
    sliding_distance : float
        Sliding distance until the onset. [m]
    friction_force : float
        Mean after the onset. [N]
    friction_force_deviation : float
        Standard deviation of the windows after the onset. [N]
    friction_force_uncertainty : float
        Standard error of the mean. [N]
    """

    steady: bool
    reason: str
    start_time: float
    sliding_distance: float
    friction_force: float
    friction_force_deviation: float
    friction_force_uncertainty: float


def steady_state_onset(
    *, time: ArrayLike, friction_force: ArrayLike, sliding_speed: float, band: float = 3.0, least_band: float = 0.01
) -> SteadyStateOnset:
    r"""Onset of steady-state friction by a tolerance band about the level of the end of the test.

    Parameters
    ----------
    time : array_like, shape (windows,)
        Middle of each window, from the start of the sliding. [s]
    friction_force : array_like, shape (windows,)
        Mean, or fluctuation, in each window. [N]
    sliding_speed : float
        Sliding speed. [m/s]
    band : float
        Half width of the band about the steady level, in standard deviations of the windows.
    least_band : float
        Smallest half width, as a fraction of the level.

    Returns
    -------
    SteadyStateOnset
        Of a test that does not become steady the values are those of its last third.

    Raises
    ------
    InvalidInput
        If there are fewer than 12 windows, or the speed is not positive.

    Notes
    -----
    Level and scatter are the median of the last third of the test and the scaled median absolute deviation about a line
    through it,

    .. math:: s = 1.4826\; \mathrm{median}\,|F_i - \hat F_i| .

    The friction is steady from the first of five consecutive windows whose values lie within the band. It is not steady
    when the last third itself drifts: when the line rises or falls, over its length, by more than the scatter, by more
    than the smallest half width, and by more than three standard errors that account for autocorrelation. D 2.3.3 reads
    the distance off the curve by eye.
    """
    require_positive(sliding_speed=sliding_speed, least_band=least_band, band=band)
    t, f = require_time_series(time=time, friction_force=friction_force)
    known = np.isfinite(f)
    t, f = t[known], f[known]
    if t.size < _MIN_WINDOWS:
        raise InvalidInput(f"a steady state needs at least {_MIN_WINDOWS} windows, got {t.size}")
    tail = slice(t.size - max(_CONSECUTIVE, int(t.size * _TAIL_FRACTION)), t.size)
    level = float(np.median(f[tail]))
    rise, residual = _linear_trend(t[tail], f[tail])
    scatter = _NORMAL_CONSISTENCY * float(np.median(np.abs(residual)))
    half_width = max(band * scatter, least_band * abs(level))
    reason = _drift(rise, residual, max(scatter, least_band * abs(level)))
    within = np.abs(f - level) <= half_width
    held = np.convolve(within, np.ones(_CONSECUTIVE), mode="valid") == _CONSECUTIVE
    first = int(np.argmax(held)) if held.any() and not reason else tail.start
    if not held.any():
        reason = reason or f"no {_CONSECUTIVE} consecutive windows stay within {half_width:.3g} N of {level:.3g} N"
    estimate = correlated_mean(f[first:])
    start = float(t[first] - t[0])
    return SteadyStateOnset(
        steady=not reason,
        reason=reason,
        start_time=start,
        sliding_distance=sliding_speed * start,
        friction_force=estimate.mean,
        friction_force_deviation=estimate.deviation,
        friction_force_uncertainty=estimate.uncertainty,
    )


def _linear_trend(t: Floats, f: Floats) -> tuple[float, Floats]:
    """Rise of the regression line from first to last point, and the residuals about it."""
    x = (t - t.mean()) / (t[-1] - t[0])
    rise = float(x @ f / (x @ x))
    return rise, f - f.mean() - rise * x


def _drift(rise: float, residual: Floats, tolerance: float) -> str:
    """Message where the trend is significant and above the tolerance; empty where it is not."""
    # the rise of a regression line over n even points has the variance 12 s^2/n, times the statistical inefficiency
    variance = 12 * float(residual @ residual) / residual.size**2 * statistical_inefficiency(residual)
    if abs(rise) > tolerance and abs(rise) > 3 * variance**0.5:
        return f"the last third of the test still {'rises' if rise > 0 else 'falls'} by {abs(rise):.3g} N; run longer"
    return ""
