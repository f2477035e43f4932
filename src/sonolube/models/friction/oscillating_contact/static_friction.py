"""Static friction ratio of a spring contact under oscillation: the exact limits of slow sliding, by direction."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.models.friction.oscillating_contact.spring_contact import (
    SpringContact,
    critical_speed,
    load_balanced_approach,
    mean_normal_forces,
    require_contact,
)

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
