"""Friction ratio of asperity stick-slip under a load-balanced sine: in closed form, and tabulated for very many points.

The ratio R depends on the amplitude in decay lengths, beta, and on the reduced speed v alone. The table holds

    (1 + beta)/beta (1 - R)/(1 - v)^2

over ln beta and the fourth root of v, in which it is smooth from v = 0 to 1, both included. The factor before it keeps
the ratio exact without vibration and from v = 1 on.
"""

from collections.abc import Callable
from functools import cache
from math import acos, asin, cos, exp, pi, sin, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.execution.compilation import kernel
from sonolube.models.contact.rough import RoughContact, decay_length, separation
from sonolube.models.friction.oscillating_contact.stick_slip_phases import half_stick_phase
from sonolube.models.friction.scaled_bessel import scaled_bessel_i0
from sonolube.models.friction.uniform_spline import in_chunks, spline_coefficients, spline_values

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


__all__ = [  # the rest serves this package only
    "EMPIRICAL_MEMORY_LENGTH",
    "mindlin_memory_length",
    "sine_stick_slip_ratio",
    "tabulated_stick_slip_ratio",
]

LOG_BETA = (float(np.log(1e-4)), float(np.log(1e6)))
"""Range of the table. Below it the reduction is proportional to beta, to 1e-8."""

ROWS, COLUMNS = 225, 177
_NODES = np.polynomial.legendre.leggauss(40)
_BAND = 12  # rows that share the nodes of the quadrature
_NEGLIGIBLE_IN_TABLE = 45.0  # exponent beyond which the load of elements is negligible
_LAST_SPEED = 1 - 1e-6  # in place of 1, where the tabulated function is a limit


def tabulated_stick_slip_ratio(
    *,
    decay_length: ArrayLike,
    vibration_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
    memory_length: ArrayLike = EMPIRICAL_MEMORY_LENGTH,
) -> Floats:
    """Friction ratio by asperity stick-slip under a load-balanced sine, interpolated to 2e-6. []

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
        Of `sine_stick_slip_ratio`, which is called for amplitudes above 1e6 decay lengths.

    Raises
    ------
    InvalidInput
        If a length, frequency or speed is not positive, an amplitude negative, or a value not finite.

    Notes
    -----
    A cubic spline over the logarithm of amplitude over decay length and the fourth root of the reduced speed, computed
    on the first call in some hundredths of a second. A hundred thousand points then take some milliseconds.

    See Also
    --------
    sine_stick_slip_ratio : Computed anew for each point, to 1e-12.
    tabulated_spring_ratio : The same for a flat spring contact.
    """
    length, a = (
        require_positive(decay_length=decay_length),
        require_non_negative(vibration_amplitude=vibration_amplitude),
    )
    f, v_r = require_positive(frequency=frequency), require_positive(sliding_speed=sliding_speed)
    beta = a / length
    scaled_speed = v_r * (length / require_positive(memory_length=memory_length))  # v times omega a, which may be 0
    v = scaled_speed / np.maximum(2 * np.pi * f * a, scaled_speed)
    ratio = in_chunks(_interpolated, beta, v)
    beyond = np.broadcast_to(beta > np.exp(LOG_BETA[1]), ratio.shape) & (v < 1)
    if np.any(beyond):
        many, fast = (np.broadcast_to(each, ratio.shape)[beyond] for each in (beta, v))
        ratio[beyond] = sine_stick_slip_ratio(
            decay_length=1.0,
            vibration_amplitude=many,
            frequency=1 / (2 * np.pi),
            sliding_speed=np.maximum(fast * many, np.finfo(float).tiny),
            memory_length=1.0,
        )
    return ratio


def _interpolated(beta: Floats, v: Floats) -> Floats:
    """Ratios for each amplitude over decay length, up to that of the last row, and each reduced speed up to 1."""
    (low, high), slower = LOG_BETA, 1 - v
    row = (np.log(np.clip(beta, np.exp(low), np.exp(high))) - low) * ((ROWS - 1) / (high - low))
    table = spline_values(sine_table(), row, np.sqrt(np.sqrt(v)) * (COLUMNS - 1))
    table *= beta / (1 + beta) * (slower * slower)
    return np.asarray(np.clip(1 - table, 0.0, 1.0))


@cache
def sine_table() -> Floats:
    """Coefficients of the spline, shape (ROWS + 2, COLUMNS + 2), computed once."""
    beta = np.exp(np.linspace(*LOG_BETA, ROWS))[:, None]
    v = np.minimum(np.linspace(0, 1, COLUMNS) ** 4, _LAST_SPEED)
    return spline_coefficients(_deficits(beta, v) * (1 + beta) / (beta * (1 - v) ** 2))


def _deficits(beta: Floats, v: Floats) -> Floats:
    """Reductions of friction on a grid, shape (n, m), by the integral over h of `sine_stick_slip_ratio`.

    Neighbouring rows share the phases h at which the integrand is evaluated, so that one exponential a node is left.
    """
    distance, last, speed = (1 - _NODES[0]) / 2, np.sqrt(1 - v * v), v[:, None]
    longest = _bisected(lambda h: np.sin(h) * (v * np.cos(h) + last * np.sin(h)) < v * h, np.full(v.size, np.pi))
    deficits = np.empty((beta.size, v.size))
    for start in range(0, beta.size, _BAND):
        b = beta[start : start + _BAND]
        cut = 1 - last + _NEGLIGIBLE_IN_TABLE / b[0]
        end = _bisected(lambda h, cut=cut: _motion(h, v)[2] > cut, longest)  # type: ignore[misc]
        h = end[:, None] * (1 - distance**2)  # graded to where slow sliding makes the integrand steep
        s, c, exponent = _motion(h, speed)
        density = h * (c * s - (speed * (s - h * np.cos(h))) ** 2 / (c * s**3)) * distance * end[:, None]
        load = np.exp(-b[:, :, None] * exponent)
        deficits[start : start + _BAND] = b * np.einsum("bvn,vn,n->bv", load, density, _NODES[1])
    return deficits / (np.pi * scaled_bessel_i0(beta))


def _motion(h: Floats, v: Floats) -> tuple[Floats, Floats, Floats]:
    """Sine of half the phase of sticking h, cosine of its middle, and exponent of the load of these elements."""
    s = np.sin(h)
    c = np.sqrt(np.maximum(1 - (v * h / s) ** 2, 0.0))
    return s, c, 1 - c * np.cos(h) + v * h


def _bisected(beyond: Callable[[Floats], Any], end: Floats) -> Floats:
    """Phases between 0 and `end` from which on a condition holds, or `end`."""
    low, high = np.zeros_like(end), end
    for _ in range(32):
        middle = (low + high) / 2
        found = beyond(middle)
        low, high = np.where(found, low, middle), np.where(found, middle, high)
    return high
