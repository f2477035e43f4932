"""Dahl friction: an elastoplastic bristle whose force depends on the sliding distance and not on the rate.

Along sampled motions, and the mean over the steady period of a vibration with stiffness and limit that follow the
separation.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.execution.compilation import kernel
from sonolube.facts.metrics import peak_vibration_velocity
from sonolube.models.contact.rough import RoughContact, normal_force
from sonolube.models.contact.tangential_stiffness import cube_tangential_stiffness
from sonolube.models.friction.laws.steady_period_kernel import steady_period_mean_force


@dataclass(frozen=True, kw_only=True, slots=True)
class DahlFriction:
    r"""Dahl's law of friction for one contact at a constant normal load.

    Parameters
    ----------
    contact_stiffness : float
        Tangential stiffness of the contact at rest, K. [N/m]
    coulomb_friction_force : float
        Friction force of steady sliding, F_c. [N]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    .. math:: \frac{\mathrm{d}\delta}{\mathrm{d}t} = v \left( 1 - \frac{K \delta}{F_c}\, \mathrm{sgn}\, v \right),
              \qquad F = K \delta \tag{D 1.3}

    with the tangential deformation delta and the sliding velocity v.

    See Also
    --------
    LuGreFriction : The law with Stribeck effect, bristle damping and viscous friction.

    References
    ----------
    .. [1] P. R. Dahl, AIAA J. 14, 1675 (1976). doi:10.2514/3.61511
    """

    contact_stiffness: float
    coulomb_friction_force: float

    def __post_init__(self) -> None:
        require_positive(contact_stiffness=self.contact_stiffness, coulomb_friction_force=self.coulomb_friction_force)


def dahl_friction_history(
    law: DahlFriction, *, time: ArrayLike, relative_velocity: ArrayLike, deformation: ArrayLike = 0.0
) -> Floats:
    """Friction force along sampled motions by Dahl's law. [N]

    Parameters
    ----------
    law : DahlFriction
    time : array_like, shape (n,)
        Increasing times of the samples. [s]
    relative_velocity : array_like, shape (..., n)
        Sliding velocity at these times, interpolated linearly between them. [m/s]
    deformation : array_like, shape (...)
        Tangential deformation of the contact at the first sample. [m]

    Returns
    -------
    ndarray, shape (..., n)

    Raises
    ------
    InvalidInput
        If times do not increase, shapes disagree, or a value is not finite.

    Notes
    -----
    Exact for velocities that are linear between samples, at any step: the law depends on the distance alone, and a step
    in which the velocity changes sign is divided there. The error is that of the sampling, second order in the step.

    See Also
    --------
    dahl_under_vibration : Mean force over the steady period of a vibration.

    References
    ----------
    .. [1] D 1.3.
    """
    times, velocities = _increasing(time), require_finite(relative_velocity=relative_velocity)
    start = require_finite(deformation=deformation)
    K, F_c = law.contact_stiffness, law.coulomb_friction_force
    if velocities.ndim == 0 or velocities.shape[-1] != times.size:
        raise InvalidInput(
            f"relative_velocity must have one value for each of {times.size} times along its last axis,"
            f" got shape {velocities.shape}"
        )
    try:
        rows = np.broadcast_shapes(velocities.shape[:-1], start.shape)
    except ValueError:
        raise InvalidInput(f"{start.shape} starting values do not match {velocities.shape[:-1]} motions") from None
    motions = np.broadcast_to(velocities, (*rows, times.size)).reshape(-1, times.size)
    starts = np.broadcast_to(start, rows).ravel()
    found = [_deformation_history(times, motion, one, K / F_c) for motion, one in zip(motions, starts, strict=True)]
    return K * np.reshape(found, (*rows, times.size))


def _increasing(time: ArrayLike) -> Floats:
    """Sample times as an array; refuse times that do not increase; shape (n,)."""
    times = require_finite(time=time)
    if times.ndim != 1 or times.size < 2:
        raise InvalidInput(f"time must be one-dimensional with at least two samples, got shape {times.shape}")
    steps = np.diff(times)
    if not np.all(steps > 0):
        first = int(np.argmin(steps > 0))
        raise InvalidInput(f"time must increase, got {times[first + 1]!s} s after {times[first]!s} s")
    return times


@kernel(cache=True)
def _deformation_history(times: Floats, velocities: Floats, start: float, rate: float) -> Floats:
    """Deformation along one sampled motion; `rate` is K/F_c."""
    deformation = np.empty_like(velocities)
    deformation[0] = delta = start
    for k in range(times.size - 1):
        step, v0, v1 = times[k + 1] - times[k], velocities[k], velocities[k + 1]
        if v0 * v1 < 0:
            reversal = step * v0 / (v0 - v1)
            delta = _deformation_after_slide(delta, 0.5 * v0 * reversal, rate)
            delta = _deformation_after_slide(delta, 0.5 * v1 * (step - reversal), rate)
        else:
            delta = _deformation_after_slide(delta, 0.5 * (v0 + v1) * step, rate)
        deformation[k + 1] = delta
    return deformation


@kernel(cache=True)
def _deformation_after_slide(delta: float, distance: float, rate: float) -> float:
    """Deformation after a slide in one direction."""
    decay = -rate * abs(distance)
    return delta * math.exp(decay) + math.copysign(math.expm1(decay) / rate, distance)


_BLOCK = 512  # points computed together, to bound the memory of their samples


def dahl_under_vibration(
    contact: RoughContact,
    *,
    separation: ArrayLike,
    friction_coefficient: ArrayLike,
    sliding_speed: ArrayLike,
    frequency: ArrayLike,
    in_plane_amplitude: ArrayLike = 0.0,
    normal_amplitude: ArrayLike = 0.0,
    phase: ArrayLike = np.pi / 2,
    transverse_amplitude: ArrayLike = 0.0,
    transverse_phase: ArrayLike = 0.0,
    steps: int = 512,
) -> Floats:
    r"""Mean friction force over the steady period of a vibration by Dahl's law. [N]

    Parameters
    ----------
    contact : RoughContact
    separation : array_like
        Mean separation; at rest that of `sonolube.models.contact.separation` at the load. [m]
    friction_coefficient : array_like
        Coefficient of friction of steady sliding, which limits the force at every instantaneous normal force. []
    sliding_speed : array_like
        Mean sliding speed. [m/s]
    frequency : array_like
        Frequency of the vibration. [Hz]
    in_plane_amplitude : array_like
        Amplitude along the sliding direction, forward displacement positive. [m]
    normal_amplitude : array_like
        Amplitude along the surface normal. [m]
    phase : array_like
        Lag of the normal motion behind the in-plane one; a quarter turn as D prints it. [rad]
    transverse_amplitude : array_like
        Amplitude across the sliding, within the plane. [m]
    transverse_phase : array_like
        Lag of the motion across the sliding behind the normal one. [rad]
    steps : int
        Half the number of steps of a period.

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Component along the sliding.

    Raises
    ------
    InvalidInput
        If a separation, coefficient, speed or frequency is not positive, an amplitude negative, or a value not finite.
    OutsideRange
        If a normal amplitude reaches the separation.

    Notes
    -----
    .. math::

        \frac{\mathrm{d}\boldsymbol\delta}{\mathrm{d}t} = \boldsymbol v - \frac{k_t |\boldsymbol v|}{\mu F_n}\,
        \boldsymbol\delta, \qquad \boldsymbol v = (v_r + v_1 \cos\omega t,\; v_2 \cos(\omega t - \varphi))

    where the stiffness k_t of the cube and the normal force F_n follow the separation d + a sin(omega t - phase), and
    the lag :math:`\varphi` of the motion across behind that along is the sum of both phases. Along the sliding alone it
    is D 3.10; the deformation within the plane is the same law in every direction. It is linear along a straight
    slide, so that each step is an exact exponential, the period a linear map, and the steady period its fixed point.
    Steps are graded towards the reversals of both components, near which friction turns within a very short slide. The
    error comes from constant k_t, F_n and v within a step; it is second order in the step, and below 1e-4 at 512 steps
    for normal amplitudes up to five decay lengths of the contact force.

    A stiff contact has the ratios of `parallel_vibration_ratio`, `transverse_vibration_ratio` and
    `oblique_vibration_ratio`, one that yields by far more than the stroke that of sliding speed over mean size of the
    relative velocity, which across the sliding is below Coulomb's. At a constant normal force the law dissipates in
    every closed motion.

    Vibration about the separation at rest raises the mean normal force; for a dead load, give the larger separation
    that restores it (`load_balanced_motion`).

    See Also
    --------
    lugre_under_vibration : Bristles of constant stiffness, with the Stribeck effect.

    References
    ----------
    .. [1] D 3.10 and 3.11, with the in-plane vibration in v_rel in place of D 3.12.
    """
    if steps < 1:
        raise InvalidInput(f"steps must be at least 1, got {steps!r}")
    d, a = np.broadcast_arrays(
        require_positive(separation=separation), require_non_negative(normal_amplitude=normal_amplitude)
    )
    _require_open_gap(d, a)
    f, u_peak = require_positive(frequency=frequency), require_non_negative(in_plane_amplitude=in_plane_amplitude)
    w_peak = require_non_negative(transverse_amplitude=transverse_amplitude)
    arguments = np.broadcast_arrays(
        d,
        a,
        require_positive(friction_coefficient=friction_coefficient),
        require_positive(sliding_speed=sliding_speed),
        peak_vibration_velocity(frequency=f, vibration_amplitude=u_peak),
        2 * np.pi * f,
        require_finite(phase=phase),
        peak_vibration_velocity(frequency=f, vibration_amplitude=w_peak),
        require_finite(phase=phase) + require_finite(transverse_phase=transverse_phase),
    )
    columns = [array.reshape(-1, 1) for array in arguments]
    means = [
        _mean_over_period(contact, [column[start : start + _BLOCK] for column in columns], steps)
        for start in range(0, columns[0].size, _BLOCK)
    ]
    return np.concatenate([*means, np.empty(0)]).reshape(arguments[0].shape)


def _require_open_gap(d: Floats, a: Floats) -> None:
    """Refuse the first amplitude that reaches its separation."""
    closed = a >= d
    if np.any(closed):
        raise OutsideRange(
            f"normal_amplitude must be smaller than the separation, {float(d[closed].flat[0]):.4g} m,"
            f" about which the surfaces vibrate, got {float(a[closed].flat[0]):.4g} m"
        )


def _mean_over_period(contact: RoughContact, columns: list[Floats], steps: int) -> Floats:
    """Mean force of each row of arguments, columns of shape (n, 1). [N]"""
    d, a, mu, v_r, v_1, omega, phase, v_2, lag = columns
    edges = _planar_step_edges(v_r, v_1, lag, steps) if np.any(v_2) else _step_edges(v_r, v_1, steps)
    gap = d + a * np.sin((edges[:, 1:] + edges[:, :-1]) / 2 - phase)
    slides = np.diff(v_r * edges + v_1 * np.sin(edges), axis=1) / omega
    paths = np.hypot(slides, np.diff(v_2 * np.sin(edges - lag), axis=1) / omega)
    durations = np.diff(edges, axis=1) / (2 * np.pi)
    k_t, limit = cube_tangential_stiffness(contact, separation=gap), mu * normal_force(contact, separation=gap)
    return steady_period_mean_force(k_t, limit, slides, paths, durations)


def _step_edges(v_r: Floats, v_1: Floats, steps: int) -> Floats:
    """Phases between the steps of one period, graded towards the reversals of the relative velocity."""
    graded, reversal = _graded(steps), _reversal(v_r, v_1)
    forward = reversal * (2 * graded - 1)
    backward = reversal + 2 * (np.pi - reversal) * graded[1:]
    return np.concatenate([forward, backward], axis=1)


def _planar_step_edges(v_r: Floats, v_1: Floats, lag: Floats, steps: int) -> Floats:
    """Phases between the steps of one period, graded towards the reversals of both components of the velocity."""
    reversal, quarter = _reversal(v_r, v_1), np.pi / 2
    marks = np.sort(np.mod(np.concatenate([-reversal, reversal, lag - quarter, lag + quarter], axis=1), 2 * np.pi))
    lengths = np.diff(np.concatenate([marks, marks[:, :1] + 2 * np.pi], axis=1), axis=1)
    graded = _graded(-(-steps // 2))[1:]
    parts = marks[:, :, np.newaxis] + lengths[:, :, np.newaxis] * graded
    return np.concatenate([marks[:, :1], parts.reshape(len(marks), -1)], axis=1)


def _reversal(v_r: Floats, v_1: Floats) -> Floats:
    """Phase at which the velocity along the sliding reverses; a quarter turn where it does not."""
    return np.where(v_1 > v_r, np.arccos(-v_r / np.maximum(v_1, v_r)), np.pi / 2)


def _graded(steps: int) -> Floats:
    """Places from 0 to 1, dense at both ends; shape (steps + 1,)."""
    return np.asarray((1 - np.cos(np.linspace(0, np.pi, steps + 1))) / 2)
