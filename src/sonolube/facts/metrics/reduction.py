"""Friction reduction, wear rate and wear reduction by vibration."""

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive


def friction_reduction(*, intrinsic_friction_force: ArrayLike, reduced_friction_force: ArrayLike) -> Floats:
    r"""Friction reduction by vibration, relative to the intrinsic friction force. []

    Parameters
    ----------
    intrinsic_friction_force : array_like
        Friction force without vibration. [N]
    reduced_friction_force : array_like, broadcast against `intrinsic_friction_force`
        Friction force with vibration; negative where the vibration drives the motion. [N]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        1 where no friction is left, above 1 where the vibration drives, negative where friction has increased.

    Raises
    ------
    InvalidInput
        If an intrinsic friction force is not positive, or a value not finite.

    See Also
    --------
    wear_reduction

    Notes
    -----
    .. math:: P_f = \frac{F_{t0} - F_{t1}}{F_{t0}} \qquad \text{(D 2.1)}

    References
    ----------
    .. [1] D 2.1.

    Examples
    --------
    >>> from sonolube.facts.metrics import friction_reduction
    >>> round(float(friction_reduction(intrinsic_friction_force=1.0, reduced_friction_force=0.35)), 3)
    0.65
    """
    intrinsic = require_positive(intrinsic_friction_force=intrinsic_friction_force)
    reduced = require_finite(reduced_friction_force=reduced_friction_force)
    return (intrinsic - reduced) / intrinsic


def wear_reduction(*, intrinsic_wear_rate: ArrayLike, reduced_wear_rate: ArrayLike) -> Floats:
    r"""Wear reduction by vibration, relative to the intrinsic wear rate. []

    Parameters
    ----------
    intrinsic_wear_rate : array_like
        Wear rate without vibration. [m2]
    reduced_wear_rate : array_like, broadcast against `intrinsic_wear_rate`
        Wear rate with vibration. [m2]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an intrinsic rate is not positive, a reduced one negative, or a value not finite.

    See Also
    --------
    friction_reduction, wear_rate

    Notes
    -----
    .. math:: P_w = \frac{W_0 - W_1}{W_0} \qquad \text{(D 2.3)}

    References
    ----------
    .. [1] D 2.3.

    Examples
    --------
    >>> from sonolube.facts.metrics import wear_reduction
    >>> round(float(wear_reduction(intrinsic_wear_rate=2.237e-11, reduced_wear_rate=1.214e-11)), 3)  # D Table 2.5
    0.457
    """
    intrinsic = require_positive(intrinsic_wear_rate=intrinsic_wear_rate)
    return (intrinsic - require_non_negative(reduced_wear_rate=reduced_wear_rate)) / intrinsic


def wear_rate(*, wear_volume: ArrayLike, sliding_distance: ArrayLike) -> Floats:
    r"""Wear rate, wear volume per sliding distance. [m2]

    Parameters
    ----------
    wear_volume : array_like
        Wear volume. [m3]
    sliding_distance : array_like, broadcast against `wear_volume`
        Sliding distance over which it was worn. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a volume is negative, a distance not positive, or a value not finite.

    Notes
    -----
    .. math:: W = \frac{V}{D} \qquad \text{(D 2.2)}

    References
    ----------
    .. [1] D 2.2.

    Examples
    --------
    >>> from sonolube.facts.metrics import wear_rate
    >>> from sonolube.text.units import format_quantity
    >>> format_quantity(float(wear_rate(wear_volume=7.5e-9, sliding_distance=300.0)), "wear_rate")
    '0.025 mm3/m'
    """
    return require_non_negative(wear_volume=wear_volume) / require_positive(sliding_distance=sliding_distance)
