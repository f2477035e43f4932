"""Onset of steady-state friction after running-in, from the friction of consecutive windows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.statistics.autocorrelation import correlated_mean, statistical_inefficiency
from sonolube.measurement.time_series import require_time_series

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
