"""Coulomb friction under vibration within the plane of contact: friction turns with the velocity and keeps its size."""

import numba
import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive


def parallel_vibration_ratio(*, sliding_speed: ArrayLike, vibration_velocity: ArrayLike) -> Floats:
    """Return friction with vibration along the sliding over friction without. []

    Parameters
    ----------
    sliding_speed : array_like
        Mean speed of the sliding. [m/s]
    vibration_velocity : array_like, broadcast against `sliding_speed`
        Peak velocity of a harmonic vibration, zero for none. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If the sliding speed is not positive, the vibration negative, or a value not finite.

    Notes
    -----
    One where the vibration never turns the velocity round; below that the share of the period in which it does counts
    against the sliding. Contacts are rigid: `dahl_under_vibration` gives them a tangential stiffness.

    References
    ----------
    .. [1] W. Littmann, H. Storck, J. Wallaschek, Arch. Appl. Mech. 71, 549 (2001). doi:10.1007/s004190100160
    .. [2] V. C. Kumar, I. M. Hutchings, Tribol. Int. 37, 833 (2004). doi:10.1016/j.triboint.2004.05.003
    """
    v_r, v_1 = _speeds(sliding_speed, vibration_velocity)
    return 2 / np.pi * np.arcsin(np.minimum(v_r / np.maximum(v_1, v_r), 1.0))


def transverse_vibration_ratio(*, sliding_speed: ArrayLike, vibration_velocity: ArrayLike) -> Floats:
    """Return friction with vibration across the sliding over friction without. []

    Parameters
    ----------
    sliding_speed : array_like
        Mean speed of the sliding. [m/s]
    vibration_velocity : array_like, broadcast against `sliding_speed`
        Peak velocity of a harmonic vibration, zero for none. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If the sliding speed is not positive, the vibration negative, or a value not finite.

    Notes
    -----
    The mean cosine of the angle between velocity and sliding, 2/pi K(m) sqrt(1 - m) with m = v^2/(v^2 + v_r^2) and the
    complete elliptic integral K; always above the ratio of a vibration along the sliding where that reduces friction.

    References
    ----------
    .. [1] V. C. Kumar, I. M. Hutchings, Tribol. Int. 37, 833 (2004). doi:10.1016/j.triboint.2004.05.003
    """
    return oblique_vibration_ratio(
        sliding_speed=sliding_speed, vibration_velocity=vibration_velocity, vibration_direction=np.pi / 2
    )


def oblique_vibration_ratio(
    *, sliding_speed: ArrayLike, vibration_velocity: ArrayLike, vibration_direction: ArrayLike
) -> Floats:
    """Return friction along the sliding with vibration at any angle to it, over friction without. []

    Parameters
    ----------
    sliding_speed : array_like
        Mean speed of the sliding. [m/s]
    vibration_velocity : array_like
        Peak velocity of a harmonic vibration, zero for none. [m/s]
    vibration_direction : array_like
        Angle between vibration and sliding. [rad]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If the sliding speed is not positive, the vibration negative, or a value not finite.

    Notes
    -----
    A substitution that keeps the ends of the stroke and removes the odd term below the root leaves one complete
    elliptic integral of Bulirsch's general form, good to 1e-12; the closed forms along and across are its limits.
    Friction also gains a mean sideways part, which is not given.

    References
    ----------
    .. [1] R. Bulirsch, Numer. Math. 13, 305 (1969). doi:10.1007/BF02165405
    """
    v_r, v_1 = _speeds(sliding_speed, vibration_velocity)
    v_r, v_1, angle = np.broadcast_arrays(v_r, v_1, require_finite(vibration_direction=vibration_direction))
    ratio = _oblique(v_r.ravel(), v_1.ravel(), np.cos(angle).ravel(), np.sin(angle).ravel())
    return ratio.reshape(v_r.shape)


def _speeds(sliding_speed: ArrayLike, vibration_velocity: ArrayLike) -> tuple[Floats, Floats]:
    return (
        require_positive(sliding_speed=sliding_speed),
        require_non_negative(vibration_velocity=vibration_velocity),
    )


@numba.njit(cache=True)
def _oblique(v_r: Floats, v_1: Floats, cosine: Floats, sine: Floats) -> Floats:
    """Return the mean over a period of the velocity's cosine to the sliding, the speeds' ratio being zeta."""
    ratios = np.ones(v_r.size)
    for i in range(v_r.size):
        if v_1[i] <= 1e-9 * v_r[i]:
            continue
        zeta, c, s = v_r[i] / v_1[i], abs(cosine[i]), abs(sine[i])
        if s < 1e-12:
            ratios[i] = 2 / np.pi * np.arcsin(min(zeta, 1.0))
            continue
        # mean of (zeta + c x)/sqrt(zeta^2 + 2 zeta c x + x^2) over x = cos(theta); x = (u + r)/(1 + r u) removes the
        # odd term of the root, (P u^2 + Q)/(1 + r u)^2, and with it the odd part of the fraction
        half_gap = np.hypot(1 - zeta * zeta, 2 * zeta * s)  # sqrt((1 + zeta^2)^2 - 4 zeta^2 c^2) without cancellation
        r = -2 * zeta * c / (1 + zeta * zeta + half_gap)
        one_less = half_gap * 2 / (1 + zeta * zeta + half_gap)  # 1 - r^2, likewise
        P = (zeta * r + c) ** 2 + s * s
        Q = (r + zeta * c) ** 2 + (zeta * s) ** 2
        p = 1 / one_less
        integral = _complete_integral(np.sqrt(Q / (P + Q)), p, zeta, p * (zeta + r * c))
        ratios[i] = min(2 / np.pi * np.sqrt(one_less / (P + Q)) * integral, 1.0)
    return ratios


@numba.njit(cache=True)
def _complete_integral(k_c: float, p: float, a: float, b: float) -> float:
    """Integrate (a cos^2 + b sin^2)/(cos^2 + p sin^2)/sqrt(cos^2 + k_c^2 sin^2) over a quarter turn, for p > 0."""
    mean, product, root = 1.0, k_c, np.sqrt(p)
    b = b / root
    while True:
        a, before = a + b / root, a
        ratio = product / root
        b = 2 * (b + before * ratio)
        root += ratio
        mean, last = mean + k_c, mean
        if abs(last - k_c) <= 1e-8 * last:  # squares at every turn
            return float(np.pi / 2 * (a * mean + b) / (mean * (mean + root)))
        k_c = 2 * np.sqrt(product)
        product = k_c * mean
