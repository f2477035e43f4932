"""The LuGre law in a contact that vibrates along its normal and along the sliding direction."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.contact.motion import GapMotion, converged_mean, shifted
from sonolube.friction.lugre import LuGreFriction, lugre_steady_friction
from sonolube.friction.vibrated_dahl import periodic_mean

_TOLERANCE = 1e-4


def lugre_under_vibration(
    law: LuGreFriction,
    motion: GapMotion,
    *,
    sliding_speed: ArrayLike,
    in_plane_fraction: ArrayLike = 0.0,
    phase: ArrayLike = 0.0,
) -> Floats:
    """Return LuGre's mean friction over a steady period of vibration over its friction without vibration. []

    Parameters
    ----------
    law : LuGreFriction
        Of the contact under its dead load.
    motion : GapMotion
        One period of the motion along the normal, with its normal force.
    sliding_speed : array_like, any shape
        Mean speed of the sliding. [m/s]
    in_plane_fraction : float
        Motion along the sliding direction over that along the normal. []
    phase : float
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
    dz/dt = v - abs(v) z/g, the limit g falling with the speed after Stribeck and following the normal force, while the
    bristles' stiffness stays. The law is linear in z while the motion is given, so each step is an exact exponential
    and the steady period the fixed point of a linear map. Damping of the bristles adds nothing to a period's mean.
    Good to 1e-4.

    Along the normal alone Stribeck's curve cancels, and slow sliding leaves 1/mean(F_N/F_n) of friction: bristles
    heed the load only as far as they slip. Fast in-plane vibration lowers friction further where that curve falls.

    References
    ----------
    .. [1] C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, IEEE Trans. Autom. Control 40, 419 (1995).
       doi:10.1109/9.376053
    """
    v_r = require_positive(sliding_speed=sliding_speed)
    fraction = float(require_non_negative(in_plane_fraction=in_plane_fraction))
    lag = float(require_finite(phase=phase))
    speeds = v_r.reshape(-1, 1)
    F_c, F_s = law.coulomb_friction_force, law.static_friction_force

    def friction(sampled: GapMotion) -> Floats:
        n = sampled.displacement.size
        u = fraction * shifted(sampled.displacement, phase=lag)
        load = (sampled.normal_force + np.roll(sampled.normal_force, -1)) / (2 * motion.normal_load)
        slides = np.roll(u, -1) - u + speeds / (motion.frequency * n)
        v = slides * motion.frequency * n
        limit = load * (F_c + (F_s - F_c) * np.exp(-((v / law.stribeck_velocity) ** 2)))
        limit = np.maximum(limit, np.finfo(np.float64).tiny)  # of bodies apart
        stiffness = np.full(limit.shape, law.bristle_stiffness)
        bent = periodic_mean(stiffness, limit, slides, np.full(limit.shape, 1 / n))
        return bent + law.viscous_coefficient * speeds[:, 0]

    without = lugre_steady_friction(law, relative_velocity=speeds[:, 0])
    return converged_mean(lambda sampled: friction(sampled) / without, motion, tolerance=_TOLERANCE).reshape(v_r.shape)
