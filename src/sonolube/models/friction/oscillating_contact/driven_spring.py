"""Friction of a spring contact by time integration: oscillations in several directions, or a compliant guide."""

from math import atan, copysign, cos, exp, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange, warn_of_range
from sonolube.execution.compilation import INNER, kernel
from sonolube.models.friction.bristle import Holder, holder_propagators, mean_force_inertial_holder
from sonolube.models.friction.oscillating_contact.rigid_guide import normal_oscillation_ratio
from sonolube.models.friction.oscillating_contact.spring_contact import SpringContact, critical_speed

_MAXIMUM_PERIODS = 2000
_QUADRATURE = np.polynomial.legendre.leggauss(24)


def combined_oscillation_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
    normal_amplitude: ArrayLike = 0.0,
    in_plane_amplitude: ArrayLike = 0.0,
    in_plane_phase: ArrayLike = 0.0,
    transverse_amplitude: ArrayLike = 0.0,
    transverse_phase: ArrayLike = 0.0,
    steps: int = 1024,
) -> Floats:
    r"""Friction ratio along the sliding direction under oscillations in all directions. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Mean approach; under a dead load that of `load_balanced_approach`. [m]
    frequency : array_like
        Frequency of all oscillations. [Hz]
    sliding_speed : array_like
        Mean sliding speed. [m/s]
    normal_amplitude : array_like
        Amplitude along the surface normal. [m]
    in_plane_amplitude : array_like
        Amplitude along the sliding direction. [m]
    in_plane_phase : array_like
        Lag of the motion along the sliding behind the normal one, u cos(omega t - phase). [rad]
    transverse_amplitude : array_like
        Amplitude across the sliding, within the plane. [m]
    transverse_phase : array_like
        Lag of the motion across the sliding behind the normal one. [rad]
    steps : int
        Number of steps of a period, at least 8.

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Friction over that of the same mean normal force; negative where the oscillations drive the slider, as in a
        motor.

    Raises
    ------
    InvalidInput
        If frequency or speed is not positive, an amplitude negative, steps below 8, or a value not finite.
    OutsideRange
        If contact is lost throughout the period.

    Warns
    -----
    ModelRangeWarning
        If a spring reaches no steady period in 2000; the last period is used.

    Notes
    -----
    Massless springs on a rigid guide, deformed by the vector s within the plane. A sticking spring follows the slide; a
    slipping one has the length of its limit and the direction of a tractrix,

    .. math::

        \dot{\boldsymbol s} = \boldsymbol v - \lambda \boldsymbol s, \qquad
        |\boldsymbol s| = \frac{\mu k_z}{k_x} \max(u - a_z \cos\omega t,\, 0)

    integrated exactly along straight steps, so that the error is second order in the step and below 1e-4 with 1024.
    Across alone the flat profile gives sqrt(1 - (k_x a/(mu F_N))^2) for slow sliding, zero from the stroke of full slip
    on; a long stroke gives `transverse_vibration_ratio`.

    See Also
    --------
    normal_oscillation_ratio, longitudinal_oscillation_ratio : Closed forms for one direction.
    elliptical_traction_ratio : Normal and longitudinal motion without tangential springs.

    References
    ----------
    .. [1] J. Benad, K. Nakano, V. L. Popov and M. Popov, Friction 7, 74 (2019), across. doi:10.1007/s40544-018-0202-1
    .. [2] M. Popov and Q. Li, Phys. Mesomech. 21, 24 (2018), along and normal at once. doi:10.1134/S1029959918010046
    """
    if steps < 8:
        raise InvalidInput(f"steps must be at least 8, got {steps!r}")
    u, f, v_r, a_z, a_x, lag_x, a_y, lag_y = np.broadcast_arrays(
        require_finite(approach=approach),
        require_positive(frequency=frequency),
        require_positive(sliding_speed=sliding_speed),
        require_non_negative(normal_amplitude=normal_amplitude),
        require_non_negative(in_plane_amplitude=in_plane_amplitude),
        require_finite(in_plane_phase=in_plane_phase),
        require_non_negative(transverse_amplitude=transverse_amplitude),
        require_finite(transverse_phase=transverse_phase),
    )
    if np.any(u + a_z <= 0):
        raise OutsideRange("contact is lost throughout the period: approach plus normal_amplitude must be positive")
    nodes, weights = (np.zeros(1), np.ones(1)) if contact.profile == "flat" else _QUADRATURE
    shape, slip = u.shape, contact.slip_per_approach
    u, slide, a_z, a_x, lag_x, a_y, lag_y = (each.ravel() for each in (u, v_r / f, a_z, a_x, lag_x, a_y, lag_y))
    ratio, settled = _mean_ratios(u, slide, a_z, a_x, lag_x, a_y, lag_y, slip, nodes, weights, steps)
    if not settled:
        warn_of_range(
            f"a spring has no steady period within {_MAXIMUM_PERIODS}; the last one is used. Increase sliding_speed"
        )
    return ratio.reshape(shape)


@kernel(cache=True, no_cfunc_wrapper=True)
def _mean_ratios(
    u: Floats,
    slide_per_period: Floats,
    a_z: Floats,
    a_x: Floats,
    lag_x: Floats,
    a_y: Floats,
    lag_y: Floats,
    slip_per_approach: float,
    nodes: Floats,
    weights: Floats,
    n: int,
) -> tuple[Floats, bool]:
    """Friction ratio of each point over the springs of its profile, and whether all became periodic."""
    ratio = np.empty(u.size)
    limit, x, y = np.empty(n + 1), np.empty(n + 1), np.empty(n + 1)
    settled = True
    for i in range(u.size):
        for k in range(n + 1):
            theta = 2 * pi * k / n
            limit[k] = slip_per_approach * (u[i] - a_z[i] * cos(theta))
            x[k] = slide_per_period[i] * k / n + a_x[i] * cos(theta - lag_x[i])
            y[k] = a_y[i] * cos(theta - lag_y[i])
        edge = sqrt(slip_per_approach * (u[i] + a_z[i]))
        friction, normal = 0.0, 0.0
        for j in range(nodes.size):
            q = edge * (1 + nodes[j]) / 2
            force, mean_limit, steady = steady_spring_period(limit, q * q if nodes.size > 1 else 0.0, x, y)
            friction += weights[j] * force
            normal += weights[j] * mean_limit
            settled = settled and steady
        ratio[i] = friction / normal
    return ratio, settled


@kernel(**INNER)
def steady_spring_period(limit: Floats, offset: float, x: Floats, y: Floats) -> tuple[float, float, bool]:
    """Mean force along x and the mean limit of one spring over its steady period, as deformations."""
    n = limit.size - 1
    p, q = max(limit[0] - offset, 0.0), 0.0
    friction = mean_limit = 0.0
    for _ in range(_MAXIMUM_PERIODS):
        start_p, start_q = p, q
        friction = mean_limit = 0.0
        for k in range(n):
            before, after = limit[k] - offset, limit[k + 1] - offset
            last_p = p
            p, q = slide_spring(p, q, before, after, x[k + 1] - x[k], y[k + 1] - y[k])
            friction += (last_p + p) / 2
            mean_limit += (max(before, 0.0) + max(after, 0.0)) / 2
        if hypot(p - start_p, q - start_q) <= 1e-9 * mean_limit / n:
            return friction / n, mean_limit / n, True
    return friction / n, mean_limit / n, mean_limit == 0.0


@kernel(**INNER)
def slide_spring(p: float, q: float, before: float, after: float, dx: float, dy: float) -> tuple[float, float]:
    """Deformation of a spring after a straight slide while its limit changes from `before` to `after`."""
    if after <= 0.0:
        return 0.0, 0.0
    if before < 0.0:  # comes into contact within the step
        fraction = after / (after - before)
        p, q, before, dx, dy = 0.0, 0.0, 0.0, dx * fraction, dy * fraction
    change = after - before
    if hypot(p + dx, q + dy) <= after:
        return p + dx, q + dy
    # |deformation + s slide| = before + s change
    A, B, C = dx * dx + dy * dy - change * change, p * dx + q * dy - before * change, p * p + q * q - before * before
    root = sqrt(max(B * B - A * C, 0.0))
    C = min(C, 0.0)
    stuck = 0.0
    if B + root > 0:
        stuck = min(max(-C / (B + root), 0.0), 1.0)
    elif A != 0.0:
        stuck = min(max((root - B) / A, 0.0), 1.0)
    p, q, left = p + stuck * dx, q + stuck * dy, 1 - stuck
    length, slide = hypot(p, q), hypot(dx, dy) * left
    if slide == 0.0 or length == 0.0:
        if length == 0.0:
            whole = hypot(dx, dy)
            return after * dx / whole, after * dy / whole
        return p / length * after, q / length * after
    along, across = (p * dx + q * dy) / length, (p * dy - q * dx) / length
    whole = hypot(dx, dy)
    if across == 0.0:  # collinear, and it remains so even if opposed to the slide
        scaled = copysign(after / whole, along)
        return scaled * dx, scaled * dy
    mean = (before + stuck * change + after) / 2
    # tangent of half the angle to the slide, in the form without cancellation
    half = abs(across) / (whole + along) if along > 0 else (whole - along) / abs(across)
    angle = 2 * atan(half * exp(-slide / mean))
    c, s = cos(angle), -copysign(sin(angle), across)
    return after * (dx * c - dy * s) / whole, after * (dy * c + dx * s) / whole


_STEPS = 4096  # of a period


def guided_oscillation_ratio(
    contact: SpringContact,
    holder: Holder,
    *,
    normal_stiffness: ArrayLike,
    approach: ArrayLike,
    normal_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    r"""Friction ratio under an oscillation along the normal on a compliant guide. []

    Parameters
    ----------
    contact : SpringContact
        Contact of the flat profile.
    holder : Holder
        Stiffness and damping of the guide, and mass that moves with the slider.
    normal_stiffness : float
        Normal stiffness of the contact. [N/m]
    approach : float
        Mean approach. [m]
    normal_amplitude : float
        Amplitude along the surface normal. [m]
    frequency : float
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like, any shape
        Mean sliding speed. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If the profile is not flat, a value is not finite, or a value other than the approach is not positive.
    OutsideRange
        If contact is lost throughout the period.

    Warns
    -----
    ModelRangeWarning
        If no steady period is found; the mean over the last of many periods is returned.

    Notes
    -----
    .. math:: m \ddot y + c \dot y + K y = F, \qquad \dot F = k_x (v_r - \dot y), \quad |F| \le \mu F_n(t)

    A guide without mass is a spring in series with the contact. At the resonance of a guide with mass the slider
    oscillates so far that friction is reduced at any speed; a slider much heavier than at resonance is rigidly guided.
    The reduction ends at `guided_critical_speed`. Error about 1e-3.

    See Also
    --------
    approximate_guided_ratio : Approximation in closed form.

    References
    ----------
    .. [1] X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017). doi:10.1007/s40544-017-0146-x
    """
    if contact.profile != "flat":
        raise InvalidInput(
            "profile must be 'flat' on a compliant guide, whose displacement couples the springs of other profiles"
        )
    k_z = float(require_positive(normal_stiffness=normal_stiffness))
    u, a = float(require_finite(approach=approach)), float(require_positive(normal_amplitude=normal_amplitude))
    f, v_r = float(require_positive(frequency=frequency)), require_positive(sliding_speed=sliding_speed)
    if u + a <= 0:
        raise OutsideRange("contact is lost throughout the period: approach plus normal_amplitude must be positive")
    theta = 2 * np.pi * np.arange(_STEPS) / _STEPS
    limit = contact.friction_coefficient * k_z * np.maximum(u - a * np.cos(theta), 0.0)
    k_x = np.full(_STEPS, contact.mindlin_ratio * k_z)
    if holder.holder_mass == 0:
        speed = v_r / (1 + k_x[0] / holder.holder_stiffness)
        return normal_oscillation_ratio(contact, approach=u, normal_amplitude=a, frequency=f, sliding_speed=speed)
    step = 1 / (f * _STEPS)
    deflection = np.full(v_r.size, np.mean(limit) / holder.holder_stiffness)
    slides, matrices = (np.zeros(_STEPS), v_r.ravel() * step), holder_propagators(holder, step)
    forces, settled = mean_force_inertial_holder(k_x, limit, *slides, step, 0.0, matrices, deflection)
    if not settled:
        warn_of_range(
            "no steady period of slider and guide was found; the mean over the last of many periods is returned."
            " Increase holder_damping"
        )
    return (forces / np.mean(limit)).reshape(v_r.shape)


def guided_critical_speed(
    contact: SpringContact,
    holder: Holder,
    *,
    normal_stiffness: ArrayLike,
    normal_amplitude: ArrayLike,
    frequency: ArrayLike,
) -> Floats:
    r"""Critical speed of an oscillation along the normal on a compliant guide. [m/s]

    Parameters
    ----------
    contact : SpringContact
    holder : Holder
        Stiffness and damping of the guide, and mass that moves with the slider.
    normal_stiffness : array_like
        Normal stiffness of the contact. [N/m]
    normal_amplitude : array_like
        Amplitude along the surface normal. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Infinite at the resonance of a guide without damping.

    Raises
    ------
    InvalidInput
        If stiffness or frequency is not positive, or the amplitude negative.

    Notes
    -----
    .. math:: v_c = \mu k_z a\, \omega \left| \frac1{k_x} + \frac1{K - m \omega^2 + \mathrm{i} c \omega} \right|

    While the contact slips throughout, friction oscillates with the amplitude mu k_z a, and deforms the contact spring
    and the guide. The speed is unbounded at the resonance of the guide, omega^2 = K/m, and zero at
    omega^2 = (K + k_x)/m, where both deformations cancel. Holds without loss of contact.

    See Also
    --------
    critical_speed : Critical speed on a rigid guide.

    References
    ----------
    .. [1] X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017), who find no critical speed at
       resonance. doi:10.1007/s40544-017-0146-x
    """
    k_z = require_positive(normal_stiffness=normal_stiffness)
    rigid = critical_speed(contact, frequency=frequency, normal_amplitude=normal_amplitude)
    omega = 2 * np.pi * require_positive(frequency=frequency)
    if np.isinf(holder.holder_stiffness):
        return rigid + np.zeros_like(k_z)
    guide = holder.holder_stiffness - holder.holder_mass * omega**2 + 1j * holder.holder_damping * omega
    resonant = guide == 0
    factor = np.abs(1 + contact.mindlin_ratio * k_z / np.where(resonant, 1.0, guide))
    return np.where(rigid > 0, rigid * np.where(resonant, np.inf, factor), 0.0)
