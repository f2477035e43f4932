"""Friction over velocity: the work it takes, in all and cycle by cycle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.time_series import require_time_series

_HYSTERESIS = 0.1  # of the highest velocity, which a reversal must exceed to count


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrictionWork:
    """Work of friction along a recording.

    Parameters
    ----------
    time : ndarray, shape (samples,)
        As given. [s]
    frictional_power : ndarray, shape (samples,)
        Friction times velocity; NaN where either is missing. [W]
    frictional_work : ndarray, shape (samples,)
        Since the first sample. [J]
    sliding_distance : float
        Slid in all, whatever the direction, where both are known. [m]
    friction_force : float
        Work over distance. [N]
    measured_fraction : float
        Share of the time in which both are known; the work of the rest is missing.
    """

    time: Floats
    frictional_power: Floats
    frictional_work: Floats
    sliding_distance: float
    friction_force: float
    measured_fraction: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FrictionLoops:
    """Work of friction in each cycle of a reciprocating motion.

    Parameters
    ----------
    start_time : ndarray, shape (cycles,)
        When the velocity turns positive. [s]
    end_time : ndarray, shape (cycles,)
        When it does so again. [s]
    frictional_work : ndarray, shape (cycles,)
        Area of the loop over displacement; a zero error of the force drops out. [J]
    sliding_distance : ndarray, shape (cycles,)
        There and back. [m]
    friction_force : ndarray, shape (cycles,)
        Work over distance. [N]
    measured_fraction : ndarray, shape (cycles,)
        Share of the cycle in which force and velocity are known.
    """

    start_time: Floats
    end_time: Floats
    frictional_work: Floats
    sliding_distance: Floats
    friction_force: Floats
    measured_fraction: Floats


def friction_work(*, time: ArrayLike, friction_force: ArrayLike, relative_velocity: ArrayLike) -> FrictionWork:
    """Return the work that friction takes along a recording.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    friction_force : array_like, shape (samples,)
        Against the motion where it has the sign of the velocity; NaN where missing. [N]
    relative_velocity : array_like, shape (samples,)
        Along the sliding; NaN where missing. [m/s]

    Returns
    -------
    FrictionWork

    Raises
    ------
    InvalidInput
        If the time does not increase, a signal is all missing, or nothing slides.

    References
    ----------
    .. [1] D 4.5.4, figure 4.57 (f).
    """
    t, f, v = require_time_series(time=time, friction_force=friction_force, relative_velocity=relative_velocity)
    work, distance, known = _sums(t, f, v)
    if distance[-1] <= 0:
        raise InvalidInput("relative_velocity is zero wherever the friction is known")
    return FrictionWork(
        time=t,
        frictional_power=f * v,
        frictional_work=work,
        sliding_distance=float(distance[-1]),
        friction_force=float(work[-1] / distance[-1]),
        measured_fraction=float(known[-1] / (t[-1] - t[0])),
    )


def friction_loops(*, time: ArrayLike, friction_force: ArrayLike, relative_velocity: ArrayLike) -> FrictionLoops:
    """Return the work of friction in each whole cycle of a reciprocating motion.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    friction_force : array_like, shape (samples,)
        Against the motion where it has the sign of the velocity; NaN where missing. [N]
    relative_velocity : array_like, shape (samples,)
        Along the sliding. [m/s]

    Returns
    -------
    FrictionLoops

    Raises
    ------
    InvalidInput
        If the time does not increase, a signal is all missing, or the velocity does not turn positive twice.

    Notes
    -----
    Integrated by trapezia between samples, with the instants of reversal put between them. A reversal counts where
    the velocity passes from below -10 % to above 10 % of its highest.
    """
    t, f, v = require_time_series(time=time, friction_force=friction_force, relative_velocity=relative_velocity)
    turns = _turns_positive(t, v)
    if turns.size < 2:
        raise InvalidInput(f"relative_velocity turns positive {turns.size} times; a cycle needs two")
    all_t = np.concatenate([t, turns])
    order = np.argsort(all_t, kind="stable")
    at_turns = np.interp(turns, t, f)
    work, distance, known = _sums(
        all_t[order], np.concatenate([f, at_turns])[order], np.concatenate([v, np.zeros(turns.size)])[order]
    )
    at = np.flatnonzero(order >= t.size)
    area, slid = np.diff(work[at]), np.diff(distance[at])
    return FrictionLoops(
        start_time=turns[:-1],
        end_time=turns[1:],
        frictional_work=area,
        sliding_distance=slid,
        friction_force=np.divide(area, slid, out=np.full(area.size, np.nan), where=slid > 0),
        measured_fraction=np.diff(known[at]) / np.diff(turns),
    )


def _turns_positive(t: Floats, v: Floats) -> Floats:
    limit = _HYSTERESIS * float(np.nanmax(np.abs(v)))
    decided = np.flatnonzero(np.abs(v) > limit)
    rises = np.flatnonzero((v[decided[:-1]] < 0) & (v[decided[1:]] > 0))
    turns = []
    for before, after in zip(decided[rises], decided[rises + 1], strict=True):
        stretch = v[before : after + 1]
        last = int(before + np.flatnonzero(stretch < 0)[-1])
        following = int(last + 1 + np.argmax(np.isfinite(v[last + 1 : after + 1])))
        turns.append(t[last] - v[last] * (t[following] - t[last]) / (v[following] - v[last]))
    return np.array(turns)


def _sums(t: Floats, f: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Work, distance and known time since the first sample; unknown stretches add nothing."""
    power = f * v
    step = np.diff(t)
    known = np.isfinite(power[1:]) & np.isfinite(power[:-1])
    speed = np.abs(v)
    parts = (
        np.where(known, step * (power[1:] + power[:-1]) / 2, 0.0),
        np.where(known, step * (speed[1:] + speed[:-1]) / 2, 0.0),
        np.where(known, step, 0.0),
    )
    work, distance, time = (np.concatenate([[0.0], np.cumsum(part)]) for part in parts)
    return work, distance, time
