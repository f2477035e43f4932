"""Friction-driven oscillation of a slider pulled by a spring over a vibrating surface, by Dahl's or the LuGre law."""

from dataclasses import astuple, dataclass
from math import ceil, cos, exp, hypot, pi, sin, sqrt

import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel
from sonolube.models.friction.bristle import Holder
from sonolube.models.friction.laws.dahl import DahlFriction
from sonolube.models.friction.laws.lugre import LuGreFriction


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveForce:
    """Force of the drive of a slider after its transient.

    Parameters
    ----------
    mean_drive_force : float
        Mean force of spring and damper, which equals the mean friction. [N]
    drive_force_range : float
        Peak-to-peak force of the spring, large in stick-slip. [N]
    """

    mean_drive_force: float
    drive_force_range: float


def spring_driven_slider_force(
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
) -> DriveForce:
    r"""Force of a spring drive that pulls a slider at constant speed over a vibrating surface.

    Parameters
    ----------
    law : DahlFriction or LuGreFriction
        Law of the contact under its mean load; Dahl's is the LuGre law without damping, viscous friction and Stribeck
        effect.
    drive : Holder
        Stiffness and damping of the drive, and mass of the slider.
    sliding_speed : float
        Speed of the drive. [m/s]
    frequency : float
        Frequency of the vibration. [Hz]
    vibration_amplitude : float
        Amplitude of the surface within its plane. [m]
    vibration_direction : float
        Angle between vibration and sliding: 0 along, pi/2 across. [rad]
    load_fraction : float
        Amplitude of the normal force over its mean, in step with the displacement within the plane. []
    settling_time : float
        Time before the averaging. [s]
    duration : float
        Time of the averaging, rounded up to whole periods of the vibration. [s]

    Returns
    -------
    DriveForce

    Raises
    ------
    InvalidInput
        If the drive has no mass or is rigid, a value is negative or not finite, or the load fraction not below 1.

    Notes
    -----
    .. math::

        m \dot w = K e + c \dot e - F, \qquad \dot e = v - w, \qquad
        \dot{\boldsymbol z} = \boldsymbol v_{rel} - \frac{|\boldsymbol v_{rel}|}{g}\, \boldsymbol z

    with the slider's velocity w, the elongation e of the spring, the speed v of the drive, and two-dimensional bristles
    of constant stiffness whose limit g follows the normal force. Integrated by the Runge-Kutta method of fourth order
    in steps of a tenth of the shortest time scale of vibration, bristles and slip; the error of the mean is 2e-3.

    Vibration reduces the mean friction. Where the Stribeck effect causes stick-slip, it also flattens the falling curve
    of friction over speed: the range of the spring force of a soft drive vanishes where the peak velocity of the
    vibration exceeds the sliding speed.

    See Also
    --------
    dahl_under_vibration, lugre_under_vibration : Mean friction of a slider at constant velocity.

    References
    ----------
    .. [1] P. Gutowski and M. Leus, Tribol. Int. 55, 108 (2012), Dahl's law along. doi:10.1016/j.triboint.2012.05.023
    .. [2] C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, IEEE Trans. Autom. Control 40, 419 (1995).
       doi:10.1109/9.376053
    """
    if drive.holder_mass == 0:
        raise InvalidInput("holder_mass must be positive for a spring-driven slider, got 0.0 kg")
    v = float(require_positive(sliding_speed=sliding_speed))
    a = float(require_non_negative(vibration_amplitude=vibration_amplitude))
    f = float(require_positive(frequency=frequency))
    angle = float(require_finite(vibration_direction=vibration_direction))
    load_amplitude = float(require_within(0, 0.99, load_fraction=load_fraction))
    settle = float(require_non_negative(settling_time=settling_time))
    averaging = float(require_positive(duration=duration))
    constants = _constants(law)
    spring = (drive.holder_stiffness, drive.holder_damping, drive.holder_mass)
    rate = _highest_rate(constants, spring, v + 2 * pi * f * a, 2 * pi * f, 1 - load_amplitude)
    steps = max(ceil(10 * rate / f), 64)
    mean, force_range = _drive_force(
        constants,
        spring,
        v,
        2 * pi * f,
        a * cos(angle),
        a * sin(angle),
        load_amplitude,
        steps,
        ceil(settle * f),
        ceil(averaging * f),
    )
    return DriveForce(mean_drive_force=mean, drive_force_range=force_range)


_Constants = tuple[float, float, float, float, float, float]


def _constants(law: DahlFriction | LuGreFriction) -> _Constants:
    """F_c, F_s, v_s, stiffness, damping and viscous coefficient of a law."""
    if isinstance(law, DahlFriction):
        return law.coulomb_friction_force, law.coulomb_friction_force, 1.0, law.contact_stiffness, 0.0, 0.0
    return astuple(law)


def _highest_rate(
    constants: _Constants, spring: tuple[float, float, float], speed: float, omega: float, least_load: float
) -> float:
    """Highest rate of vibration, slider on its bristles, damping, and slip. [1/s]"""
    F_c, _, _, stiffness, damping, viscous = constants
    K, c, m = spring
    slip = speed * stiffness / (F_c * least_load)
    return float(max(omega, sqrt((K + stiffness) / m), (c + damping + viscous) / m, slip) / (2 * pi))


@kernel(cache=True)
def _derivatives(
    state: Floats,
    rates: Floats,
    constants: tuple[float, float, float, float, float, float],
    spring: tuple[float, float, float],
    speed: float,
    base_x: float,
    base_y: float,
    load_ratio: float,
) -> None:
    """Write the time derivatives of elongation, slider velocity and bristle deflection along and across."""
    F_c, F_s, v_s, stiffness, damping, viscous = constants
    K, c, m = spring
    elongation, w, z_x, z_y = state
    x, y = w - base_x, -base_y
    relative_speed = hypot(x, y)
    g = load_ratio * (F_c + (F_s - F_c) * exp(-((relative_speed / v_s) ** 2))) / stiffness
    rates[0] = speed - w
    rates[2] = x - relative_speed * z_x / g
    rates[3] = y - relative_speed * z_y / g
    rates[1] = (K * elongation + c * rates[0] - stiffness * z_x - damping * rates[2] - viscous * x) / m


@kernel(cache=True)
def _drive_force(
    constants: tuple[float, float, float, float, float, float],
    spring: tuple[float, float, float],
    speed: float,
    omega: float,
    along: float,
    across: float,
    load_amplitude: float,
    steps: int,
    settling_periods: int,
    averaged_periods: int,
) -> tuple[float, float]:
    """Mean force of the drive and the range of its spring force, by the Runge-Kutta method. [N]"""
    state = np.zeros(4)
    state[1] = speed
    k1, k2, k3, k4 = np.empty(4), np.empty(4), np.empty(4), np.empty(4)
    dt = 2 * pi / omega / steps
    total, lowest, highest = 0.0, np.inf, -np.inf
    phases = np.empty((2 * steps, 2))  # cosine of the velocity, and load over its mean, at half steps
    for j in range(2 * steps):
        phases[j, 0], phases[j, 1] = cos(pi * j / steps), 1 + load_amplitude * sin(pi * j / steps)
    for period in range(settling_periods + averaged_periods):
        for j in range(steps):
            start, half, end = 2 * j, 2 * j + 1, (2 * j + 2) % (2 * steps)
            c, p = phases[start, 0] * omega, phases[start, 1]
            _derivatives(state, k1, constants, spring, speed, along * c, across * c, p)
            c, p = phases[half, 0] * omega, phases[half, 1]
            _derivatives(state + dt / 2 * k1, k2, constants, spring, speed, along * c, across * c, p)
            _derivatives(state + dt / 2 * k2, k3, constants, spring, speed, along * c, across * c, p)
            c, p = phases[end, 0] * omega, phases[end, 1]
            _derivatives(state + dt * k3, k4, constants, spring, speed, along * c, across * c, p)
            state += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            if period >= settling_periods:
                force = spring[0] * state[0]
                total += force + spring[1] * (speed - state[1])
                lowest, highest = min(lowest, force), max(highest, force)
    return total / (averaged_periods * steps), highest - lowest
