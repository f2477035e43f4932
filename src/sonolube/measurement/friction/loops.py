"""Frictional work and friction loops: force over velocity integrated along a recording and per cycle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.time_series import require_time_series

_HYSTERESIS = 0.1  # of the peak velocity, which both sides of a reversal must exceed


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrictionWork:
    """Frictional power and cumulative work along a recording.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        As given. [s]
    frictional_power : ndarray, shape (samples,)
        Friction force times velocity; NaN where either is missing. [W]
    frictional_work : ndarray, shape (samples,)
        Cumulative work since the first sample. [J]
    sliding_distance : float
        Total distance, irrespective of direction, where both signals are known. [m]
    friction_force : float
        Work over distance. [N]
    measured_fraction : float
        Fraction of the time in which both signals are known; the work of the rest is not included.
    """

    time: Floats
    frictional_power: Floats
    frictional_work: Floats
    sliding_distance: float
    friction_force: float
    measured_fraction: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrictionLoops:
    """Frictional work of each cycle of a reciprocating motion.

    Parameters
    ----------
    start_time : ndarray, shape (cycles,)
        Time at which the velocity turns positive. [s]
    end_time : ndarray, shape (cycles,)
        Time at which it does so again. [s]
    frictional_work : ndarray, shape (cycles,)
        Area of the loop of force over displacement; a constant offset of the force cancels. [J]
    sliding_distance : ndarray, shape (cycles,)
        Path length of the cycle, forth and back. [m]
    friction_force : ndarray, shape (cycles,)
        Work over distance. [N]
    measured_fraction : ndarray, shape (cycles,)
        Fraction of the cycle in which force and velocity are known.
    """

    start_time: Floats
    end_time: Floats
    frictional_work: Floats
    sliding_distance: Floats
    friction_force: Floats
    measured_fraction: Floats


def friction_work(*, time: ArrayLike, friction_force: ArrayLike, relative_velocity: ArrayLike) -> FrictionWork:
    r"""Frictional power and cumulative work along a recording.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    friction_force : array_like, shape (samples,)
        Opposes the motion where it has the sign of the velocity; NaN where missing. [N]
    relative_velocity : array_like, shape (samples,)
        Along the sliding direction; NaN where missing. [m/s]

    Returns
    -------
    FrictionWork

    Raises
    ------
    InvalidInput
        If the time does not increase, a signal is all missing, or there is no sliding.

    See Also
    --------
    friction_loops : the work of each cycle.

    Notes
    -----
    .. math:: W(t) = \int_{t_0}^{t} F_t\, v\, dt' , \qquad \bar F_t = \frac{W}{\int |v|\, dt'} ,

    by the trapezoidal rule.

    References
    ----------
    .. [1] D 4.5.4, figure 4.57 (f).
    """
    t, f, v = require_time_series(time=time, friction_force=friction_force, relative_velocity=relative_velocity)
    work, distance, known_time = _cumulative_integrals(t, f, v)
    if distance[-1] <= 0:
        raise InvalidInput("relative_velocity is zero wherever the friction is known")
    return FrictionWork(
        time=t,
        frictional_power=f * v,
        frictional_work=work,
        sliding_distance=float(distance[-1]),
        friction_force=float(work[-1] / distance[-1]),
        measured_fraction=float(known_time[-1] / (t[-1] - t[0])),
    )


def friction_loops(*, time: ArrayLike, friction_force: ArrayLike, relative_velocity: ArrayLike) -> FrictionLoops:
    r"""Frictional work of each whole cycle of a reciprocating motion.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    friction_force : array_like, shape (samples,)
        Opposes the motion where it has the sign of the velocity; NaN where missing. [N]
    relative_velocity : array_like, shape (samples,)
        Along the sliding direction. [m/s]

    Returns
    -------
    FrictionLoops

    Raises
    ------
    InvalidInput
        If the time does not increase, a signal is all missing, or the velocity does not turn positive twice.

    See Also
    --------
    friction_work : the cumulative work of the whole recording.

    Notes
    -----
    .. math:: W = \oint F_t\, v\, dt = \oint F_t\, dx ,

    by the trapezoidal rule, with the interpolated instants of reversal inserted between the samples. A reversal counts
    where the velocity passes from below -10 % to above 10 % of its peak.
    """
    t, f, v = require_time_series(time=time, friction_force=friction_force, relative_velocity=relative_velocity)
    reversals = _positive_reversals(t, v)
    if reversals.size < 2:
        raise InvalidInput(f"relative_velocity turns positive {reversals.size} times; a cycle needs two")
    all_t = np.concatenate([t, reversals])
    order = np.argsort(all_t, kind="stable")
    f_at_reversals = np.interp(reversals, t, f)
    work, distance, known_time = _cumulative_integrals(
        all_t[order], np.concatenate([f, f_at_reversals])[order], np.concatenate([v, np.zeros(reversals.size)])[order]
    )
    at = np.flatnonzero(order >= t.size)
    loop_area, path_length = np.diff(work[at]), np.diff(distance[at])
    return FrictionLoops(
        start_time=reversals[:-1],
        end_time=reversals[1:],
        frictional_work=loop_area,
        sliding_distance=path_length,
        friction_force=np.divide(loop_area, path_length, out=np.full(loop_area.size, np.nan), where=path_length > 0),
        measured_fraction=np.diff(known_time[at]) / np.diff(reversals),
    )


def _positive_reversals(t: Floats, v: Floats) -> Floats:
    """Interpolated times at which the velocity turns positive, with hysteresis."""
    threshold = _HYSTERESIS * float(np.nanmax(np.abs(v)))
    fast = np.flatnonzero(np.abs(v) > threshold)
    rises = np.flatnonzero((v[fast[:-1]] < 0) & (v[fast[1:]] > 0))
    reversals = []
    for before, after in zip(fast[rises], fast[rises + 1], strict=True):
        part = v[before : after + 1]
        last = int(before + np.flatnonzero(part < 0)[-1])
        following = int(last + 1 + np.argmax(np.isfinite(v[last + 1 : after + 1])))
        reversals.append(t[last] - v[last] * (t[following] - t[last]) / (v[following] - v[last]))
    return np.array(reversals)


def _cumulative_integrals(t: Floats, f: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Cumulative work, distance and known time; intervals with a missing value contribute nothing."""
    power, speed, step = f * v, np.abs(v), np.diff(t)
    known = np.isfinite(power[1:]) & np.isfinite(power[:-1])
    parts = step * (power[1:] + power[:-1]) / 2, step * (speed[1:] + speed[:-1]) / 2, step
    sums = np.cumsum(np.where(known, np.stack(parts), 0.0), axis=1)
    work, distance, known_time = np.concatenate([np.zeros((3, 1)), sums], axis=1)
    return work, distance, known_time
