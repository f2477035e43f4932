"""Peak velocity of periodic motions given by their displacement harmonics."""

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.kernels.simd import INNER, KERNEL

_WEAK_HARMONICS = 0.5  # sum of k^3 |X_k|, k > 1, over |X_1| up to which the velocity has one maximum and one minimum
_SAMPLES_PER_HARMONIC = 32  # for every other motion


@kernel(**KERNEL)
def peak_velocities(omega: Floats, harmonics: Complexes, peak: Floats) -> None:
    r"""Write the largest magnitude of the velocity of each motion.

    `harmonics` has shape (p, H).

    The velocity is :math:`v = \omega\,\mathrm{Re}\sum_k i k X_k e^{ik\theta}`. Where
    :math:`\sum_{k>1} k^3 |X_k| \le |X_1|/2` it has a single maximum and a single minimum, which Newton's method finds
    from those of the first harmonic. Any other motion is sampled.
    """
    for point in range(omega.size):
        size, higher = harmonics.shape[1], 0.0
        while size > 1 and harmonics[point, size - 1] == 0:  # so that the samples do not depend on other points
            size -= 1
        own = harmonics[point, :size]
        for k in range(2, own.size + 1):
            higher += k**3 * abs(own[k - 1])
        fastest = 0.0
        if np.isnan(higher) or np.isnan(own[0].real):
            fastest = np.nan
        elif higher <= _WEAK_HARMONICS * abs(own[0]):
            start = 0.5 * np.pi - np.arctan2(own[0].imag, own[0].real)
            fastest = max(_extremum(own, start), _extremum(own, start + np.pi))
        else:
            count = _SAMPLES_PER_HARMONIC * own.size
            for j in range(count):
                fastest = max(fastest, abs(_phase_derivatives(own, 2 * np.pi * j / count)[0]))
        peak[point] = omega[point] * fastest


@kernel(**INNER)
def _extremum(own: Complexes, phase: float) -> float:
    """Magnitude of dx/dtheta at its extremum near a phase, by Newton's method on the second derivative."""
    first = 0.0
    for _ in range(8):
        first, second, third = _phase_derivatives(own, phase)
        if third == 0.0 or abs(second) < 1e-7 * abs(first):
            break
        phase -= second / third
    return abs(first)


@kernel(**INNER)
def _phase_derivatives(own: Complexes, phase: float) -> tuple[float, float, float]:
    """First three derivatives of the displacement with respect to the phase."""
    cosine, sine = np.cos(phase), np.sin(phase)
    c, s, first, second, third = 1.0, 0.0, 0.0, 0.0, 0.0
    for k in range(1, own.size + 1):
        c, s = c * cosine - s * sine, c * sine + s * cosine
        real, imaginary = own[k - 1].real * c - own[k - 1].imag * s, own[k - 1].real * s + own[k - 1].imag * c
        first -= k * imaginary
        second -= k * k * real
        third += k * k * k * imaginary
    return first, second, third
