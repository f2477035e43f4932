"""Stick-slip of a mass pulled by a spring at constant speed, with LuGre friction: history, period and peaks."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.integrate import solve_ivp

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.friction.bristle import Holder
from sonolube.models.friction.laws.lugre import LuGreFriction

_SAMPLES = 4001
_RELATIVE_TOLERANCE = 1e-8
_SAME_PERIOD = 0.01  # relative difference of two periods below which the motion repeats
_STUCK = 0.01  # of the pulling speed, below which the mass counts as stuck
_LATE = 0.75  # of the duration, from which a motion without period is judged
_STEADY = 0.01  # of the Coulomb friction force, range of the spring force of steady sliding


class SlidingKind(StrEnum):
    """Kind of the motion that a pulled mass ends in."""

    STICK_SLIP = "stick_slip"
    """It repeats, and the mass rests within every period."""

    STEADY_SLIDING = "steady_sliding"
    """The mass follows the pulled end at its speed."""

    OSCILLATION = "oscillation"
    """It repeats, and the mass never rests."""

    UNSETTLED = "unsettled"
    """It has not repeated within the duration."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StickSlipHistory:
    """Motion of a mass pulled by a spring from rest, and the measures of its stick-slip.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Uniform times from the first motion of the pulled end. [s]
    displacement : ndarray, shape (n,)
        Displacement of the mass. [m]
    velocity : ndarray, shape (n,)
        Velocity of the mass, in m/s.
    spring_force : ndarray, shape (n,)
        Force of spring and damper on the mass, in N.
    friction_force : ndarray, shape (n,)
        Friction force on the mass, against its motion. [N]
    kind : SlidingKind
        Kind of the motion at the end.
    reason : str
        Meaning of the kind, and advice where the motion has not settled.
    first_slip_time : float
        Time at which the mass first overtakes the pulled end, where the spring force passes its first maximum; NaN if
        it never does, in s.
    period : float
        Time between the last two such overtakings; NaN unless the motion repeats. [s]
    peak_spring_force : float
        Highest spring force within the last period, within the last quarter for steady sliding, in N.
    peak_friction_force : float
        Highest friction force within the same time, that at breakaway, in N.
    peak_velocity : float
        Highest velocity of the mass within the same time, in m/s.
    """

    time: Floats
    displacement: Floats
    velocity: Floats
    spring_force: Floats
    friction_force: Floats
    kind: SlidingKind
    reason: str
    first_slip_time: float
    period: float
    peak_spring_force: float
    peak_friction_force: float
    peak_velocity: float


def lugre_stick_slip(
    law: LuGreFriction, drive: Holder, *, sliding_speed: float, duration: float, samples: int = _SAMPLES
) -> StickSlipHistory:
    r"""Motion of a mass that a spring pulls from rest over a surface with LuGre friction.

    Parameters
    ----------
    law : LuGreFriction
    drive : Holder
        Stiffness K and damping c of the spring, and mass m.
    sliding_speed : float
        Speed of the pulled end of the spring, v. [m/s]
    duration : float
        Simulated time; some periods after the first slip are needed for a period. [s]
    samples : int
        Number of uniform times in the history.

    Returns
    -------
    StickSlipHistory

    Raises
    ------
    InvalidInput
        If the drive has no mass or is rigid, a speed or duration is not positive, or samples are fewer than two.

    Notes
    -----
    .. math::

        \dot e = v - w, \qquad m \dot w = K e + c \dot e - F, \qquad F = \sigma_0 z + \sigma_1 \dot z + \sigma_2 w

    with the elongation e of the spring, the velocity w of the mass and the LuGre bristle deflection z, from relaxed
    spring and bristles, by the implicit Adams and BDF methods of LSODA to a relative tolerance of 1e-8. Peaks are
    taken from its steps, not from the samples, and slips are its events.

    With stiff bristles, a Stribeck velocity far below v (and far above :math:`K v/\sigma_0`, the creep before
    breakaway) and no other damping the mass is that of rigid Coulomb friction with a static limit. With
    :math:`\omega^2 = K/m` and :math:`\Delta = F_s - F_c` it breaks away at :math:`F_s/(K v)`, and

    .. math::

        t_1 &= \frac{F_s}{K v} + \frac1\omega \arctan\frac{K v}{\Delta\, \omega}, &
        T &= \frac{2 \Delta}{K v} + \frac2\omega \left(\pi - \arctan\frac{\Delta\, \omega}{K v}\right), \\
        \hat w &= v + \sqrt{v^2 + \frac{\Delta^2}{K m}}, &
        \hat F_{spring} &= F_c + \sqrt{\Delta^2 + K m v^2}, \qquad \hat F = F_s

    for the first slip, the period, the peak velocity, and the peak forces of spring and friction.

    See Also
    --------
    spring_driven_slider_force : Mean drive force of such a mass over a vibrating surface.
    sonolube.design.control.stick_slip_motion : The same mass with a static friction law and a rig's vibration.

    References
    ----------
    .. [1] C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, IEEE Trans. Autom. Control 40, 419 (1995),
       section III B. doi:10.1109/9.376053
    """
    if drive.holder_mass == 0 or not np.isfinite(drive.holder_stiffness):
        raise InvalidInput("lugre_stick_slip needs a holder with a mass and an elastic spring")
    if samples < 2:
        raise InvalidInput(f"samples must be at least 2, got {samples!r}")
    v = float(require_positive(sliding_speed=sliding_speed))
    end = float(require_positive(duration=duration))
    K, c, m = drive.holder_stiffness, drive.holder_damping, drive.holder_mass
    F_c, F_s, v_s = law.coulomb_friction_force, law.static_friction_force, law.stribeck_velocity
    s_0, s_1, s_2 = law.bristle_stiffness, law.bristle_damping, law.viscous_coefficient

    def forces(state: Floats) -> tuple[Floats, Floats, Floats]:
        """Forces of spring and friction, and the rate of the bristles."""
        e, w, z = state
        rate = w - np.abs(w) * s_0 * z / (F_c + (F_s - F_c) * np.exp(-((w / v_s) ** 2)))
        return K * e + c * (v - w), s_0 * z + s_1 * rate + s_2 * w, rate

    def rates(_: float, state: Floats) -> list[Floats]:
        spring, friction, bristle_rate = forces(state)
        return [v - state[1], (spring - friction) / m, bristle_rate]

    def overtaking(_: float, state: Floats) -> float:
        return float(state[1] - v)

    overtaking.direction = 1  # type: ignore[attr-defined]
    found = solve_ivp(
        rates,
        (0.0, end),
        [0.0, 0.0, 0.0],
        method="LSODA",
        dense_output=True,
        events=overtaking,
        rtol=_RELATIVE_TOLERANCE,
        atol=[_RELATIVE_TOLERANCE * F_c / K, _RELATIVE_TOLERANCE * v, _RELATIVE_TOLERANCE * F_c / s_0],
        max_step=end / 200,
    )
    if not found.success:
        raise InvalidInput(f"the motion cannot be integrated: {found.message}; check the parameters of law and drive")
    slips, (spring, friction, _) = found.t_events[0], forces(found.y)
    kind, reason = _kind(found.t, found.y[1], spring, slips, speed=v, coulomb=F_c)
    repeats = kind in (SlidingKind.STICK_SLIP, SlidingKind.OSCILLATION)
    last = found.t >= (slips[-2] if repeats else _LATE * end)
    time = np.linspace(0, end, samples)
    state = found.sol(time)
    sampled_spring, sampled_friction, _ = forces(state)
    return StickSlipHistory(
        time=time,
        displacement=v * time - state[0],
        velocity=state[1],
        spring_force=sampled_spring,
        friction_force=sampled_friction,
        kind=kind,
        reason=reason,
        first_slip_time=float(slips[0]) if slips.size else float("nan"),
        period=float(slips[-1] - slips[-2]) if repeats else float("nan"),
        peak_spring_force=float(spring[last].max()),
        peak_friction_force=float(friction[last].max()),
        peak_velocity=float(found.y[1][last].max()),
    )


def _kind(
    time: Floats, velocity: Floats, spring: Floats, slips: Floats, *, speed: float, coulomb: float
) -> tuple[SlidingKind, str]:
    """Kind of the motion at the end, and its meaning."""
    late = time >= _LATE * time[-1]
    if np.ptp(spring[late]) < _STEADY * coulomb and velocity[late].min() > 0.5 * speed:
        return SlidingKind.STEADY_SLIDING, "steady_sliding: the mass follows the pulled end at its speed"
    if slips.size >= 3 and abs(slips[-1] - 2 * slips[-2] + slips[-3]) < _SAME_PERIOD * (slips[-1] - slips[-2]):
        within = (time >= slips[-2]) & (time <= slips[-1])
        if velocity[within].min(initial=np.inf) < _STUCK * speed:
            return SlidingKind.STICK_SLIP, "stick_slip: the mass rests and slips in turn, once a period"
        return SlidingKind.OSCILLATION, "oscillation: the mass oscillates without rest"
    return SlidingKind.UNSETTLED, f"unsettled: {slips.size} slips that do not repeat yet; lengthen the duration"
