"""Measures of a test with a pin on a rotating disc: speeds, distances, friction and wear reduction, wear rate."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive


def peak_vibration_velocity(*, frequency: ArrayLike, vibration_amplitude: ArrayLike) -> Floats:
    r"""Peak velocity of a harmonic vibration. [m/s]

    Parameters
    ----------
    frequency : array_like
        Frequency of the vibration. [Hz]
    vibration_amplitude : array_like, broadcast against `frequency`
        Displacement amplitude, zero to peak. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a frequency is not positive, an amplitude negative, or a value not finite.

    Notes
    -----
    .. math:: v_1 = 2\pi f a

    Examples
    --------
    >>> from sonolube.facts.metrics import peak_vibration_velocity
    >>> from sonolube.text.units import format_si
    >>> format_si(float(peak_vibration_velocity(frequency=22e3, vibration_amplitude=2.5e-6)), "m/s")
    '346 mm/s'
    """
    f = require_positive(frequency=frequency)
    return 2 * np.pi * f * require_non_negative(vibration_amplitude=vibration_amplitude)


def superimposed_speed(*, sliding_speed: ArrayLike, vibration_velocity: ArrayLike) -> Floats:
    r"""Superimposed speed of sliding and a vibration perpendicular to it, after D Table 4.5. [m/s]

    Parameters
    ----------
    sliding_speed : array_like
        Speed of the sliding. [m/s]
    vibration_velocity : array_like, broadcast against `sliding_speed`
        Peak velocity of the vibration, from `peak_vibration_velocity`. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is negative or not finite.

    Notes
    -----
    .. math:: v_s = \sqrt{v_r^2 + \left( \frac{v_1}{\pi} \right)^2}

    The vibration enters by its half-wave mean, peak over pi: the positive half of the velocity averaged over the whole
    period. It is the "average vibrational velocity" of D Table 4.5, whose cells this form reproduces within 2 %; the
    mean of the absolute velocity would be twice as high.
    """
    v_r = require_non_negative(sliding_speed=sliding_speed)
    v_1 = require_non_negative(vibration_velocity=vibration_velocity)
    return np.hypot(v_r, v_1 / np.pi)


def dot_spacing(*, sliding_speed: ArrayLike, frequency: ArrayLike) -> Floats:
    r"""Spacing along the wear track of the marks left by successive vibration cycles. [m]

    Parameters
    ----------
    sliding_speed : array_like
        Speed of the sliding. [m/s]
    frequency : array_like, broadcast against `sliding_speed`
        Frequency of the vibration. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a speed is negative, a frequency not positive, or a value not finite.

    Notes
    -----
    .. math:: s = \frac{v_r}{f}
    """
    return require_non_negative(sliding_speed=sliding_speed) / require_positive(frequency=frequency)


def indentation_spacing(*, sliding_speed: ArrayLike, period: ArrayLike) -> Floats:
    r"""Spacing along the wear track of the indentations left by stick-slip. [m]

    Parameters
    ----------
    sliding_speed : array_like
        Speed of the sliding. [m/s]
    period : array_like, broadcast against `sliding_speed`
        Period of the stick-slip. [s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a speed is negative, a period not positive, or a value not finite.

    Notes
    -----
    .. math:: s_i = v_r T
    """
    return require_non_negative(sliding_speed=sliding_speed) * require_positive(period=period)


def linear_speed(*, rotation_speed: ArrayLike, groove_diameter: ArrayLike) -> Floats:
    r"""Sliding speed of a pin on a rotating disc. [m/s]

    Parameters
    ----------
    rotation_speed : array_like
        Rotational speed of the disc, revolutions per time. [1/s]
    groove_diameter : array_like, broadcast against `rotation_speed`
        Diameter of the wear track under the pin. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a rotational speed is negative, a diameter not positive, or a value not finite.

    Notes
    -----
    .. math:: v_r = \pi D_g n

    Examples
    --------
    >>> from sonolube.facts.metrics import linear_speed
    >>> from sonolube.text.units import format_si
    >>> format_si(float(linear_speed(rotation_speed=1.0, groove_diameter=50e-3)), "m/s")  # 60 rpm
    '157 mm/s'
    """
    return (
        np.pi * require_non_negative(rotation_speed=rotation_speed) * require_positive(groove_diameter=groove_diameter)
    )


def sliding_distance(*, revolutions: ArrayLike, groove_diameter: ArrayLike) -> Floats:
    r"""Sliding distance of a pin on a rotating disc. [m]

    Parameters
    ----------
    revolutions : array_like
        Revolutions of the disc, not necessarily whole. []
    groove_diameter : array_like, broadcast against `revolutions`
        Diameter of the wear track under the pin. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If the revolutions are negative, a diameter not positive, or a value not finite.

    Notes
    -----
    .. math:: D = \pi D_g N

    Examples
    --------
    >>> from sonolube.facts.metrics import sliding_distance
    >>> round(float(sliding_distance(revolutions=1000, groove_diameter=50e-3)), 1)  # m
    157.1
    """
    return np.pi * require_non_negative(revolutions=revolutions) * require_positive(groove_diameter=groove_diameter)


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
