"""Drive voltage required for a target friction ratio: scan over voltages, and root finding by the Illinois method."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.design.optimisation.requirements import Limits
from sonolube.rig import point_batch
from sonolube.rig.driven_rig import DrivenRig, driven_rig
from sonolube.rig.excitation import DriveVoltage
from sonolube.rig.record import Rig

DEFAULT_MAXIMUM_SWING = 200.0
"""Highest peak-to-peak voltage that is tried where neither stack nor amplifier limits it. [V]"""

_LEVELS, _SECANT_STEPS = 24, 2
_LOWEST = 2e-3  # of the highest swing, where friction is hardly reduced
_MAX_STEPS = 40
_LOG_TOLERANCE = 1e-7  # of the logarithm of the voltage
_RATIO_TOLERANCE = 1e-9  # of the friction ratio
_FIRST_BRACKET = 0.05  # in the logarithm of the voltage; doubled until the root is bracketed


def maximum_swing(rig: Rig, limits: Limits) -> float:
    """Highest peak-to-peak voltage (swing) within the limits of stack and amplifier, offset included, in V.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    limits : Limits

    Returns
    -------
    float
    """
    rig = replace(driven_rig(rig), amplitude_source="computed")
    drive, stack = rig.drive, rig.stack
    ends = DriveVoltage(drive=drive).range(voltage_peak_to_peak=1.0, voltage_offset=drive.offset_ratio)
    low, high = (float(end) for end in ends)
    bounds = [DEFAULT_MAXIMUM_SWING] if stack.highest_voltage is None and limits.voltage_maximum is None else []
    if stack.highest_voltage is not None and high > 0:
        bounds.append(stack.highest_voltage / high)
    if stack.lowest_voltage is not None and low < 0:
        bounds.append(stack.lowest_voltage / low)
    if limits.voltage_maximum is not None:
        bounds.append(limits.voltage_maximum / max(abs(low), abs(high)))
    return max(min(bounds, default=DEFAULT_MAXIMUM_SWING), 0.0) * (1 - 1e-9)


def estimate_swings(rig: Rig, limits: Limits, *, frequency: ArrayLike, friction_ratio: float) -> Floats:
    """Lowest peak-to-peak voltage for a target friction ratio at each frequency, to about 1e-3 of the ratio.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    limits : Limits
        Those of the amplifier bound the voltage.
    frequency : array_like, shape (n,)
        Drive frequencies. [Hz]
    friction_ratio : float
        Target of friction with vibration over friction without. []

    Returns
    -------
    ndarray, shape (n,)
        In V; NaN where no voltage within the limits gives the ratio.

    See Also
    --------
    refine_swing

    Notes
    -----
    The friction ratio at 24 voltages in geometric sequence brackets the first crossing; two steps of false position
    over the logarithm of the voltage follow.
    """
    rig = replace(driven_rig(rig), amplitude_source="computed")
    f = np.atleast_1d(np.asarray(frequency, dtype=float))
    highest = maximum_swing(rig, limits)
    if highest <= 0:
        return np.full(f.shape, np.nan)
    levels = np.log(np.geomspace(_LOWEST * highest, highest, _LEVELS))
    ratios = _friction_ratios(rig, f[:, np.newaxis], np.exp(levels))
    reached = ratios <= friction_ratio
    first = np.argmax(reached, axis=1)
    swings = np.full(f.shape, np.nan)
    rows = np.flatnonzero(reached.any(axis=1) & np.isfinite(ratios[:, 0]))
    upper = np.maximum(first[rows], 1)
    low, high = levels[upper - 1], levels[upper]
    above, below = ratios[rows, upper - 1] - friction_ratio, ratios[rows, upper] - friction_ratio
    estimate = low
    for step in range(_SECANT_STEPS + 1):
        with np.errstate(invalid="ignore", divide="ignore"):
            fraction = np.clip(above / (above - below), 0, 1)
        estimate = low + np.where(np.isfinite(fraction), fraction, 1.0) * (high - low)
        if step == _SECANT_STEPS or not rows.size:
            break
        residual = _friction_ratios(rig, f[rows], np.exp(estimate)) - friction_ratio
        positive = residual > 0
        low, above = np.where(positive, estimate, low), np.where(positive, residual, above)
        high, below = np.where(positive, high, estimate), np.where(positive, below, residual)
    swings[rows] = np.exp(estimate)
    return swings


def refine_swing(rig: Rig, *, frequency: float, friction_ratio: float, near: float, highest: float) -> float:
    """Peak-to-peak voltage at which a target friction ratio is reached, to a relative tolerance of 1e-7, in V.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    frequency : float
        Drive frequency. [Hz]
    friction_ratio : float
        Target of friction with vibration over friction without. []
    near : float
        Initial estimate, in V.
    highest : float
        Highest voltage to try, in V.

    Returns
    -------
    float
        NaN where the target is out of reach.

    See Also
    --------
    estimate_swings

    Notes
    -----
    The root is bracketed by steps from the initial estimate that double, then found by the Illinois variant of false
    position over the logarithm of the voltage.
    """
    rig = replace(driven_rig(rig), amplitude_source="computed")

    def residual(log_swing: float) -> float:
        ratio = _friction_ratios(rig, np.array([frequency]), np.array([np.exp(log_swing)]))
        return float(ratio[0]) - friction_ratio

    low, high = np.log(near), np.log(near)
    above = below = residual(low)
    step, bottom, top = _FIRST_BRACKET, np.log(_LOWEST * highest), np.log(highest)
    while not above > 0 and low > bottom:
        low, step = max(low - step, bottom), 2 * step
        above = residual(low)
    step = _FIRST_BRACKET
    while not below <= 0 and high < top:
        high, step = min(high + step, top), 2 * step
        below = residual(high)
    if not (above > 0 >= below):
        return float("nan")
    return float(np.exp(_illinois_root(residual, low, high, above, below)))


def _illinois_root(residual: Callable[[float], float], low: float, high: float, above: float, below: float) -> float:
    """Root of a falling function in a bracket by the Illinois variant of false position."""
    last = 0
    for _ in range(_MAX_STEPS):
        if high - low < _LOG_TOLERANCE:
            break
        estimate = low + (high - low) * np.clip(above / (above - below), 1e-3, 1 - 1e-3)
        value = residual(estimate)
        if value > 0:
            low, above = estimate, value
            below = below / 2 if last == 1 else below
            last = 1
        else:
            high, below = estimate, value
            above = above / 2 if last == -1 else above
            last = -1
        if abs(value) < _RATIO_TOLERANCE:
            return float(estimate)
    return high


def _friction_ratios(rig: DrivenRig, frequency: Floats, swing: Floats) -> Floats:
    """Friction ratio of a rig by its model's formula at the broadcast frequencies and peak-to-peak voltages."""
    f, volts = np.broadcast_arrays(frequency, swing)
    points = point_batch(rig, frequency=f, voltage_peak_to_peak=volts, voltage_offset=rig.drive.offset_ratio * volts)
    return np.asarray(points.numbers["raw_friction_ratio"].reshape(f.shape))
