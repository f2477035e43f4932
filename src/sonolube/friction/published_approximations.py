"""Friction of spring-coupled sliders in closed form: what was published, or follows from the published systems.

The exact ratios are those of `spring_coupled` and `spring_motion`; how far each form is off is said against them.
"""

import warnings

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, ModelRangeWarning
from sonolube.friction.bristle import Holder
from sonolube.friction.in_plane import transverse_vibration_ratio
from sonolube.friction.spring_coupled import SpringContact, static_plateau
from sonolube.friction.spring_motion import guided_critical_speed

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(32)
_MOST_STROKE = {"flat": 1.0, "parabolic": 0.5}
_LEAST_VELOCITY = 0.3  # over the peak velocity across
_FASTEST_OWN = 0.5  # of slider and guide on the contact's springs, over the frequency of the oscillation


def approximate_oscillation_ratio(
    contact: SpringContact, *, approach: ArrayLike, normal_amplitude: ArrayLike, velocity_ratio: ArrayLike
) -> Floats:
    """Return friction under an oscillation along the normal in the published approximation, over friction without. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Mean approach. [m]
    normal_amplitude : array_like
        Amplitude along the surface normal. [m]
    velocity_ratio : array_like
        Sliding speed over `critical_speed`. []

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a speed is not positive, the amplitude negative, or a value not finite.
    OutsideRange
        If the bodies never touch.

    Warns
    -----
    ModelRangeWarning
        If contact is lost for part of the period, for which the approximation was not made.

    Notes
    -----
    1 - (1 - plateau) [3/4 (1 - v)^2 + 1/4 (1 - v)^4]: known as theirs for constant stiffness, where the plateau is
    1 - a/u, and verified here, for the text was not at hand: within 0.0144 a/u of the exact ratio, always below it.
    With the plateau of the parabolic profile, for which it was not published, within 0.023 while the bodies touch.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    """
    plateau = static_plateau(contact, approach=approach, normal_amplitude=normal_amplitude)
    _warn_of_parting(approach, normal_amplitude)
    return 1 - (1 - plateau) * _lacking_share(require_positive(velocity_ratio=velocity_ratio))


def approximate_guided_ratio(
    contact: SpringContact,
    holder: Holder,
    *,
    normal_stiffness: ArrayLike,
    approach: ArrayLike,
    normal_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    """Return friction of a guided slider under an oscillation along the normal over that without, in closed form. []

    Parameters
    ----------
    contact : SpringContact
        Of the flat profile.
    holder : Holder
        The guide: stiffness, damping and the mass that moves with the slider.
    normal_stiffness : array_like
        Stiffness of the contact along the normal. [N/m]
    approach : array_like
        Mean approach. [m]
    normal_amplitude : array_like
        Amplitude along the surface normal. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like
        Mean speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If the profile is not flat, a stiffness, frequency or speed not positive, or a value not finite.
    OutsideRange
        If the bodies never touch.

    Warns
    -----
    ModelRangeWarning
        If contact is lost for part of the period, or a slider with mass can follow the oscillation: if its frequency on
        guide and contact exceeds half that of the oscillation.

    Notes
    -----
    The form of `approximate_oscillation_ratio` in the speed over `guided_critical_speed`: it follows from both sources,
    neither of which states it. Within 0.02 of `guided_oscillation_ratio` where it does not warn; near resonance off by
    up to 0.2.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    .. [2] X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017). doi:10.1007/s40544-017-0146-x
    """
    if contact.profile != "flat":
        raise InvalidInput("profile must be 'flat' on a guide that yields")
    k_z, omega = require_positive(normal_stiffness=normal_stiffness), 2 * np.pi * require_positive(frequency=frequency)
    critical = guided_critical_speed(
        contact, holder, normal_stiffness=k_z, normal_amplitude=normal_amplitude, frequency=frequency
    )
    stiffness = holder.holder_stiffness + contact.mindlin_ratio * k_z
    if holder.holder_mass > 0 and np.any(np.sqrt(stiffness / holder.holder_mass) > _FASTEST_OWN * omega):
        warnings.warn(
            "the slider can follow the oscillation on its guide and contact, for which the approximation was not made;"
            " guided_oscillation_ratio holds there",
            ModelRangeWarning,
            stacklevel=2,
        )
    speed = require_positive(sliding_speed=sliding_speed)
    plateau = static_plateau(contact, approach=approach, normal_amplitude=normal_amplitude)
    _warn_of_parting(approach, normal_amplitude)
    return 1 - (1 - plateau) * _lacking_share(speed / np.maximum(critical, 1e-200 * speed))


def longitudinal_static_ratio(contact: SpringContact, *, approach: ArrayLike, in_plane_amplitude: ArrayLike) -> Floats:
    """Return what holds against creep under an oscillation along the pull over static friction without. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Approach. [m]
    in_plane_amplitude : array_like, broadcast against `approach`
        Amplitude along the pull. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Zero where the stroke slides every spring.

    Raises
    ------
    InvalidInput
        If the approach is not positive, the amplitude negative, or a value not finite.

    Notes
    -----
    The limit of `longitudinal_oscillation_ratio` for slow sliding, exactly. With s the amplitude over the slip length
    mu k_z u/k_x, flat, 1 - s: the force falls by k_x a, the known form of [1]_, whose text was not at
    hand. Parabolic, (1 - s)^(3/2), which follows spring by spring; of that contact [2]_ tell that force, amplitude,
    indentation and coefficient make one curve, which this is.

    References
    ----------
    .. [1] V. L. Popov, J. Starcevic and A. E. Filippov, Tribol. Lett. 39, 25 (2010). doi:10.1007/s11249-009-9531-6
    .. [2] N. Milahin and J. Starcevic, Phys. Mesomech. 18, 197 (2015); Fiz. Mezomekh. 17 (3), 84 (2014).
    """
    left = np.maximum(1 - _stroke(contact, approach, require_non_negative(in_plane_amplitude=in_plane_amplitude)), 0.0)
    return left if contact.profile == "flat" else left**1.5


def approximate_longitudinal_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    in_plane_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    """Return friction under a short oscillation along the sliding over friction without, in closed form. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Approach. [m]
    in_plane_amplitude : array_like
        Amplitude along the sliding direction. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like
        Mean speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If approach, frequency or speed is not positive, the amplitude negative, or a value not finite.

    Warns
    -----
    ModelRangeWarning
        If the amplitude exceeds the slip length mu k_z u/k_x, or half of it under the parabolic profile.

    Notes
    -----
    The form of `approximate_oscillation_ratio` from `longitudinal_static_ratio` up to the peak velocity: a spring feels
    its end oscillate as it feels its limit do, so that the form may be carried over, which neither source does. Of
    `longitudinal_oscillation_ratio` it stays, flat, within 0.0144 s, always below; parabolic within 0.017 up to half
    the slip length and within 0.11 up to all of it.

    References
    ----------
    .. [1] V. L. Popov, J. Starcevic and A. E. Filippov, Tribol. Lett. 39, 25 (2010). doi:10.1007/s11249-009-9531-6
    .. [2] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    """
    a = require_non_negative(in_plane_amplitude=in_plane_amplitude)
    if np.any(_stroke(contact, approach, a) > _MOST_STROKE[contact.profile]):
        warnings.warn(
            "in_plane_amplitude slides springs back, for which the approximation was not made;"
            " longitudinal_oscillation_ratio holds there",
            ModelRangeWarning,
            stacklevel=2,
        )
    static = longitudinal_static_ratio(contact, approach=approach, in_plane_amplitude=a)
    speed, omega = require_positive(sliding_speed=sliding_speed), 2 * np.pi * require_positive(frequency=frequency)
    return 1 - (1 - static) * _lacking_share(speed / np.maximum(omega * a, 1e-200 * speed))


def transverse_static_ratio(contact: SpringContact, *, approach: ArrayLike, transverse_amplitude: ArrayLike) -> Floats:
    """Return what holds against creep under an oscillation across the pull over static friction without. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Approach. [m]
    transverse_amplitude : array_like, broadcast against `approach`
        Amplitude across the pull, within the plane. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Zero where the stroke slides every spring.

    Raises
    ------
    InvalidInput
        If the approach is not positive, the amplitude negative, or a value not finite.

    Notes
    -----
    The limit of `oscillation_ratio` for slow sliding: at each end of the stroke the force across, k_x a, leaves
    sqrt((mu F_N)^2 - (k_x a)^2) along the pull, a known form whose source was not at hand. Parabolic, the same spring
    by spring, to 1e-9: partial slip, which [2]_ finds to matter.

    References
    ----------
    .. [1] J. Benad, K. Nakano, V. L. Popov and M. Popov, Friction 7, 74 (2019). doi:10.1007/s40544-018-0202-1
    .. [2] Friction Influenced by Vibrations: A Refined Contact-Mechanics View on Lateral and Rotational Oscillations,
       Front. Mech. Eng. 6 (2020). doi:10.3389/fmech.2020.566440
    """
    s = _stroke(contact, approach, require_non_negative(transverse_amplitude=transverse_amplitude))
    s = np.minimum(s, 1.0)
    if contact.profile == "flat":
        return np.sqrt((1 - s) * (1 + s))
    # distances sqrt(1 - s) sin t of the springs that hold
    held = np.zeros_like(s)
    for node, weight in zip(np.pi / 4 * (1 + _NODES), np.pi / 4 * _WEIGHTS, strict=True):
        held += weight * np.cos(node) ** 2 * np.sqrt(1 + s - (1 - s) * np.sin(node) ** 2)
    return 1.5 * (1 - s) * held


def approximate_transverse_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    transverse_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    """Return friction under an oscillation across the sliding over friction without, in closed form. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Approach. [m]
    transverse_amplitude : array_like
        Amplitude across the sliding, within the plane. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like
        Mean speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If approach, frequency or speed is not positive, the amplitude negative, or a value not finite.

    Warns
    -----
    ModelRangeWarning
        If the sliding is slower than 0.3 of the peak velocity across; between there and rest, where
        `transverse_static_ratio` holds, springs grip.

    Notes
    -----
    A spring dragged by its slip length l = mu k_z u/k_x turns after the velocity only as fast as it is dragged on:
    friction is that of rigid bodies, `transverse_vibration_ratio`, which slide at sqrt(v^2 + (omega l)^2). Derived here
    for the system of [1]_, exactly for small angles; from 0.3 of the peak velocity on at most 0.043 above and 0.004
    below `oscillation_ratio`, from 0.5 on within 0.021 and from 0.7 on within 0.01.

    References
    ----------
    .. [1] J. Benad, K. Nakano, V. L. Popov and M. Popov, Friction 7, 74 (2019), who give the system.
       doi:10.1007/s40544-018-0202-1
    """
    a, omega = (
        require_non_negative(transverse_amplitude=transverse_amplitude),
        2 * np.pi * require_positive(frequency=frequency),
    )
    v_r, v_1 = require_positive(sliding_speed=sliding_speed), omega * a
    if np.any(v_r < _LEAST_VELOCITY * v_1):
        warnings.warn(
            "sliding_speed is below 0.3 of the peak velocity across, where springs grip, for which the approximation"
            " was not made; oscillation_ratio holds there",
            ModelRangeWarning,
            stacklevel=2,
        )
    turning = omega * contact.slip_per_approach * require_positive(approach=approach)
    if contact.profile == "flat":
        return transverse_vibration_ratio(sliding_speed=np.hypot(v_r, turning), vibration_velocity=v_1)
    ratio = np.zeros(np.broadcast_shapes(v_r.shape, v_1.shape, turning.shape))
    for node, weight in zip((1 + _NODES) / 2, _WEIGHTS / 2, strict=True):
        limit = 1 - node**2
        raised = np.hypot(v_r, limit * turning)
        ratio += 1.5 * weight * limit * transverse_vibration_ratio(sliding_speed=raised, vibration_velocity=v_1)
    return ratio


def _stroke(contact: SpringContact, approach: ArrayLike, amplitude: Floats) -> Floats:
    """Return an amplitude over the slip length of the deepest spring."""
    return amplitude / (contact.slip_per_approach * require_positive(approach=approach))


def _lacking_share(velocity_ratio: Floats) -> Floats:
    """Return which share of the plateau's reduction a speed leaves, by the published fit."""
    left = 1 - np.minimum(velocity_ratio, 1.0)
    return 0.75 * left**2 + 0.25 * left**4


def _warn_of_parting(approach: ArrayLike, normal_amplitude: ArrayLike) -> None:
    if np.any(require_finite(normal_amplitude=normal_amplitude) > require_finite(approach=approach)):
        warnings.warn(
            "normal_amplitude exceeds the approach: contact is lost for part of the period, for which the"
            " approximation was not made; normal_oscillation_ratio holds there",
            ModelRangeWarning,
            stacklevel=3,
        )
