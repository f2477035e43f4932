"""Friction of a flat spring contact on a compliant guide, with spring, mass and damper, under normal oscillation."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_positive
from sonolube.errors import InvalidInput, OutsideRange, warn_of_range
from sonolube.models.friction.bristle import Holder, holder_propagators, mean_force_inertial_holder
from sonolube.models.friction.oscillating_contact.rigid_guide import normal_oscillation_ratio
from sonolube.models.friction.oscillating_contact.spring_contact import SpringContact, critical_speed

_STEPS = 4096  # of a period


def guided_oscillation_ratio(
    contact: SpringContact,
    holder: Holder,
    *,
    normal_stiffness: ArrayLike,
    approach: ArrayLike,
    normal_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    r"""Friction ratio under an oscillation along the normal on a compliant guide. []

    Parameters
    ----------
    contact : SpringContact
        Contact of the flat profile.
    holder : Holder
        Stiffness and damping of the guide, and mass that moves with the slider.
    normal_stiffness : float
        Normal stiffness of the contact. [N/m]
    approach : float
        Mean approach. [m]
    normal_amplitude : float
        Amplitude along the surface normal. [m]
    frequency : float
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like, any shape
        Mean sliding speed. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If the profile is not flat, a value is not finite, or a value other than the approach is not positive.
    OutsideRange
        If contact is lost throughout the period.

    Warns
    -----
    ModelRangeWarning
        If no steady period is found; the mean over the last of many periods is returned.

    Notes
    -----
    .. math:: m \ddot y + c \dot y + K y = F, \qquad \dot F = k_x (v_r - \dot y), \quad |F| \le \mu F_n(t)

    A guide without mass is a spring in series with the contact. At the resonance of a guide with mass the slider
    oscillates so far that friction is reduced at any speed; a slider much heavier than at resonance is rigidly guided.
    The reduction ends at `guided_critical_speed`. Error about 1e-3.

    See Also
    --------
    approximate_guided_ratio : Approximation in closed form.

    References
    ----------
    .. [1] X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017). doi:10.1007/s40544-017-0146-x
    """
    if contact.profile != "flat":
        raise InvalidInput(
            "profile must be 'flat' on a compliant guide, whose displacement couples the springs of other profiles"
        )
    k_z = float(require_positive(normal_stiffness=normal_stiffness))
    u, a = float(require_finite(approach=approach)), float(require_positive(normal_amplitude=normal_amplitude))
    f, v_r = float(require_positive(frequency=frequency)), require_positive(sliding_speed=sliding_speed)
    if u + a <= 0:
        raise OutsideRange("contact is lost throughout the period: approach plus normal_amplitude must be positive")
    theta = 2 * np.pi * np.arange(_STEPS) / _STEPS
    limit = contact.friction_coefficient * k_z * np.maximum(u - a * np.cos(theta), 0.0)
    k_x = np.full(_STEPS, contact.mindlin_ratio * k_z)
    if holder.holder_mass == 0:
        speed = v_r / (1 + k_x[0] / holder.holder_stiffness)
        return normal_oscillation_ratio(contact, approach=u, normal_amplitude=a, frequency=f, sliding_speed=speed)
    step = 1 / (f * _STEPS)
    deflection = np.full(v_r.size, np.mean(limit) / holder.holder_stiffness)
    slides, matrices = (np.zeros(_STEPS), v_r.ravel() * step), holder_propagators(holder, step)
    forces, settled = mean_force_inertial_holder(k_x, limit, *slides, step, 0.0, matrices, deflection)
    if not settled:
        warn_of_range(
            "no steady period of slider and guide was found; the mean over the last of many periods is returned."
            " Increase holder_damping"
        )
    return (forces / np.mean(limit)).reshape(v_r.shape)


def guided_critical_speed(
    contact: SpringContact,
    holder: Holder,
    *,
    normal_stiffness: ArrayLike,
    normal_amplitude: ArrayLike,
    frequency: ArrayLike,
) -> Floats:
    r"""Critical speed of an oscillation along the normal on a compliant guide. [m/s]

    Parameters
    ----------
    contact : SpringContact
    holder : Holder
        Stiffness and damping of the guide, and mass that moves with the slider.
    normal_stiffness : array_like
        Normal stiffness of the contact. [N/m]
    normal_amplitude : array_like
        Amplitude along the surface normal. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Infinite at the resonance of a guide without damping.

    Raises
    ------
    InvalidInput
        If stiffness or frequency is not positive, or the amplitude negative.

    Notes
    -----
    .. math:: v_c = \mu k_z a\, \omega \left| \frac1{k_x} + \frac1{K - m \omega^2 + \mathrm{i} c \omega} \right|

    While the contact slips throughout, friction oscillates with the amplitude mu k_z a, and deforms the contact spring
    and the guide. The speed is unbounded at the resonance of the guide, omega^2 = K/m, and zero at
    omega^2 = (K + k_x)/m, where both deformations cancel. Holds without loss of contact.

    See Also
    --------
    critical_speed : Critical speed on a rigid guide.

    References
    ----------
    .. [1] X. Mao, V. L. Popov, J. Starcevic and M. Popov, Friction 5, 194 (2017), who find no critical speed at
       resonance. doi:10.1007/s40544-017-0146-x
    """
    k_z = require_positive(normal_stiffness=normal_stiffness)
    rigid = critical_speed(contact, frequency=frequency, normal_amplitude=normal_amplitude)
    omega = 2 * np.pi * require_positive(frequency=frequency)
    if np.isinf(holder.holder_stiffness):
        return rigid + np.zeros_like(k_z)
    guide = holder.holder_stiffness - holder.holder_mass * omega**2 + 1j * holder.holder_damping * omega
    resonant = guide == 0
    factor = np.abs(1 + contact.mindlin_ratio * k_z / np.where(resonant, 1.0, guide))
    return np.where(rigid > 0, rigid * np.where(resonant, np.inf, factor), 0.0)
