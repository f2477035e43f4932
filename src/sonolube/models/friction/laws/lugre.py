"""LuGre friction: elastic bristles with a Stribeck curve as slip limit, bristle damping and viscous friction."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel
from sonolube.models.friction.laws.sampled_motion import integrate_rows, require_increasing


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


@dataclass(frozen=True, kw_only=True, slots=True)
class LuGreHistory:
    """Bristle deflection and friction force along sampled motions.

    Parameters
    ----------
    bristle_deflection : ndarray, shape (..., n)
        Mean deflection of the bristles. [m]
    friction_force : ndarray, shape (..., n)
        Friction force. [N]
    """

    bristle_deflection: Floats
    friction_force: Floats


def lugre_steady_friction(law: LuGreFriction, *, relative_velocity: ArrayLike) -> Floats:
    r"""Friction force of steady sliding by the LuGre law. [N]

    Parameters
    ----------
    law : LuGreFriction
    relative_velocity : array_like, any shape
        Sliding velocity, of either sign. [m/s]

    Returns
    -------
    ndarray, shape of `relative_velocity`

    Raises
    ------
    InvalidInput
        If a velocity is not finite.

    Notes
    -----
    .. math:: F = \left[ F_c + (F_s - F_c)\, e^{-(v/v_s)^2} \right] \mathrm{sgn}\, v + \sigma_2 v

    Zero is returned at zero velocity, where any deflection up to F_s over the stiffness is steady.

    References
    ----------
    .. [1] D 1.4 and 1.5, with the modulus of v that D omits.

    Examples
    --------
    >>> from sonolube.models.friction import LuGreFriction, lugre_steady_friction
    >>> forces = {"coulomb_friction_force": 1.0, "static_friction_force": 1.5, "stribeck_velocity": 1e-3}
    >>> bristles = {"bristle_stiffness": 1e5, "bristle_damping": 300.0, "viscous_coefficient": 0.4}
    >>> force = lugre_steady_friction(LuGreFriction(**forces, **bristles), relative_velocity=[1e-6, 1e-3, 0.1])
    >>> force.round(3).tolist()  # static, Stribeck velocity (1 + 0.5/e), Coulomb with viscous
    [1.5, 1.184, 1.04]
    """
    v = require_finite(relative_velocity=relative_velocity)
    return law.bristle_stiffness * _steady_deflection(law, v) * np.sign(v) + law.viscous_coefficient * v


def lugre_friction_history(
    law: LuGreFriction, *, time: ArrayLike, relative_velocity: ArrayLike, bristle_deflection: ArrayLike = 0.0
) -> LuGreHistory:
    """Bristle deflection and the friction force along sampled motions by the LuGre law.

    Parameters
    ----------
    law : LuGreFriction
    time : array_like, shape (n,)
        Increasing times of the samples. [s]
    relative_velocity : array_like, shape (..., n)
        Sliding velocity at these times. [m/s]
    bristle_deflection : array_like, shape (...)
        Mean deflection of the bristles at the first sample. [m]

    Returns
    -------
    LuGreHistory

    Raises
    ------
    InvalidInput
        If times do not increase, shapes disagree, or a value is not finite.

    Notes
    -----
    Each step integrates the deflection exactly at the mean of its two velocities, so that no step is too long for the
    stiffness: a deflection within F_s over the stiffness remains within it. The error is second order in the step.

    See Also
    --------
    lugre_under_vibration : Mean friction over the steady period of a vibration.

    References
    ----------
    .. [1] D 1.4 and 1.5, with the modulus of v that D omits.
    """
    times = require_increasing(time=time)
    v = require_finite(relative_velocity=relative_velocity)
    start = require_finite(bristle_deflection=bristle_deflection)
    sliding_limit = law.coulomb_friction_force / law.bristle_stiffness
    sticking_limit = law.static_friction_force / law.bristle_stiffness
    z = integrate_rows(_deflection_history, times, v, start, sliding_limit, sticking_limit, law.stribeck_velocity)
    z_rate = v - np.abs(v) / _steady_deflection(law, v) * z  # D 1.4
    force = law.bristle_stiffness * z + law.bristle_damping * z_rate + law.viscous_coefficient * v  # D 1.5
    return LuGreHistory(bristle_deflection=z, friction_force=force)


def _steady_deflection(law: LuGreFriction, v: Floats) -> Floats:
    """Deflection g(v) of steady sliding. [m]"""
    F_c, F_s = law.coulomb_friction_force, law.static_friction_force
    return (F_c + (F_s - F_c) * np.exp(-((v / law.stribeck_velocity) ** 2))) / law.bristle_stiffness


@kernel(cache=True)
def _deflection_history(
    times: Floats,
    velocities: Floats,
    start: float,
    sliding_limit: float,
    sticking_limit: float,
    stribeck_velocity: float,
) -> Floats:
    """Deflection along one sampled motion; the limits are the forces F_c and F_s over the stiffness."""
    deflection = np.empty_like(velocities)
    deflection[0] = z = start
    for k in range(times.size - 1):
        v = 0.5 * (velocities[k] + velocities[k + 1])
        g = sliding_limit + (sticking_limit - sliding_limit) * np.exp(-((v / stribeck_velocity) ** 2))
        relaxation = np.expm1(-abs(v) * (times[k + 1] - times[k]) / g)
        z += relaxation * (z - np.sign(v) * g)
        deflection[k + 1] = z
    return deflection
