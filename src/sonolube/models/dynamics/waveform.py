"""Waveforms of the drive voltage: one period of zero mean and unit peak-to-peak height, and its start-up ramp."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, UnknownName

_PERIOD = 2 * np.pi


@dataclass(frozen=True, slots=True)
class Sine:
    r"""Sinusoidal waveform of unit peak-to-peak height.

    Notes
    -----
    .. math:: w(\theta) = \tfrac12\sin\theta
    """


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PiecewiseLinear:
    """Piecewise linear waveform, with or without jumps between its pieces.

    Parameters
    ----------
    starts_at : ndarray, shape (n,)
        Phase at which each piece starts, increasing, from 0 to less than 2 pi, in rad; the last piece ends where the
        first one starts.
    first : ndarray, shape (n,)
        Value at the start of each piece.
    last : ndarray, shape (n,)
        Value at the end of each piece.

    Raises
    ------
    InvalidInput
        If shapes disagree, phases do not increase within a period, the mean is not zero or the peak-to-peak height is
        not one.
    """

    starts_at: Floats
    first: Floats
    last: Floats

    def __post_init__(self) -> None:
        start = require_finite(starts_at=self.starts_at, first=self.first, last=self.last)
        if start.shape != (start.size,) or not start.size or not start.shape == self.first.shape == self.last.shape:
            raise InvalidInput("starts_at, first and last must be arrays of one axis and the same length")
        if start[0] < 0 or start[-1] >= _PERIOD or np.any(np.diff(start) <= 0):
            raise InvalidInput("starts_at must increase, and lie between 0 and 2 pi, less than the latter")
        mean, (lowest, highest) = self._lengths @ (self.first + self.last) / (2 * _PERIOD), waveform_extremes(self)
        swing = highest - lowest
        if abs(mean) > 1e-9 or abs(swing - 1) > 1e-9:
            raise InvalidInput(f"a waveform must have mean 0 and peak to peak 1, got {mean:.4g} and {swing:.4g}")

    @property
    def _lengths(self) -> Floats:
        return np.diff(self.starts_at, append=self.starts_at[0] + _PERIOD)

    @property
    def _slopes(self) -> Floats:
        return (self.last - self.first) / self._lengths


Waveform = Sine | PiecewiseLinear


def sampled_waveform(samples: ArrayLike) -> PiecewiseLinear:
    """Piecewise linear waveform through equally spaced samples of one period, normalised.

    Parameters
    ----------
    samples : array_like, shape (n,)
        At least two, not all equal; the first one at phase 0, and after the last one the first again.

    Returns
    -------
    PiecewiseLinear
        Linear between samples, without jumps; of zero mean and unit peak-to-peak height.

    Raises
    ------
    InvalidInput
        If there are fewer than two samples, all are equal, or one is not finite.
    """
    given = np.asarray(samples, dtype=np.float64)
    if given.ndim != 1 or given.size < 2:
        raise InvalidInput(f"samples must be at least two on one axis, got shape {given.shape}")
    if not np.all(np.isfinite(given)):
        index = int(np.flatnonzero(~np.isfinite(given))[0])
        raise InvalidInput(f"samples[{index}] must be finite, got {float(given[index])!r}")
    height = float(np.ptp(given))
    if height == 0:
        raise InvalidInput(f"samples must not all be equal, got {float(given[0])!r} throughout")
    values = (given - given.mean()) / height
    starts_at = np.linspace(0.0, _PERIOD, given.size, endpoint=False, dtype=np.float64)
    return PiecewiseLinear(starts_at=starts_at, first=values, last=np.roll(values, -1))


def waveform_value(waveform: Waveform, *, phase: ArrayLike) -> Floats:
    """Value of a waveform at a phase; at a jump, the value after it.

    Parameters
    ----------
    waveform : Waveform
    phase : array_like, any shape
        Phase, of any number of periods. [rad]

    Returns
    -------
    ndarray, shape of `phase`

    Raises
    ------
    InvalidInput
        If a phase is not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.models.dynamics import WAVEFORMS, waveform_value
    >>> waveform_value(WAVEFORMS["square"], phase=[0.5 * np.pi, 1.5 * np.pi]).tolist()
    [0.5, -0.5]
    """
    theta = require_finite(phase=phase)
    if isinstance(waveform, Sine):
        return np.asarray(0.5 * np.sin(theta))
    theta = theta % _PERIOD
    piece = np.searchsorted(waveform.starts_at, theta, side="right") - 1  # -1 before the first: the last, wrapped
    into = (theta - waveform.starts_at[piece]) % _PERIOD
    return np.asarray(waveform.first[piece] + waveform._slopes[piece] * into)


def fourier_coefficients(waveform: Waveform, count: int) -> Complexes:
    r"""Exact Fourier coefficients c_0 to c_count of a waveform.

    Parameters
    ----------
    waveform : Waveform
    count : int
        Highest harmonic.

    Returns
    -------
    ndarray of complex, shape (count + 1,)
        Of :math:`w(\theta) = \sum_{k=-\infty}^{\infty} c_k e^{ik\theta}`: harmonic k has the complex amplitude
        2 c_k; the mean c_0 is zero.

    Raises
    ------
    InvalidInput
        If the count is negative.

    Notes
    -----
    Integration by parts over the pieces, which start at the phases :math:`\theta_j` with the jump
    :math:`\Delta w_j` and the change of slope :math:`\Delta w'_j`, gives

    .. math:: c_k = \frac{1}{2\pi} \sum_j
              \left[\frac{\Delta w_j}{ik} + \frac{\Delta w'_j}{(ik)^2}\right] e^{-ik\theta_j}
    """
    if count < 0:
        raise InvalidInput(f"count must not be negative, got {count!r}")
    coefficients = np.zeros(count + 1, dtype=np.complex128)
    if isinstance(waveform, Sine):
        coefficients[1:2] = -0.25j
        return coefficients
    ik = 1j * np.arange(1, count + 1)
    rotation = np.exp(-np.multiply.outer(ik, waveform.starts_at))
    jump = waveform.first - np.roll(waveform.last, 1)
    slope_change = waveform._slopes - np.roll(waveform._slopes, 1)
    coefficients[1:] = (rotation @ jump / ik + rotation @ slope_change / ik**2) / _PERIOD
    return coefficients


def jump_phases(waveform: Waveform) -> Floats:
    """Phases within one period at which the waveform jumps, in increasing order, in rad.

    Parameters
    ----------
    waveform : Waveform

    Returns
    -------
    ndarray, shape (number of jumps,)
    """
    if isinstance(waveform, Sine):
        return np.empty(0)
    return waveform.starts_at[np.abs(waveform.first - np.roll(waveform.last, 1)) > 1e-12]


def waveform_extremes(waveform: Waveform) -> tuple[float, float]:
    """Lowest and the highest value of a waveform.

    Parameters
    ----------
    waveform : Waveform

    Returns
    -------
    lowest, highest : float
        They differ by one; -1/2 and 1/2 for the named waveforms.
    """
    if isinstance(waveform, Sine):
        return -0.5, 0.5
    ends = np.concatenate([waveform.first, waveform.last])
    return float(ends.min()), float(ends.max())


def _pieces(*pieces: tuple[float, float, float]) -> PiecewiseLinear:
    """Waveform of pieces, each given by its start in units of pi, its first and its last value."""
    start, first, last = np.array(pieces).T
    return PiecewiseLinear(starts_at=start * np.pi, first=first, last=last)


WAVEFORMS: Mapping[str, Waveform] = MappingProxyType(
    {
        "sine": Sine(),
        "square": _pieces((0.0, 0.5, 0.5), (1.0, -0.5, -0.5)),
        "triangle": _pieces((0.5, 0.5, -0.5), (1.5, -0.5, 0.5)),
        "sawtooth": _pieces((1.0, -0.5, 0.5)),
    }
)
"""Waveforms by name, each with a fundamental in phase with the sine; the sawtooth rises, then jumps down."""


def drive_voltage(
    waveform: Waveform,
    *,
    voltage_offset: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    frequency: ArrayLike,
    time: ArrayLike,
) -> Floats:
    r"""Drive voltage at given times. [V]

    Parameters
    ----------
    waveform : Waveform
    voltage_offset : array_like
        Mean voltage. [V]
    voltage_peak_to_peak : array_like, broadcast against `voltage_offset`
        Difference of the highest and the lowest voltage. [V]
    frequency : array_like, broadcast against `voltage_offset`
        Repetition frequency. [Hz]
    time : array_like, broadcast against `voltage_offset`
        Time; phase 0 is at 0. [s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a peak-to-peak voltage is negative, a frequency not positive, or a value not finite.

    Notes
    -----
    .. math:: V(t) = U_0 + U_{pp}\,w(2\pi f t)
    """
    phase = _PERIOD * (require_positive(frequency=frequency) * require_finite(time=time))
    swing = require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak)
    return require_finite(voltage_offset=voltage_offset) + swing * waveform_value(waveform, phase=phase)


RAMP_SHAPES = ("linear", "cosine")


@dataclass(frozen=True, kw_only=True, slots=True)
class StartUpRamp:
    """Ramp by which offset and amplitude of the drive rise from zero when it is switched on.

    Parameters
    ----------
    duration : float
        Time from zero to full amplitude; zero for a step. [s]
    shape : str
        "linear", or "cosine" for half a cosine wave, whose slope is continuous.

    Raises
    ------
    InvalidInput
        If the duration is negative.
    UnknownName
        If the shape is unknown.
    """

    duration: float
    shape: str = "linear"

    def __post_init__(self) -> None:
        require_non_negative(duration=self.duration)
        if self.shape not in RAMP_SHAPES:
            raise UnknownName.among(RAMP_SHAPES, kind="ramp", name=self.shape)


def ramp_factor(ramp: StartUpRamp, *, time: ArrayLike) -> Floats:
    r"""Fraction of the full drive amplitude that a ramp has reached. []

    Parameters
    ----------
    ramp : StartUpRamp
    time : array_like, any shape
        Time since the start; before it there is no drive. [s]

    Returns
    -------
    ndarray, shape of `time`
        From 0 to 1.

    Raises
    ------
    InvalidInput
        If a time is not finite.

    Notes
    -----
    With :math:`s = \min(\max(t/T, 0), 1)`, the factor is s for a linear ramp and
    :math:`\tfrac12 - \tfrac12\cos\pi s` for a cosine ramp.
    """
    t = require_finite(time=time)
    if ramp.duration == 0:
        return np.where(t >= 0, 1.0, 0.0)
    share = np.clip(t / ramp.duration, 0.0, 1.0)
    return share if ramp.shape == "linear" else 0.5 - 0.5 * np.cos(np.pi * share)
