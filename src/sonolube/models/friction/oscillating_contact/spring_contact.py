"""Spring contact under oscillation: the record, its critical speed, load-balanced approach and static friction ratios.

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


__all__ = [  # the rest serves this package only
    "SpringContact",
    "critical_speed",
    "load_balanced_approach",
    "longitudinal_static_ratio",
    "normal_static_ratio",
    "transverse_static_ratio",
]

_SLIP_NODES, _SLIP_WEIGHTS = np.polynomial.legendre.leggauss(32)


def normal_static_ratio(contact: SpringContact, *, approach: ArrayLike, normal_amplitude: ArrayLike) -> Floats:
    r"""Static friction ratio under an oscillation along the normal, the limit of slow sliding. []

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
        If contact is lost throughout the period.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \frac{\min_t F_n}{\langle F_n \rangle}

    the largest steady force that causes no creep. For the flat profile 1 - a/u; zero where contact is lost.

    See Also
    --------
    longitudinal_static_ratio, transverse_static_ratio : The same for oscillations within the plane.

    References
    ----------
    .. [1] R. Teidelt, J. Starcevic and V. L. Popov, Tribol. Lett. 48, 51 (2012). doi:10.1007/s11249-012-9937-4

    Examples
    --------
    >>> from sonolube.models.friction import SpringContact, normal_static_ratio
    >>> contact = SpringContact(friction_coefficient=0.3, mindlin_ratio=0.8)
    >>> ratio = normal_static_ratio(contact, approach=2e-6, normal_amplitude=[0.0, 0.5e-6, 2e-6])
    >>> ratio.round(3).tolist()  # 1 - a/u
    [1.0, 0.75, 0.0]
    """
    u, a = require_contact(approach=approach, normal_amplitude=normal_amplitude)
    ratio: Floats = mean_normal_forces(contact, u - a, np.zeros_like(a)) / mean_normal_forces(contact, u, a)
    return ratio


def longitudinal_static_ratio(contact: SpringContact, *, approach: ArrayLike, in_plane_amplitude: ArrayLike) -> Floats:
    r"""Static friction ratio under an oscillation along the pulling force. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Approach. [m]
    in_plane_amplitude : array_like, broadcast against `approach`
        Amplitude along the pulling force. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Zero where every spring slips.

    Raises
    ------
    InvalidInput
        If the approach is not positive, the amplitude negative, or a value not finite.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = 1 - s \ \text{(flat)}, \qquad (1 - s)^{3/2} \ \text{(parabolic)}, \qquad
              s = \frac{k_x a}{\mu k_z u}

    The exact limit of `longitudinal_oscillation_ratio` for slow sliding, with the amplitude over the slip length s. The
    form of the flat profile, a reduction of the force by k_x a, is known from [1]_, whose text was not available. That
    of the parabolic profile is derived spring by spring; [2]_ report for that contact that force, amplitude,
    indentation and coefficient form one curve, as here.

    References
    ----------
    .. [1] V. L. Popov, J. Starcevic and A. E. Filippov, Tribol. Lett. 39, 25 (2010). doi:10.1007/s11249-009-9531-6
    .. [2] N. Milahin and J. Starcevic, Phys. Mesomech. 18, 197 (2015); Fiz. Mezomekh. 17 (3), 84 (2014).
    """
    a = require_non_negative(in_plane_amplitude=in_plane_amplitude)
    remaining = np.maximum(1 - slip_length_fraction(contact, approach=approach, amplitude=a), 0.0)
    return remaining if contact.profile == "flat" else remaining**1.5


def transverse_static_ratio(contact: SpringContact, *, approach: ArrayLike, transverse_amplitude: ArrayLike) -> Floats:
    r"""Static friction ratio under an oscillation across the pulling force. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Approach. [m]
    transverse_amplitude : array_like, broadcast against `approach`
        Amplitude across the pulling force, within the plane. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Zero where every spring slips.

    Raises
    ------
    InvalidInput
        If the approach is not positive, the amplitude negative, or a value not finite.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \sqrt{1 - s^2} \ \text{(flat)}, \qquad s = \frac{k_x a}{\mu k_z u}

    The limit of `combined_oscillation_ratio` for slow sliding: at the ends of the stroke the transverse force k_x a
    leaves sqrt((mu F_N)^2 - (k_x a)^2) along the pulling force, a known form whose source was not available. The
    parabolic profile is integrated spring by spring to 1e-9; its partial slip is relevant according to [2]_.

    References
    ----------
    .. [1] J. Benad, K. Nakano, V. L. Popov and M. Popov, Friction 7, 74 (2019). doi:10.1007/s40544-018-0202-1
    .. [2] Friction Influenced by Vibrations: A Refined Contact-Mechanics View on Lateral and Rotational Oscillations,
       Front. Mech. Eng. 6 (2020). doi:10.3389/fmech.2020.566440
    """
    a = require_non_negative(transverse_amplitude=transverse_amplitude)
    s: Floats = np.minimum(slip_length_fraction(contact, approach=approach, amplitude=a), 1.0)
    if contact.profile == "flat":
        return np.sqrt((1 - s) * (1 + s))
    # springs that stick, at distances sqrt(1 - s) sin t
    sticking = np.zeros_like(s)
    for node, weight in zip(np.pi / 4 * (1 + _SLIP_NODES), np.pi / 4 * _SLIP_WEIGHTS, strict=True):
        sticking += weight * np.cos(node) ** 2 * np.sqrt(1 + s - (1 - s) * np.sin(node) ** 2)
    return 1.5 * (1 - s) * sticking


def slip_length_fraction(contact: SpringContact, *, approach: ArrayLike, amplitude: Floats) -> Floats:
    r"""Amplitude within the plane over the slip length of the deepest spring. []

    .. math:: s = \frac{k_x a}{\mu k_z u}
    """
    return amplitude / (contact.slip_per_approach * require_positive(approach=approach))
