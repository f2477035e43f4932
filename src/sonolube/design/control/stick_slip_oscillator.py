"""Stick-slip oscillator: a mass on a spring against a moving belt, with Stribeck friction reduced by vibration."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.execution.compilation import kernel
from sonolube.rig import Rig, commanded_quantity, level_settings, operating_points

_SPEEDS = 33  # at which the friction ratio is computed; it is interpolated between them
_SLOWEST = 1e-3  # of the belt's speed, whose friction ratio is taken for that at rest
_MAX_STEPS = 5_000_000
_FINAL_FRACTION = 4  # amplitude and stick fraction are those of the last quarter
_SLOPE_STEP = 0.01  # relative, of the finite difference of friction over speed


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MassOnBelt:
    r"""Mass held by a spring and a damper on a moving belt, with velocity-dependent friction.

    Parameters
    ----------
    holder_mass : float
        Mass that moves with the slider, m. [kg]
    holder_stiffness : float
        Stiffness of the holder, k. [N/m]
    holder_damping : float
        Damping of the holder, c. [N s/m]
    sliding_speed : float
        Speed of the belt, v_b. [m/s]
    coulomb_friction_force : float
        Friction at high speed, without vibration, F_c. [N]
    static_friction_force : float
        Friction at rest, without vibration, F_s. [N]
    stribeck_velocity : float
        Velocity of the transition between both, v_s. [m/s]
    relative_velocity : ndarray, shape (n,)
        Velocities of `friction_ratio`, increasing from zero. [m/s]
    friction_ratio : ndarray, shape (n,)
        Friction with vibration over friction without, R, at each velocity; ones without vibration. []

    Raises
    ------
    InvalidInput
        If a mass, stiffness, speed, force or velocity is not positive, the damping is negative, the static friction
        force is below that of sliding, or the velocities do not increase from zero.

    See Also
    --------
    mass_on_belt, stick_slip_motion

    Notes
    -----
    In sliding, with the relative velocity :math:`v = v_b - \dot x`,

    .. math::

        m \ddot x + c \dot x + k x &= F(v)

        F(v) &= R(|v|) \bigl[F_c + (F_s - F_c) e^{-(v/v_s)^2}\bigr] \operatorname{sgn} v

    At rest on the belt the friction force balances :math:`k x + c v_b` up to :math:`R(0) F_s`.
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
            raise InvalidInput(
                f"static_friction_force must not be below coulomb_friction_force, got {self.static_friction_force:g} N"
                f" and {self.coulomb_friction_force:g} N"
            )
        v = require_non_negative(relative_velocity=self.relative_velocity)
        if v.ndim != 1 or v.shape != np.shape(self.friction_ratio) or v[0] != 0 or np.any(np.diff(v) <= 0):
            raise InvalidInput("relative_velocity must increase from zero, with a friction_ratio for each entry")

    @property
    def period(self) -> float:
        """Undamped natural period of the mass on its holder, in s."""
        return float(2 * np.pi * np.sqrt(self.holder_mass / self.holder_stiffness))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StickSlipMotion:
    """Motion of a mass on a moving belt.

    Parameters
    ----------
    time : ndarray
        Time. [s]
    displacement : ndarray
        Displacement of the mass along the belt. [m]
    friction_force : ndarray
        Force of spring and damper, which a sensor in the holder measures. [N]
    sticking : ndarray of bool
        Whether the mass is at rest on the belt.
    """

    time: Floats
    displacement: Floats
    friction_force: Floats
    sticking: NDArray[np.bool_]

    @property
    def stick_slip_amplitude(self) -> float:
        """Peak-to-peak force over the last quarter, in N."""
        return float(np.ptp(self.friction_force[-self.time.size // _FINAL_FRACTION :]))

    @property
    def stick_fraction(self) -> float:
        """Fraction of the last quarter in which the mass sticks to the belt."""
        return float(np.mean(self.sticking[-self.time.size // _FINAL_FRACTION :]))


def mass_on_belt(
    rig: Rig,
    *,
    holder_mass: float,
    holder_stiffness: float,
    holder_damping: float,
    static_friction_force: float,
    stribeck_velocity: float,
    level: float,
) -> MassOnBelt:
    """Slider of a rig on an elastic holder, with the rig's friction as that of sliding.

    Parameters
    ----------
    rig : Rig
        With an amplitude.
    holder_mass : float
        Mass that moves with the slider. [kg]
    holder_stiffness : float
        Stiffness of the holder. [N/m]
    holder_damping : float
        Damping of the holder. [N s/m]
    static_friction_force : float
        Friction at rest, without vibration. [N]
    stribeck_velocity : float
        Velocity of the transition from static friction to that of sliding. [m/s]
    level : float
        Drive voltage, its offset scaled in the rig's own ratio, or amplitude of a rig without one; zero for no
        vibration, in V or m.

    Returns
    -------
    MassOnBelt

    Raises
    ------
    InvalidInput
        If the rig has no amplitude, or a value is outside its range.
    OutsideRange
        If the friction model has no result at some speed.

    See Also
    --------
    stick_slip_motion, steady_sliding_damping

    Notes
    -----
    The rig's friction model gives the friction ratio at 33 speeds in geometric sequence up to the fastest relative
    velocity; that at rest is taken from a thousandth of the belt's speed. The ratio is a mean over periods of the
    vibration, so that stick-slip must be slow against them.
    """
    fastest = 2 * rig.sliding_speed + static_friction_force / np.sqrt(holder_stiffness * holder_mass)
    speeds = np.geomspace(_SLOWEST * rig.sliding_speed, fastest, _SPEEDS)
    ratio = np.ones(_SPEEDS)
    if level > 0:
        points = operating_points(rig, **level_settings(rig, level), sliding_speed=speeds)
        if np.any(points.failed):
            raise OutsideRange(f"at {commanded_quantity(rig).text(level)}: {points.reason[points.failed][0]}")
        ratio = points.friction_ratio
    return MassOnBelt(
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


def kinetic_friction(mass: MassOnBelt, *, relative_velocity: Floats) -> Floats:
    r"""Stribeck friction force of sliding under vibration. [N]

    Parameters
    ----------
    mass : MassOnBelt
    relative_velocity : ndarray, any shape
        Velocity of the belt less that of the mass, not negative. [m/s]

    Returns
    -------
    ndarray, shape of `relative_velocity`

    Notes
    -----
    .. math:: F(v) = R(v) \bigl[F_c + (F_s - F_c) e^{-(v/v_s)^2}\bigr]
    """
    v = require_non_negative(relative_velocity=relative_velocity)
    excess = mass.static_friction_force - mass.coulomb_friction_force
    stribeck = mass.coulomb_friction_force + excess * np.exp(-((v / mass.stribeck_velocity) ** 2))
    return np.asarray(stribeck * np.interp(v, mass.relative_velocity, mass.friction_ratio))


def steady_sliding_damping(mass: MassOnBelt) -> float:
    r"""Effective damping of small motions about steady sliding, in N s/m; negative where steady sliding is unstable.

    Parameters
    ----------
    mass : MassOnBelt

    Returns
    -------
    float

    Notes
    -----
    .. math:: c_{eff} = c + \left.\frac{dF}{dv}\right|_{v_b}

    by a central difference over a hundredth of the speed to either side.
    """
    v = mass.sliding_speed * np.array([1 - _SLOPE_STEP, 1 + _SLOPE_STEP])
    below, above = kinetic_friction(mass, relative_velocity=v)
    return mass.holder_damping + float(above - below) / (2 * _SLOPE_STEP * mass.sliding_speed)


def stick_slip_motion(mass: MassOnBelt, *, duration: float, steps_per_period: int = 2000) -> StickSlipMotion:
    """Motion of a mass on a belt from rest on it with a relaxed spring, by the classical Runge-Kutta method.

    Parameters
    ----------
    mass : MassOnBelt
    duration : float
        Simulated time. [s]
    steps_per_period : int
        Time steps per natural period, 20 to 1,000,000.

    Returns
    -------
    StickSlipMotion

    Raises
    ------
    InvalidInput
        If the duration is not positive, or takes more than 5,000,000 steps.

    See Also
    --------
    mass_on_belt, steady_sliding_damping

    Notes
    -----
    Transitions between sticking and sliding fall on the ends of time steps, so that the method is of first order in
    the step there.
    """
    require_within(20, 1e6, steps_per_period=steps_per_period)
    step = mass.period / steps_per_period
    count = int(np.ceil(float(require_positive(duration=duration)) / step)) + 1
    if count > _MAX_STEPS:
        raise InvalidInput(f"duration {duration:g} s takes {count} steps, of {_MAX_STEPS} at most; shorten it")
    x, v, sticking = _integrate(
        count,
        step,
        (mass.holder_mass, mass.holder_damping, mass.holder_stiffness, mass.sliding_speed),
        (mass.coulomb_friction_force, mass.static_friction_force, mass.stribeck_velocity),
        mass.relative_velocity,
        mass.friction_ratio,
    )
    return StickSlipMotion(
        time=step * np.arange(count, dtype=np.float64),
        displacement=x,
        friction_force=mass.holder_stiffness * x + mass.holder_damping * v,
        sticking=sticking,
    )


@kernel(cache=True)
def _integrate(
    count: int,
    h: float,
    holder: tuple[float, float, float, float],
    forces: tuple[float, float, float],
    speeds: Floats,
    ratios: Floats,
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Displacement, velocity and sticking of the mass at each time step."""
    _, c, k, belt = holder
    x, v = np.zeros(count), np.full(count, belt)
    sticking = np.ones(count, dtype=np.bool_)
    holding_force = forces[1] * ratios[0]
    for n in range(count - 1):
        if sticking[n]:
            x[n + 1] = x[n] + belt * h
            sticking[n + 1] = k * x[n + 1] + c * belt <= holding_force
            continue
        direction = 1.0 if v[n] < belt else -1.0
        if v[n] == belt:
            direction = 1.0 if k * x[n] + c * belt > 0 else -1.0
        x1, v1 = v[n], _acceleration(x[n], v[n], direction, holder, forces, speeds, ratios)
        x2 = v[n] + h / 2 * v1
        v2 = _acceleration(x[n] + h / 2 * x1, x2, direction, holder, forces, speeds, ratios)
        x3 = v[n] + h / 2 * v2
        v3 = _acceleration(x[n] + h / 2 * x2, x3, direction, holder, forces, speeds, ratios)
        x4 = v[n] + h * v3
        v4 = _acceleration(x[n] + h * x3, x4, direction, holder, forces, speeds, ratios)
        x[n + 1] = x[n] + h / 6 * (x1 + 2 * x2 + 2 * x3 + x4)
        v[n + 1] = v[n] + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
        reversed_slip = (belt - v[n + 1]) * direction <= 0
        sticking[n + 1] = reversed_slip and abs(k * x[n + 1] + c * belt) <= holding_force
        if sticking[n + 1]:
            v[n + 1] = belt
    return x, v, sticking


@kernel(cache=True)
def _acceleration(
    x: float,
    v: float,
    direction: float,
    holder: tuple[float, float, float, float],
    forces: tuple[float, float, float],
    speeds: Floats,
    ratios: Floats,
) -> float:
    """Acceleration of the mass in sliding."""
    m, c, k, belt = holder
    slip = abs(belt - v)
    force = forces[0] + (forces[1] - forces[0]) * np.exp(-((slip / forces[2]) ** 2))
    return float((direction * force * np.interp(slip, speeds, ratios) - c * v - k * x) / m)
