"""Mean and fluctuation of a signal in consecutive windows, of arrays and of files larger than memory."""

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

DEFAULT_WINDOW_DURATION = 2.0  # s, D 2.3.2


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WindowStatistics:
    """A signal reduced to consecutive windows.

    Parameters
    ----------
    time : ndarray, shape (windows,)
        Middle of each window. [s]
    mean : ndarray, shape (windows,)
        Mean in each window, in `unit`; NaN where it holds no value. So too the next two.
    deviation : ndarray, shape (windows,)
        Standard deviation of the samples; NaN where there are fewer than two.
    fluctuation : ndarray, shape (windows,)
        Root mean square of the difference from the window's mean.
    samples : ndarray of int, shape (windows,)
        Samples that hold a value.
    window_duration : float
        Duration of each window. [s]
    channel : str
        What the signal is.
    unit : str
        Its unit.
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
    """Return mean and fluctuation in consecutive boxcar windows, the last of which may be cut short.

    Parameters
    ----------
    signal : array_like, shape (samples,)
        In any unit; NaN is passed over.
    time : array_like, shape (samples,)
        Increasing; gaps are allowed, and windows without a sample left out. [s]
    window_duration : float
        Duration of each window. [s]
    channel : str
        What the signal is, for the record.
    unit : str
        Its unit, for the record.

    Returns
    -------
    WindowStatistics

    Raises
    ------
    InvalidInput
        If the time does not increase, the signal has another length or no value, or the window is not positive.

    References
    ----------
    .. [1] D 2.3.2 and 2.3.3: windows of 2 s at 400 Hz; their RMS is that of the variation, not of the force.
    """
    require_positive(window_duration=window_duration)
    t, x = require_time_series(time=time, **{channel or "signal": signal})
    return _record([_moments(t, {channel: x}, t[0], window_duration)], channel, unit, t[0], window_duration)


def streamed_window_statistics(
    path: Path,
    *,
    channels: Sequence[str] | None = None,
    mapping: RecordingMapping | Path | None = None,
    window_duration: float = DEFAULT_WINDOW_DURATION,
    block_samples: int = 1 << 18,
) -> Mapping[str, WindowStatistics]:
    """Return the window statistics of a file's channels without ever holding the file in memory.

    Parameters
    ----------
    path : Path
        A recording; only TDMS is truly streamed.
    channels : sequence of str or None
        Which are wanted; all of them without it.
    mapping : RecordingMapping, Path or None
        What the columns mean.
    window_duration : float
        Duration of each window. [s]
    block_samples : int
        Samples read at a time.

    Returns
    -------
    mapping of str to WindowStatistics
        The same numbers as `window_statistics` of the whole.

    Raises
    ------
    InvalidInput
        As `recording_blocks`, or if a channel is not there.
    """
    require_positive(window_duration=window_duration)
    parts: list[_Moments] = []
    units: dict[str, str] = {}
    origin = None
    for t, signals, written in _whole_windows(path, channels, mapping, window_duration, block_samples):
        origin = t[0] if origin is None else origin
        units = written
        parts.append(_moments(t, signals, origin, window_duration))
    if origin is None:
        raise InvalidInput(f"{path}: holds no samples")
    for name in units:
        if not any(part.channels[name][0].any() for part in parts):
            raise InvalidInput(f"{path}: channel {name!r} holds no value")
    return {name: _record(parts, name, units[name], origin, window_duration) for name in units}


Signals = dict[str, Floats]


def _whole_windows(
    path: Path, channels: Sequence[str] | None, mapping: RecordingMapping | Path | None, window: float, size: int
) -> Iterator[tuple[Floats, Signals, dict[str, str]]]:
    held_time, held, origin, units = np.empty(0), dict[str, Floats](), None, dict[str, str]()
    for block in recording_blocks(path, mapping=mapping, block_samples=size):
        names = list(channels) if channels is not None else [str(name) for name in block]
        for name in names:
            if name not in block:
                raise InvalidInput(f"{path}: has no channel {name!r}; it has {', '.join(map(str, block))}")
        units = {name: str(block[name].attrs["units"]) for name in names}
        t = np.concatenate([held_time, block["time"].to_numpy()])
        signals = {
            name: np.concatenate([held[name], block[name].to_numpy()]) if held else block[name].to_numpy()
            for name in names
        }
        origin = t[0] if origin is None else origin
        last = _window_of(t[-1:], origin, window)[0]
        whole = int(np.searchsorted(t, origin + last * window - 1e-9 * window))
        if whole:
            yield t[:whole], {name: x[:whole] for name, x in signals.items()}, units
        held_time, held = t[whole:], {name: x[whole:] for name, x in signals.items()}
    if held_time.size:
        yield held_time, held, units


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Moments:
    """Number of the window, and of each channel the count, mean and sum of squares about it."""

    window: NDArray[np.int64]
    channels: Mapping[str, tuple[NDArray[np.int64], Floats, Floats]]


def _window_of(t: Floats, origin: float, window: float) -> NDArray[np.int64]:
    return np.floor((t - origin) / window + 1e-9).astype(np.int64)


def _moments(t: Floats, signals: Signals, origin: float, window: float) -> _Moments:
    numbers = _window_of(t, origin, window)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(numbers)) + 1])
    sizes = np.diff(np.append(starts, t.size))
    return _Moments(
        window=numbers[starts], channels={name: _channel_moments(x, starts, sizes) for name, x in signals.items()}
    )


def _channel_moments(
    x: Floats, starts: NDArray[np.int64], sizes: NDArray[np.int64]
) -> tuple[NDArray[np.int64], Floats, Floats]:
    missing = np.isnan(x)
    some_missing = bool(missing.any())
    count = sizes - np.add.reduceat(missing.astype(np.int64), starts) if some_missing else sizes
    filled = np.where(missing, 0.0, x) if some_missing else x
    mean = np.add.reduceat(filled, starts) / np.where(count, count, np.nan)
    residual = filled - np.repeat(mean, sizes)
    if some_missing:
        residual[missing] = 0.0
    squares = np.add.reduceat(np.square(residual, out=residual), starts)
    return count, mean, squares


def _record(parts: list[_Moments], channel: str, unit: str, origin: float, window: float) -> WindowStatistics:
    number = np.concatenate([part.window for part in parts])
    count, mean, squares = (np.concatenate([part.channels[channel][which] for part in parts]) for which in range(3))
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
