"""Coulomb's law: friction that knows the load and the direction of sliding, and nothing else."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class CoulombFriction:
    """Coulomb's law for one pair of surfaces.

    Parameters
    ----------
    friction_coefficient : float
        Friction force over normal load. []

    Raises
    ------
    InvalidInput
        If the coefficient is negative or not finite.
    """

    friction_coefficient: float

    def __post_init__(self) -> None:
        require_non_negative(friction_coefficient=self.friction_coefficient)


def coulomb_friction(law: CoulombFriction, *, normal_load: ArrayLike, relative_velocity: ArrayLike) -> Floats:
    """Return the friction force that opposes a sliding motion. [N]

    Parameters
    ----------
    law : CoulombFriction
    normal_load : array_like
        Force pressing the bodies together. [N]
    relative_velocity : array_like, broadcast against `normal_load`
        Sliding velocity of the body over its counterpart. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Positive for positive velocity: the force on the counterpart.

    Raises
    ------
    InvalidInput
        If a load is negative, or a value not finite.

    Notes
    -----
    Zero at zero velocity, where the law leaves the force between minus and plus the limit open.

    References
    ----------
    .. [1] D 1.2.
    """
    load = require_non_negative(normal_load=normal_load)
    velocity = require_finite(relative_velocity=relative_velocity)
    return law.friction_coefficient * load * np.sign(velocity)  # D 1.2


def friction_coefficient(*, friction_force: ArrayLike, normal_load: ArrayLike) -> Floats:
    """Return friction force over normal load. []

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
    """
    force = require_finite(friction_force=friction_force)
    return force / require_positive(normal_load=normal_load)
