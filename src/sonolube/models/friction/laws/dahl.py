"""Dahl friction: an elastoplastic bristle whose force depends on the sliding distance and not on the rate."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_positive
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel


@dataclass(frozen=True, kw_only=True, slots=True)
class DahlFriction:
    r"""Dahl's law of friction for one contact at a constant normal load.

    Parameters
    ----------
    contact_stiffness : float
        Tangential stiffness of the contact at rest, K. [N/m]
    coulomb_friction_force : float
        Friction force of steady sliding, F_c. [N]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    .. math:: \frac{\mathrm{d}\delta}{\mathrm{d}t} = v \left( 1 - \frac{K \delta}{F_c}\, \mathrm{sgn}\, v \right),
              \qquad F = K \delta \tag{D 1.3}

    with the tangential deformation delta and the sliding velocity v.

    See Also
    --------
    LuGreFriction : The law with Stribeck effect, bristle damping and viscous friction.

    References
    ----------
    .. [1] P. R. Dahl, AIAA J. 14, 1675 (1976). doi:10.2514/3.61511
    """

    contact_stiffness: float
    coulomb_friction_force: float

    def __post_init__(self) -> None:
        require_positive(contact_stiffness=self.contact_stiffness, coulomb_friction_force=self.coulomb_friction_force)


def dahl_friction_history(
    law: DahlFriction, *, time: ArrayLike, relative_velocity: ArrayLike, deformation: ArrayLike = 0.0
) -> Floats:
    """Friction force along sampled motions by Dahl's law. [N]

    Parameters
    ----------
    law : DahlFriction
    time : array_like, shape (n,)
        Increasing times of the samples. [s]
    relative_velocity : array_like, shape (..., n)
        Sliding velocity at these times, interpolated linearly between them. [m/s]
    deformation : array_like, shape (...)
        Tangential deformation of the contact at the first sample. [m]

    Returns
    -------
    ndarray, shape (..., n)

    Raises
    ------
    InvalidInput
        If times do not increase, shapes disagree, or a value is not finite.

    Notes
    -----
    Exact for velocities that are linear between samples, at any step: the law depends on the distance alone, and a step
    in which the velocity changes sign is divided there. The error is that of the sampling, second order in the step.

    See Also
    --------
    dahl_under_vibration : Mean force over the steady period of a vibration.

    References
    ----------
    .. [1] D 1.3.
    """
    times, velocities = _increasing(time), require_finite(relative_velocity=relative_velocity)
    start = require_finite(deformation=deformation)
    K, F_c = law.contact_stiffness, law.coulomb_friction_force
    if velocities.ndim == 0 or velocities.shape[-1] != times.size:
        raise InvalidInput(
            f"relative_velocity must have one value for each of {times.size} times along its last axis,"
            f" got shape {velocities.shape}"
        )
    try:
        rows = np.broadcast_shapes(velocities.shape[:-1], start.shape)
    except ValueError:
        raise InvalidInput(f"{start.shape} starting values do not match {velocities.shape[:-1]} motions") from None
    motions = np.broadcast_to(velocities, (*rows, times.size)).reshape(-1, times.size)
    starts = np.broadcast_to(start, rows).ravel()
    found = [_deformation_history(times, motion, one, K / F_c) for motion, one in zip(motions, starts, strict=True)]
    return K * np.reshape(found, (*rows, times.size))


def _increasing(time: ArrayLike) -> Floats:
    """Sample times as an array; refuse times that do not increase; shape (n,)."""
    times = require_finite(time=time)
    if times.ndim != 1 or times.size < 2:
        raise InvalidInput(f"time must be one-dimensional with at least two samples, got shape {times.shape}")
    steps = np.diff(times)
    if not np.all(steps > 0):
        first = int(np.argmin(steps > 0))
        raise InvalidInput(f"time must increase, got {times[first + 1]!s} s after {times[first]!s} s")
    return times


@kernel(cache=True)
def _deformation_history(times: Floats, velocities: Floats, start: float, rate: float) -> Floats:
    """Deformation along one sampled motion; `rate` is K/F_c."""
    deformation = np.empty_like(velocities)
    deformation[0] = delta = start
    for k in range(times.size - 1):
        step, v0, v1 = times[k + 1] - times[k], velocities[k], velocities[k + 1]
        if v0 * v1 < 0:
            reversal = step * v0 / (v0 - v1)
            delta = _deformation_after_slide(delta, 0.5 * v0 * reversal, rate)
            delta = _deformation_after_slide(delta, 0.5 * v1 * (step - reversal), rate)
        else:
            delta = _deformation_after_slide(delta, 0.5 * (v0 + v1) * step, rate)
        deformation[k + 1] = delta
    return deformation


@kernel(cache=True)
def _deformation_after_slide(delta: float, distance: float, rate: float) -> float:
    """Deformation after a slide in one direction."""
    decay = -rate * abs(distance)
    return delta * math.exp(decay) + math.copysign(math.expm1(decay) / rate, distance)
