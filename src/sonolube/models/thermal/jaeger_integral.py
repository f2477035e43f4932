r"""Compiled evaluation of Jaeger's integral of exp(-t) K0(abs t) for a uniform moving band source.

With :math:`s = |u|` the integral has the closed form (DLMF 10.43.9)

.. math:: \int_0^u e^{-t} K_0(|t|)\,dt = 1 + e^{-u} \left[ u K_0(s) - s K_1(s) \right] .

Up to s = 2 the ascending series of both Bessel functions are summed (DLMF 10.31.1, 10.31.2). Beyond, the bracket times
:math:`e^{s}` over a power of s is smooth in 2/s (DLMF 10.40.2) and is a polynomial interpolated at Chebyshev points.
"""

from collections.abc import Callable
from math import exp, log, sqrt

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from scipy.special import digamma, factorial, k0e, k1e

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel

__all__: list[str] = []  # used within this package only

_ORDERS = np.arange(11)
_I0 = 1 / factorial(_ORDERS) ** 2  # coefficients of I0 in (s/2)^2
_K0_SERIES = digamma(_ORDERS + 1) * _I0  # of K0 + ln(s/2) I0
_I1 = 2 / (factorial(_ORDERS) * factorial(_ORDERS + 1))  # of s I1 over (s/2)^2
_K1_SERIES = _I1 / 2 * (digamma(_ORDERS + 1) + digamma(_ORDERS + 2))  # of 1 + ln(s/2) s I1 - s K1 over (s/2)^2


def _polynomial_in_inverse(function: Callable[[Floats], Floats]) -> Floats:
    """Coefficients of a Chebyshev interpolant in powers of w = 2/s on 0 < w <= 1."""
    near_zero = np.finfo(np.float64).tiny
    smooth = Chebyshev.interpolate(lambda w: function(2 / np.maximum(w, near_zero)), 17, domain=[0, 1])
    return np.asarray(smooth.convert(kind=Polynomial, domain=[-1, 1]).coef, dtype=np.float64)


_NEGATIVE_U = _polynomial_in_inverse(lambda s: np.sqrt(s) * (k0e(s) + k1e(s)))
_POSITIVE_U = _polynomial_in_inverse(lambda s: s * np.sqrt(s) * (k1e(s) - k0e(s)))


@kernel(cache=True)
def moving_band_integrals(first: Floats, last: Floats) -> Floats:
    """Integrals of exp(-t) K0(abs t) from each `first` to its `last`."""
    integrals = np.empty(first.size)
    for i in range(first.size):
        integrals[i] = _integral_from_zero(last[i]) - _integral_from_zero(first[i])
    return integrals


@kernel(cache=True)
def _integral_from_zero(u: float) -> float:
    """Integral of exp(-t) K0(abs t) from 0 to u."""
    s = abs(u)
    if s == 0.0:
        return 0.0
    if s > 2.0:
        if u < 0:
            return 1 - sqrt(s) * _polynomial(_NEGATIVE_U, 2 / s)
        return 1 - exp(-2 * s) / sqrt(s) * _polynomial(_POSITIVE_U, 2 / s)
    t, ln = s * s / 4, log(s / 2)
    k0 = _polynomial(_K0_SERIES, t) - ln * _polynomial(_I0, t)
    k1 = 1 + t * (ln * _polynomial(_I1, t) - _polynomial(_K1_SERIES, t))  # times s
    return 1 + exp(-u) * (u * k0 - k1)


@kernel(cache=True)
def _polynomial(coefficients: Floats, x: float) -> float:
    """Polynomial's value by Horner's scheme, lowest coefficient first."""
    total = coefficients[-1]
    for k in range(coefficients.size - 2, -1, -1):
        total = total * x + coefficients[k]
    return float(total)
