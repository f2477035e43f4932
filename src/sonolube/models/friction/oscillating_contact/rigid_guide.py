"""Friction of a spring contact on a rigid guide under oscillation along the normal or the sliding, in closed form."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.models.friction.oscillating_contact.spring_contact import FEW, NODES, SpringContact, require_contact
from sonolube.models.friction.oscillating_contact.stick_slip_phases import (
    flat_longitudinal_ratio,
    flat_normal_ratio,
    parabolic_longitudinal_ratio,
    parabolic_normal_ratio,
)


def normal_oscillation_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    normal_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    r"""Friction ratio under an oscillation along the normal on a rigid guide. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Mean approach; under a dead load that of `load_balanced_approach`. [m]
    normal_amplitude : array_like
        Amplitude along the surface normal; contact is lost for part of the period if it exceeds the approach. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like
        Mean sliding speed. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Friction over that of the same mean normal force: from `normal_static_ratio` for slow sliding to exactly 1 from
        `critical_speed` on.

    Raises
    ------
    InvalidInput
        If frequency or speed is not positive, the amplitude negative, or a value not finite.
    OutsideRange
        If contact is lost throughout the period.

    Notes
    -----
    Exact for massless springs: the steady period of each spring follows from the phases at which it sticks and slips.
    For the flat profile without loss of contact

    .. math::

        \frac{F_1}{F_0} = 1 - \frac au\, S\!\left( \frac{v_r}{v_c} \right), \qquad
        S = \frac{v\, (1 - h \cot h)^2}{\pi}, \quad v = \frac{\sin h}{\sqrt{h^2 + (1 - h \cot h)^2}}

    with half the phase of sticking h, to 1e-9. Parabolic profiles are integrated over the springs to 1e-6.

    See Also
    --------
    approximate_normal_ratio : Published approximation.
    guided_oscillation_ratio : The same on a compliant guide.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017), who give the system.
       doi:10.1007/s40544-016-0136-4

    Examples
    --------
    >>> from sonolube.models.friction import SpringContact, normal_oscillation_ratio
    >>> contact = SpringContact(friction_coefficient=0.3, mindlin_ratio=0.8)
    >>> vibrated = {"approach": 2e-6, "normal_amplitude": 1e-6, "frequency": 20e3}
    >>> ratio = normal_oscillation_ratio(contact, sliding_speed=[1e-6, 0.02, 0.05], **vibrated)
    >>> ratio.round(2).tolist()  # from 1 - a/u to 1 beyond the critical speed of 0.047 m/s
    [0.5, 0.86, 1.0]
    """
    u, a = require_contact(approach=approach, normal_amplitude=normal_amplitude)
    omega = 2 * np.pi * require_positive(frequency=frequency)
    v_r = require_positive(sliding_speed=sliding_speed)
    u, a, omega, v_r = np.broadcast_arrays(u, a, omega, v_r)
    v = np.minimum(v_r / np.maximum(contact.slip_per_approach * omega * a, v_r), 1.0)
    c = np.where(a > 0, u / np.where(a > 0, a, 1.0), 2.0)
    if contact.profile == "flat":
        return flat_normal_ratio.for_points(c.size, at_first=FEW)(c.ravel(), v.ravel()).reshape(u.shape)
    parabolic_ratio = parabolic_normal_ratio.for_points(c.size * NODES[0].size, at_first=FEW)
    return parabolic_ratio(c.ravel(), v.ravel(), *NODES).reshape(u.shape)


def longitudinal_oscillation_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    in_plane_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    r"""Friction ratio under an oscillation along the sliding direction on a rigid guide. []

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
        Exactly 1 from the peak velocity of the oscillation on.

    Raises
    ------
    InvalidInput
        If approach, frequency or speed is not positive, the amplitude negative, or a value not finite.

    Notes
    -----
    Exact for massless springs. For the flat profile and a stroke too short for reverse slip

    .. math:: \frac{F_1}{F_0} = 1 - \frac{k_x a}{\mu F_N}\, S\!\left( \frac{v_r}{\omega a} \right)

    with the function S of `normal_oscillation_ratio`: an oscillating limit and an oscillating end have the same effect
    on a spring. Long strokes give the arcsine of `parallel_vibration_ratio`.

    See Also
    --------
    approximate_longitudinal_ratio : Approximation in closed form.

    References
    ----------
    .. [1] V. L. Popov, J. Starcevic and A. E. Filippov, Tribol. Lett. 39, 25 (2010), who give the system.
       doi:10.1007/s11249-009-9531-6
    """
    u, a, omega, v_r = np.broadcast_arrays(
        require_positive(approach=approach),
        require_non_negative(in_plane_amplitude=in_plane_amplitude),
        2 * np.pi * require_positive(frequency=frequency),
        require_positive(sliding_speed=sliding_speed),
    )
    v = np.minimum(v_r / np.maximum(omega * a, v_r), 1.0).ravel()
    stroke = (a / (contact.slip_per_approach * u)).ravel()
    if contact.profile == "flat":
        return flat_longitudinal_ratio(stroke, v).reshape(u.shape)
    return parabolic_longitudinal_ratio(stroke, v, *NODES).reshape(u.shape)
