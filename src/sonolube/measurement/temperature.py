"""Temperature at the contact: its rise, how fast it settles, and what vibration changes."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats
from scipy.optimize import least_squares

from sonolube.checks import Floats, require_finite, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.measurement.statistics.autocorrelation import correlated_mean, statistical_inefficiency
from sonolube.measurement.statistics.log_parameter_fit import ConfidenceInterval
from sonolube.measurement.time_series import require_time_series

_STARTS = 7  # time constants tried, over the duration


@dataclass(frozen=True, kw_only=True, slots=True)
class TemperatureRise:
    """Difference of a temperature between two spans of time.

    Parameters
    ----------
    temperature_rise : float
        Mean of the later span less that of the earlier. [K]
    temperature_rise_uncertainty : float
        Standard error, heeding that neighbouring samples resemble each other. [K]
    """

    temperature_rise: float
    temperature_rise_uncertainty: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TemperatureResponse:
    """A temperature that settles in one or two exponentials.

    Parameters
    ----------
    final_temperature : Interval
        Where it settles, in kelvin.
    temperature_change : Interval
        Final less initial temperature, in kelvin.
    time_constants : tuple of Interval
        In seconds, the shorter first.
    temperature_changes : tuple of Interval
        Share of each in the change, in kelvin.
    temperature_deviation : float
        Standard deviation of the samples about the curve. [K]
    confidence_level : float
        Of the intervals. []
    caveats : tuple of str
        What speaks against the curve, one line each.
    """

    final_temperature: ConfidenceInterval
    temperature_change: ConfidenceInterval
    time_constants: tuple[ConfidenceInterval, ...]
    temperature_changes: tuple[ConfidenceInterval, ...]
    temperature_deviation: float
    confidence_level: float
    caveats: tuple[str, ...]


def temperature_rise_between(
    *, time: ArrayLike, temperature: ArrayLike, before: tuple[float, float], after: tuple[float, float]
) -> TemperatureRise:
    """Return by how much a temperature rose.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    temperature : array_like, shape (samples,)
        From any zero, so degrees Celsius serve as well; NaN is no value. [K]
    before, after : tuple of two float
        First and last time of the earlier and the later span, in seconds.

    Returns
    -------
    TemperatureRise

    Raises
    ------
    InvalidInput
        If a span holds fewer than two values.
    """
    t, value = require_time_series(time=time, temperature=temperature)
    first, last = (_span_mean(t, value, span, name) for span, name in ((before, "before"), (after, "after")))
    return TemperatureRise(
        temperature_rise=last[0] - first[0], temperature_rise_uncertainty=float(np.hypot(first[1], last[1]))
    )


def fit_temperature_response(
    *, time: ArrayLike, temperature: ArrayLike, exponentials: int | None = None, confidence_level: float = 0.95
) -> TemperatureResponse:
    """Return the time constants with which a temperature settles after a step at the first sample.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    temperature : array_like, shape (samples,)
        From any zero; NaN is no value. [K]
    exponentials : int or None
        1 or 2; None takes the number that lowers the Bayesian information criterion.
    confidence_level : float
        Of the intervals. []

    Returns
    -------
    TemperatureResponse

    Raises
    ------
    InvalidInput
        If fewer than 8 values are there, they do not vary, or `exponentials` is neither 1 nor 2.

    Notes
    -----
    Intervals are first-order, on a logarithmic scale for time constants, and widened for residuals that resemble their
    neighbours. A time constant longer than the record is doubted: record and constant are then one straight line.
    """
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    if exponentials not in (None, 1, 2):
        raise InvalidInput(f"exponentials must be 1 or 2, got {exponentials}")
    t, value = require_time_series(time=time, temperature=temperature)
    known = np.isfinite(value)
    t, value = t[known] - t[0], value[known]
    if t.size < 8 or np.ptp(value) == 0:
        raise InvalidInput(f"a settling temperature needs 8 values that vary, got {t.size}")
    fits = [_settled(t, value, count) for count in ((1, 2) if exponentials is None else (exponentials,))]
    logarithms = min(fits, key=lambda fit: _criterion(t, value, fit))
    return _response(t, value, logarithms, confidence_level)


def temperature_rise_by_stage(
    *,
    time: ArrayLike,
    temperature: ArrayLike,
    reference_time: ArrayLike,
    reference_temperature: ArrayLike,
    stages: ArrayLike,
) -> tuple[TemperatureRise, ...]:
    """Return by how much a temperature differs from that of a test without vibration, stage by stage.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Of the test with vibration, from its start. [s]
    temperature : array_like, shape (samples,)
        With vibration. [K]
    reference_time : array_like, shape (reference_samples,)
        Of the test without vibration, from its start. [s]
    reference_temperature : array_like, shape (reference_samples,)
        Without vibration, from the same zero. [K]
    stages : array_like, shape (stages + 1,)
        Times at which stages begin, and at which the last ends, in seconds.

    Returns
    -------
    tuple of TemperatureRise
        One a stage: with less without.

    Raises
    ------
    InvalidInput
        If stages do not rise or a stage holds fewer than two samples of both tests.

    Notes
    -----
    The reference is taken between its samples by straight lines. The uncertainty is that of one pair of tests; how far
    tests differ among themselves is for `compare` and several pairs to say.

    References
    ----------
    .. [1] D 4.3.4, figure 4.34.
    """
    t, value = require_time_series(time=time, temperature=temperature)
    t_0, reference = require_time_series(time=reference_time, reference_temperature=reference_temperature)
    ends = require_finite(stages=stages)
    if ends.ndim != 1 or ends.size < 2 or np.any(np.diff(ends) <= 0):
        raise InvalidInput("stages must be at least two times that rise")
    known = np.isfinite(reference)
    without = np.interp(t, t_0[known], reference[known], left=np.nan, right=np.nan)
    differences = []
    for place, (start, end) in enumerate(pairwise(ends.tolist()), start=1):
        mean, error = _span_mean(t, value - without, (start, end), f"stage {place}")
        differences.append(TemperatureRise(temperature_rise=mean, temperature_rise_uncertainty=error))
    return tuple(differences)


def heating_rate(*, time: ArrayLike, temperature: ArrayLike, start_time: float, end_time: float) -> float:
    """Return how fast a temperature rises over a span, as least squares see it, in kelvin per second.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    temperature : array_like, shape (samples,)
        From any zero; NaN is no value. [K]
    start_time : float
        Where the span begins. [s]
    end_time : float
        Where it ends. [s]

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If the span holds fewer than two values.
    """
    t, value = require_time_series(time=time, temperature=temperature)
    require_positive(duration=end_time - start_time)
    inside = (t >= start_time) & (t <= end_time) & np.isfinite(value)
    if np.count_nonzero(inside) < 2:
        raise InvalidInput(f"{start_time:g} to {end_time:g} s holds {np.count_nonzero(inside)} values; two are needed")
    return float(np.polyfit(t[inside] - start_time, value[inside], 1)[0])


def _span_mean(t: Floats, value: Floats, span: tuple[float, float], name: str) -> tuple[float, float]:
    start, end = span
    inside = (t >= start) & (t <= end) & np.isfinite(value)
    if np.count_nonzero(inside) < 2:
        raise InvalidInput(f"{name}, {start:g} to {end:g} s, holds {np.count_nonzero(inside)} values; two are needed")
    known = correlated_mean(value[inside])
    return known.mean, known.uncertainty


def _columns(t: Floats, logarithms: Floats) -> Floats:
    return np.stack([np.ones_like(t), *(np.exp(-t / tau) for tau in np.exp(logarithms))], axis=-1)


def _misses(t: Floats, value: Floats, logarithms: Floats) -> Floats:
    columns = _columns(t, logarithms)
    return np.asarray(columns @ np.linalg.lstsq(columns, value, rcond=None)[0] - value)


def _settled(t: Floats, value: Floats, count: int) -> Floats:
    """Return logarithms of the time constants; the temperatures follow linearly."""
    duration, shortest = float(t[-1]), float(np.median(np.diff(t)))
    bounds = np.log([shortest / 3, 30 * duration])
    grid = np.geomspace(2 * shortest, 2 * duration, _STARTS)
    if count == 1:
        starts = [np.log([tau]) for tau in grid]
    else:
        starts = [np.log([short, long]) for at, short in enumerate(grid) for long in grid[at + 1 :]]
    best = min(starts, key=lambda start: float(np.sum(_misses(t, value, start) ** 2)))
    found = least_squares(
        lambda logarithms: _misses(t, value, logarithms),
        np.clip(best, bounds[0] + 1e-6, bounds[1] - 1e-6),
        bounds=(bounds[0], bounds[1]),
        xtol=1e-12,
        ftol=1e-12,
    )
    return np.sort(found.x)


def _criterion(t: Floats, value: Floats, logarithms: Floats) -> float:
    mean_square = max(float(np.mean(_misses(t, value, logarithms) ** 2)), (1e-10 * float(np.ptp(value))) ** 2)
    return t.size * float(np.log(mean_square)) + (1 + 2 * logarithms.size) * float(np.log(t.size))


def _response(t: Floats, value: Floats, logarithms: Floats, confidence_level: float) -> TemperatureResponse:
    count = logarithms.size
    columns = _columns(t, logarithms)
    amplitudes = np.linalg.lstsq(columns, value, rcond=None)[0]
    misses = value - columns @ amplitudes
    ratios = t[:, np.newaxis] / np.exp(logarithms)
    jacobian = np.concatenate([columns, amplitudes[1:] * ratios * columns[:, 1:]], axis=1)
    alike = statistical_inefficiency(misses) if np.ptp(misses) > 0 else 1.0
    variance = float(np.sum(misses**2)) / max(1, t.size - jacobian.shape[1])
    size = np.linalg.norm(jacobian, axis=0)
    inverse = np.linalg.pinv(jacobian / size)
    covariance = alike * variance * (inverse @ inverse.T) / np.multiply.outer(size, size)
    reach = float(stats.t.ppf((1 + confidence_level) / 2, max(1.0, t.size / alike - jacobian.shape[1])))

    def linear(direction: Floats) -> ConfidenceInterval:
        middle = float(direction @ amplitudes)
        half = reach * float(np.sqrt(direction @ covariance[: count + 1, : count + 1] @ direction))
        return ConfidenceInterval(value=middle, lower=middle - half, upper=middle + half)

    places = np.eye(count + 1)
    factors = np.exp(np.minimum(reach * np.sqrt(np.diag(covariance)[count + 1 :]), 300.0))
    taus = np.exp(logarithms)
    return TemperatureResponse(
        final_temperature=linear(places[0]),
        temperature_change=linear(-places[1:].sum(axis=0)),
        time_constants=tuple(
            ConfidenceInterval(value=float(tau), lower=float(tau / factor), upper=float(tau * factor))
            for tau, factor in zip(taus, factors, strict=True)
        ),
        temperature_changes=tuple(linear(-place) for place in places[1:]),
        temperature_deviation=float(np.sqrt(variance)),
        confidence_level=confidence_level,
        caveats=_caveats(float(taus[-1]), float(t[-1])),
    )


def _caveats(longest: float, duration: float) -> tuple[str, ...]:
    if longest <= duration:
        return ()
    return (
        f"a time constant of {longest:.3g} s is longer than the record of {duration:.3g} s;"
        " where it settles is a guess: record longer",
    )
