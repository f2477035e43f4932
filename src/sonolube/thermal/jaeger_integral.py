"""Jaeger's integral of exp(-t) K0(abs t), which a moving band of heat needs twice a point, compiled for its sake.

With s = abs u, the integral from 0 to u is 1 + exp(-u) [u K0(s) - s K1(s)] (DLMF 10.43.9). Up to s = 2 the ascending
series of both functions give it (DLMF 10.31.1, 10.31.2); beyond, the bracket times exp(s) over a power of s is smooth
in 2/s (DLMF 10.40.2) and interpolated at Chebyshev's points.
"""

from collections.abc import Callable
from math import exp, log, sqrt

import numba
import numpy as np
from numpy.polynomial import Chebyshev, Polynomial
from scipy.special import digamma, factorial, k0e, k1e

from sonolube.checks import Floats

__all__: list[str] = []  # of use in this room only

_ORDERS = np.arange(11)
_I0 = 1 / factorial(_ORDERS) ** 2  # of I0 in (s/2)^2
_SUM_0 = digamma(_ORDERS + 1) * _I0  # of K0 + ln(s/2) I0
_I1 = 2 / (factorial(_ORDERS) * factorial(_ORDERS + 1))  # of s I1 over (s/2)^2
_SUM_1 = _I1 / 2 * (digamma(_ORDERS + 1) + digamma(_ORDERS + 2))  # of 1 + ln(s/2) s I1 - s K1 over (s/2)^2


def _in_powers(function: Callable[[Floats], Floats]) -> Floats:
    """Return the coefficients in powers of w = 2/s, up to 1, of what is smooth in it."""
    near_zero = np.finfo(np.float64).tiny
    smooth = Chebyshev.interpolate(lambda w: function(2 / np.maximum(w, near_zero)), 17, domain=[0, 1])
    return np.asarray(smooth.convert(kind=Polynomial, domain=[-1, 1]).coef, dtype=np.float64)


_BEHIND = _in_powers(lambda s: np.sqrt(s) * (k0e(s) + k1e(s)))
_AHEAD = _in_powers(lambda s: s * np.sqrt(s) * (k1e(s) - k0e(s)))


@numba.njit(cache=True)
def moving_band_integrals(first: Floats, last: Floats) -> Floats:
    """Return the integrals of exp(-t) K0(abs t) from each `first` to its `last`."""
    between = np.empty(first.size)
    for i in range(first.size):
        between[i] = _from_zero(last[i]) - _from_zero(first[i])
    return between


@numba.njit(cache=True)
def _from_zero(u: float) -> float:
    s = abs(u)
    if s == 0.0:
        return 0.0
    if s > 2.0:
        if u < 0:
            return 1 - sqrt(s) * _sum(_BEHIND, 2 / s)
        return 1 - exp(-2 * s) / sqrt(s) * _sum(_AHEAD, 2 / s)
    t, ln = s * s / 4, log(s / 2)
    k0 = _sum(_SUM_0, t) - ln * _sum(_I0, t)
    k1 = 1 + t * (ln * _sum(_I1, t) - _sum(_SUM_1, t))  # times s
    return 1 + exp(-u) * (u * k0 - k1)


@numba.njit(cache=True)
def _sum(coefficients: Floats, x: float) -> float:
    total = coefficients[-1]
    for k in range(coefficients.size - 2, -1, -1):
        total = total * x + coefficients[k]
    return float(total)
