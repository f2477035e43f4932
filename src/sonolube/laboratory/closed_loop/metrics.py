"""Figures of merit of friction held in closed loop, from one change of speed to the next."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.laboratory.closed_loop.record import HeldFriction

_SETTLED = 2.0  # deviations of the scatter
_FINAL_FRACTION = 2  # the last half of a phase is its steady part


@dataclass(frozen=True, kw_only=True, slots=True)
class HoldMetrics:
    """Figures of merit of friction held at one sliding speed.

    Parameters
    ----------
    start_time : float
        When the speed was set. [s]
    sliding_speed : float
        [m/s]
    friction_force : float
        Mean over the last half of the phase. [N]
    tracking_error : float
        Root mean square of friction less reference over that half. [N]
    scatter : float
        Standard deviation of the friction over that half, in N.
    settling_time : float or None
        After which the friction stays within two deviations of the scatter of its reference, but for one interval in
        twenty; None where it does not. [s]
    voltage_peak_to_peak : float
        Mean over the last half. [V]
    saturated_fraction : float
        Share of the intervals of the phase at the highest voltage or at none.
    """

    start_time: float
    sliding_speed: float
    friction_force: float
    tracking_error: float
    scatter: float
    settling_time: float | None
    voltage_peak_to_peak: float
    saturated_fraction: float


def hold_metrics(record: HeldFriction) -> tuple[HoldMetrics, ...]:
    """Figures of merit from one change of speed to the next.

    Parameters
    ----------
    record : HeldFriction

    Returns
    -------
    tuple of HoldMetrics
        One for each speed that was reached.

    Raises
    ------
    InvalidInput
        If the controller never took over.
    """
    if record.time.size == 0:
        raise InvalidInput(f"the controller never took over: {record.reason}")
    changes = np.flatnonzero(np.diff(record.sliding_speed)) + 1
    edges = [0, *changes.tolist(), record.time.size]
    return tuple(_phase(record, slice(a, b)) for a, b in pairwise(edges))


def _phase(record: HeldFriction, part: slice) -> HoldMetrics:
    """Figures of merit of one phase."""
    force, volts = record.friction_force[part], record.voltage_peak_to_peak[part]
    time, error = record.time[part], force - record.setpoint[part]
    last = slice(-max(force.size // _FINAL_FRACTION, 1), None)
    scatter = float(np.std(force[last]))
    saturated = (volts >= record.hold.controller.level_maximum * (1 - 1e-9)) | (volts <= 0)
    return HoldMetrics(
        start_time=float(time[0]),
        sliding_speed=float(record.sliding_speed[part][0]),
        friction_force=float(np.mean(force[last])),
        tracking_error=float(np.sqrt(np.mean(error[last] ** 2))),
        scatter=scatter,
        settling_time=_settling_time(time - time[0], np.abs(error) > _SETTLED * scatter),
        voltage_peak_to_peak=float(np.mean(volts[last])),
        saturated_fraction=float(np.mean(saturated)),
    )


def _settling_time(time: "np.ndarray", outside: "np.ndarray") -> float | None:
    """First time from which on at most one entry in twenty lies outside."""
    later = np.cumsum(outside[::-1])[::-1]
    remaining = np.arange(time.size, 0, -1)
    settled = np.flatnonzero(~outside & (later <= np.maximum(remaining / 20, 1)) & (remaining >= 5))
    return float(time[settled[0]]) if settled.size else None
