"""LuGre friction: elastic bristles with a Stribeck curve as slip limit, bristle damping and viscous friction.

Its mean ratio under vibration has a limit that follows speed and normal force.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.contact.contact_motion import ContactMotion, delayed_oscillation
from sonolube.models.contact.period_mean import richardson_period_means
from sonolube.models.friction.laws.steady_period_kernel import steady_period_mean_force


@dataclass(frozen=True, kw_only=True, slots=True)
class LuGreFriction:
    r"""LuGre law of friction for one contact at a constant normal load.

    Parameters
    ----------
    coulomb_friction_force : float
        Friction force of fast sliding without viscous friction, F_c. [N]
    static_friction_force : float
        Friction force of slow sliding, F_s, at least F_c. [N]
    stribeck_velocity : float
        Velocity of the transition between both, v_s. [m/s]
    bristle_stiffness : float
        Stiffness of all bristles, sigma_0. [N/m]
    bristle_damping : float
        Damping of the bristle deflection, sigma_1. [N s/m]
    viscous_coefficient : float
        Coefficient of viscous friction, sigma_2. [N s/m]

    Raises
    ------
    InvalidInput
        If a force, velocity or stiffness is not positive, a damping negative, or F_s below F_c.

    Notes
    -----
    .. math::

        \frac{\mathrm{d}z}{\mathrm{d}t} &= v - \frac{|v|}{g(v)}\, z, \qquad
        \sigma_0\, g(v) = F_c + (F_s - F_c)\, e^{-(v/v_s)^2} \tag{D 1.4} \\
        F &= \sigma_0 z + \sigma_1 \frac{\mathrm{d}z}{\mathrm{d}t} + \sigma_2 v \tag{D 1.5}

    with the mean bristle deflection z and the sliding velocity v, whose modulus D 1.4 omits. Without damping, viscous
    friction and Stribeck effect this is Dahl's law.

    See Also
    --------
    DahlFriction : The law without Stribeck effect and damping.

    References
    ----------
    .. [1] C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, IEEE Trans. Autom. Control 40, 419 (1995).
       doi:10.1109/9.376053
    """

    coulomb_friction_force: float
    static_friction_force: float
    stribeck_velocity: float
    bristle_stiffness: float
    bristle_damping: float
    viscous_coefficient: float

    def __post_init__(self) -> None:
        require_positive(
            coulomb_friction_force=self.coulomb_friction_force,
            static_friction_force=self.static_friction_force,
            stribeck_velocity=self.stribeck_velocity,
            bristle_stiffness=self.bristle_stiffness,
        )
        require_non_negative(bristle_damping=self.bristle_damping, viscous_coefficient=self.viscous_coefficient)
        if self.static_friction_force < self.coulomb_friction_force:
            raise InvalidInput(
                f"static_friction_force must be at least coulomb_friction_force, {self.coulomb_friction_force!r} N,"
                f" got {self.static_friction_force!r} N"
            )


_TOLERANCE = 1e-4


def lugre_under_vibration(
    law: LuGreFriction,
    motion: ContactMotion,
    *,
    sliding_speed: ArrayLike,
    in_plane_fraction: ArrayLike = 0.0,
    in_plane_phase: ArrayLike = 0.0,
) -> Floats:
    r"""Mean friction ratio over the steady period of a vibration by the LuGre law. []

    Parameters
    ----------
    law : LuGreFriction
        Law of the contact under its dead load.
    motion : ContactMotion
        One period of the gap, with its normal force, and its own motion along and across the sliding where it has one.
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
    .. math:: \frac{\mathrm{d}\boldsymbol z}{\mathrm{d}t} = \boldsymbol v
              - \frac{|\boldsymbol v|}{g}\, \boldsymbol z, \qquad
              \sigma_0\, g = \frac{F_n(t)}{F_N} \left[ F_c + (F_s - F_c)\, e^{-(|\boldsymbol v|/v_s)^2} \right]

    The slip limit follows speed and normal force; the bristle stiffness is constant. Bristles yield alike in every
    direction of the plane, and the ratio is that of the force along the sliding. The law is linear in z along a
    given motion, so that each step is an exact exponential and the steady period the fixed point of a linear map. The
    bristle damping has no effect on the mean over a period. Relative error 1e-4.

    Without bristle damping the law is passive: over a period it takes the work
    :math:`\langle \sigma_0 |\boldsymbol v| |\boldsymbol z|^2/g + \sigma_2 |\boldsymbol v|^2 \rangle`. With damping it
    is so where :math:`\sigma_1 \le 4 \sigma_0 g/|\boldsymbol v|` throughout.

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
    points, motion_along = v_r.size, {"in_plane_fraction": in_plane_fraction, "in_plane_phase": in_plane_phase}
    return lugre_ratios([law] * points, [motion] * points, sliding_speed=v_r.ravel(), **motion_along).reshape(v_r.shape)


def lugre_ratios(
    laws: Sequence[LuGreFriction],
    motions: Sequence[ContactMotion],
    *,
    sliding_speed: Floats,
    in_plane_fraction: ArrayLike = 0.0,
    in_plane_phase: ArrayLike = 0.0,
) -> Floats:
    """Friction ratios of `lugre_under_vibration` for many pairs of law and motion at once. []

    Parameters
    ----------
    laws : sequence of LuGreFriction
        Of each point.
    motions : sequence of ContactMotion
        Of each point.
    sliding_speed : ndarray, shape (n,)
        Mean sliding speed of each point. [m/s]
    in_plane_fraction : float
        Amplitude along the sliding direction over that along the normal. []
    in_plane_phase : float
        Lag of the in-plane motion behind the normal one. [rad]

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    InvalidInput
        If a speed is not positive, the fraction negative, or a value not finite.
    """
    v_r = require_positive(sliding_speed=sliding_speed)
    fraction = float(require_non_negative(in_plane_fraction=in_plane_fraction))
    lag = float(require_finite(in_plane_phase=in_plane_phase))
    law = _Columns.of(laws)
    loads, frequencies = (
        np.array([[getattr(motion, name)] for motion in motions]) for name in ("normal_load", "frequency")
    )
    steady = law.limit(v_r[:, np.newaxis]) + law.viscous_coefficient * v_r[:, np.newaxis]

    def mean_ratio(rows: Integers, displacement: Floats, normal_force: Floats) -> Floats:
        n, own, speeds, frequency = displacement.shape[-1], law.rows(rows), v_r[rows, np.newaxis], frequencies[rows]
        along = fraction * delayed_oscillation(displacement, phase=lag) if fraction else np.zeros(displacement.shape)
        across = np.zeros(displacement.shape)
        for place, row in enumerate(rows.tolist()):
            sampled = motions[row].resampled(n)
            along[place] = along[place] if sampled.along is None else sampled.along
            across[place] = 0.0 if sampled.across is None else sampled.across
        slides = np.roll(along, -1, axis=-1) - along + speeds / (frequency * n)
        paths = np.hypot(slides, np.roll(across, -1, axis=-1) - across)
        load = (normal_force + np.roll(normal_force, -1, axis=-1)) / (2 * loads[rows])  # amid successive samples
        # where contact is lost the limit is the least number
        limit = np.maximum(load * own.limit(paths * frequency * n), np.finfo(np.float64).tiny)
        stiffness = np.broadcast_to(own.bristle_stiffness, limit.shape).copy()
        bristle_force = steady_period_mean_force(stiffness, limit, slides, paths, np.full(limit.shape, 1 / n))
        return np.asarray((bristle_force + (own.viscous_coefficient * speeds)[:, 0]) / steady[rows, 0])

    return richardson_period_means(mean_ratio, motions, tolerance=_TOLERANCE)


class _Columns(NamedTuple):
    """Parameters of laws, shape (n, 1) each."""

    coulomb_friction_force: Floats
    static_friction_force: Floats
    stribeck_velocity: Floats
    bristle_stiffness: Floats
    viscous_coefficient: Floats

    @classmethod
    def of(cls, laws: Sequence[LuGreFriction]) -> "_Columns":
        """Columns of some laws."""
        return cls(*(np.array([[getattr(law, name)] for law in laws]) for name in cls._fields))

    def rows(self, rows: Integers) -> "_Columns":
        """Some rows."""
        return _Columns(*(column[rows] for column in self))

    def limit(self, v: Floats) -> Floats:
        """Limit of the bristle force under the dead load at relative velocities. [N]"""
        F_c, F_s = self.coulomb_friction_force, self.static_friction_force
        return np.asarray(F_c + (F_s - F_c) * np.exp(-((v / self.stribeck_velocity) ** 2)))
