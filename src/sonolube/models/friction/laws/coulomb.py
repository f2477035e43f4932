"""Coulomb friction: its coefficient, and the mean friction ratio of rigid contacts under vibration within the plane.

The friction force has constant magnitude and the direction of the relative velocity. Contacts with a tangential
stiffness are in `dahl_under_vibration` and `sonolube.models.friction.oscillating_contact`.
"""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.execution.compilation import INNER, kernel


def friction_coefficient(*, friction_force: ArrayLike, normal_load: ArrayLike) -> Floats:
    """Coefficient of friction, friction force over normal load. []

    Parameters
    ----------
    friction_force : array_like
        Friction force, of either sign. [N]
    normal_load : array_like, broadcast against `friction_force`
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a load is not positive, or a value not finite.

    References
    ----------
    .. [1] D 1.1.

    Examples
    --------
    >>> from sonolube.models.friction import friction_coefficient
    >>> round(float(friction_coefficient(friction_force=1.023, normal_load=3.0)), 3)
    0.341
    """
    force = require_finite(friction_force=friction_force)
    return force / require_positive(normal_load=normal_load)


_FEW = 20_000  # points for which plain Python takes less than compiling


def parallel_vibration_ratio(*, sliding_speed: ArrayLike, vibration_velocity: ArrayLike) -> Floats:
    r"""Mean friction ratio under vibration along the sliding direction by Coulomb's law. []

    Parameters
    ----------
    sliding_speed : array_like
        Mean sliding speed. [m/s]
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
    .. math:: \frac{F_1}{F_0} = \frac2\pi \arcsin \frac{v_r}{v_1} \quad (v_r < v_1), \qquad
              \frac{F_1}{F_0} = 1 \quad (v_r \ge v_1)

    Friction is reduced only where the vibration reverses the relative velocity for part of the period.

    See Also
    --------
    transverse_vibration_ratio : Vibration across the sliding direction.
    longitudinal_oscillation_ratio : The same with the springs of an elastic contact.

    References
    ----------
    .. [1] W. Littmann, H. Storck, J. Wallaschek, Arch. Appl. Mech. 71, 549 (2001). doi:10.1007/s004190100160
    .. [2] V. C. Kumar, I. M. Hutchings, Tribol. Int. 37, 833 (2004). doi:10.1016/j.triboint.2004.05.003

    Examples
    --------
    >>> from sonolube.models.friction import parallel_vibration_ratio
    >>> ratio = parallel_vibration_ratio(sliding_speed=[0.1, 0.2, 0.3], vibration_velocity=0.2)
    >>> ratio.round(4).tolist()  # 2/pi arcsin 1/2, and no reduction from the peak velocity on
    [0.3333, 1.0, 1.0]
    """
    v_r, v_1 = _speeds(sliding_speed, vibration_velocity)
    return 2 / np.pi * np.arcsin(np.minimum(v_r / np.maximum(v_1, v_r), 1.0))


def transverse_vibration_ratio(*, sliding_speed: ArrayLike, vibration_velocity: ArrayLike) -> Floats:
    r"""Mean friction ratio under vibration across the sliding direction by Coulomb's law. []

    Parameters
    ----------
    sliding_speed : array_like
        Mean sliding speed. [m/s]
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
    .. math:: \frac{F_1}{F_0} = \left\langle \frac{v_r}{\sqrt{v_r^2 + v_1^2 \cos^2\omega t}} \right\rangle
              = \frac2\pi \sqrt{1 - m}\, K(m), \qquad m = \frac{v_1^2}{v_1^2 + v_r^2}

    the mean cosine of the angle between relative velocity and sliding direction, with the complete elliptic integral K
    of parameter m. It exceeds the ratio of a vibration along the sliding direction where that reduces friction.

    See Also
    --------
    oblique_vibration_ratio : Vibration at any angle to the sliding direction.

    References
    ----------
    .. [1] V. C. Kumar, I. M. Hutchings, Tribol. Int. 37, 833 (2004). doi:10.1016/j.triboint.2004.05.003

    Examples
    --------
    >>> from sonolube.models.friction import parallel_vibration_ratio, transverse_vibration_ratio
    >>> speeds = {"sliding_speed": 0.1, "vibration_velocity": 0.2}
    >>> round(float(parallel_vibration_ratio(**speeds)), 3), round(float(transverse_vibration_ratio(**speeds)), 3)
    (0.333, 0.643)
    """
    return oblique_vibration_ratio(
        sliding_speed=sliding_speed, vibration_velocity=vibration_velocity, vibration_direction=np.pi / 2
    )


def oblique_vibration_ratio(
    *, sliding_speed: ArrayLike, vibration_velocity: ArrayLike, vibration_direction: ArrayLike
) -> Floats:
    r"""Mean friction ratio under vibration at any angle to the sliding direction by Coulomb's law. []

    Parameters
    ----------
    sliding_speed : array_like
        Mean sliding speed. [m/s]
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
    With the angle psi between vibration and sliding, and :math:`\zeta = v_r/v_1`,

    .. math:: \frac{F_1}{F_0} = \left\langle \frac{\zeta + \cos\psi \cos\omega t}
              {\sqrt{\zeta^2 + 2 \zeta \cos\psi \cos\omega t + \cos^2\omega t}} \right\rangle

    A substitution that keeps the ends of the stroke and removes the odd term below the root reduces it to one complete
    elliptic integral of Bulirsch's general form, to 1e-12. The closed forms along and across are its limits. The mean
    lateral component of the friction force is not returned.

    References
    ----------
    .. [1] R. Bulirsch, Numer. Math. 13, 305 (1969). doi:10.1007/BF02165405
    """
    v_r, v_1 = _speeds(sliding_speed, vibration_velocity)
    v_r, v_1, angle = np.broadcast_arrays(v_r, v_1, require_finite(vibration_direction=vibration_direction))
    ratio = _oblique.for_points(v_r.size, at_first=_FEW)(
        v_r.ravel(), v_1.ravel(), np.cos(angle).ravel(), np.sin(angle).ravel()
    )
    return ratio.reshape(v_r.shape)


def torsional_vibration_ratio(*, sliding_speed: ArrayLike, vibration_velocity: ArrayLike) -> Floats:
    r"""Mean friction ratio of a ring that turns to and fro about the normal of its face, by Coulomb's law. []

    Parameters
    ----------
    sliding_speed : array_like
        Mean sliding speed of the whole ring in one direction. [m/s]
    vibration_velocity : array_like, broadcast against `sliding_speed`
        Peak velocity along the circumference: amplitude of the angle times angular frequency and radius. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If the sliding speed is not positive, the vibration negative, or a value not finite.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \frac2\pi \int_0^{\pi/2} R(\psi)\, \mathrm{d}\psi

    with the ratio R of a vibration at the angle psi to the sliding (`oblique_vibration_ratio`), which every place of
    the ring has, under an even pressure; Gauss-Legendre with nodes towards the vibration along, to 1e-6. A contact
    that also slides about the axis of the vibration, as in a bearing or a thread, vibrates along its sliding
    everywhere: `parallel_vibration_ratio`.

    Examples
    --------
    >>> from sonolube.models.friction import torsional_vibration_ratio
    >>> round(float(torsional_vibration_ratio(sliding_speed=0.1, vibration_velocity=0.2)), 3)
    0.525
    """
    v_r, v_1 = np.broadcast_arrays(*_speeds(sliding_speed, vibration_velocity))
    angles, weights = ring_directions(64)
    ratios = oblique_vibration_ratio(
        sliding_speed=v_r[..., np.newaxis], vibration_velocity=v_1[..., np.newaxis], vibration_direction=angles
    )
    return np.asarray(ratios @ weights)


def ring_directions(count: int) -> tuple[Floats, Floats]:
    """Angles of the motion of a turning ring to its sliding over a quarter turn, and their weights, which sum to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    part = (1 + nodes) / 2
    return np.pi / 2 * part**2, weights * part


def _speeds(sliding_speed: ArrayLike, vibration_velocity: ArrayLike) -> tuple[Floats, Floats]:
    """Checked sliding speed and peak vibration velocity. [m/s]"""
    return (require_positive(sliding_speed=sliding_speed), require_non_negative(vibration_velocity=vibration_velocity))


@kernel(cache=True, no_cfunc_wrapper=True)
def _oblique(v_r: Floats, v_1: Floats, cosine: Floats, sine: Floats) -> Floats:
    """Mean cosine of the angle between relative velocity and sliding direction over a period."""
    ratios = np.ones(v_r.size)
    for i in range(v_r.size):
        if v_1[i] <= 1e-9 * v_r[i]:
            continue
        zeta, c, s = v_r[i] / v_1[i], abs(cosine[i]), abs(sine[i])
        if s < 1e-30:
            ratios[i] = 2 / np.pi * np.arcsin(min(zeta, 1.0))
            continue
        # mean of (zeta + c x)/sqrt(zeta^2 + 2 zeta c x + x^2) over x = cos(theta); x = (u + r)/(1 + r u) with
        # r = -2 zeta c/total removes the odd term of the root, (P u^2 + Q)/(1 + r u)^2, and of the fraction
        root = np.hypot(1 - zeta * zeta, 2 * zeta * s)  # sqrt((1 + zeta^2)^2 - 4 zeta^2 c^2) without cancellation
        total = 1 + zeta * zeta + root
        # root + 1 - zeta^2 and root - 1 + zeta^2 without cancellation, from their product
        larger = abs(1 - zeta * zeta) + root
        smaller = (2 * zeta * s) ** 2 / larger
        plus, minus = (larger, smaller) if zeta <= 1 else (smaller, larger)
        one_less = 2 * root / total  # 1 - r^2
        P = (c * plus / total) ** 2 + s * s
        Q = (zeta * c * minus / total) ** 2 + (zeta * s) ** 2
        p = 1 / one_less
        b = p * zeta * (minus + 2 * s * s) / total  # p (zeta + r c)
        integral = _complete_integral(np.sqrt(Q / (P + Q)), p, zeta, b)
        ratios[i] = min(2 / np.pi * np.sqrt(one_less / (P + Q)) * integral, 1.0)
    return ratios


@kernel(**INNER)
def _complete_integral(k_c: float, p: float, a: float, b: float) -> float:
    """Bulirsch's integral cel(k_c, p, a, b) for p > 0 by his arithmetic-geometric mean.

    The integral of (a cos^2 + b sin^2)/(cos^2 + p sin^2)/sqrt(cos^2 + k_c^2 sin^2) from 0 to pi/2.
    """
    mean, product, root = 1.0, k_c, np.sqrt(p)
    b = b / root
    while True:
        a, before = a + b / root, a
        ratio = product / root
        b = 2 * (b + before * ratio)
        root += ratio
        mean, last = mean + k_c, mean
        if abs(last - k_c) <= 1e-8 * last:  # the error is squared in every pass
            return float(np.pi / 2 * (a * mean + b) / (mean * (mean + root)))
        k_c = 2 * np.sqrt(product)
        product = k_c * mean
