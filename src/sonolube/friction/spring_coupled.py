"""A slider before the springs of its contact, under oscillation along the normal or along the sliding."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.friction.spring_element import (
    flat_under_load,
    flat_under_stroke,
    mean_limits,
    parabolic_under_load,
    parabolic_under_stroke,
)

_NODES = np.polynomial.legendre.leggauss(48)


@dataclass(frozen=True, kw_only=True, slots=True)
class SpringContact:
    """A contact of springs along the normal and along the plane, each of which slips at its own Coulomb limit.

    Parameters
    ----------
    friction_coefficient : float
        Coefficient of steady sliding, which limits every spring at every instant's normal force. []
    mindlin_ratio : float
        Tangential over normal stiffness, (2 - 2 nu)/(2 - nu) for like bodies. []
    profile : {"flat", "parabolic"}
        "flat": all springs touch at once, so that both stiffnesses are constant; "parabolic": a sphere on a plane.

    Raises
    ------
    InvalidInput
        If a value is not positive, or the profile unknown.

    Notes
    -----
    The springs of the parabolic profile stand side by side as those of the method of dimensionality reduction do. For
    like bodies, and any history of approach and slide, they give the force of Hertz, Cattaneo and Mindlin.

    References
    ----------
    .. [1] V. L. Popov and M. Hess, Method of Dimensionality Reduction in Contact Mechanics and Friction, Springer
       (2015). doi:10.1007/978-3-642-53876-6
    """

    friction_coefficient: float
    mindlin_ratio: float
    profile: Literal["flat", "parabolic"] = "flat"

    def __post_init__(self) -> None:
        require_positive(friction_coefficient=self.friction_coefficient, mindlin_ratio=self.mindlin_ratio)
        if self.profile not in ("flat", "parabolic"):
            raise InvalidInput(f"profile must be 'flat' or 'parabolic', got {self.profile!r}")

    @property
    def slip_per_approach(self) -> float:
        """Slide at which the deepest spring slips over its approach, mu k_z/k_x."""
        return self.friction_coefficient / self.mindlin_ratio


def critical_speed(contact: SpringContact, *, frequency: ArrayLike, normal_amplitude: ArrayLike) -> Floats:
    """Return the sliding speed from which an oscillation along the normal leaves friction as it is. [m/s]

    Parameters
    ----------
    contact : SpringContact
    frequency : array_like
        Frequency of the oscillation. [Hz]
    normal_amplitude : array_like, broadcast against `frequency`
        Amplitude along the surface normal. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If the frequency is not positive, or the amplitude negative.

    Notes
    -----
    mu omega a k_z/k_x: from there on no spring grips, for its limit never rises faster than the slide stretches it.
    This holds for any profile and with the contact lost for part of the period, but for a rigid guide only.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4
    """
    omega = 2 * np.pi * require_positive(frequency=frequency)
    return contact.slip_per_approach * omega * require_non_negative(normal_amplitude=normal_amplitude)


def balanced_approach(contact: SpringContact, *, approach: ArrayLike, normal_amplitude: ArrayLike) -> Floats:
    """Return the mean approach at which an oscillating contact carries, on average, what it carries at rest. [m]

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Approach at rest. [m]
    normal_amplitude : array_like, broadcast against `approach`
        Amplitude along the surface normal. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Smaller than at rest wherever stiffness varies or contact is lost, and negative where the slider mostly flies.

    Raises
    ------
    InvalidInput
        If the approach is not positive, or the amplitude negative.
    """
    u, a = np.broadcast_arrays(
        require_positive(approach=approach), require_non_negative(normal_amplitude=normal_amplitude)
    )
    carried = _mean_forces(contact, u, np.zeros_like(a))
    low, high = np.minimum(-a, u), u.copy()
    for _ in range(60):
        middle = (low + high) / 2
        too_deep = _mean_forces(contact, middle, a) > carried
        high, low = np.where(too_deep, middle, high), np.where(too_deep, low, middle)
    return np.asarray((low + high) / 2)


def static_plateau(contact: SpringContact, *, approach: ArrayLike, normal_amplitude: ArrayLike) -> Floats:
    """Return friction of very slow sliding under an oscillation along the normal, over friction without. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Mean approach. [m]
    normal_amplitude : array_like, broadcast against `approach`
        Amplitude along the surface normal. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is not finite, or the amplitude negative.
    OutsideRange
        If the bodies never touch.

    Notes
    -----
    The least normal force over its mean: what a contact under steady pull holds without creeping. Flat,
    1 - a/u; zero where contact is lost.

    References
    ----------
    .. [1] R. Teidelt, J. Starcevic and V. L. Popov, Tribol. Lett. 48, 51 (2012). doi:10.1007/s11249-012-9937-4
    """
    u, a = _approach(approach, normal_amplitude)
    held: Floats = _mean_forces(contact, u - a, np.zeros_like(a)) / _mean_forces(contact, u, a)
    return held


def normal_oscillation_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    normal_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    """Return friction under an oscillation along the normal over that of the same mean normal force. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Mean approach; under dead weight that of `balanced_approach`. [m]
    normal_amplitude : array_like
        Amplitude along the surface normal; contact is lost for part of the period where it exceeds the approach. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like
        Mean speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        From `static_plateau` of slow sliding to exactly 1 from `critical_speed` on.

    Raises
    ------
    InvalidInput
        If frequency or speed is not positive, the amplitude negative, or a value not finite.
    OutsideRange
        If the bodies never touch.

    Notes
    -----
    Exact for springs without mass on a rigid guide: the steady period of each follows from the phases at which it
    grips and slips. Flat and never parting, the ratio is 1 - a/u S(v) with v the speed over the critical one and
    S = v (1 - h cot h)^2/pi, v = sin h/sqrt(h^2 + (1 - h cot h)^2), h half the phase for which it grips: good to 1e-9.
    Parabolic, springs are integrated to 1e-6.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017), who give the system.
       doi:10.1007/s40544-016-0136-4
    """
    u, a = _approach(approach, normal_amplitude)
    omega = 2 * np.pi * require_positive(frequency=frequency)
    v_r = require_positive(sliding_speed=sliding_speed)
    u, a, omega, v_r = np.broadcast_arrays(u, a, omega, v_r)
    v = np.minimum(v_r / np.maximum(contact.slip_per_approach * omega * a, v_r), 1.0)
    c = np.where(a > 0, u / np.where(a > 0, a, 1.0), 2.0)
    if contact.profile == "flat":
        return flat_under_load(c.ravel(), v.ravel()).reshape(u.shape)
    return parabolic_under_load(c.ravel(), v.ravel(), *_NODES).reshape(u.shape)


def longitudinal_oscillation_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    in_plane_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    """Return friction under an oscillation along the sliding over friction without. []

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
        Exactly 1 from the oscillation's peak velocity on.

    Raises
    ------
    InvalidInput
        If approach, frequency or speed is not positive, the amplitude negative, or a value not finite.

    Notes
    -----
    Exact for springs without mass on a rigid guide. A long stroke gives the arcsine of `parallel_vibration_ratio`. Of a
    stroke too short to slide the spring back, flat, friction is 1 - k_x a/(mu F_N) S(v) with the function S of
    `normal_oscillation_ratio`, now of the speed over the peak velocity: to a spring it is the same whether its limit
    oscillates or its end.

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
        return flat_under_stroke(stroke, v).reshape(u.shape)
    return parabolic_under_stroke(stroke, v, *_NODES).reshape(u.shape)


def _approach(approach: ArrayLike, normal_amplitude: ArrayLike) -> tuple[Floats, Floats]:
    u, a = np.broadcast_arrays(
        require_finite(approach=approach), require_non_negative(normal_amplitude=normal_amplitude)
    )
    apart = u + a <= 0
    if np.any(apart):
        raise OutsideRange(
            f"the bodies never touch at a mean approach of {float(u[apart].flat[0]):.4g} m"
            f" with a normal_amplitude of {float(a[apart].flat[0]):.4g} m"
        )
    return u, a


def _mean_forces(contact: SpringContact, u: Floats, a: Floats) -> Floats:
    """Return the mean normal force of springs of unit stiffness, or of unit stiffness over the root of distance."""
    flat = contact.profile == "flat"
    power, share = (1.0, 1.0) if flat else (1.5, 2 / 3)
    scale = np.where(a > 0, a, 1.0)
    moving = scale**power * mean_limits((u / scale).ravel(), flat, *_NODES).reshape(u.shape)
    return np.where(a > 0, moving, share * np.maximum(u, 0.0) ** power)
