"""Friction ratio under a sine of balanced load by asperity stick-slip in closed form, and its memory length."""

from math import acos, asin, cos, exp, pi, sin, sqrt

import numba
import numpy as np
from numpy.typing import ArrayLike
from scipy.special import i0e

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.contact.rough import RoughContact, decay_length, separation
from sonolube.friction.spring_element import half_grip

EMPIRICAL_MEMORY_LENGTH = 1.5e-6
"""Memory length of an asperity: sliding distance in which its force adapts to the sliding. [m]

Empirical: fitted, with a decay length of 2 um, to D Table 2.3 and sections 2.4 and 2.5, of whose friction ratios it
misses 0.09 rms and 0.15 at worst. Not valid for rigs like that of D Table 4.2."""

_PHASES = np.polynomial.legendre.leggauss(32)
_NEGLIGIBLE = 40.0  # exponents beyond which elements carry nothing


def mindlin_memory_length(contact: RoughContact, *, friction_coefficient: ArrayLike, normal_load: ArrayLike) -> Floats:
    """Return the sliding distance in which an asperity pressed by one decay length reaches its friction. [m]

    Parameters
    ----------
    contact : RoughContact
    friction_coefficient : array_like
        Coefficient of steady sliding. []
    normal_load : array_like, broadcast against `friction_coefficient`
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a coefficient or load is not positive.

    Notes
    -----
    D_c = mu C l, C the normal over the tangential stiffness of sticking asperities, (2 - nu)/(2 (1 - nu)) for like
    bodies: nothing is fitted.

    References
    ----------
    .. [1] R. D. Mindlin, J. Appl. Mech. 16, 259 (1949).
    """
    mu = require_positive(friction_coefficient=friction_coefficient)
    d = separation(contact, normal_load=normal_load)
    return mu * decay_length(contact, separation=d) / contact.pair.mindlin_ratio


def sine_stick_slip_ratio(
    *,
    decay_length: ArrayLike,
    vibration_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
    memory_length: ArrayLike = EMPIRICAL_MEMORY_LENGTH,
) -> Floats:
    """Return friction under a sine of balanced load over friction without. []

    Parameters
    ----------
    decay_length : array_like
        Length over which the normal force falls by a factor of e. [m]
    vibration_amplitude : array_like, broadcast against `decay_length`
        Amplitude of the vibration along the surface normal. [m]
    frequency : array_like, broadcast against them
        Frequency of the vibration. [Hz]
    sliding_speed : array_like, broadcast against them
        Mean speed of the sliding. [m/s]
    memory_length : array_like, broadcast against them
        Sliding distance D_c in which an asperity pressed by one decay length reaches its friction. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        From exp(-beta)/I0(beta), beta = a/l, of slow sliding to exactly 1 from v_r = omega a D_c/l on.

    Raises
    ------
    InvalidInput
        If a length, frequency or speed is not positive, an amplitude negative, or a value not finite.

    Notes
    -----
    Asperities are linear springs that touch at different gaps, so many at each gap that the normal force falls as
    exp(-x/l); each carries a tangential spring that the sliding stretches, slips at its own limit mu n(t), and starts
    anew at every touch. The mean gap rises so that the mean normal force stays the load.

    An element slips until the gap closes faster than its spring stretches, and grips from its touch, or from that
    phase, until its limit has fallen to its force. With h half the phase it grips and m the middle of that phase, this
    asks for sin m = v h/sin h, v = v_r l/(omega a D_c); the force it then lacks is 2 abs(cos m) (sin h - h cos h) in a
    period, and the sum over all elements one integral over h, here to 1e-12.
    """
    length, a, f, v_r, D_c = np.broadcast_arrays(
        require_positive(decay_length=decay_length),
        require_non_negative(vibration_amplitude=vibration_amplitude),
        require_positive(frequency=frequency),
        require_positive(sliding_speed=sliding_speed),
        require_positive(memory_length=memory_length),
    )
    beta = a / length
    reach = v_r * length / D_c  # v times omega a, which may be 0
    v = np.minimum(reach / np.maximum(2 * pi * f * a, reach), 1.0)
    return _harmonic_ratio(beta.ravel(), v.ravel(), i0e(beta).ravel(), *_PHASES).reshape(beta.shape)


@numba.njit(cache=True)
def _harmonic_ratio(beta: Floats, v: Floats, i0e_beta: Floats, nodes: Floats, weights: Floats) -> Floats:
    ratio = np.ones(beta.size)
    for i in range(beta.size):
        b, speed = beta[i], v[i]
        if speed >= 1.0 - 1e-12 or b == 0.0:  # what still grips there lacks less than 1e-23
            continue
        # elements that touch at phase theta_0 = m - h: from pi - arcsin v, where none grips, to arcsin v, where all do
        last = sqrt(1 - speed * speed)
        longest = half_grip(speed, max(asin(speed), acos(min(1.0, _NEGLIGIBLE / b - last))))
        lacking = 0.0
        for j in range(nodes.size):
            left = (1 - nodes[j]) / 2
            h = longest * (1 - left * left)  # crowding where slow sliding makes the integrand steep
            s = sin(h)
            rise, c = s - h * cos(h), sqrt(1 - (speed * h / s) ** 2)
            density = exp(-b * (1 - c * cos(h) + speed * h)) * h * (c * s - (speed * rise) ** 2 / (c * s**3))
            lacking += weights[j] * left * longest * density
        ratio[i] = 1 - b * lacking / (pi * i0e_beta[i])
    return ratio
