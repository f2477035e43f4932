"""Temperature measurements: step response in exponentials, and differences between tests."""

from dataclasses import dataclass
from functools import partial
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats
from scipy.optimize import least_squares

from sonolube.checks import Floats, require_finite, require_within
from sonolube.errors import InvalidInput
from sonolube.measurement.statistics.autocorrelation import correlated_mean, statistical_inefficiency
from sonolube.measurement.statistics.log_parameter_fit import ConfidenceInterval
from sonolube.measurement.time_series import require_time_series

_INITIAL_TIME_CONSTANTS = 7  # on a logarithmic grid over the duration
_MOST_CANCELLED = 5.0  # shares of exponentials over the change that they make together


@dataclass(frozen=True, kw_only=True, slots=True)
class TemperatureRise:
    """Mean temperature rise over a reference with its standard error.

    Parameters
    ----------
    temperature_rise : float
        With less without vibration. [K]
    temperature_rise_uncertainty : float
        Standard error, accounting for the autocorrelation of samples. [K]
    """

    temperature_rise: float
    temperature_rise_uncertainty: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TemperatureResponse:
    """Step response of a temperature as a sum of one or two exponentials, with confidence intervals.

    Parameters
    ----------
    final_temperature : ConfidenceInterval
        Asymptotic temperature, in kelvin.
    temperature_change : ConfidenceInterval
        Final less initial temperature, in kelvin.
    time_constants : tuple of ConfidenceInterval
        In seconds, the shorter first.
    temperature_changes : tuple of ConfidenceInterval
        Contribution of each exponential to the change, in kelvin.
    temperature_deviation : float
        Standard deviation of the samples about the curve. [K]
    confidence_level : float
        Of the intervals. []
    caveats : tuple of str
        Reservations about the fit, one line each.
    """

    final_temperature: ConfidenceInterval
    temperature_change: ConfidenceInterval
    time_constants: tuple[ConfidenceInterval, ...]
    temperature_changes: tuple[ConfidenceInterval, ...]
    temperature_deviation: float
    confidence_level: float
    caveats: tuple[str, ...]


def fit_temperature_response(
    *, time: ArrayLike, temperature: ArrayLike, exponentials: int | None = None, confidence_level: float = 0.95
) -> TemperatureResponse:
    r"""Exponential step response fitted to a temperature after a step of the heat at the first sample.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    temperature : array_like, shape (samples,)
        Relative to any zero; NaN is a missing value. [K]
    exponentials : int or None
        1 or 2; None selects the number of the lower Bayesian information criterion.
    confidence_level : float
        Of the intervals. []

    Returns
    -------
    TemperatureResponse

    Raises
    ------
    InvalidInput
        If there are fewer than 8 values, they do not vary, `exponentials` is neither 1 nor 2, or the record does not
        determine the exponentials: shares that cancel each other, or a change that is not beyond its noise.

    Notes
    -----
    Fits, with the asymptote and the changes eliminated as linear parameters (variable projection),

    .. math:: T(t) = T_\infty - \sum_{k} \Delta T_k\, e^{-t/\tau_k} .

    Intervals are first-order, on a logarithmic scale for time constants, and widened by the statistical inefficiency of
    the residuals. A time constant longer than the record is reported in the caveats: the response is then nearly a
    straight line, which does not determine it.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.measurement import fit_temperature_response
    >>> time = np.linspace(0, 300, 61)
    >>> found = fit_temperature_response(time=time, temperature=20.0 * (1 - np.exp(-time / 60)), exponentials=1)
    >>> round(found.time_constants[0].value, 3), round(found.final_temperature.value, 3)
    (60.0, 20.0)
    """
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    if exponentials not in (None, 1, 2):
        raise InvalidInput(f"exponentials must be 1 or 2, got {exponentials}")
    t, value = require_time_series(time=time, temperature=temperature)
    known = np.isfinite(value)
    t, value = t[known] - t[0], value[known]
    if t.size < 8 or np.ptp(value) == 0:
        raise InvalidInput(f"a settling temperature needs 8 values that vary, got {t.size}")
    fits = [_log_time_constants(t, value, count) for count in ((1, 2) if exponentials is None else (exponentials,))]
    fits.sort(key=partial(_information_criterion, t, value))
    found = [_response(t, value, logarithms, confidence_level) for logarithms in fits]
    range_of_values = float(np.ptp(value))
    reasons = [_undetermined(response, range_of_values) for response in found]
    known_ones = [response for response, reason in zip(found, reasons, strict=True) if not reason]
    if not known_ones:
        raise InvalidInput(f"temperature is no determined step response: {reasons[0]}; choose the part after one step")
    return known_ones[0]


def temperature_rise_by_stage(
    *,
    time: ArrayLike,
    temperature: ArrayLike,
    reference_time: ArrayLike,
    reference_temperature: ArrayLike,
    stages: ArrayLike,
) -> tuple[TemperatureRise, ...]:
    """Temperature rise over a test without vibration, stage by stage.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Time of the test with vibration, from its start. [s]
    temperature : array_like, shape (samples,)
        With vibration. [K]
    reference_time : array_like, shape (reference_samples,)
        Time of the test without vibration, from its start. [s]
    reference_temperature : array_like, shape (reference_samples,)
        Without vibration, relative to the same zero. [K]
    stages : array_like, shape (stages + 1,)
        Times at which the stages begin, and at which the last ends, in seconds.

    Returns
    -------
    tuple of TemperatureRise
        One per stage: with less without vibration.

    Raises
    ------
    InvalidInput
        If stages do not increase or a stage holds fewer than two samples of both tests.

    Notes
    -----
    The reference is interpolated linearly between its samples. The uncertainty is that of one pair of tests; the
    scatter between tests follows from several pairs, by `compare_means`.

    References
    ----------
    .. [1] D 4.3.4, figure 4.34.
    """
    t, value = require_time_series(time=time, temperature=temperature)
    t_0, reference = require_time_series(time=reference_time, reference_temperature=reference_temperature)
    ends = require_finite(stages=stages)
    if ends.ndim != 1 or ends.size < 2 or np.any(np.diff(ends) <= 0):
        raise InvalidInput("stages must be at least two increasing times")
    known = np.isfinite(reference)
    without = np.interp(t, t_0[known], reference[known], left=np.nan, right=np.nan)
    spans = enumerate(pairwise(ends.tolist()), start=1)
    return tuple(_rise(t, value - without, span, f"stage {place}") for place, span in spans)


def _rise(t: Floats, rise: Floats, span: tuple[float, float], name: str) -> TemperatureRise:
    """Mean rise over a time span and its standard error."""
    start, end = span
    inside = (t >= start) & (t <= end) & np.isfinite(rise)
    if np.count_nonzero(inside) < 2:
        raise InvalidInput(f"{name}, {start:g} to {end:g} s, holds {np.count_nonzero(inside)} values; two are needed")
    estimate = correlated_mean(rise[inside])
    return TemperatureRise(temperature_rise=estimate.mean, temperature_rise_uncertainty=estimate.uncertainty)


def _basis(t: Floats, logarithms: Floats) -> Floats:
    """Columns of the linear parameters: a constant and the decaying exponentials."""
    return np.stack([np.ones_like(t), *(np.exp(-t / tau) for tau in np.exp(logarithms))], axis=-1)


def _projected_residuals(t: Floats, value: Floats, logarithms: Floats) -> Floats:
    """Residuals after the linear parameters are eliminated."""
    columns = _basis(t, logarithms)
    return np.asarray(columns @ np.linalg.lstsq(columns, value, rcond=None)[0] - value)


def _log_time_constants(t: Floats, value: Floats, count: int) -> Floats:
    """Logarithms of the fitted time constants, the shorter first."""
    duration, shortest = float(t[-1]), float(np.median(np.diff(t)))
    lower, upper = np.log([shortest / 3, 30 * duration])
    initial = np.geomspace(2 * shortest, 2 * duration, _INITIAL_TIME_CONSTANTS)
    residuals = partial(_projected_residuals, t, value)
    best = min(map(np.log, combinations(initial, count)), key=lambda start: float(np.sum(residuals(start) ** 2)))
    start = np.clip(best, lower + 1e-6, upper - 1e-6)
    return np.sort(least_squares(residuals, start, bounds=(lower, upper), xtol=1e-12, ftol=1e-12).x)


def _information_criterion(t: Floats, value: Floats, logarithms: Floats) -> float:
    """Bayesian information criterion of a fit, up to a constant of the data."""
    residuals, rounding = _projected_residuals(t, value, logarithms), 1e-10 * float(np.ptp(value))
    mean_square = max(float(np.mean(residuals**2)), rounding**2)
    return t.size * float(np.log(mean_square)) + (1 + 2 * logarithms.size) * float(np.log(t.size))


def _response(t: Floats, value: Floats, logarithms: Floats, confidence_level: float) -> TemperatureResponse:
    """Response of fitted time constants with its confidence intervals."""
    count = logarithms.size
    columns = _basis(t, logarithms)
    amplitudes = np.linalg.lstsq(columns, value, rcond=None)[0]
    residuals = value - columns @ amplitudes
    ratios = t[:, np.newaxis] / np.exp(logarithms)
    jacobian = np.concatenate([columns, amplitudes[1:] * ratios * columns[:, 1:]], axis=1)
    inefficiency = statistical_inefficiency(residuals) if np.ptp(residuals) > 0 else 1.0
    variance = float(np.sum(residuals**2)) / max(1, t.size - jacobian.shape[1])
    norms = np.linalg.norm(jacobian, axis=0)
    # Rows of it: the covariance of the parameters is this matrix times its transpose, never negative by rounding.
    spread = np.sqrt(inefficiency * variance) * np.linalg.pinv(jacobian / norms) / norms[:, np.newaxis]
    quantile = float(stats.t.ppf((1 + confidence_level) / 2, max(1.0, t.size / inefficiency - jacobian.shape[1])))

    def interval(direction: Floats) -> ConfidenceInterval:
        """Interval of a linear combination of the amplitudes."""
        estimate = float(direction @ amplitudes)
        half = quantile * float(np.linalg.norm(direction @ spread[: count + 1]))
        return ConfidenceInterval(value=estimate, lower=estimate - half, upper=estimate + half)

    unit_vectors = np.eye(count + 1)
    factors = np.exp(np.minimum(quantile * np.linalg.norm(spread[count + 1 :], axis=1), 300.0))
    taus = np.exp(logarithms)
    return TemperatureResponse(
        final_temperature=interval(unit_vectors[0]),
        temperature_change=interval(-unit_vectors[1:].sum(axis=0)),
        time_constants=tuple(
            ConfidenceInterval(value=float(tau), lower=float(tau / factor), upper=float(tau * factor))
            for tau, factor in zip(taus, factors, strict=True)
        ),
        temperature_changes=tuple(interval(-unit) for unit in unit_vectors[1:]),
        temperature_deviation=float(np.sqrt(variance)),
        confidence_level=confidence_level,
        caveats=_caveats(float(taus[-1]), float(t[-1])),
    )


def _undetermined(found: TemperatureResponse, values: float) -> str:
    """Why a record with a range of values, in K, does not determine the exponentials of a fit; empty where it does."""
    shares = sum(abs(each.value) for each in found.temperature_changes)
    change = found.temperature_change
    if shares > _MOST_CANCELLED * max(values, abs(change.value)):
        times = " and ".join(f"{each.value:.3g} s" for each in found.time_constants)
        return f"its exponentials of {times} cancel each other, {shares:.3g} K for a range of {values:.3g} K"
    if change.lower <= 0 <= change.upper and len(found.temperature_changes) == 1:
        return f"its change of {change.value:.3g} K is not beyond its noise, {change.lower:.3g} to {change.upper:.3g} K"
    return ""


def _caveats(longest: float, duration: float) -> tuple[str, ...]:
    """Caveat of a time constant that exceeds the record."""
    if longest <= duration:
        return ()
    return (
        f"a time constant of {longest:.3g} s is longer than the record of {duration:.3g} s;"
        " the final temperature is an extrapolation: record longer",
    )
