"""Where running-in ends and steady friction begins."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.statistics.autocorrelation import correlated_mean, statistical_inefficiency
from sonolube.measurement.time_series import require_time_series

_SETTLED_SHARE = 1 / 3  # of the test, at its end, which tells level and scatter
_HOLD = 5  # windows that must stay within the band
_FEWEST = 12  # windows
_ROBUST = 1.4826  # deviation of a normal variable over its median absolute deviation


@dataclass(frozen=True, kw_only=True, slots=True)
class SteadyStateOnset:
    """Steady friction, and how far the pin slid until it was reached.

    Parameters
    ----------
    steady : bool
        Whether the friction became steady at all.
    reason : str
        Why not; empty when steady.
    start_time : float
        Since the start of the first window. [s]
    sliding_distance : float
        Slid until then. [m]
    friction_force : float
        Mean from then on. [N]
    friction_force_deviation : float
        Scatter of the windows' means from then on. [N]
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
    """Return where friction becomes steady.

    Parameters
    ----------
    time : array_like, shape (windows,)
        Middle of each window, from the start of the sliding. [s]
    friction_force : array_like, shape (windows,)
        Mean, or fluctuation, in each window. [N]
    sliding_speed : float
        Speed of the sliding. [m/s]
    band : float
        Half width of the band about the steady level, in scatters of the windows.
    least_band : float
        The least half width, as a share of the level.

    Returns
    -------
    SteadyState
        Of a test that does not become steady the numbers are those of its last third.

    Raises
    ------
    InvalidInput
        If there are fewer than 12 windows, or the speed is not positive.

    Notes
    -----
    Level and scatter are the median of the last third of the test and the scaled median absolute deviation about a line
    through it. The friction is steady from the first of five windows in a row whose values lie within the band. It is
    not steady when the last third itself drifts: when the line rises or falls, over its length, by more than the
    scatter, by more than the least band, and by more than three standard errors that heed correlation. D 2.3.3 reads
    the distance off the curve by eye.
    """
    require_positive(sliding_speed=sliding_speed, least_band=least_band, band=band)
    t, f = require_time_series(time=time, friction_force=friction_force)
    known = np.isfinite(f)
    t, f = t[known], f[known]
    if t.size < _FEWEST:
        raise InvalidInput(f"a steady state needs at least {_FEWEST} windows, got {t.size}")
    tail = slice(t.size - max(_HOLD, int(t.size * _SETTLED_SHARE)), t.size)
    level = float(np.median(f[tail]))
    rise, residual = _line(t[tail], f[tail])
    scatter = _ROBUST * float(np.median(np.abs(residual)))
    half_width = max(band * scatter, least_band * abs(level))
    reason = _drift(rise, residual, max(scatter, least_band * abs(level)))
    within = np.abs(f - level) <= half_width
    held = np.convolve(within, np.ones(_HOLD), mode="valid") == _HOLD
    first = int(np.argmax(held)) if held.any() and not reason else tail.start
    if not held.any():
        reason = reason or f"no {_HOLD} windows in a row stay within {half_width:.3g} N of {level:.3g} N"
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


def _line(t: Floats, f: Floats) -> tuple[float, Floats]:
    """Rise of a line through all points, from first to last, and what is left about it."""
    x = (t - t.mean()) / (t[-1] - t[0])
    rise = float(x @ f / (x @ x))
    return rise, f - f.mean() - rise * x


def _drift(rise: float, residual: Floats, tolerated: float) -> str:
    # the rise of a line over n even points has the variance 12 s^2/n, times what correlation adds
    variance = 12 * float(residual @ residual) / residual.size**2 * statistical_inefficiency(residual)
    if abs(rise) > tolerated and abs(rise) > 3 * variance**0.5:
        return (
            f"the last third of the test still {'rises' if rise > 0 else 'falls'} by {abs(rise):.3g} N; run it longer"
        )
    return ""
