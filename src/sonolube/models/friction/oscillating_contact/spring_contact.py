r"""Spring contact under oscillation: the record, its critical speed and its load-balanced approach.

A slider is pressed by the approach u against springs of the normal stiffness k_z and the tangential stiffness k_x, each
of which slips at its own Coulomb limit. Under harmonic oscillations the springs stick for part of the period, which
reduces the mean friction. The modules of this package compute its ratio to friction without oscillation:
`static_friction` for slow sliding, `rigid_guide` in closed form for one direction, `combined_oscillation` numerically
for all directions, `compliant_guide` for a slider on a guide with spring and mass, and `approximations` by the
published approximations.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.friction.oscillating_contact.stick_slip_phases import balanced_approaches, profile_mean_limits

NODES = np.polynomial.legendre.leggauss(48)
"""Gauss-Legendre rule over the springs of a parabolic profile."""

FEW = 20_000
"""Springs for which plain Python takes less than compiling. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class SpringContact:
    """Contact of independent springs with normal and tangential stiffness, each with its own Coulomb limit.

    Parameters
    ----------
    friction_coefficient : float
        Coefficient of friction of steady sliding, which limits every spring at its instantaneous normal force. []
    mindlin_ratio : float
        Tangential over normal stiffness, k_x/k_z; (2 - 2 nu)/(2 - nu) for bodies of one material. []
    profile : {"flat", "parabolic"}
        "flat": all springs come into contact at once, so that both stiffnesses are constant; "parabolic": a sphere on a
        plane.

    Raises
    ------
    InvalidInput
        If a value is not positive, or the profile not one of these.

    Notes
    -----
    The springs of the parabolic profile are those of the method of dimensionality reduction. For bodies of one
    material, and any history of approach and slide, they give the force of Hertz, Cattaneo and Mindlin.

    References
    ----------
    .. [1] V. L. Popov and M. Hess, Method of Dimensionality Reduction in Contact Mechanics and Friction, Springer
       (2015). doi:10.1007/978-3-642-53876-6

    Examples
    --------
    >>> from sonolube.models.friction import SpringContact, longitudinal_static_ratio
    >>> contact = SpringContact(friction_coefficient=0.3, mindlin_ratio=0.8)
    >>> ratio = longitudinal_static_ratio(contact, approach=2e-6, in_plane_amplitude=[0.0, 0.3e-6])
    >>> ratio.round(3).tolist()  # 1 - 0.8 (0.3 um)/(0.3 2 um)
    [1.0, 0.6]
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
        """Slip length of the deepest spring over its approach, mu k_z/k_x."""
        return self.friction_coefficient / self.mindlin_ratio


def critical_speed(contact: SpringContact, *, frequency: ArrayLike, normal_amplitude: ArrayLike) -> Floats:
    r"""Critical speed, from which an oscillation along the normal does not reduce friction. [m/s]

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
    .. math:: v_c = \mu \omega a\, \frac{k_z}{k_x}

    From this speed on no spring sticks, since its limit never rises faster than its force by sliding. Holds for any
    profile, and with contact lost for part of the period, on a rigid guide.

    See Also
    --------
    guided_critical_speed : Critical speed on a compliant guide.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017). doi:10.1007/s40544-016-0136-4

    Examples
    --------
    >>> from sonolube.models.friction import SpringContact, critical_speed
    >>> contact = SpringContact(friction_coefficient=0.3, mindlin_ratio=0.8)
    >>> round(float(critical_speed(contact, frequency=20e3, normal_amplitude=1e-6)), 4)  # 0.3 (2 pi 20 kHz) 1 um/0.8
    0.0471
    """
    omega = 2 * np.pi * require_positive(frequency=frequency)
    return contact.slip_per_approach * omega * require_non_negative(normal_amplitude=normal_amplitude)


def load_balanced_approach(contact: SpringContact, *, approach: ArrayLike, normal_amplitude: ArrayLike) -> Floats:
    r"""Mean approach at which the mean normal force of an oscillating contact is that at rest. [m]

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
        Smaller than at rest where the stiffness varies or contact is lost, and negative where contact is lost for most
        of the period.

    Raises
    ------
    InvalidInput
        If the approach is not positive, or the amplitude negative.

    Notes
    -----
    The mean approach u of

    .. math:: \langle F_n(u - a \cos\omega t) \rangle = F_n(u_0), \qquad F_n \propto \max(u, 0)^p

    by Newton's method, with p = 1 for the flat and 3/2 for the parabolic profile.
    """
    a = require_non_negative(normal_amplitude=normal_amplitude)
    u, a = np.broadcast_arrays(require_positive(approach=approach), a)
    flat = contact.profile == "flat"
    lost = a > u if flat else a > 0  # for part of the period, or at some springs
    balanced = u.astype(np.float64)
    approaches = balanced_approaches.for_points(int(lost.sum()) * (1 if flat else NODES[0].size), at_first=FEW)
    balanced[lost] = a[lost] * approaches(u[lost] / a[lost], flat, *NODES)
    return balanced


def require_contact(*, approach: ArrayLike, normal_amplitude: ArrayLike) -> tuple[Floats, Floats]:
    """Mean approach and amplitude, broadcast; refuse values with which contact is lost throughout the period.

    The arguments. [m]
    """
    a = require_non_negative(normal_amplitude=normal_amplitude)
    u, a = np.broadcast_arrays(require_finite(approach=approach), a)
    separated = u + a <= 0
    if np.any(separated):
        raise OutsideRange(
            f"contact is lost throughout the period at a mean approach of {float(u[separated].flat[0]):.4g} m"
            f" with a normal_amplitude of {float(a[separated].flat[0]):.4g} m"
        )
    return u, a


def mean_normal_forces(contact: SpringContact, u: Floats, a: Floats) -> Floats:
    """Mean normal force in units of one spring (flat), or of the springs per length (parabolic)."""
    flat = contact.profile == "flat"
    power, factor = (1.0, 1.0) if flat else (1.5, 2 / 3)
    moves = a > 0
    scale = np.where(moves, a, 1.0)
    mean_limits = profile_mean_limits.for_points(u.size * (1 if flat else NODES[0].size), at_first=FEW)
    moving = scale**power * mean_limits((u / scale).ravel(), flat, *NODES).reshape(u.shape)
    return np.asarray(np.where(moves, moving, factor * np.maximum(u, 0.0) ** power))
