"""A slider before the springs of its contact, under oscillations in all directions and on a guide that yields."""

import warnings
from math import atan, copysign, cos, exp, hypot, pi, sin, sqrt

import numba
import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, ModelRangeWarning, OutsideRange
from sonolube.friction.bristle import Holder, bristle_on_mass, holder_propagators
from sonolube.friction.spring_coupled import SpringContact, critical_speed, normal_oscillation_ratio

_PERIODS, _STEPS = 2000, 4096
_SPRINGS = np.polynomial.legendre.leggauss(24)


def oscillation_ratio(
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
    """Return friction along the sliding under oscillations in any directions over that of the same mean load. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Mean approach; under dead weight that of `balanced_approach`. [m]
    frequency : array_like
        Frequency of all oscillations. [Hz]
    sliding_speed : array_like
        Mean speed of the sliding. [m/s]
    normal_amplitude : array_like
        Amplitude along the surface normal. [m]
    in_plane_amplitude : array_like
        Amplitude along the sliding direction. [m]
    in_plane_phase : array_like
        Lag of the motion along the sliding behind that apart, u cos(omega t - phase). [rad]
    transverse_amplitude : array_like
        Amplitude across the sliding, within the plane. [m]
    transverse_phase : array_like
        Lag of the motion across behind that apart. [rad]
    steps : int
        Steps into which the period is divided.

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Negative where oscillations in step carry the slider on, as those of a motor do.

    Raises
    ------
    InvalidInput
        If frequency or speed is not positive, an amplitude negative, steps fewer than 8, or a value not finite.
    OutsideRange
        If the bodies never touch.

    Warns
    -----
    ModelRangeWarning
        If a spring found no steady period in 2000; the last is taken.

    Notes
    -----
    Springs without mass on a rigid guide, stretched in the plane; one at its limit follows the slide as an end follows
    the tractor that drags it. Along each straight step that is exact, so that the error falls with the square of the
    step, and is below 1e-4 with 1024. Across alone, flat and slow, the ratio is sqrt(1 - (k_x a/(mu F_N))^2), zero from
    the stroke on that slides the spring; a long stroke gives `transverse_vibration_ratio`.

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
        raise OutsideRange("the bodies never touch: approach and normal_amplitude together must be positive")
    nodes, weights = (np.zeros(1), np.ones(1)) if contact.profile == "flat" else _SPRINGS
    ratio, settled = _driven(
        u.ravel(),
        (v_r / f).ravel(),
        a_z.ravel(),
        a_x.ravel(),
        lag_x.ravel(),
        a_y.ravel(),
        lag_y.ravel(),
        contact.slip_per_approach,
        nodes,
        weights,
        steps,
    )
    if not settled:
        warnings.warn(
            f"a spring found no steady period in {_PERIODS}; the last is taken. Faster sliding settles sooner",
            ModelRangeWarning,
            stacklevel=2,
        )
    return ratio.reshape(u.shape)


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
    """Return friction under an oscillation along the normal, the slider on a guide that yields, over that without. []

    Parameters
    ----------
    contact : SpringContact
        Of the flat profile.
    holder : Holder
        The guide: stiffness, damping and the mass that moves with the slider.
    normal_stiffness : float
        Stiffness of the contact along the normal. [N/m]
    approach : float
        Mean approach. [m]
    normal_amplitude : float
        Amplitude along the surface normal. [m]
    frequency : float
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like, any shape
        Mean speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If the profile is not flat, a value not finite, or one but the approach not positive.
    OutsideRange
        If the bodies never touch.

    Warns
    -----
    ModelRangeWarning
        If slider and guide found no steady period; the mean over the last of many periods is given.

    Notes
    -----
    A guide without mass stands in series with the contact. With mass the slider swings so far at the resonance of the
    guide that friction falls at any speed; a slider far heavier than that is rigidly guided. `guided_critical_speed`
    says where the reduction ends. Error about 1e-3.

    References
    ----------
    .. [1] X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017). doi:10.1007/s40544-017-0146-x
    """
    if contact.profile != "flat":
        raise InvalidInput(
            "profile must be 'flat' on a guide that yields: springs that slip apart would move it together"
        )
    k_z = float(require_positive(normal_stiffness=normal_stiffness))
    u, a = float(require_finite(approach=approach)), float(require_positive(normal_amplitude=normal_amplitude))
    f, v_r = float(require_positive(frequency=frequency)), require_positive(sliding_speed=sliding_speed)
    if u + a <= 0:
        raise OutsideRange("the bodies never touch: approach and normal_amplitude together must be positive")
    theta = 2 * np.pi * np.arange(_STEPS) / _STEPS
    limit = contact.friction_coefficient * k_z * np.maximum(u - a * np.cos(theta), 0.0)
    k_x = np.full(_STEPS, contact.mindlin_ratio * k_z)
    if holder.holder_mass == 0:
        slower = v_r / (1 + k_x[0] / holder.holder_stiffness)
        return normal_oscillation_ratio(contact, approach=u, normal_amplitude=a, frequency=f, sliding_speed=slower)
    step = 1 / (f * _STEPS)
    pulled = np.mean(limit) / holder.holder_stiffness
    forces, settled = bristle_on_mass(
        k_x,
        limit,
        np.zeros(_STEPS),
        v_r.ravel() * step,
        step,
        0.0,
        *holder_propagators(holder, step),
        np.full(v_r.size, pulled),
    )
    if not settled:
        warnings.warn(
            "slider and guide found no steady period; the mean over the last of many is given."
            " More holder_damping lets them settle",
            ModelRangeWarning,
            stacklevel=2,
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
    """Return the sliding speed from which an oscillation along the normal cannot make a guided slider grip. [m/s]

    Parameters
    ----------
    contact : SpringContact
    holder : Holder
        The guide: stiffness, damping and the mass that moves with the slider.
    normal_stiffness : array_like
        Stiffness of the contact along the normal. [N/m]
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
    Sliding throughout, the friction swings by mu k_z a, the spring by that over k_x and the guide by that over
    K - m omega^2 + i c omega. The speed is mu k_z a omega abs(1/k_x + 1/(K - m omega^2 + i c omega)): without bound
    where the guide resonates, at omega^2 = K/m, and none at omega^2 = (K + k_x)/m, where both swings cancel. For
    bodies that touch throughout.

    References
    ----------
    .. [1] X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017), who find the resonant case without
       critical speed. doi:10.1007/s40544-017-0146-x
    """
    k_z = require_positive(normal_stiffness=normal_stiffness)
    rigid = critical_speed(contact, frequency=frequency, normal_amplitude=normal_amplitude)
    omega = 2 * np.pi * require_positive(frequency=frequency)
    if np.isinf(holder.holder_stiffness):
        return rigid + np.zeros_like(k_z)
    guide = holder.holder_stiffness - holder.holder_mass * omega**2 + 1j * holder.holder_damping * omega
    resonant = guide == 0
    yielded = np.abs(1 + contact.mindlin_ratio * k_z / np.where(resonant, 1.0, guide))
    return np.where(rigid > 0, rigid * np.where(resonant, np.inf, yielded), 0.0)


@numba.njit(cache=True)
def _driven(
    u: Floats,
    per_period: Floats,
    a_z: Floats,
    a_x: Floats,
    lag_x: Floats,
    a_y: Floats,
    lag_y: Floats,
    slip: float,
    nodes: Floats,
    weights: Floats,
    n: int,
) -> tuple[Floats, bool]:
    ratio = np.empty(u.size)
    depth, x, y = np.empty(n + 1), np.empty(n + 1), np.empty(n + 1)
    settled = True
    for i in range(u.size):
        for k in range(n + 1):
            theta = 2 * pi * k / n
            depth[k] = slip * (u[i] - a_z[i] * cos(theta))
            x[k] = per_period[i] * k / n + a_x[i] * cos(theta - lag_x[i])
            y[k] = a_y[i] * cos(theta - lag_y[i])
        edge = sqrt(slip * (u[i] + a_z[i]))
        friction, limit = 0.0, 0.0
        for j in range(nodes.size):
            q = edge * (1 + nodes[j]) / 2
            force, most, steady = _periodic(depth, q * q if nodes.size > 1 else 0.0, x, y)
            friction += weights[j] * force
            limit += weights[j] * most
            settled = settled and steady
        ratio[i] = friction / limit
    return ratio, settled


@numba.njit(cache=True)
def _periodic(depth: Floats, lowered: float, x: Floats, y: Floats) -> tuple[float, float, bool]:
    """Return mean force along x and mean limit of one spring over its steady period, in lengths of stretch."""
    n = depth.size - 1
    p, q = max(depth[0] - lowered, 0.0), 0.0
    friction = most = 0.0
    for _ in range(_PERIODS):
        begun_p, begun_q = p, q
        friction = most = 0.0
        for k in range(n):
            before, after = depth[k] - lowered, depth[k + 1] - lowered
            last_p = p
            p, q = _slid(p, q, before, after, x[k + 1] - x[k], y[k + 1] - y[k])
            friction += (last_p + p) / 2
            most += (max(before, 0.0) + max(after, 0.0)) / 2
        if hypot(p - begun_p, q - begun_q) <= 1e-9 * most / n:
            return friction / n, most / n, True
    return friction / n, most / n, most == 0.0


@numba.njit(cache=True)
def _slid(p: float, q: float, before: float, after: float, dx: float, dy: float) -> tuple[float, float]:
    """Return a spring's stretch after a straight slide while its limit runs from `before` to `after`."""
    if after <= 0.0:
        return 0.0, 0.0
    if before < 0.0:  # touches within the step
        held = after / (after - before)
        p, q, before, dx, dy = 0.0, 0.0, 0.0, dx * held, dy * held
    change = after - before
    if hypot(p + dx, q + dy) <= after:
        return p + dx, q + dy
    # |stretch + s slide| = before + s change
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
    if across == 0.0:  # in line, and it stays so even where it faces the slide
        kept = copysign(after / whole, along)
        return kept * dx, kept * dy
    mean = (before + stuck * change + after) / 2
    # tangent of half the angle to the slide, of both its forms that which does not cancel
    half = abs(across) / (whole + along) if along > 0 else (whole - along) / abs(across)
    turned = 2 * atan(half * exp(-slide / mean))
    c, s = cos(turned), -copysign(sin(turned), across)
    return after * (dx * c - dy * s) / whole, after * (dy * c + dx * s) / whole
