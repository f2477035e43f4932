"""Voltage and power for a given friction ratio over drive frequency, by regula falsi."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive, require_within
from sonolube.rig.datasets import Dataset, gridded
from sonolube.rig.operating_point_grid import Advance, OperatingPoints, operating_points
from sonolube.rig.power import POWERS
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, amplitude_labels, resolved_rig

OUT_OF_REACH = "out_of_reach"
"""Status of a frequency at which the highest voltage does not bring friction down to the ratio."""

_LOWEST = 1e-4  # of the highest voltage, at which no friction is lost
_ROUNDS = 40
_CLOSE = 1e-4  # relative error of the voltage


def least_power_study(
    rig: Rig | ResolvedRig,
    *,
    frequency: ArrayLike,
    friction_ratio: float,
    voltage_maximum: float = 200.0,
    advance: Advance | None = None,
) -> Dataset:
    """Drive voltage and power at which friction falls to a ratio, at each drive frequency.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack, a structure and a drive voltage.
    frequency : array_like, shape (n,)
        Frequencies of the drive. [Hz]
    friction_ratio : float
        Friction with vibration over friction without, to be reached. []
    voltage_maximum : float
        Highest peak-to-peak voltage to try; the offset keeps the rig's ratio to it. [V]
    advance : callable, optional
        Called with the number of iterations done, and their maximum.

    Returns
    -------
    xarray.Dataset
        Over `frequency`; where the ratio is out of reach the numbers are NaN, beside a status and a reason.

    Raises
    ------
    InvalidInput
        If the rig has no structure, a frequency or voltage is not positive, or the ratio does not lie between 0 and 1.

    Notes
    -----
    By regula falsi (the Illinois variant) on the logarithm of the voltage, to a relative error of 1e-4. Takes friction
    to fall as the voltage rises; of a friction model by which it rises again, any
    voltage that gives the ratio may be found.

    References
    ----------
    .. [1] D 3.3.5, figure 3.17 (b).
    """
    resolved = resolved_rig(rig)
    rig = resolved.moved
    f = np.atleast_1d(require_positive(frequency=frequency))
    target = float(require_within(0.0, 1.0, friction_ratio=friction_ratio))
    highest = float(require_positive(voltage_maximum=voltage_maximum))
    top = _points(resolved, f, np.full(f.shape, highest))
    reached = top.friction_ratio <= target
    log_volts = np.full(f.shape, np.log(highest))
    log_volts[reached] = _search(resolved, f[reached], target, top.friction_ratio[reached], np.log(highest), advance)
    found = _points(resolved, f, np.exp(log_volts))
    missed, reached = ~reached & ~top.failed, reached & ~found.failed
    numbers = {
        name: np.where(reached, getattr(found, name), np.nan)
        for name in ("voltage_peak_to_peak", "friction_ratio", "vibration_amplitude", *POWERS)
    }
    status, reason = found.status.astype(object), found.reason.astype(object)
    status[missed] = OUT_OF_REACH
    reason[missed] = f"out_of_reach: {highest:g} V does not reduce friction that far; drive nearer to a resonance"
    return gridded(
        {"status": status.astype(np.str_), "reason": reason.astype(np.str_)} | numbers,
        axes={"frequency": f},
        title=f"Voltage and power for a friction ratio of {target:g}, {rig.title}",
        about={"rig": rig.title, "friction_model": rig.friction_model.name} | amplitude_labels(resolved),
    )


def _search(
    resolved: ResolvedRig, f: Floats, target: float, at_top: Floats, top: float, advance: Advance | None
) -> Floats:
    """Logarithm of the voltage that gives the friction ratio at each frequency, by the Illinois method."""
    low, high = np.full(f.shape, top + np.log(_LOWEST)), np.full(f.shape, top)
    above, below = np.full(f.shape, 1.0) - target, at_top - target
    last = np.zeros(f.shape)
    for done in range(_ROUNDS):
        going = np.flatnonzero(high - low > _CLOSE)
        if advance is not None:
            advance(done if going.size else _ROUNDS, _ROUNDS)
        if not going.size:
            break
        span, a, b = high[going] - low[going], above[going], below[going]
        guess = low[going] + span * np.clip(a / (a - b), _CLOSE / 3, 1 - _CLOSE / 3)
        miss = _points(resolved, f[going], np.exp(guess)).raw_friction_ratio - target
        left = miss > 0
        low[going], high[going] = np.where(left, guess, low[going]), np.where(left, high[going], guess)
        # Illinois: the value at an end that stays twice is halved
        above[going] = np.where(left, miss, np.where(last[going] == -1, a / 2, a))
        below[going] = np.where(left, np.where(last[going] == 1, b / 2, b), miss)
        last[going] = np.where(left, 1, -1)
    return high


def _points(resolved: ResolvedRig, f: Floats, volts: Floats) -> OperatingPoints:
    offset = resolved.voltage.drive.offset_ratio * volts
    return operating_points(resolved, frequency=f, voltage_peak_to_peak=volts, voltage_offset=offset)
