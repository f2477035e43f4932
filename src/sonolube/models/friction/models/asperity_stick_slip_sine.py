"""Friction ratio of asperity stick-slip under a load-balanced sine in closed form, and memory length of asperities."""

from math import acos, asin, cos, exp, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.execution.compilation import kernel
from sonolube.models.contact.rough import RoughContact, decay_length, separation
from sonolube.models.friction.oscillating_contact.stick_slip_phases import half_stick_phase
from sonolube.models.friction.scaled_bessel import scaled_bessel_i0

EMPIRICAL_MEMORY_LENGTH = 1.5e-6
"""Memory length of an asperity: sliding distance in which its tangential force reaches the friction limit. [m]

Empirical: fitted to the tests of D Table 2.3 and sections 2.4 and 2.5, whose least squares are at 1.64 um, 1.25 to 2.21
um with 95 %, and not moved for Table 4.2, with which they are at 1.67 um, 1.30 to 2.21 um. On all 15 tests 1.5 um errs
by 0.12 rms and 0.23 at most, and by 0.14 where it predicts Table 4.2 and refits predict each set that it has seen.
Five of the tests have a printed roughness, that of the others is by comparison standards; with every printed roughness
the length is 1.35 um, 0.97 to 1.99 um."""

_PHASES = np.polynomial.legendre.leggauss(32)
_FEW = 8000  # points for which plain Python takes less than compiling
_NEGLIGIBLE = 40.0  # exponent beyond which the load of elements is negligible


def mindlin_memory_length(contact: RoughContact, *, friction_coefficient: ArrayLike, normal_load: ArrayLike) -> Floats:
    r"""Memory length of an asperity by Mindlin's tangential stiffness. [m]

    Parameters
    ----------
    contact : RoughContact
    friction_coefficient : array_like
        Coefficient of friction of steady sliding. []
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
    .. math:: D_c = \mu\, \frac{k_n}{k_t}\, l

    with the decay length l of the contact force; for bodies of one material k_n/k_t is (2 - nu)/(2 (1 - nu)). The
    sliding distance in which the tangential force of an asperity pressed by one decay length reaches its friction
    limit, without a fitted parameter.

    See Also
    --------
    EMPIRICAL_MEMORY_LENGTH : The fitted default.

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
    r"""Friction ratio under a load-balanced sine by asperity stick-slip. []

    Parameters
    ----------
    decay_length : array_like
        Length over which the normal force falls by a factor of e. [m]
    vibration_amplitude : array_like, broadcast against `decay_length`
        Amplitude of the vibration along the surface normal. [m]
    frequency : array_like, broadcast against them
        Frequency of the vibration. [Hz]
    sliding_speed : array_like, broadcast against them
        Mean sliding speed. [m/s]
    memory_length : array_like, broadcast against them
        Sliding distance D_c in which an asperity pressed by one decay length reaches its friction limit. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        From exp(-beta)/I0(beta), beta = a/l, for slow sliding to exactly 1 from v_r = omega a D_c/l on.

    Raises
    ------
    InvalidInput
        If a length, frequency or speed is not positive, an amplitude negative, or a value not finite.

    Notes
    -----
    The model of `AsperityStickSlip` with the mean gap at which the mean normal force equals the load.

    An element slips until the gap closes faster than its spring deforms, and sticks from its contact, or from that
    phase, until its limit has fallen to its force. With half the phase of sticking h and the middle m of that phase

    .. math:: \sin m = \frac{v h}{\sin h}, \qquad v = \frac{v_r l}{\omega a D_c}

    and the friction deficit of the element is 2 abs(cos m) (sin h - h cos h) in a period. The sum over all elements is
    one integral over h, computed to 1e-12.

    See Also
    --------
    AsperityStickSlip : The same for any motion of the gap.
    batched_stick_slip_ratio : Tabulated, for very many points.

    Examples
    --------
    >>> from sonolube.models.friction import sine_stick_slip_ratio
    >>> vibrated = {"vibration_amplitude": 2.5e-6, "frequency": 22e3, "decay_length": 2e-6, "memory_length": 1.5e-6}
    >>> ratio = sine_stick_slip_ratio(sliding_speed=[1e-6, 0.02, 0.26], **vibrated)
    >>> ratio.round(2).tolist()  # from exp(-1.25)/I0(1.25) to 1 at 0.26 m/s
    [0.2, 0.35, 1.0]
    """
    length, a, f, v_r, D_c = np.broadcast_arrays(
        require_positive(decay_length=decay_length),
        require_non_negative(vibration_amplitude=vibration_amplitude),
        require_positive(frequency=frequency),
        require_positive(sliding_speed=sliding_speed),
        require_positive(memory_length=memory_length),
    )
    beta = a / length
    scaled_speed = v_r * length / D_c  # v times omega a, which may be 0
    v = np.minimum(scaled_speed / np.maximum(2 * pi * f * a, scaled_speed), 1.0)
    harmonic_ratio = _harmonic_ratio.for_points(beta.size, at_first=_FEW)
    return harmonic_ratio(beta.ravel(), v.ravel(), scaled_bessel_i0(beta).ravel(), *_PHASES).reshape(beta.shape)


@kernel(cache=True, no_cfunc_wrapper=True)
def _harmonic_ratio(beta: Floats, v: Floats, i0e_beta: Floats, nodes: Floats, weights: Floats) -> Floats:
    """Friction ratio for each amplitude over decay length and each reduced speed."""
    ratio = np.ones(beta.size)
    for i in range(beta.size):
        b, speed = beta[i], v[i]
        if speed >= 1.0 - 1e-12 or b == 0.0:  # the deficit there is below 1e-23
            continue
        # elements in contact from theta_0 = m - h on: from pi - arcsin v, where none sticks, to arcsin v, where all do
        last = sqrt(1 - speed * speed)
        longest = half_stick_phase(speed, max(asin(speed), acos(min(1.0, _NEGLIGIBLE / b - last))))
        deficit = 0.0
        for j in range(nodes.size):
            distance = (1 - nodes[j]) / 2
            h = longest * (1 - distance * distance)  # graded to where slow sliding makes the integrand steep
            s = sin(h)
            rise, c = s - h * cos(h), sqrt(1 - (speed * h / s) ** 2)
            density = exp(-b * (1 - c * cos(h) + speed * h)) * h * (c * s - (speed * rise) ** 2 / (c * s**3))
            deficit += weights[j] * distance * longest * density
        ratio[i] = 1 - b * deficit / (pi * i0e_beta[i])
    return ratio
