"""Mean friction ratio of a contact that vibrates in any direction, by Coulomb's law at every instant."""

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.execution.compilation import kernel
from sonolube.models.contact.contact_motion import ContactMotion
from sonolube.models.contact.period_mean import richardson_period_mean
from sonolube.models.contact.rough import RoughContact
from sonolube.models.friction.laws.coulomb import oblique_vibration_ratio
from sonolube.models.friction.models.model import FrictionModel

_SAME = 1e-9  # relative, below which a harmonic or a change of the force is rounding


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class Coulomb(FrictionModel):
    r"""Friction of a rigid contact, against the relative velocity within the plane and in proportion to the force.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \left\langle \frac{F_n(t)}{F_N}\,
              \frac{v_r + \dot u}{\sqrt{(v_r + \dot u)^2 + \dot w^2}} \right\rangle

    with the motion u along the sliding and w across it. Nothing is fitted. Of vibration in one direction of the plane
    under a constant force it is the closed form of `oblique_vibration_ratio`, otherwise an integral that is exact for
    velocities that are linear between samples. Vibration along the normal alone leaves friction as it is: contacts
    with a tangential stiffness are in `asperity_stick_slip`. No compliance limits the reduction of slow sliding, so
    that the ratio is a lower bound of that with springs under one and the same vibration within the plane.

    See Also
    --------
    sonolube.models.friction.parallel_vibration_ratio, sonolube.models.friction.transverse_vibration_ratio : Its limits.
    sonolube.models.friction.elliptical_traction_ratio : Normal and longitudinal motion with loss of contact.

    References
    ----------
    .. [1] W. Littmann, H. Storck, J. Wallaschek, Arch. Appl. Mech. 71, 549 (2001). doi:10.1007/s004190100160
    .. [2] V. C. Kumar, I. M. Hutchings, Tribol. Int. 37, 833 (2004). doi:10.1016/j.triboint.2004.05.003
    """

    name: ClassVar[str] = "coulomb"
    citation: ClassVar[str] = "W. Littmann, H. Storck and J. Wallaschek 2001; V. C. Kumar and I. M. Hutchings 2004"

    needs_open_gap: ClassVar[bool] = False
    directions: ClassVar[frozenset[str]] = frozenset({"along", "across"})

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        force_ratio = motion.normal_force / motion.normal_load
        if motion.along is None and motion.across is None:
            level = float(force_ratio.mean())
            return np.full(v_r.shape, 1.0 if abs(level - 1) <= _SAME else level)  # the load balances but for rounding
        straight = _straight_vibration(motion)
        if straight is not None and np.ptp(force_ratio) <= _SAME:
            velocity, angle = straight
            ratio = oblique_vibration_ratio(
                sliding_speed=v_r,
                vibration_velocity=np.full(v_r.shape, velocity),
                vibration_direction=np.full(v_r.shape, angle),
            )
            return np.asarray(float(force_ratio.mean()) * ratio)

        return richardson_period_mean(lambda sampled: sampled_coulomb_ratio(sampled, v_r), motion)


def sampled_coulomb_ratio(motion: ContactMotion, v_r: Floats) -> Floats:
    """Friction ratio by Coulomb's law with velocities and force linear between the samples; shape of `v_r`, (n,)."""
    rate = motion.frequency * motion.displacement.size
    along, across = (
        np.zeros(motion.displacement.size) if each is None else _rates(each, rate)
        for each in (motion.along, motion.across)
    )
    return _weighted_direction(motion.normal_force / motion.normal_load, along, across, v_r)


_POWER_SAMPLES = 8192  # per period, of a velocity that may turn within it


def sliding_power_ratio(motion: ContactMotion, *, sliding_speed: float) -> float:
    r"""Power of friction by Coulomb's law under a motion over that of sliding without it. []

    Parameters
    ----------
    motion : ContactMotion
    sliding_speed : float
        Mean sliding speed. [m/s]

    Returns
    -------
    float
        At least the mean normal force over the load; the drive of the vibration supplies what exceeds the ratio of the
        forces.

    Raises
    ------
    InvalidInput
        If the speed is not positive.

    Notes
    -----
    .. math:: \left\langle \frac{F_n(t)}{F_N}\, \frac{\sqrt{(v_r + \dot u)^2 + \dot w^2}}{v_r} \right\rangle

    to 1e-5. Along the sliding it is :math:`\frac2\pi (\arcsin\zeta + \sqrt{1/\zeta^2 - 1})` below the peak velocity.
    """
    v_r = float(require_positive(sliding_speed=sliding_speed))
    sampled = motion.resampled(max(_POWER_SAMPLES, motion.displacement.size))
    rate = sampled.frequency * sampled.displacement.size
    along, across = (0.0 if each is None else _rates(each, rate) for each in (sampled.along, sampled.across))
    return float(np.mean(sampled.normal_force / sampled.normal_load * np.hypot(v_r + along, across))) / v_r


def _rates(values: Floats, rate: float) -> Floats:
    """Velocity at the samples of a period by spectral differentiation. [m/s]"""
    n = values.size
    harmonics = np.fft.rfft(values) * (2j * np.pi * rate / n) * np.arange(n // 2 + 1)
    if n % 2 == 0:
        harmonics[-1] = 0.0
    return np.fft.irfft(harmonics, n)


def _straight_vibration(motion: ContactMotion) -> tuple[float, float] | None:
    """Peak velocity and angle to the sliding of a harmonic motion in one direction of the plane; None of others."""
    zero = np.zeros(motion.displacement.size)
    harmonics = np.stack([np.fft.rfft(zero if part is None else part) for part in (motion.along, motion.across)])
    first, rest = harmonics[:, 1], np.abs(harmonics[:, 2:]).max()
    size = float(np.linalg.norm(first))
    if rest > _SAME * size or abs((first[0] * np.conj(first[1])).imag) > _SAME * size**2:
        return None
    amplitude = 2 / motion.displacement.size * size
    sign = 1.0 if (first[0] * np.conj(first[1])).real >= 0 else -1.0
    return 2 * np.pi * motion.frequency * amplitude, float(np.arctan2(sign * abs(first[1]), abs(first[0])))


@kernel(cache=True, no_cfunc_wrapper=True)
def _weighted_direction(weights: Floats, along: Floats, across: Floats, speeds: Floats) -> Floats:
    """Mean over a period of weight times the cosine of the relative velocity, all linear between samples."""
    n = weights.size
    means = np.empty(speeds.size)
    for i in range(speeds.size):
        total = 0.0
        for k in range(n):
            # (p + q s) over the root of (p + q s)^2 + (r + t s)^2 = A s^2 + 2 B s + C, s from 0 to 1
            p, r = speeds[i] + along[k - 1], across[k - 1]
            q, t = speeds[i] + along[k] - p, across[k] - r
            A, B, C, D = q * q + t * t, p * q + r * t, p * p + r * r, abs(p * t - q * r)
            weight = (weights[k - 1] + weights[k]) / 2
            if A <= 1e-8 * C:
                middle, lateral = p + q / 2, r + t / 2
                total += weight * middle / np.sqrt(middle * middle + lateral * lateral)
            elif D <= 1e-12 * C:  # on a line through the origin
                cosine = q / np.sqrt(A)
                turn = min(max(-B / A, 0.0), 1.0)
                total += weight * cosine * (1 - 2 * turn)
            else:
                root = np.sqrt(A)
                change = np.sqrt(A + 2 * B + C) - np.sqrt(C)
                angle = np.arcsinh((A + B) / D) - np.arcsinh(B / D)
                total += weight * (q / A * change + (p - q * B / A) * angle / root)
        means[i] = total / n
    return means
