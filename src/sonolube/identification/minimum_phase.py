"""Phase of an admittance of which only the magnitude was measured, for initial values of a fit."""

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum

_MAX_POINTS = 5000  # of which the phase is computed; between them it is interpolated


def admittance_with_phase(spectrum: ImpedanceSpectrum) -> Complexes:
    """Measured admittance, its phase that of minimum phase where only the magnitude was measured."""
    if spectrum.has_phase:
        return spectrum.admittance
    return minimum_phase_admittance(np.abs(spectrum.admittance), frequency=spectrum.frequency)


def minimum_phase_admittance(magnitude: Floats, *, frequency: Floats) -> Complexes:
    r"""Admittance of a capacitive one-port from its magnitude, by the relation of gain and phase.

    Complex, of the given magnitude.

    An admittance of passive parts has neither poles nor zeros in the right half-plane, so that its phase follows from
    its magnitude With :math:`g = \ln(|Y|/f)`, which is constant far from resonances,

    .. math:: \varphi(f) = \frac{\pi}{2} + \frac{2f}{\pi} \int_0^\infty \frac{g(\nu) - g(f)}{\nu^2 - f^2}\,d\nu .

    Beyond the sweep g is continued as constant, so the phase is approximate near the ends of a sweep that begins or
    ends close to a resonance.

    Source: H. W. Bode, Network Analysis and Feedback Amplifier Design, Van Nostrand (1945), chapter 14.
    """
    step = -(-frequency.size // _MAX_POINTS)
    f = frequency[::step]
    phase = np.interp(frequency, f, _phase(np.log(magnitude[::step] / f), f))
    return np.asarray(magnitude * np.exp(1j * np.clip(phase, -np.pi / 2, np.pi / 2)))


def _phase(gain: Floats, frequency: Floats) -> Floats:
    """Phase in rad, by the trapezoidal rule within the sweep and in closed form beyond."""
    phase = np.empty_like(gain)
    width = np.gradient(frequency)
    lowest, highest = frequency[0], frequency[-1]
    slope = np.gradient(gain, frequency)
    for at, f in enumerate(frequency):
        with np.errstate(divide="ignore", invalid="ignore"):
            kernel = (gain - gain[at]) / (frequency**2 - f**2)
            below = np.log((f + lowest) / (f - lowest)) / (2 * f)
            above = np.log((highest + f) / (highest - f)) / (2 * f)
        kernel[at] = slope[at] / (2 * f)
        inside = float(np.sum(kernel * width)) - 0.5 * float(kernel[0] * width[0] + kernel[-1] * width[-1])
        beyond = (gain[-1] - gain[at]) * above if at < gain.size - 1 else 0.0
        before = (gain[0] - gain[at]) * below if at else 0.0
        phase[at] = np.pi / 2 + 2 * f / np.pi * (inside + beyond - before)
    return phase
