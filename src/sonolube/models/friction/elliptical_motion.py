"""Mean traction of an elliptically vibrating surface on a pressed slider, as in an ultrasonic motor.

The surface moves by u cos(omega t) along and by a cos(omega t - phase) towards the slider. The slider is too heavy to
follow the vibration along the normal; the contact has a normal stiffness and, within the plane, Coulomb friction.
"""

from math import acos, cos, pi, sin

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.execution.compilation import INNER, kernel

_FEW = 20_000  # points for which plain Python takes less than compiling


def contact_time_fraction(
    *, normal_load: ArrayLike, normal_stiffness: ArrayLike, normal_amplitude: ArrayLike
) -> Floats:
    r"""Fraction of the period in which a vibrating surface is in contact with a heavy slider. []

    Parameters
    ----------
    normal_load : array_like
        Mean normal force, which is the load. [N]
    normal_stiffness : array_like, broadcast against `normal_load`
        Normal stiffness of the contact. [N/m]
    normal_amplitude : array_like, broadcast against them
        Vibration amplitude of the surface along its normal. [m]

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
    .. math:: \frac{F_N}{k_z a} = \frac{\sin h - h \cos h}{\pi}

    for half the phase of contact h: the slider is lifted until the mean normal force is the load. The fraction is
    h/pi.
    """
    load, force_amplitude = np.broadcast_arrays(
        require_positive(normal_load=normal_load),
        require_positive(normal_stiffness=normal_stiffness) * require_non_negative(normal_amplitude=normal_amplitude),
    )
    load_ratio = load / np.maximum(force_amplitude, load)
    return (_half_contact_phases(load_ratio.ravel()) / np.pi).reshape(load.shape)


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
    r"""Mean traction of an elliptically vibrating surface on a slider over their steady friction. []

    Parameters
    ----------
    normal_load : array_like
        Mean normal force, which is the load. [N]
    normal_stiffness : array_like
        Normal stiffness of the contact. [N/m]
    normal_amplitude : array_like
        Vibration amplitude of the surface along its normal. [m]
    in_plane_amplitude : array_like
        Vibration amplitude along the sliding direction; negative on the other side of a node. [m]
    frequency : array_like
        Frequency of the vibration. [Hz]
    relative_velocity : array_like
        Velocity of the slider along the surface; zero for a slider held in place. [m/s]
    phase : array_like
        Lag of the normal motion behind the in-plane one; pi/2 as D prints it. [rad]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Between -1 and 1, positive where the surface drives the slider forward: the motor force on a slider held in
        place. For a slider that moves forward it is minus the friction ratio, so that the friction reduction is 1 plus
        this value, and exceeds 100 % where the surface drives the slider.

    Raises
    ------
    InvalidInput
        If load, stiffness or frequency is not positive, the normal amplitude negative, or a value not finite.

    Notes
    -----
    .. math:: \frac{F}{\mu F_N} = \left\langle \frac{F_n(t)}{F_N}\, \mathrm{sgn}(\dot u(t) - v) \right\rangle

    with rigid contact along the plane (`combined_oscillation_ratio` has tangential springs), integrated in closed form
    over the part of the contact in which the surface is faster than the slider. For a phase of pi/2 and contact for at
    most half a period, k_z a >= pi F_N, the surface drives throughout the contact: the motor force is mu F_N,
    proportional to the load, and changes sign with the amplitude across a node, towards which it acts with the phase as
    D prints it. Under heavier loads it is smaller, down to 2/pi mu k_z a where contact is never lost.

    See Also
    --------
    contact_time_fraction : Duration of the contact.

    References
    ----------
    .. [1] D 2.1.4, figures 2.5 and 2.6; D 3.25 for the phase.
    """
    load, force_amplitude, u, omega, v, lag = np.broadcast_arrays(
        require_positive(normal_load=normal_load),
        require_positive(normal_stiffness=normal_stiffness) * require_non_negative(normal_amplitude=normal_amplitude),
        require_finite(in_plane_amplitude=in_plane_amplitude),
        2 * np.pi * require_positive(frequency=frequency),
        require_finite(relative_velocity=relative_velocity),
        require_finite(phase=phase),
    )
    return _traction.for_points(load.size, at_first=_FEW)(
        (load / np.maximum(force_amplitude, load)).ravel(),
        (force_amplitude / load).ravel(),
        (u * omega).ravel(),
        v.ravel(),
        lag.ravel(),
    ).reshape(load.shape)


@kernel(cache=True, no_cfunc_wrapper=True)
def _half_contact_phases(load_ratio: Floats) -> Floats:
    """Half the phase of contact for each load over the amplitude of the force."""
    phases = np.empty(load_ratio.size)
    for i in range(load_ratio.size):
        phases[i] = _half_contact_phase(load_ratio[i])
    return phases


@kernel(cache=True, no_cfunc_wrapper=True)
def _half_contact_phase(load_ratio: float) -> float:
    """Root h of sin h - h cos h = pi times the load over the amplitude of the force, by Halley's method."""
    if load_ratio >= 1.0:
        return pi
    root = (3 * pi * load_ratio) ** (1 / 3)
    h = root * (1 + root * root / 30) if root < 1.6 else pi - (1 - load_ratio) * (1.9 - 0.9 * (1 - load_ratio))
    h = min(h, 3.1)
    for _ in range(8):
        s, c = sin(h), cos(h)
        residual = s - h * c - pi * load_ratio
        step = residual / (h * s)
        step /= max(1 - step * (s + h * c) / (2 * h * s), 0.5)
        h = min(max(h - step, 0.5 * h), (h + pi) / 2)
        if abs(step) < 1e-4 * h:  # third-order convergence
            break
    return h


@kernel(**INNER)
def _force_integral(low: float, high: float, half: float, offset: float) -> float:
    """Integral of max(cos x + offset, 0), which vanishes beyond +-half, over an interval."""
    low, high = max(low, -half), min(high, half)
    return sin(high) - sin(low) + offset * (high - low) if high > low else 0.0


@kernel(cache=True, no_cfunc_wrapper=True)
def _traction(load_ratio: Floats, amplitude_ratio: Floats, v_1: Floats, v: Floats, lag: Floats) -> Floats:
    """Mean traction over the friction, from load and force amplitude over each other, velocities and lag."""
    ratio = np.empty(load_ratio.size)
    for i in range(load_ratio.size):
        speed = abs(v_1[i])
        if speed <= abs(v[i]):
            ratio[i] = -1.0 if v[i] > 0 else (1.0 if v[i] < 0 else 0.0)
            continue
        half = _half_contact_phase(load_ratio[i])
        ahead = acos(v[i] / speed)  # half the phase in which the surface is faster
        # contact is centred at x = 0; the surface velocity -v_1 sin(omega t) has its maximum pi/2 before that of u
        middle = -pi / 2 - lag[i] if v_1[i] > 0 else pi / 2 - lag[i]
        middle -= 2 * pi * round(middle / (2 * pi))
        if load_ratio[i] < 1.0:
            scale, offset, contact = amplitude_ratio[i], -cos(half), half
        elif amplitude_ratio[i] > 0.0:
            scale, offset, contact = amplitude_ratio[i], 1 / amplitude_ratio[i], pi
        else:
            ratio[i] = 2 * ahead / pi - 1
            continue
        driven = 0.0
        for turn in range(-1, 2):
            centre = middle + 2 * pi * turn
            driven += _force_integral(centre - ahead, centre + ahead, contact, offset)
        ratio[i] = min(max(driven * scale / pi - 1, -1.0), 1.0)
    return ratio
