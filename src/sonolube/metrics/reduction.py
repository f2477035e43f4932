"""How much friction and wear a vibration takes away."""

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive


def friction_reduction(*, intrinsic_friction_force: ArrayLike, reduced_friction_force: ArrayLike) -> Floats:
    """Return the share of the friction that the vibration takes away. []

    Parameters
    ----------
    intrinsic_friction_force : array_like
        Friction without vibration. [N]
    reduced_friction_force : array_like, broadcast against `intrinsic_friction_force`
        Friction with vibration; negative where the vibration drives. [N]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        1 for no friction left, negative for more friction than before.

    Raises
    ------
    InvalidInput
        If an intrinsic friction is not positive, or a value not finite.

    References
    ----------
    .. [1] D 2.1.
    """
    intrinsic = require_positive(intrinsic_friction_force=intrinsic_friction_force)
    reduced = require_finite(reduced_friction_force=reduced_friction_force)
    return (intrinsic - reduced) / intrinsic


def wear_reduction(*, intrinsic_wear_rate: ArrayLike, reduced_wear_rate: ArrayLike) -> Floats:
    """Return the share of the wear that the vibration takes away. []

    Parameters
    ----------
    intrinsic_wear_rate : array_like
        Volume worn per sliding distance without vibration. [m2]
    reduced_wear_rate : array_like, broadcast against `intrinsic_wear_rate`
        Volume worn per sliding distance with vibration. [m2]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an intrinsic rate is not positive, a reduced one negative, or a value not finite.

    References
    ----------
    .. [1] D 2.3.
    """
    intrinsic = require_positive(intrinsic_wear_rate=intrinsic_wear_rate)
    return (intrinsic - require_non_negative(reduced_wear_rate=reduced_wear_rate)) / intrinsic


def wear_rate(*, wear_volume: ArrayLike, sliding_distance: ArrayLike) -> Floats:
    """Return the volume worn per sliding distance. [m2]

    Parameters
    ----------
    wear_volume : array_like
        Volume worn away. [m3]
    sliding_distance : array_like, broadcast against `wear_volume`
        Distance slid meanwhile. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a volume is negative, a distance not positive, or a value not finite.

    References
    ----------
    .. [1] D 2.2.
    """
    return require_non_negative(wear_volume=wear_volume) / require_positive(sliding_distance=sliding_distance)
