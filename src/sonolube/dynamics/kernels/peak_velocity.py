"""The highest velocity of each of many periodic motions."""

import numba
import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.kernels.simd import INSIDE, KERNEL

_PLAIN = 0.5  # share of k^3 X_k in the first harmonic up to which a velocity has one peak each way
_SCAN = 32  # samples per harmonic otherwise


@numba.njit(**KERNEL)
def highest_velocities(omega: Floats, harmonics: Complexes, highest: Floats) -> None:
    """Write the highest magnitude of each velocity.

    Parameters
    ----------
    omega : ndarray, shape (p,)
        Angular frequency, in rad/s.
    harmonics : ndarray of complex, shape (p, room)
        Of the displacement, in m; NaN for motions that are not known.
    highest : ndarray, shape (p,)
        Written, in m/s.
    """
    for point in range(omega.size):
        own, higher = harmonics[point], 0.0
        for k in range(2, own.size + 1):
            higher += k**3 * abs(own[k - 1])
        fastest = 0.0
        if np.isnan(higher) or np.isnan(own[0].real):
            fastest = np.nan
        elif higher <= _PLAIN * abs(own[0]):
            start = 0.5 * np.pi - np.arctan2(own[0].imag, own[0].real)
            fastest = max(_peak(own, start), _peak(own, start + np.pi))
        else:
            count = _SCAN * own.size
            for j in range(count):
                fastest = max(fastest, abs(_turning(own, 2 * np.pi * j / count)[0]))
        highest[point] = omega[point] * fastest


@numba.njit(**INSIDE)
def _peak(own: Complexes, phase: float) -> float:
    """Return the velocity per phase where its slope vanishes nearby."""
    rate = 0.0
    for _ in range(8):
        rate, bend, third = _turning(own, phase)
        if third == 0.0 or abs(bend) < 1e-7 * abs(rate):
            break
        phase -= bend / third
    return abs(rate)


@numba.njit(**INSIDE)
def _turning(own: Complexes, phase: float) -> tuple[float, float, float]:
    """Return the first three derivatives of the displacement by phase."""
    cosine, sine = np.cos(phase), np.sin(phase)
    c, s, rate, bend, third = 1.0, 0.0, 0.0, 0.0, 0.0
    for k in range(1, own.size + 1):
        c, s = c * cosine - s * sine, c * sine + s * cosine
        real, imaginary = own[k - 1].real * c - own[k - 1].imag * s, own[k - 1].real * s + own[k - 1].imag * c
        rate -= k * imaginary
        bend -= k * k * real
        third += k * k * k * imaginary
    return rate, bend, third
