"""The voltage that brings friction down to what is wanted."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.design.optimisation.requirements import Limits
from sonolube.rig import point_batch
from sonolube.rig.driven_rig import DrivenRig, driven_rig
from sonolube.rig.excitation import voltage_range
from sonolube.rig.record import Rig

HIGHEST_SWING = 200.0
"""Swing beyond which no voltage is tried where neither stack nor amplifier has a limit. [V]"""

_LEVELS, _SECANTS = 24, 2
_LOWEST = 2e-3  # of the highest swing, at which hardly any friction is lost
_ROUNDS = 40
_CLOSE = 1e-7  # relative error of the voltage


def highest_swing(rig: Rig, limits: Limits) -> float:
    """Return the largest swing that stack and amplifier bear, offset included, in V."""
    rig = driven_rig(rig)
    drive, stack = rig.drive, rig.stack
    ends = voltage_range(drive, voltage_peak_to_peak=1.0, voltage_offset=drive.offset_ratio)
    low, high = (float(end) for end in ends)
    found = [HIGHEST_SWING] if stack.highest_voltage is None and limits.voltage_maximum is None else []
    if stack.highest_voltage is not None and high > 0:
        found.append(stack.highest_voltage / high)
    if stack.lowest_voltage is not None and low < 0:
        found.append(stack.lowest_voltage / low)
    if limits.voltage_maximum is not None:
        found.append(limits.voltage_maximum / max(abs(low), abs(high)))
    return max(min(found, default=HIGHEST_SWING), 0.0) * (1 - 1e-9)


def swings_for_ratio(rig: Rig, limits: Limits, *, frequency: ArrayLike, friction_ratio: float) -> Floats:
    """Return the least swing that brings friction down to a ratio at each frequency, to about 1e-3.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    limits : Limits
        Those of the amplifier bound the swing.
    frequency : array_like, shape (n,)
        Frequencies of the drive. [Hz]
    friction_ratio : float
        Friction with vibration over friction without, to be had. []

    Returns
    -------
    ndarray, shape (n,)
        In V; NaN where no swing within the limits gives the ratio.

    Notes
    -----
    Friction over 24 swings in even ratios, then false position between two over the logarithm of the swing, twice.
    """
    rig = driven_rig(rig)
    f = np.atleast_1d(np.asarray(frequency, dtype=float))
    top = highest_swing(rig, limits)
    if top <= 0:
        return np.full(f.shape, np.nan)
    levels = np.log(np.geomspace(_LOWEST * top, top, _LEVELS))
    ratios = _ratios(rig, f[:, np.newaxis], np.exp(levels))
    reached = ratios <= friction_ratio
    first = np.argmax(reached, axis=1)
    found = np.full(f.shape, np.nan)
    rows = np.flatnonzero(reached.any(axis=1) & np.isfinite(ratios[:, 0]))
    place = np.maximum(first[rows], 1)
    low, high = levels[place - 1], levels[place]
    above, below = ratios[rows, place - 1] - friction_ratio, ratios[rows, place] - friction_ratio
    guess = low
    for turn in range(_SECANTS + 1):
        with np.errstate(invalid="ignore", divide="ignore"):
            share = np.clip(above / (above - below), 0, 1)
        guess = low + np.where(np.isfinite(share), share, 1.0) * (high - low)
        if turn == _SECANTS or not rows.size:
            break
        value = _ratios(rig, f[rows], np.exp(guess)) - friction_ratio
        left = value > 0
        low, above = np.where(left, guess, low), np.where(left, value, above)
        high, below = np.where(left, high, guess), np.where(left, below, value)
    found[rows] = np.exp(guess)
    return found


def exact_swing(rig: Rig, *, frequency: float, friction_ratio: float, near: float, highest: float) -> float:
    """Return the swing at which friction falls to a ratio, to 1e-7 of it, in V.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.
    frequency : float
        Frequency of the drive. [Hz]
    friction_ratio : float
        Friction with vibration over friction without, to be had. []
    near : float
        Swing to start from, in V.
    highest : float
        Largest swing to try, in V.

    Returns
    -------
    float
        NaN where it is out of reach.
    """
    rig = driven_rig(rig)

    def miss(log_swing: float) -> float:
        return float(_ratios(rig, np.array([frequency]), np.array([np.exp(log_swing)]))[0]) - friction_ratio

    low, high = np.log(near), np.log(near)
    above = below = miss(low)
    step, lowest, top = 0.05, np.log(_LOWEST * highest), np.log(highest)
    while not above > 0 and low > lowest:
        low, step = max(low - step, lowest), 2 * step
        above = miss(low)
    step = 0.05
    while not below <= 0 and high < top:
        high, step = min(high + step, top), 2 * step
        below = miss(high)
    if not (above > 0 >= below):
        return float("nan")
    return float(np.exp(_crossing(miss, low, high, above, below)))


def _crossing(miss: Callable[[float], float], low: float, high: float, above: float, below: float) -> float:
    """Return where a falling function crosses nought, by regula falsi in the Illinois variant."""
    last = 0
    for _ in range(_ROUNDS):
        if high - low < _CLOSE:
            break
        guess = low + (high - low) * np.clip(above / (above - below), 1e-3, 1 - 1e-3)
        value = miss(guess)
        if value > 0:
            low, above = guess, value
            below = below / 2 if last == 1 else below
            last = 1
        else:
            high, below = guess, value
            above = above / 2 if last == -1 else above
            last = -1
        if abs(value) < 1e-9:
            return float(guess)
    return high


def _ratios(rig: DrivenRig, frequency: Floats, swing: Floats) -> Floats:
    f, volts = np.broadcast_arrays(frequency, swing)
    found = point_batch(rig, frequency=f, voltage_peak_to_peak=volts, voltage_offset=rig.drive.offset_ratio * volts)
    return np.asarray(found.numbers["friction_ratio"].reshape(f.shape))
