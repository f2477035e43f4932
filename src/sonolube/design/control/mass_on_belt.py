"""Stick-slip: a mass on a spring that a moving belt drags along, and how vibration ends it."""

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.rig import Rig, operating_points

_SPEEDS = 33  # at which the closure is asked; between them friction ratios are interpolated
_SLOWEST = 1e-3  # of the belt's speed, taken for standing still
_MOST_STEPS = 5_000_000


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DraggedMass:
    """A mass held by a spring against a belt, with friction that falls with speed.

    m x'' + c x' + k x = F(v_b - x'), with F(v) = R(abs(v)) [F_c + (F_s - F_c) exp(-(v/v_s)^2)] sgn v, and at rest on
    the belt whatever holds it there up to R(0) F_s.

    Parameters
    ----------
    holder_mass : float
        Mass that moves with the slider. [kg]
    holder_stiffness : float
        Stiffness that holds it. [N/m]
    holder_damping : float
        Damping beside the spring. [N s/m]
    sliding_speed : float
        Speed of the belt. [m/s]
    coulomb_friction_force : float
        Friction of fast sliding, without vibration. [N]
    static_friction_force : float
        Friction at rest, without vibration. [N]
    stribeck_velocity : float
        Velocity over which the one passes into the other. [m/s]
    relative_velocity : ndarray, shape (n,)
        Velocities at which the effect of vibration is known, rising from zero. [m/s]
    friction_ratio : ndarray, shape (n,)
        Friction with vibration over friction without, R, at each; ones where nothing vibrates. []

    Raises
    ------
    InvalidInput
        If a mass, stiffness, speed, force or velocity is not positive, damping negative, static friction below that of
        sliding, or the velocities do not rise from zero.
    """

    holder_mass: float
    holder_stiffness: float
    holder_damping: float
    sliding_speed: float
    coulomb_friction_force: float
    static_friction_force: float
    stribeck_velocity: float
    relative_velocity: Floats
    friction_ratio: Floats

    def __post_init__(self) -> None:
        require_positive(
            holder_mass=self.holder_mass,
            holder_stiffness=self.holder_stiffness,
            sliding_speed=self.sliding_speed,
            coulomb_friction_force=self.coulomb_friction_force,
            stribeck_velocity=self.stribeck_velocity,
        )
        require_non_negative(holder_damping=self.holder_damping, friction_ratio=self.friction_ratio)
        if require_positive(static_friction_force=self.static_friction_force) < self.coulomb_friction_force:
            raise InvalidInput("static_friction_force must not be below coulomb_friction_force")
        v = require_non_negative(relative_velocity=self.relative_velocity)
        if v.ndim != 1 or v.shape != np.shape(self.friction_ratio) or v[0] != 0 or np.any(np.diff(v) <= 0):
            raise InvalidInput("relative_velocity must rise from zero, with a friction_ratio for each entry")

    @property
    def period(self) -> float:
        """Period of the free mass, in s."""
        return float(2 * np.pi * np.sqrt(self.holder_mass / self.holder_stiffness))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DraggedMotion:
    """How a dragged mass moves.

    Parameters
    ----------
    time : ndarray
        Time. [s]
    displacement : ndarray
        Of the mass along the belt. [m]
    friction_force : ndarray
        What a sensor in the holder reads: force of its spring and damper. [N]
    sticking : ndarray of bool
        Whether the mass rests on the belt.
    """

    time: Floats
    displacement: Floats
    friction_force: Floats
    sticking: NDArray[np.bool_]

    @property
    def stick_slip_amplitude(self) -> float:
        """Highest less lowest force over the last quarter, in N."""
        return float(np.ptp(self.friction_force[-self.time.size // 4 :]))

    @property
    def stick_fraction(self) -> float:
        """Share of the last quarter in which the mass rests on the belt."""
        return float(np.mean(self.sticking[-self.time.size // 4 :]))


def dragged_mass(
    rig: Rig,
    *,
    holder_mass: float,
    holder_stiffness: float,
    holder_damping: float,
    static_friction_force: float,
    stribeck_velocity: float,
    voltage_peak_to_peak: float,
) -> DraggedMass:
    """Return a rig's slider on its holder, the rig's own friction taken for that of sliding.

    Parameters
    ----------
    rig : Rig
        With a stack and a structure, whose closure is asked for friction at every speed.
    holder_mass : float
        Mass that moves with the slider. [kg]
    holder_stiffness : float
        Stiffness that holds it. [N/m]
    holder_damping : float
        Damping beside the spring. [N s/m]
    static_friction_force : float
        Friction at rest, without vibration. [N]
    stribeck_velocity : float
        Velocity over which friction falls to that of sliding. [m/s]
    voltage_peak_to_peak : float
        Swing of the drive; none for no vibration, the offset goes with it in the rig's own proportion. [V]

    Returns
    -------
    DraggedMass

    Raises
    ------
    InvalidInput
        If the rig has no structure or a value no meaning.
    OutsideRange
        If the closure gives no friction at some speed.

    Notes
    -----
    Friction at a standstill is that at a thousandth of the belt's speed. A closure's ratio is a mean over periods of
    the vibration, which slow sliding allows: stick-slip must be slow against them.
    """
    fastest = 2 * rig.sliding_speed + static_friction_force / np.sqrt(holder_stiffness * holder_mass)
    speeds = np.geomspace(_SLOWEST * rig.sliding_speed, fastest, _SPEEDS)
    ratio = np.ones(_SPEEDS)
    if voltage_peak_to_peak > 0:
        drive = rig.drive
        swing = drive.voltage_peak_to_peak if drive is not None else None
        offset = drive.voltage_offset / swing * voltage_peak_to_peak if drive is not None and swing else 0.0
        found = operating_points(
            rig, voltage_peak_to_peak=voltage_peak_to_peak, voltage_offset=offset, sliding_speed=speeds
        )
        if np.any(found.failed):
            raise OutsideRange(f"at {voltage_peak_to_peak:g} V peak to peak: {found.reason[found.failed][0]}")
        ratio = found.friction_ratio
    return DraggedMass(
        holder_mass=holder_mass,
        holder_stiffness=holder_stiffness,
        holder_damping=holder_damping,
        sliding_speed=rig.sliding_speed,
        coulomb_friction_force=rig.friction_coefficient * rig.normal_load,
        static_friction_force=static_friction_force,
        stribeck_velocity=stribeck_velocity,
        relative_velocity=np.append(0.0, speeds[1:]),
        friction_ratio=ratio,
    )


def kinetic_friction(mass: DraggedMass, *, relative_velocity: Floats) -> Floats:
    """Return the friction of sliding. [N]

    Parameters
    ----------
    mass : DraggedMass
    relative_velocity : ndarray, any shape
        Velocity of the belt less that of the mass, not negative. [m/s]

    Returns
    -------
    ndarray, shape of `relative_velocity`
    """
    v = require_non_negative(relative_velocity=relative_velocity)
    excess = mass.static_friction_force - mass.coulomb_friction_force
    stribeck = mass.coulomb_friction_force + excess * np.exp(-((v / mass.stribeck_velocity) ** 2))
    return np.asarray(stribeck * np.interp(v, mass.relative_velocity, mass.friction_ratio))


def steady_sliding_damping(mass: DraggedMass) -> float:
    """Return the damping of small motions about steady sliding, in N s/m: below zero sliding turns to stick-slip.

    Notes
    -----
    c + dF/dv at the belt's speed, by a difference over a hundredth of it.
    """
    v = mass.sliding_speed * np.array([0.99, 1.01])
    below, above = kinetic_friction(mass, relative_velocity=v)
    return mass.holder_damping + float(above - below) / (0.02 * mass.sliding_speed)


def dragged_motion(mass: DraggedMass, *, duration: float, steps_per_period: int = 2000) -> DraggedMotion:
    """Return the motion from rest on the belt, the spring slack.

    Parameters
    ----------
    mass : DraggedMass
    duration : float
        How long to follow it. [s]
    steps_per_period : int
        Steps to a period of the free mass.

    Returns
    -------
    DraggedMotion

    Raises
    ------
    InvalidInput
        If the duration is not positive, or takes too many steps.

    Notes
    -----
    Sliding by the classical Runge-Kutta method; sticking and breaking loose fall on ends of steps, which limits
    accuracy to the first order in the step.
    """
    require_within(20, 1e6, steps_per_period=steps_per_period)
    step = mass.period / steps_per_period
    count = int(np.ceil(float(require_positive(duration=duration)) / step)) + 1
    if count > _MOST_STEPS:
        raise InvalidInput(f"duration {duration:g} s takes {count} steps; take a shorter one or fewer steps")
    x, v, sticking = _march(
        count,
        step,
        (mass.holder_mass, mass.holder_damping, mass.holder_stiffness, mass.sliding_speed),
        (mass.coulomb_friction_force, mass.static_friction_force, mass.stribeck_velocity),
        mass.relative_velocity,
        mass.friction_ratio,
    )
    return DraggedMotion(
        time=step * np.arange(count, dtype=np.float64),
        displacement=x,
        friction_force=mass.holder_stiffness * x + mass.holder_damping * v,
        sticking=sticking,
    )


@numba.njit(cache=True)
def _march(
    count: int,
    h: float,
    holder: tuple[float, float, float, float],
    forces: tuple[float, float, float],
    speeds: Floats,
    ratios: Floats,
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    m, c, k, belt = holder
    x, v = np.zeros(count), np.full(count, belt)
    sticking = np.ones(count, dtype=np.bool_)
    holds = forces[1] * ratios[0]
    for n in range(count - 1):
        if sticking[n]:
            x[n + 1] = x[n] + belt * h
            sticking[n + 1] = k * x[n + 1] + c * belt <= holds
            continue
        way = 1.0 if v[n] < belt else -1.0
        if v[n] == belt:
            way = 1.0 if k * x[n] + c * belt > 0 else -1.0
        x1, v1 = v[n], _acceleration(x[n], v[n], way, m, c, k, belt, forces, speeds, ratios)
        x2 = v[n] + h / 2 * v1
        v2 = _acceleration(x[n] + h / 2 * x1, x2, way, m, c, k, belt, forces, speeds, ratios)
        x3 = v[n] + h / 2 * v2
        v3 = _acceleration(x[n] + h / 2 * x2, x3, way, m, c, k, belt, forces, speeds, ratios)
        x4 = v[n] + h * v3
        v4 = _acceleration(x[n] + h * x3, x4, way, m, c, k, belt, forces, speeds, ratios)
        x[n + 1] = x[n] + h / 6 * (x1 + 2 * x2 + 2 * x3 + x4)
        v[n + 1] = v[n] + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
        caught = (belt - v[n + 1]) * way <= 0
        sticking[n + 1] = caught and abs(k * x[n + 1] + c * belt) <= holds
        if sticking[n + 1]:
            v[n + 1] = belt
    return x, v, sticking


@numba.njit(cache=True)
def _acceleration(
    x: float,
    v: float,
    way: float,
    m: float,
    c: float,
    k: float,
    belt: float,
    forces: tuple[float, float, float],
    speeds: Floats,
    ratios: Floats,
) -> float:
    slip = abs(belt - v)
    force = forces[0] + (forces[1] - forces[0]) * np.exp(-((slip / forces[2]) ** 2))
    return float((way * force * np.interp(slip, speeds, ratios) - c * v - k * x) / m)
