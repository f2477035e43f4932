"""Coulomb friction: a force in proportion to the normal load, opposed to the sliding velocity."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class CoulombFriction:
    """Coulomb's law of friction for one pair of surfaces.

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
    r"""Friction force by Coulomb's law. [N]

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
        Force on the counterpart, positive for positive velocity.

    Raises
    ------
    InvalidInput
        If a load is negative, or a value not finite.

    Notes
    -----
    .. math:: F = \mu F_N\, \mathrm{sgn}\, v \tag{D 1.2}

    Zero is returned at zero velocity, where the law admits any force up to the limit.

    References
    ----------
    .. [1] D 1.2.

    Examples
    --------
    >>> from sonolube.models.friction import CoulombFriction, coulomb_friction
    >>> law = CoulombFriction(friction_coefficient=0.25)
    >>> coulomb_friction(law, normal_load=4.0, relative_velocity=[-0.02, 0.0, 0.02]).tolist()
    [-1.0, 0.0, 1.0]
    """
    load = require_non_negative(normal_load=normal_load)
    velocity = require_finite(relative_velocity=relative_velocity)
    return law.friction_coefficient * load * np.sign(velocity)  # D 1.2


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
