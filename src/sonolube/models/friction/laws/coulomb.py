"""Coefficient of friction, by Coulomb's law."""

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_positive


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
