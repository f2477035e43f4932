"""A slider with mass, pulled through a yielding drive over a surface that vibrates: Dahl's and LuGre's laws."""

from dataclasses import dataclass
from math import ceil, cos, exp, hypot, pi, sin, sqrt

import numba
import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.friction.bristle import Holder
from sonolube.friction.dahl import DahlFriction
from sonolube.friction.lugre import LuGreFriction


@dataclass(frozen=True, kw_only=True, slots=True)
class DrivenSlide:
    """What the drive bears after settling.

    Parameters
    ----------
    drive_force : float
        Mean force of the drive, which is the mean friction. [N]
    drive_force_swing : float
        Highest less lowest force of the drive's spring: large in stick-slip. [N]
    """

    drive_force: float
    drive_force_swing: float


def driven_slide(
    law: DahlFriction | LuGreFriction,
    drive: Holder,
    *,
    sliding_speed: float,
    frequency: float,
    vibration_amplitude: float,
    vibration_direction: float = 0.0,
    load_fraction: float = 0.0,
    settling_time: float,
    duration: float,
) -> DrivenSlide:
    """Return the force of a drive that pulls a slider steadily over a vibrating surface.

    Parameters
    ----------
    law : DahlFriction or LuGreFriction
        Of the contact under its mean load; Dahl's is LuGre's without damping, drag and Stribeck effect.
    drive : Holder
        Stiffness and damping of the drive, and the mass it pulls.
    sliding_speed : float
        Speed of the drive. [m/s]
    frequency : float
        Frequency of the vibration. [Hz]
    vibration_amplitude : float
        Amplitude of the surface within its plane, zero for none. [m]
    vibration_direction : float
        Angle between vibration and sliding: 0 along, a quarter turn across. [rad]
    load_fraction : float
        Amplitude of the normal force over its mean, in step with the displacement within the plane. []
    settling_time : float
        Time before the force is taken. [s]
    duration : float
        Time over which it is taken, rounded up to whole periods of the vibration. [s]

    Returns
    -------
    DrivenSlide

    Raises
    ------
    InvalidInput
        If the drive has no mass or is rigid, a value is negative or not finite, or the load fraction not below 1.

    Notes
    -----
    m dw/dt = K e + c de/dt - F, de/dt = v - w, with bristles in the plane, dz/dt = v_rel - abs(v_rel) z/g, whose limit
    g follows the normal force while their stiffness stays. Marched by Runge's and Kutta's fourth order in steps of a
    tenth of the fastest time among vibration, bristles and slip; the mean is good to 2e-3.

    Vibration lets friction fall and, where the Stribeck effect drives stick-slip, levels the falling curve: the swing
    of a soft drive vanishes once the vibration outruns the sliding.

    References
    ----------
    .. [1] P. Gutowski and M. Leus, Tribol. Int. 55, 108 (2012), Dahl's law along. doi:10.1016/j.triboint.2012.05.023
    .. [2] C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, IEEE Trans. Autom. Control 40, 419 (1995).
       doi:10.1109/9.376053
    """
    if drive.holder_mass == 0:
        raise InvalidInput("holder_mass must be positive for a driven slider, got 0.0 kg")
    v = float(require_positive(sliding_speed=sliding_speed))
    a = float(require_non_negative(vibration_amplitude=vibration_amplitude))
    f = float(require_positive(frequency=frequency))
    angle = float(require_finite(vibration_direction=vibration_direction))
    share = float(require_within(0, 0.99, load_fraction=load_fraction))
    settle = float(require_non_negative(settling_time=settling_time))
    taken = float(require_positive(duration=duration))
    laws = _constants(law)
    guide = (drive.holder_stiffness, drive.holder_damping, drive.holder_mass)
    fastest = _fastest(laws, guide, v + 2 * pi * f * a, 2 * pi * f, 1 - share)
    steps = max(ceil(10 * fastest / f), 64)
    mean, swing = _marched(
        laws, guide, v, 2 * pi * f, a * cos(angle), a * sin(angle), share, steps, ceil(settle * f), ceil(taken * f)
    )
    return DrivenSlide(drive_force=mean, drive_force_swing=swing)


_Constants = tuple[float, float, float, float, float, float]


def _constants(law: DahlFriction | LuGreFriction) -> _Constants:
    if isinstance(law, DahlFriction):
        return law.coulomb_friction_force, law.coulomb_friction_force, 1.0, law.contact_stiffness, 0.0, 0.0
    return (
        law.coulomb_friction_force,
        law.static_friction_force,
        law.stribeck_velocity,
        law.bristle_stiffness,
        law.bristle_damping,
        law.viscous_coefficient,
    )


def _fastest(laws: _Constants, guide: tuple[float, float, float], speed: float, omega: float, least: float) -> float:
    """Return the fastest rate among vibration, slider on its bristles, their damping, and slip. [1/s]"""
    F_c, _, _, stiffness, damping, drag = laws
    K, c, m = guide
    slip = speed * stiffness / (F_c * least)
    return float(max(omega, sqrt((K + stiffness) / m), (c + damping + drag) / m, slip) / (2 * pi))


@numba.njit(cache=True)
def _rates(
    state: Floats,
    rates: Floats,
    laws: tuple[float, float, float, float, float, float],
    guide: tuple[float, float, float],
    speed: float,
    base_x: float,
    base_y: float,
    share: float,
) -> None:
    F_c, F_s, v_s, stiffness, damping, drag = laws
    K, c, m = guide
    stretch, w, z_x, z_y = state
    x, y = w - base_x, -base_y
    rubbing = hypot(x, y)
    g = share * (F_c + (F_s - F_c) * exp(-((rubbing / v_s) ** 2))) / stiffness
    rates[0] = speed - w
    rates[2] = x - rubbing * z_x / g
    rates[3] = y - rubbing * z_y / g
    rates[1] = (K * stretch + c * rates[0] - stiffness * z_x - damping * rates[2] - drag * x) / m


@numba.njit(cache=True)
def _marched(
    laws: tuple[float, float, float, float, float, float],
    guide: tuple[float, float, float],
    speed: float,
    omega: float,
    along: float,
    across: float,
    share: float,
    steps: int,
    settling: int,
    taken: int,
) -> tuple[float, float]:
    state = np.zeros(4)
    state[1] = speed
    k1, k2, k3, k4 = np.empty(4), np.empty(4), np.empty(4), np.empty(4)
    dt = 2 * pi / omega / steps
    total, lowest, highest = 0.0, np.inf, -np.inf
    turns = np.empty((2 * steps, 2))
    for j in range(2 * steps):
        turns[j, 0], turns[j, 1] = cos(pi * j / steps), 1 + share * sin(pi * j / steps)
    for period in range(settling + taken):
        for j in range(steps):
            here, half, there = 2 * j, 2 * j + 1, (2 * j + 2) % (2 * steps)
            c, p = turns[here, 0] * omega, turns[here, 1]
            _rates(state, k1, laws, guide, speed, along * c, across * c, p)
            c, p = turns[half, 0] * omega, turns[half, 1]
            _rates(state + dt / 2 * k1, k2, laws, guide, speed, along * c, across * c, p)
            _rates(state + dt / 2 * k2, k3, laws, guide, speed, along * c, across * c, p)
            c, p = turns[there, 0] * omega, turns[there, 1]
            _rates(state + dt * k3, k4, laws, guide, speed, along * c, across * c, p)
            state += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            if period >= settling:
                force = guide[0] * state[0]
                total += force + guide[1] * (speed - state[1])
                lowest, highest = min(lowest, force), max(highest, force)
    return total / (taken * steps), highest - lowest
