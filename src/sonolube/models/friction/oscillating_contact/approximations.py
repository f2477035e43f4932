"""Closed-form approximations of the friction of oscillating spring contacts, published or derived from publications.

The exact ratios are those of `rigid_guide`, `combined_oscillation` and `compliant_guide`; the error of every
approximation is stated relative to them.
"""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, warn_of_range
from sonolube.models.friction.bristle import Holder
from sonolube.models.friction.laws.coulomb import transverse_vibration_ratio
from sonolube.models.friction.oscillating_contact.driven_spring import guided_critical_speed
from sonolube.models.friction.oscillating_contact.spring_contact import (
    SpringContact,
    longitudinal_static_ratio,
    normal_static_ratio,
    slip_length_fraction,
)

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(32)
_MAXIMUM_STROKE = {"flat": 1.0, "parabolic": 0.5}  # amplitude over the slip length, by profile
_MINIMUM_SPEED = 0.3  # sliding speed over the peak velocity across
_MAXIMUM_NATURAL_FREQUENCY = 0.5  # of slider on guide and contact, over the frequency of the oscillation


def approximate_normal_ratio(
    contact: SpringContact, *, approach: ArrayLike, normal_amplitude: ArrayLike, velocity_ratio: ArrayLike
) -> Floats:
    r"""Approximate friction ratio under an oscillation along the normal on a rigid guide. []

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
        If contact is lost throughout the period.

    Warns
    -----
    ModelRangeWarning
        If contact is lost for part of the period, which the approximation does not cover.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = 1 - (1 - R_s)\, P(v), \qquad P = \tfrac34 (1 - v)^2 + \tfrac14 (1 - v)^4

    with the static ratio R_s of `normal_static_ratio`, 1 - a/u for the flat profile, for which this is known as the
    published form. The text was not available; compared with the exact ratio it is lower by at most 0.0144 a/u. With
    the static ratio of the parabolic profile, which was not published, the error is at most 0.023 without loss of
    contact.

    See Also
    --------
    normal_oscillation_ratio : The exact ratio.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    """
    return _normal_ratio(contact, approach, normal_amplitude, require_positive(velocity_ratio=velocity_ratio))


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
    """Approximate friction ratio under an oscillation along the normal on a compliant guide. []

    Parameters
    ----------
    contact : SpringContact
        Contact of the flat profile.
    holder : Holder
        Stiffness and damping of the guide, and mass that moves with the slider.
    normal_stiffness : array_like
        Normal stiffness of the contact. [N/m]
    approach : array_like
        Mean approach. [m]
    normal_amplitude : array_like
        Amplitude along the surface normal. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like
        Mean sliding speed. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If the profile is not flat, a stiffness, frequency or speed not positive, or a value not finite.
    OutsideRange
        If contact is lost throughout the period.

    Warns
    -----
    ModelRangeWarning
        If contact is lost for part of the period, or if the natural frequency of a slider with mass on guide and
        contact exceeds half the frequency of the oscillation.

    Notes
    -----
    The form of `approximate_normal_ratio` with the speed over `guided_critical_speed`, which follows from both sources
    but is stated in neither. The error relative to `guided_oscillation_ratio` is 0.02 where no warning is issued, and
    up to 0.2 near resonance.

    See Also
    --------
    guided_oscillation_ratio : The exact ratio.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    .. [2] X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017). doi:10.1007/s40544-017-0146-x
    """
    if contact.profile != "flat":
        raise InvalidInput("profile must be 'flat' on a compliant guide")
    k_z, omega = require_positive(normal_stiffness=normal_stiffness), 2 * np.pi * require_positive(frequency=frequency)
    critical = guided_critical_speed(
        contact, holder, normal_stiffness=k_z, normal_amplitude=normal_amplitude, frequency=frequency
    )
    stiffness = holder.holder_stiffness + contact.mindlin_ratio * k_z
    if holder.holder_mass > 0 and np.any(np.sqrt(stiffness / holder.holder_mass) > _MAXIMUM_NATURAL_FREQUENCY * omega):
        _warn("the slider follows the oscillation on its guide and contact", "guided_oscillation_ratio")
    speed = require_positive(sliding_speed=sliding_speed)
    return _normal_ratio(contact, approach, normal_amplitude, speed / np.maximum(critical, 1e-200 * speed))


def approximate_longitudinal_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    in_plane_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    r"""Approximate friction ratio under a short oscillation along the sliding direction. []

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
        Mean sliding speed. [m/s]

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
    .. math:: \frac{F_1}{F_0} = 1 - (1 - R_s)\, P\!\left( \frac{v_r}{\omega a} \right)

    with the static ratio R_s of `longitudinal_static_ratio` and the function P of `approximate_normal_ratio`: an
    oscillating end has the same effect on a spring as an oscillating limit, so that the form applies here, which
    neither source states. Relative to `longitudinal_oscillation_ratio` it is lower by at most 0.0144 s for the flat
    profile, and within 0.017 for the parabolic one up to half the slip length, within 0.11 up to all of it.

    References
    ----------
    .. [1] V. L. Popov, J. Starcevic and A. E. Filippov, Tribol. Lett. 39, 25 (2010). doi:10.1007/s11249-009-9531-6
    .. [2] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    """
    a = require_non_negative(in_plane_amplitude=in_plane_amplitude)
    if np.any(slip_length_fraction(contact, approach=approach, amplitude=a) > _MAXIMUM_STROKE[contact.profile]):
        _warn("in_plane_amplitude reverses the slip of springs", "longitudinal_oscillation_ratio")
    static = longitudinal_static_ratio(contact, approach=approach, in_plane_amplitude=a)
    speed, omega = require_positive(sliding_speed=sliding_speed), 2 * np.pi * require_positive(frequency=frequency)
    return 1 - (1 - static) * _deficit(speed / np.maximum(omega * a, 1e-200 * speed))


def approximate_transverse_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    transverse_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    r"""Approximate friction ratio under an oscillation across the sliding direction. []

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
        Mean sliding speed. [m/s]

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
        If the sliding speed is below 0.3 of the peak velocity across, where springs stick; at rest
        `transverse_static_ratio` holds.

    Notes
    -----
    .. math:: \frac{F_1}{F_0}(v_r)
              = \left( \frac{F_1}{F_0} \right)_\text{rigid}\!\left( \sqrt{v_r^2 + (\omega l)^2} \right),
              \qquad l = \frac{\mu k_z u}{k_x}

    A slipping spring follows the direction of the velocity only over its slip length l: friction is that of rigid
    contacts, `transverse_vibration_ratio`, at a raised sliding speed. Derived here for the system of [1]_, exact for
    small angles. From 0.3 of the peak velocity on at most 0.043 above and 0.004 below `combined_oscillation_ratio`,
    from 0.5 on within 0.021 and from 0.7 on within 0.01.

    References
    ----------
    .. [1] J. Benad, K. Nakano, V. L. Popov and M. Popov, Friction 7, 74 (2019), who give the system.
       doi:10.1007/s40544-018-0202-1
    """
    a = require_non_negative(transverse_amplitude=transverse_amplitude)
    omega = 2 * np.pi * require_positive(frequency=frequency)
    v_r, v_1 = require_positive(sliding_speed=sliding_speed), omega * a
    if np.any(v_r < _MINIMUM_SPEED * v_1):
        reason = "sliding_speed is below 0.3 of the peak velocity across, where springs stick"
        _warn(reason, "combined_oscillation_ratio")
    raised = omega * contact.slip_per_approach * require_positive(approach=approach)
    if contact.profile == "flat":
        return transverse_vibration_ratio(sliding_speed=np.hypot(v_r, raised), vibration_velocity=v_1)
    ratio = np.zeros(np.broadcast_shapes(v_r.shape, v_1.shape, raised.shape))
    for node, weight in zip((1 + _NODES) / 2, _WEIGHTS / 2, strict=True):
        limit = 1 - node**2
        speed = np.hypot(v_r, limit * raised)
        ratio += 1.5 * weight * limit * transverse_vibration_ratio(sliding_speed=speed, vibration_velocity=v_1)
    return ratio


def _deficit(velocity_ratio: Floats) -> Floats:
    """Function P of the published approximation, for speeds over the critical one."""
    margin = 1 - np.minimum(velocity_ratio, 1.0)
    return 0.75 * margin**2 + 0.25 * margin**4


def _normal_ratio(
    contact: SpringContact, approach: ArrayLike, normal_amplitude: ArrayLike, velocity_ratio: Floats
) -> Floats:
    """Ratio between that of static friction and one; warn the caller's caller where contact is lost."""
    static = normal_static_ratio(contact, approach=approach, normal_amplitude=normal_amplitude)
    if np.any(require_finite(normal_amplitude=normal_amplitude) > require_finite(approach=approach)):
        reason = "normal_amplitude exceeds the approach: contact is lost for part of the period"
        _warn(reason, "normal_oscillation_ratio", stacklevel=4)
    return 1 - (1 - static) * _deficit(velocity_ratio)


def _warn(reason: str, exact: str, *, stacklevel: int = 3) -> None:
    """Warn of a motion that the approximation does not cover, and name the exact function."""
    warn_of_range(f"{reason}, which the approximation does not cover; use {exact}", stacklevel=stacklevel)
