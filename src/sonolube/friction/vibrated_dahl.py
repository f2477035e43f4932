"""Dahl's law in a contact that vibrates both along its normal and along the sliding direction."""

import numba
import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.contact.cube import tangential_stiffness
from sonolube.contact.rough import RoughContact, normal_force
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.metrics import peak_vibration_velocity

__all__ = ["dahl_under_vibration"]  # the rest is of use in this room only
_BLOCK = 512  # points marched together, to bound the memory of their samples


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
    """Return the mean friction force over a steady period of vibration. [N]

    Parameters
    ----------
    contact : RoughContact
    separation : array_like
        Mean separation; at rest that of `sonolube.contact.separation` at the load. [m]
    friction_coefficient : array_like
        Coefficient of steady sliding, which limits friction at every instant's normal force. []
    sliding_speed : array_like
        Mean speed of the sliding. [m/s]
    frequency : array_like
        Frequency of the vibration. [Hz]
    in_plane_amplitude : array_like
        Amplitude along the sliding direction, forward displacement positive. [m]
    normal_amplitude : array_like
        Amplitude along the surface normal. [m]
    phase : array_like
        Lag of the normal motion behind the in-plane one; a quarter turn as D prints it. [rad]
    steps : int
        Steps into which each one-way slide of a period is divided.

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
    The relative velocity is v_r + v_1 cos(omega t), the separation d + a sin(omega t - phase); stiffness k_t and limit
    mu F_n follow the separation. The law is linear in the deformation while the motion keeps its way, so each step is
    an exact exponential, the period a linear map, and the steady period its fixed point: nothing is marched to a
    steady state. Steps crowd towards the turning points, where friction reverses within a very short slide. The error
    comes from holding k_t, F_n and v over a step. It falls with the square of the step, and at 512 steps is below 1e-4
    for normal amplitudes up to five decay lengths of the normal force.

    Vibration about an unmoved mean raises the mean normal force; where the load is dead weight, give the wider
    separation that restores it.

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
    f = require_positive(frequency=frequency)
    arguments = np.broadcast_arrays(
        d,
        a,
        require_positive(friction_coefficient=friction_coefficient),
        require_positive(sliding_speed=sliding_speed),
        peak_vibration_velocity(
            frequency=f, vibration_amplitude=require_non_negative(in_plane_amplitude=in_plane_amplitude)
        ),
        2 * np.pi * f,
        require_finite(phase=phase),
    )
    columns = [array.reshape(-1, 1) for array in arguments]
    means = [
        _mean_over_period(contact, *(column[start : start + _BLOCK] for column in columns), steps=steps)
        for start in range(0, columns[0].size, _BLOCK)
    ]
    return np.concatenate([*means, np.empty(0)]).reshape(arguments[0].shape)


def _require_open_gap(d: Floats, a: Floats) -> None:
    closed = a >= d
    if np.any(closed):
        raise OutsideRange(
            f"normal_amplitude must be smaller than the separation, {float(d[closed].flat[0]):.4g} m,"
            f" about which the surfaces vibrate, got {float(a[closed].flat[0]):.4g} m"
        )


def _mean_over_period(
    contact: RoughContact,
    d: Floats,
    a: Floats,
    mu: Floats,
    v_r: Floats,
    v_1: Floats,
    omega: Floats,
    phase: Floats,
    *,
    steps: int,
) -> Floats:
    edges = _step_edges(v_r, v_1, steps)
    gap = d + a * np.sin((edges[:, 1:] + edges[:, :-1]) / 2 - phase)
    slides = np.diff(v_r * edges + v_1 * np.sin(edges), axis=1) / omega
    shares = np.diff(edges, axis=1) / (2 * np.pi)
    k_t, limit = tangential_stiffness(contact, separation=gap), mu * normal_force(contact, separation=gap)
    return periodic_mean(k_t, limit, slides, shares)


def _step_edges(v_r: Floats, v_1: Floats, steps: int) -> Floats:
    """Return the phases that divide one period, crowding where the relative velocity changes its sign."""
    crowded = (1 - np.cos(np.linspace(0, np.pi, steps + 1))) / 2
    turn = np.where(v_1 > v_r, np.arccos(-v_r / np.maximum(v_1, v_r)), np.pi / 2)
    forward = turn * (2 * crowded - 1)
    backward = turn + 2 * (np.pi - turn) * crowded[1:]
    return np.concatenate([forward, backward], axis=1)


@numba.njit(cache=True)
def periodic_mean(stiffness: Floats, limit: Floats, slides: Floats, shares: Floats) -> Floats:
    """Return the mean force of each row of steps over its steady period, `shares` of which they last."""
    means = np.empty(stiffness.shape[0])
    for point in range(means.size):
        # after every step the deformation is kept * (that at the start) + gained; so is the running mean of the force
        kept, gained, log_kept, mean_kept, mean_gained = 1.0, 0.0, 0.0, 0.0, 0.0
        for step in range(stiffness.shape[1]):
            k, most, slide = stiffness[point, step], limit[point, step], slides[point, step]
            decay = k * abs(slide) / most
            if decay == 0.0:
                continue
            settled = np.sign(slide) * most / k
            leaving = -np.expm1(-decay)
            weight, held = shares[point, step] * k, leaving / decay
            mean_kept += weight * held * kept
            mean_gained += weight * (settled + held * (gained - settled))
            gained += leaving * (settled - gained)
            log_kept -= decay
            kept = np.exp(log_kept)
        means[point] = mean_gained - mean_kept * gained / np.expm1(log_kept)
    return means
