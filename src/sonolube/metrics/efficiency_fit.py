"""The efficiency line of one's own rig: fitted to measured runs, with what the fit leaves open."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.metrics.efficiency import EfficiencyLine, efficiency_at, power_for_friction

MINIMUM_RUNS = 3
"""Runs from which a line and its scatter can be told."""


@dataclass(frozen=True, kw_only=True, slots=True)
class EfficiencyFit:
    """An efficiency line fitted to runs, for speeds between the slowest and the fastest of them.

    Parameters
    ----------
    line : EfficiencyLine
    runs : int
        How many it was fitted to.
    lowest_speed, highest_speed : float
        Speeds of the slowest and the fastest run. [m/s]
    mean_speed : float
        Mean speed of the runs. [m/s]
    speed_sum_of_squares : float
        Sum of the squares of the speeds about their mean, in m2/s2.
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
    """The power that a friction takes, and between which it lies.

    Parameters
    ----------
    actuator_power : float
        Power on the line. [W]
    lowest_power : float
        Lower end of the interval. [W]
    highest_power : float or None
        Upper end; None where the runs do not bound it, the band reaching an efficiency of nought. [W]
    """

    actuator_power: float
    lowest_power: float
    highest_power: float | None


def fit_efficiency(*, sliding_speed: ArrayLike, efficiency_coefficient: ArrayLike) -> EfficiencyFit:
    """Return the line of least squares through measured efficiency coefficients.

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
        If there are fewer than three runs, all at one speed, or the line starts at no positive efficiency.

    Notes
    -----
    Runs scatter about the line alike and independently. Runs driven harder than needed, which D saw at its lowest
    speeds, scatter downwards and pull the line down.

    References
    ----------
    .. [1] D 4.2.
    """
    v = np.atleast_1d(require_non_negative(sliding_speed=sliding_speed))
    eta = np.atleast_1d(require_finite(efficiency_coefficient=efficiency_coefficient))
    if v.ndim != 1 or v.shape != eta.shape:
        raise InvalidInput(f"sliding_speed and efficiency_coefficient must be rows of runs, got {v.shape}, {eta.shape}")
    if v.size < MINIMUM_RUNS:
        raise InvalidInput(f"an efficiency line needs at least {MINIMUM_RUNS} runs, got {v.size}")
    middle = float(v.mean())
    spread = float(np.sum((v - middle) ** 2))
    if spread <= 1e-12 * v.size * middle**2:
        raise InvalidInput(f"all runs are at {middle:.4g} m/s: a line over speed needs at least two speeds")
    slope = float((v - middle) @ eta) / spread
    intercept = float(eta.mean()) - slope * middle
    deviation = float(np.sqrt(np.sum((eta - intercept - slope * v) ** 2) / (v.size - 2)))
    return EfficiencyFit(
        line=EfficiencyLine(slope=slope, intercept=intercept),
        runs=v.size,
        lowest_speed=float(v.min()),
        highest_speed=float(v.max()),
        mean_speed=middle,
        speed_sum_of_squares=spread,
        efficiency_deviation=deviation,
        slope_uncertainty=deviation / np.sqrt(spread),
        intercept_uncertainty=deviation * float(np.sqrt(1 / v.size + middle**2 / spread)),
    )


def efficiency_confidence_band(
    fit: EfficiencyFit, *, sliding_speed: ArrayLike, confidence_level: float = 0.95
) -> tuple[Floats, Floats]:
    """Return between what the line itself lies at a speed. [m2/N]

    Parameters
    ----------
    fit : EfficiencyFit
    sliding_speed : array_like, any shape
        Speed of the sliding. [m/s]
    confidence_level : float
        Probability with which the band holds the true line there. []

    Returns
    -------
    pair of ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If the level lies outside 0 to 1.
    OutsideRange
        If a speed is none that the runs cover.
    """
    v = require_fitted_speed(fit, sliding_speed=sliding_speed)
    return _band(fit, v, confidence_level, _line_error(fit, v))


def efficiency_prediction_band(
    fit: EfficiencyFit, *, sliding_speed: ArrayLike, confidence_level: float = 0.95
) -> tuple[Floats, Floats]:
    """Return between what the efficiency of one more run lies at a speed. [m2/N]

    Parameters
    ----------
    fit : EfficiencyFit
    sliding_speed : array_like, any shape
        Speed of the sliding. [m/s]
    confidence_level : float
        Probability with which the band holds that run. []

    Returns
    -------
    pair of ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If the level lies outside 0 to 1.
    OutsideRange
        If a speed is none that the runs cover.
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
    """Return the power that brings friction down to a wanted force in one more run, with its interval.

    Parameters
    ----------
    fit : EfficiencyFit
    intrinsic_friction_force : float
        Friction without vibration. [N]
    reduced_friction_force : float
        Friction wanted, at most the intrinsic one. [N]
    sliding_speed : float
        Speed of the sliding. [m/s]
    nominal_area : float
        Nominal contact area. [m2]
    normal_load : float
        Force pressing the bodies together. [N]
    confidence_level : float
        Probability with which the interval holds the power that run needs. []

    Returns
    -------
    PowerEstimate

    Raises
    ------
    InvalidInput
        If a speed, area or load is not positive, or the wanted friction negative or above the intrinsic one.
    OutsideRange
        If the speed is none that the runs cover, or the line has fallen to zero there.

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
    middle = float(efficiency_at(fit.line, sliding_speed=v))
    return PowerEstimate(
        actuator_power=power,
        lowest_power=power * middle / high,
        highest_power=power * middle / low if low > 0 else None,
    )


def require_fitted_speed(fit: EfficiencyFit, *, sliding_speed: ArrayLike) -> Floats:
    """Return speeds as an array; refuse any slower or faster than all runs of the fit. [m/s]

    Parameters
    ----------
    fit : EfficiencyFit
    sliding_speed : array_like, any shape
        Speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    OutsideRange
        Naming the range of the runs.
    """
    v = require_non_negative(sliding_speed=sliding_speed)
    beyond = (v < fit.lowest_speed * (1 - 1e-9)) | (v > fit.highest_speed * (1 + 1e-9))
    if np.any(beyond):
        raise OutsideRange(
            f"sliding_speed must lie within the runs, {fit.lowest_speed:.4g} to {fit.highest_speed:.4g} m/s, got"
            f" {float(v[beyond].flat[0]):.4g} m/s: measure there, the line is not to be carried on"
        )
    return v


def _line_error(fit: EfficiencyFit, v: Floats) -> Floats:
    """Return the standard error of the line at speeds."""
    return fit.efficiency_deviation * np.sqrt(1 / fit.runs + (v - fit.mean_speed) ** 2 / fit.speed_sum_of_squares)


def _band(fit: EfficiencyFit, v: Floats, confidence_level: float, error: Floats) -> tuple[Floats, Floats]:
    level = float(require_within(0.0, 1.0, confidence_level=confidence_level))
    middle = fit.line.slope * v + fit.line.intercept
    reach = float(stdtrit(fit.runs - 2, (1 + level) / 2)) * error
    return middle - reach, middle + reach
