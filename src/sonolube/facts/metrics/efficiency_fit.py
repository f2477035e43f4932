"""Efficiency line of a rig by linear regression on measured runs, with confidence and prediction bands."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.facts.metrics.efficiency import EfficiencyLine, efficiency_at, power_for_friction

MINIMUM_RUNS = 3
"""Least number of runs that determine a line and its residual deviation."""


@dataclass(frozen=True, kw_only=True, slots=True)
class EfficiencyFit:
    """An efficiency line fitted to runs, valid between the slowest and the fastest of them.

    Parameters
    ----------
    line : EfficiencyLine
    runs : int
        Number of runs it was fitted to.
    lowest_speed, highest_speed : float
        Speeds of the slowest and the fastest run. [m/s]
    mean_speed : float
        Mean speed of the runs. [m/s]
    speed_sum_of_squares : float
        Sum of squares of the speeds about their mean, S_vv, in m2/s2.
    efficiency_deviation : float
        Standard deviation of the runs about the line. [m2/N]
    slope_uncertainty : float
        Standard error of the slope. [m s/N]
    intercept_uncertainty : float
        Standard error of the intercept. [m2/N]
    """

    line: EfficiencyLine
    runs: int
    lowest_speed: float
    highest_speed: float
    mean_speed: float
    speed_sum_of_squares: float
    efficiency_deviation: float
    slope_uncertainty: float
    intercept_uncertainty: float


@dataclass(frozen=True, kw_only=True, slots=True)
class PowerEstimate:
    """Actuator power for a target friction force, with its prediction interval.

    Parameters
    ----------
    actuator_power : float
        Power by the fitted line. [W]
    lowest_power : float
        Lower end of the interval. [W]
    highest_power : float or None
        Upper end; None where the prediction band reaches zero efficiency, which leaves the power unbounded. [W]
    """

    actuator_power: float
    lowest_power: float
    highest_power: float | None


def fit_efficiency(*, sliding_speed: ArrayLike, efficiency_coefficient: ArrayLike) -> EfficiencyFit:
    r"""Efficiency line fitted to measured efficiency coefficients by least squares.

    Parameters
    ----------
    sliding_speed : array_like, shape (n,)
        Speed of each run. [m/s]
    efficiency_coefficient : array_like, shape (n,)
        Coefficient of each run, D 4.1. [m2/N]

    Returns
    -------
    EfficiencyFit

    Raises
    ------
    InvalidInput
        If there are fewer than three runs, all at one speed, or the intercept is not positive.

    Notes
    -----
    Ordinary linear regression with n runs, :math:`S_{vv} = \sum (v_i - \bar v)^2` and the residual variance
    :math:`s^2 = \sum (\eta_i - a v_i - b)^2/(n - 2)`:

    .. math::

        a = \frac{\sum (v_i - \bar v)\, \eta_i}{S_{vv}} , \quad b = \bar\eta - a \bar v , \quad
        u_a = \frac{s}{\sqrt{S_{vv}}} , \quad u_b = s \sqrt{\frac1n + \frac{\bar v^2}{S_{vv}}} .

    Residuals are independent and of equal variance. Runs driven harder than needed, as D observed at its lowest speeds,
    lie below the line and bias it downwards.

    References
    ----------
    .. [1] D 4.2.
    """
    v = np.atleast_1d(require_non_negative(sliding_speed=sliding_speed))
    eta = np.atleast_1d(require_finite(efficiency_coefficient=efficiency_coefficient))
    if v.ndim != 1 or v.shape != eta.shape:
        raise InvalidInput(
            "sliding_speed and efficiency_coefficient must be one-dimensional and equal in length,"
            f" got shapes {v.shape} and {eta.shape}"
        )
    if v.size < MINIMUM_RUNS:
        raise InvalidInput(f"an efficiency line needs at least {MINIMUM_RUNS} runs, got {v.size}")
    mean_speed = float(v.mean())
    sum_of_squares = float(np.sum((v - mean_speed) ** 2))
    if sum_of_squares <= 1e-12 * v.size * mean_speed**2:
        raise InvalidInput(f"all runs are at {mean_speed:.4g} m/s: a line over speed needs at least two speeds")
    slope = float((v - mean_speed) @ eta) / sum_of_squares
    intercept = float(eta.mean()) - slope * mean_speed
    deviation = float(np.sqrt(np.sum((eta - intercept - slope * v) ** 2) / (v.size - 2)))
    return EfficiencyFit(
        line=EfficiencyLine(slope=slope, intercept=intercept),
        runs=v.size,
        lowest_speed=float(v.min()),
        highest_speed=float(v.max()),
        mean_speed=mean_speed,
        speed_sum_of_squares=sum_of_squares,
        efficiency_deviation=deviation,
        slope_uncertainty=deviation / np.sqrt(sum_of_squares),
        intercept_uncertainty=deviation * float(np.sqrt(1 / v.size + mean_speed**2 / sum_of_squares)),
    )


def efficiency_confidence_band(
    fit: EfficiencyFit, *, sliding_speed: ArrayLike, confidence_level: float = 0.95
) -> tuple[Floats, Floats]:
    r"""Confidence band of the efficiency line at a speed, its lower and upper limit. [m2/N]

    Parameters
    ----------
    fit : EfficiencyFit
    sliding_speed : array_like, any shape
        Sliding speed. [m/s]
    confidence_level : float
        Probability with which the band contains the true line at that speed. []

    Returns
    -------
    pair of ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If the level lies outside 0 to 1.
    OutsideRange
        If a speed lies outside the range of the runs.

    See Also
    --------
    efficiency_prediction_band : the band of a further run.

    Notes
    -----
    .. math:: \eta(v) \pm t_{n-2}\, s \sqrt{\frac1n + \frac{(v - \bar v)^2}{S_{vv}}}
    """
    v = require_fitted_speed(fit, sliding_speed=sliding_speed)
    return _band(fit, v, confidence_level, _line_error(fit, v))


def efficiency_prediction_band(
    fit: EfficiencyFit, *, sliding_speed: ArrayLike, confidence_level: float = 0.95
) -> tuple[Floats, Floats]:
    r"""Prediction band of a further run's efficiency at a speed, its lower and upper limit. [m2/N]

    Parameters
    ----------
    fit : EfficiencyFit
    sliding_speed : array_like, any shape
        Sliding speed. [m/s]
    confidence_level : float
        Probability with which the band contains that run. []

    Returns
    -------
    pair of ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If the level lies outside 0 to 1.
    OutsideRange
        If a speed lies outside the range of the runs.

    See Also
    --------
    efficiency_confidence_band : the band of the line itself.

    Notes
    -----
    .. math:: \eta(v) \pm t_{n-2}\, s \sqrt{1 + \frac1n + \frac{(v - \bar v)^2}{S_{vv}}}
    """
    v = require_fitted_speed(fit, sliding_speed=sliding_speed)
    return _band(fit, v, confidence_level, np.sqrt(fit.efficiency_deviation**2 + _line_error(fit, v) ** 2))


def power_estimate(
    fit: EfficiencyFit,
    *,
    intrinsic_friction_force: float,
    reduced_friction_force: float,
    sliding_speed: float,
    nominal_area: float,
    normal_load: float,
    confidence_level: float = 0.95,
) -> PowerEstimate:
    """Actuator power that reduces friction to a target force in a further run, with its prediction interval.

    Parameters
    ----------
    fit : EfficiencyFit
    intrinsic_friction_force : float
        Friction force without vibration. [N]
    reduced_friction_force : float
        Target friction force, at most the intrinsic one. [N]
    sliding_speed : float
        Sliding speed. [m/s]
    nominal_area : float
        Nominal contact area. [m2]
    normal_load : float
        Force pressing the bodies together. [N]
    confidence_level : float
        Probability with which the interval contains the power that run needs. []

    Returns
    -------
    PowerEstimate

    Raises
    ------
    InvalidInput
        If a speed, area or load is not positive, or the target friction negative or above the intrinsic one.
    OutsideRange
        If the speed lies outside the range of the runs, or at or beyond the zero of the line.

    See Also
    --------
    power_for_friction : the power by a line without uncertainty.
    efficiency_prediction_band : the band from which the interval follows.

    References
    ----------
    .. [1] D 4.3.
    """
    v = float(require_positive(sliding_speed=sliding_speed))
    low, high = (
        float(end) for end in efficiency_prediction_band(fit, sliding_speed=v, confidence_level=confidence_level)
    )
    power = float(
        power_for_friction(
            fit.line,
            intrinsic_friction_force=intrinsic_friction_force,
            reduced_friction_force=reduced_friction_force,
            sliding_speed=v,
            nominal_area=nominal_area,
            normal_load=normal_load,
        )
    )
    expected = float(efficiency_at(fit.line, sliding_speed=v))
    return PowerEstimate(
        actuator_power=power,
        lowest_power=power * expected / high,
        highest_power=power * expected / low if low > 0 else None,
    )


def require_fitted_speed(fit: EfficiencyFit, *, sliding_speed: ArrayLike) -> Floats:
    """Speeds as an array; refuse any outside the range of the runs of a fit. [m/s]

    Parameters
    ----------
    fit : EfficiencyFit
    sliding_speed : array_like, any shape
        Sliding speed. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    OutsideRange
        With the range of the runs.
    """
    v = require_non_negative(sliding_speed=sliding_speed)
    outside = (v < fit.lowest_speed * (1 - 1e-9)) | (v > fit.highest_speed * (1 + 1e-9))
    if np.any(outside):
        raise OutsideRange(
            f"sliding_speed must lie within the runs, {fit.lowest_speed:.4g} to {fit.highest_speed:.4g} m/s, got"
            f" {float(v[outside].flat[0]):.4g} m/s: measure there, the line must not be extrapolated"
        )
    return v


def _line_error(fit: EfficiencyFit, v: Floats) -> Floats:
    """Standard error of the line at speeds, in m2/N."""
    return fit.efficiency_deviation * np.sqrt(1 / fit.runs + (v - fit.mean_speed) ** 2 / fit.speed_sum_of_squares)


def _band(fit: EfficiencyFit, v: Floats, confidence_level: float, error: Floats) -> tuple[Floats, Floats]:
    """Line less and plus Student's t times an error."""
    level = float(require_within(0.0, 1.0, confidence_level=confidence_level))
    line = fit.line.slope * v + fit.line.intercept
    half_width = float(stdtrit(fit.runs - 2, (1 + level) / 2)) * error
    return line - half_width, line + half_width
