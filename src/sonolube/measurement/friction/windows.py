"""Mean, standard deviation and fluctuation of a signal in consecutive windows, of arrays and of streamed files."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import recording_blocks
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
