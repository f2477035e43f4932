"""Dahl's law: friction as a spring that yields, blind to the rate of sliding."""

import math
from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_positive
from sonolube.friction.history import along_rows, require_increasing


@dataclass(frozen=True, kw_only=True, slots=True)
class DahlFriction:
    """Dahl's law for one contact at one load.

    Parameters
    ----------
    contact_stiffness : float
        Tangential stiffness of the contact at rest, K. [N/m]
    coulomb_friction_force : float
        Friction of long steady sliding. [N]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    References
    ----------
    .. [1] P. R. Dahl, AIAA J. 14, 1675 (1976). doi:10.2514/3.61511
    """

    contact_stiffness: float
    coulomb_friction_force: float

    def __post_init__(self) -> None:
        require_positive(contact_stiffness=self.contact_stiffness, coulomb_friction_force=self.coulomb_friction_force)

    @property
    def steady_deformation(self) -> float:
        """Deformation of long steady sliding, F_c/K. [m]"""
        return self.coulomb_friction_force / self.contact_stiffness


def dahl_friction(law: DahlFriction, *, displacement: ArrayLike, deformation: ArrayLike = 0.0) -> Floats:
    """Return the friction force after sliding one way. [N]

    Parameters
    ----------
    law : DahlFriction
    displacement : array_like
        Distance slid without turning back, negative for the other way. [m]
    deformation : array_like, broadcast against `displacement`
        Tangential deformation of the contact at the start. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is not finite.

    Notes
    -----
    From rest F = F_c [1 - exp(-K x/F_c)]. A deformation beyond F_c/K, as after a drop of the load, decays to it.

    References
    ----------
    .. [1] D 1.3.
    """
    slid = require_finite(displacement=displacement)
    start = require_finite(deformation=deformation)
    K, F_c = law.contact_stiffness, law.coulomb_friction_force
    decay = -K * np.abs(slid) / F_c
    return K * start * np.exp(decay) - F_c * np.sign(slid) * np.expm1(decay)  # D 1.3 integrated for one sign of v


def dahl_friction_history(
    law: DahlFriction, *, time: ArrayLike, relative_velocity: ArrayLike, deformation: ArrayLike = 0.0
) -> Floats:
    """Return the friction force along any sampled motion. [N]

    Parameters
    ----------
    law : DahlFriction
    time : array_like, shape (n,)
        Increasing times of the samples. [s]
    relative_velocity : array_like, shape (..., n)
        Sliding velocity at those times, taken as linear between them. [m/s]
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
    Exact for velocities linear between samples, at any step: the law depends on distance alone, and a step in which the
    motion turns is divided at the turning point. The error is that of the sampling, second order in the step.

    References
    ----------
    .. [1] D 1.3.
    """
    times = require_increasing(time=time)
    velocities = require_finite(relative_velocity=relative_velocity)
    start = require_finite(deformation=deformation)
    K, F_c = law.contact_stiffness, law.coulomb_friction_force
    return K * along_rows(_march, times, velocities, start, K / F_c)


@numba.njit(cache=True)
def _march(times: Floats, velocities: Floats, start: float, rate: float) -> Floats:
    deflection = np.empty_like(velocities)
    deflection[0] = delta = start
    for k in range(times.size - 1):
        step, v0, v1 = times[k + 1] - times[k], velocities[k], velocities[k + 1]
        if v0 * v1 < 0:
            turn = step * v0 / (v0 - v1)
            delta = _slide(delta, 0.5 * v0 * turn, rate)
            delta = _slide(delta, 0.5 * v1 * (step - turn), rate)
        else:
            delta = _slide(delta, 0.5 * (v0 + v1) * step, rate)
        deflection[k + 1] = delta
    return deflection


@numba.njit(cache=True)
def _slide(delta: float, distance: float, rate: float) -> float:
    decay = -rate * abs(distance)
    return delta * math.exp(decay) + math.copysign(math.expm1(decay) / rate, distance)
