"""Mean friction force of a vibrated rough contact by Dahl's law with stiffness and limit that follow the separation."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.facts.metrics import peak_vibration_velocity
from sonolube.models.contact.cube import cube_tangential_stiffness
from sonolube.models.contact.rough import RoughContact, normal_force
from sonolube.models.friction.laws.steady_period_kernel import steady_period_mean_force

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
    steps : int
        Number of steps into which each slide in one direction is divided.

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a separation, coefficient, speed or frequency is not positive, an amplitude negative, or a value not finite.
    OutsideRange
        If a normal amplitude reaches the separation.

    Notes
    -----
    .. math::

        \frac{\mathrm{d}\delta}{\mathrm{d}t} = v \left( 1 - \frac{k_t \delta}{\mu F_n}\, \mathrm{sgn}\, v \right),
        \qquad v = v_r + v_1 \cos\omega t

    where the stiffness k_t of the cube and the normal force F_n follow the separation d + a sin(omega t - phase). The
    law is linear in the deformation while the sign of v is constant, so that each step is an exact exponential, the
    period a linear map, and the steady period its fixed point. Steps are graded towards the reversals, where friction
    changes sign within a very short slide. The error comes from constant k_t, F_n and v within a step; it is second
    order in the step, and below 1e-4 at 512 steps for normal amplitudes up to five decay lengths of the contact force.

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
    arguments = np.broadcast_arrays(
        d,
        a,
        require_positive(friction_coefficient=friction_coefficient),
        require_positive(sliding_speed=sliding_speed),
        peak_vibration_velocity(frequency=f, vibration_amplitude=u_peak),
        2 * np.pi * f,
        require_finite(phase=phase),
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
    d, a, mu, v_r, v_1, omega, phase = columns
    edges = _step_edges(v_r, v_1, steps)
    gap = d + a * np.sin((edges[:, 1:] + edges[:, :-1]) / 2 - phase)
    slides = np.diff(v_r * edges + v_1 * np.sin(edges), axis=1) / omega
    durations = np.diff(edges, axis=1) / (2 * np.pi)
    k_t, limit = cube_tangential_stiffness(contact, separation=gap), mu * normal_force(contact, separation=gap)
    return steady_period_mean_force(k_t, limit, slides, durations)


def _step_edges(v_r: Floats, v_1: Floats, steps: int) -> Floats:
    """Phases between the steps of one period, graded towards the reversals of the relative velocity."""
    graded = (1 - np.cos(np.linspace(0, np.pi, steps + 1))) / 2
    reversal = np.where(v_1 > v_r, np.arccos(-v_r / np.maximum(v_1, v_r)), np.pi / 2)
    forward = reversal * (2 * graded - 1)
    backward = reversal + 2 * (np.pi - reversal) * graded[1:]
    return np.concatenate([forward, backward], axis=1)
