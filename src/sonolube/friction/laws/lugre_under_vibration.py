"""Mean friction ratio of a vibrated contact by the LuGre law with a limit that follows speed and normal force."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.contact.gap_motion import GapMotion, delayed_oscillation, richardson_period_mean
from sonolube.friction.laws.lugre import LuGreFriction, lugre_steady_friction
from sonolube.friction.laws.steady_period_kernel import steady_period_mean_force

_TOLERANCE = 1e-4


def lugre_under_vibration(
    law: LuGreFriction,
    motion: GapMotion,
    *,
    sliding_speed: ArrayLike,
    in_plane_fraction: ArrayLike = 0.0,
    in_plane_phase: ArrayLike = 0.0,
) -> Floats:
    r"""Return the mean friction ratio over the steady period of a vibration by the LuGre law. []

    Parameters
    ----------
    law : LuGreFriction
        Law of the contact under its dead load.
    motion : GapMotion
        One period of the gap, with its normal force.
    sliding_speed : array_like, any shape
        Mean sliding speed. [m/s]
    in_plane_fraction : float
        Amplitude along the sliding direction over that along the normal. []
    in_plane_phase : float
        Lag of the in-plane motion behind the normal one. [rad]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is not positive, the fraction negative, or a value not finite.

    Notes
    -----
    .. math:: \frac{\mathrm{d}z}{\mathrm{d}t} = v - \frac{|v|}{g}\, z, \qquad
              \sigma_0\, g = \frac{F_n(t)}{F_N} \left[ F_c + (F_s - F_c)\, e^{-(v/v_s)^2} \right]

    The slip limit follows speed and normal force; the bristle stiffness is constant. The law is linear in z along a
    given motion, so that each step is an exact exponential and the steady period the fixed point of a linear map. The
    bristle damping has no effect on the mean over a period. Relative error 1e-4.

    Under vibration along the normal alone the Stribeck curve cancels, and the ratio of slow sliding is the harmonic
    mean :math:`1/\langle F_N/F_n \rangle`. Fast in-plane vibration reduces friction further where the Stribeck curve
    falls.

    See Also
    --------
    dahl_under_vibration : Bristle stiffness that follows the separation, without Stribeck effect.

    References
    ----------
    .. [1] C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, IEEE Trans. Autom. Control 40, 419 (1995).
       doi:10.1109/9.376053
    """
    v_r = require_positive(sliding_speed=sliding_speed)
    fraction = float(require_non_negative(in_plane_fraction=in_plane_fraction))
    lag = float(require_finite(in_plane_phase=in_plane_phase))
    speeds = v_r.reshape(-1, 1)
    F_c, F_s = law.coulomb_friction_force, law.static_friction_force

    def mean_force(sampled: GapMotion) -> Floats:
        n = sampled.displacement.size
        u = fraction * delayed_oscillation(sampled.displacement, phase=lag)
        load = (sampled.normal_force + np.roll(sampled.normal_force, -1)) / (2 * motion.normal_load)
        slides = np.roll(u, -1) - u + speeds / (motion.frequency * n)
        v = slides * motion.frequency * n
        limit = load * (F_c + (F_s - F_c) * np.exp(-((v / law.stribeck_velocity) ** 2)))
        limit = np.maximum(limit, np.finfo(np.float64).tiny)  # where contact is lost
        stiffness = np.full(limit.shape, law.bristle_stiffness)
        bristle_force = steady_period_mean_force(stiffness, limit, slides, np.full(limit.shape, 1 / n))
        return bristle_force + law.viscous_coefficient * speeds[:, 0]

    steady = lugre_steady_friction(law, relative_velocity=speeds[:, 0])
    ratio = richardson_period_mean(lambda sampled: mean_force(sampled) / steady, motion, tolerance=_TOLERANCE)
    return ratio.reshape(v_r.shape)
