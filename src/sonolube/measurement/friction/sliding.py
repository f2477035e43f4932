"""Rest and sliding in a friction recording, by a speed, by the motor as set, or by the force without vibration."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from sonolube.checks import Floats

Mask = NDArray[np.bool_]

NOISE_VOLTAGE = 0.05
"""Voltage up to which it is noise of its channel. [V]"""

_MOVES = 0.05  # of the highest speed, above which the surfaces slide
_REVERSAL = 0.2  # s, up to which a low speed is the reversal of a stroke
_SECTION = 0.05  # s, over which medians of the force are taken
_SECTIONS = 5  # of whose states the median counts
_AT_REST = 0.5  # of the level without voltage, below which the force is that of rest
_LEVEL = 90  # percentile of the sections that is the level: most of a recording may be rest


def at_rest(
    *,
    time: Floats,
    friction_force: Floats,
    voltage_peak_to_peak: Floats | None = None,
    sliding_speed: Floats | None = None,
    tolerance: float = 0.05,
) -> Mask:
    """Whether the surfaces rest at each sample: by the speed where it is known, else by the force without vibration.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        Increasing. [s]
    friction_force : ndarray, shape (samples,)
        NaN is left out. [N]
    voltage_peak_to_peak : ndarray, shape (samples,), or None
        [V]
    sliding_speed : ndarray, shape (samples,), or None
        Measured or set, or in proportion to it. [m/s]
    tolerance : float
        Of the range of the voltage, up to which there is none; 50 mV at least.

    Returns
    -------
    ndarray of bool, shape (samples,)
        False everywhere where neither speed nor voltage are known.
    """
    unknown = np.ones(time.size, bool) if sliding_speed is None else ~np.isfinite(sliding_speed)
    rest = np.zeros(time.size, bool)
    if sliding_speed is not None and not unknown.all():
        rest = rest_by_speed(time=time, speed=sliding_speed)
    if voltage_peak_to_peak is not None and unknown.any():
        without = np.nan_to_num(voltage_peak_to_peak) <= voltage_threshold(
            voltage_peak_to_peak=voltage_peak_to_peak, tolerance=tolerance
        )
        rest |= unknown & rest_by_force(time=time, friction_force=friction_force, without_voltage=without)
    return rest


def voltage_threshold(*, voltage_peak_to_peak: Floats, tolerance: float) -> float:
    """Voltage up to which there is none, and change of it that begins another step: of its range, or of noise, in V.

    50 mV at least.
    """
    return max(tolerance * float(np.nanmax(voltage_peak_to_peak) - np.nanmin(voltage_peak_to_peak)), NOISE_VOLTAGE)


def rest_by_speed(*, time: Floats, speed: Floats) -> Mask:
    """Whether the surfaces rest, by a speed that was measured or set.

    Below a twentieth of the highest speed for over 0.2 s: a stroke that turns back rests for less.
    """
    size = np.abs(speed)
    highest = float(np.nanmax(size)) if np.isfinite(size).any() else 0.0
    slow = size <= _MOVES * highest
    for first, last in stretches(slow):
        if highest and first > 0 and last < time.size and time[last] - time[first] <= _REVERSAL:
            slow[first:last] = False
    return np.asarray(slow)


def rest_by_force(*, time: Floats, friction_force: Floats, without_voltage: Mask) -> Mask:
    """Whether the surfaces rest, by the force where there is no vibration.

    Without voltage and below half of the level there, the 90th percentile of medians over 50 ms. No rest where that
    level is not positive.

    A force that stays when the motor stops, as a holder under tension keeps it, is not told from sliding: that needs a
    speed.
    """
    size = max(1, round(_SECTION / float(np.median(np.diff(time)))))
    starts = np.arange(0, time.size, size)
    known = np.where(without_voltage, friction_force, np.nan)
    sections = [part[np.isfinite(part)] for part in np.split(known, starts[1:])]
    medians = np.array([np.median(part) if part.size else np.nan for part in sections])
    is_known = np.isfinite(medians)
    level = float(np.percentile(medians[is_known], _LEVEL)) if is_known.any() else 0.0
    if level <= 0:
        return np.zeros(time.size, bool)
    low = np.zeros(medians.size, bool)
    low[is_known] = median_filter((medians[is_known] < _AT_REST * level).astype(np.int8), _SECTIONS) > 0
    return np.asarray(np.repeat(low, size)[: time.size] & without_voltage)


def stretches(mask: Mask) -> list[tuple[int, int]]:
    """First sample of each stretch in which a mask holds, and the sample after its last one."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(first), int(last)) for first, last in list(pairwise(edges))[::2]]
