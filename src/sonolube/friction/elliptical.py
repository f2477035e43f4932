"""Traction of a surface whose points move on ellipses against a pressed slider: the friction of a motor."""

from math import acos, cos, pi, sin

import numba
import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive


def contact_fraction(*, normal_load: ArrayLike, normal_stiffness: ArrayLike, normal_amplitude: ArrayLike) -> Floats:
    """Return the share of the period in which a vibrating surface touches a slider that keeps its height. []

    Parameters
    ----------
    normal_load : array_like
        Force pressing the bodies together, on average. [N]
    normal_stiffness : array_like, broadcast against `normal_load`
        Stiffness of the contact along the normal. [N/m]
    normal_amplitude : array_like, broadcast against them
        Amplitude of the surface along its normal. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        1 where the load exceeds stiffness times amplitude.

    Raises
    ------
    InvalidInput
        If load or stiffness is not positive, or the amplitude negative.

    Notes
    -----
    With h half the phase of contact, the mean force is k_z a (sin h - h cos h)/pi. The slider is too heavy to follow
    the vibration, and lifts until that is the load.
    """
    load, swing = np.broadcast_arrays(
        require_positive(normal_load=normal_load),
        require_positive(normal_stiffness=normal_stiffness) * require_non_negative(normal_amplitude=normal_amplitude),
    )
    pressed = load / np.maximum(swing, load)
    return (_half_contact(pressed.ravel()) / np.pi).reshape(load.shape)


def elliptical_traction_ratio(
    *,
    normal_load: ArrayLike,
    normal_stiffness: ArrayLike,
    normal_amplitude: ArrayLike,
    in_plane_amplitude: ArrayLike,
    frequency: ArrayLike,
    relative_velocity: ArrayLike = 0.0,
    phase: ArrayLike = np.pi / 2,
) -> Floats:
    """Return the mean traction of a vibrating surface on a slider over their steady friction. []

    Parameters
    ----------
    normal_load : array_like
        Force pressing the bodies together, on average. [N]
    normal_stiffness : array_like
        Stiffness of the contact along the normal. [N/m]
    normal_amplitude : array_like
        Amplitude of the surface along its normal. [m]
    in_plane_amplitude : array_like
        Amplitude of the surface along the sliding direction; negative for the other side of a node. [m]
    frequency : array_like
        Frequency of the vibration. [Hz]
    relative_velocity : array_like
        Velocity of the slider along the surface; zero for a slider that is held. [m/s]
    phase : array_like
        Lag of the normal motion behind the in-plane one; a quarter turn as D prints it. [rad]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Between -1 and 1, positive where the surface drives the slider forward: the motor force of a slider that is
        held. Of a slider that moves forward, minus the friction ratio: its reduction is 1 plus this, and beyond 100 %
        where the surface drives it.

    Raises
    ------
    InvalidInput
        If load, stiffness or frequency is not positive, the normal amplitude negative, or a value not finite.

    Notes
    -----
    The surface moves by u cos(omega t) along and by a cos(omega t - phase) towards the slider, whose friction has the
    direction of their relative velocity and the size that the normal force of the instant allows: rigid along the
    plane, `oscillation_ratio` has the springs. The force is integrated in closed form over the part of the contact in
    which the surface is ahead. A quarter turn apart, contact no longer than half a period, k_z a >= pi F_N, all of it
    drives: the motor force is then mu F_N, linear in the load, and reverses with the sign of the amplitude across a
    node, towards which it drives as D prints the phase. Under heavier loads it falls behind, to 2/pi mu k_z a where the
    surface never leaves.

    References
    ----------
    .. [1] D 2.1.4, figures 2.5 and 2.6; D 3.25 for the phase.
    """
    load, swing, u, omega, v, lag = np.broadcast_arrays(
        require_positive(normal_load=normal_load),
        require_positive(normal_stiffness=normal_stiffness) * require_non_negative(normal_amplitude=normal_amplitude),
        require_finite(in_plane_amplitude=in_plane_amplitude),
        2 * np.pi * require_positive(frequency=frequency),
        require_finite(relative_velocity=relative_velocity),
        require_finite(phase=phase),
    )
    return _traction(
        (load / np.maximum(swing, load)).ravel(),
        (swing / load).ravel(),
        (u * omega).ravel(),
        v.ravel(),
        lag.ravel(),
    ).reshape(load.shape)


@numba.njit(cache=True)
def _half_contact(pressed: Floats) -> Floats:
    halves = np.empty(pressed.size)
    for i in range(pressed.size):
        halves[i] = _half(pressed[i])
    return halves


@numba.njit(cache=True)
def _half(pressed: float) -> float:
    """Return h of sin h - h cos h = pi times the load over the swing of the force."""
    if pressed >= 1.0:
        return pi
    root = (3 * pi * pressed) ** (1 / 3)
    h = root * (1 + root * root / 30) if root < 1.6 else pi - (1 - pressed) * (1.9 - 0.9 * (1 - pressed))
    h = min(h, 3.1)
    for _ in range(8):
        s, c = sin(h), cos(h)
        miss = s - h * c - pi * pressed
        step = miss / (h * s)
        step /= max(1 - step * (s + h * c) / (2 * h * s), 0.5)
        h = min(max(h - step, 0.5 * h), (h + pi) / 2)
        if abs(step) < 1e-4 * h:  # of third order
            break
    return h


@numba.njit(cache=True)
def _pressed_within(low: float, high: float, half: float, rest: float) -> float:
    """Return the integral of max(cos x + rest, 0), whose positive part ends at +-half, over an interval."""
    low, high = max(low, -half), min(high, half)
    return sin(high) - sin(low) + rest * (high - low) if high > low else 0.0


@numba.njit(cache=True)
def _traction(pressed: Floats, swing: Floats, v_1: Floats, v: Floats, lag: Floats) -> Floats:
    ratio = np.empty(pressed.size)
    for i in range(pressed.size):
        speed = abs(v_1[i])
        if speed <= abs(v[i]):
            ratio[i] = -1.0 if v[i] > 0 else (1.0 if v[i] < 0 else 0.0)
            continue
        half = _half(pressed[i])
        ahead = acos(v[i] / speed)  # half the phase in which the surface is ahead
        # contact about x = 0; the surface's velocity -v_1 sin(omega t) peaks a quarter turn before u does
        middle = -pi / 2 - lag[i] if v_1[i] > 0 else pi / 2 - lag[i]
        middle -= 2 * pi * round(middle / (2 * pi))
        if pressed[i] < 1.0:
            scale, rest, part = swing[i], -cos(half), half
        elif swing[i] > 0.0:
            scale, rest, part = swing[i], 1 / swing[i], pi
        else:
            ratio[i] = 2 * ahead / pi - 1
            continue
        driven = 0.0
        for turn in range(-1, 2):
            centre = middle + 2 * pi * turn
            driven += _pressed_within(centre - ahead, centre + ahead, part, rest)
        ratio[i] = min(max(driven * scale / pi - 1, -1.0), 1.0)
    return ratio
