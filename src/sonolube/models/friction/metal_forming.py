"""Metal forming under vibration: estimates of the reduction of flow stress by superposition and acoustic softening."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive

ZINC_STRESS_RATIO = 0.6
"""Flow stress of a zinc single crystal under ultrasound over that without. []

The force reduction of 40 % of F. Blaha, B. Langenecker, Naturwissenschaften 42, 556 (1955). doi:10.1007/BF00623773,
cited in D 2.4.1. It holds for the single crystal, not for metals in general, and without the intensity in the crystal
no constant of `acoustic_softening_ratio` follows from it."""


def acoustic_intensity(
    *, density: ArrayLike, wave_speed: ArrayLike, frequency: ArrayLike, vibration_amplitude: ArrayLike
) -> Floats:
    r"""Acoustic intensity of a travelling wave. [W/m2]

    Parameters
    ----------
    density : array_like
        Mass density of the metal. [kg/m3]
    wave_speed : array_like, broadcast against `density`
        Speed of axial waves in the metal. [m/s]
    frequency : array_like, broadcast against them
        Frequency of the vibration. [Hz]
    vibration_amplitude : array_like, broadcast against them
        Amplitude of the displacement. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an amplitude is negative, another value not positive, or a value not finite.

    Notes
    -----
    .. math:: I = \tfrac12\, \rho c\, (2 \pi f a)^2

    Examples
    --------
    >>> from sonolube.models.friction import acoustic_intensity
    >>> wave = {"frequency": 20e3, "vibration_amplitude": 1e-6}
    >>> round(1e-4 * float(acoustic_intensity(density=2700.0, wave_speed=5100.0, **wave)), 1)  # W/cm2
    10.9
    """
    impedance = require_positive(density=density) * require_positive(wave_speed=wave_speed)
    velocity = 2 * np.pi * require_positive(frequency=frequency)
    return impedance * (velocity * require_non_negative(vibration_amplitude=vibration_amplitude)) ** 2 / 2


def superposed_mean_stress(
    *, yield_strength: ArrayLike, youngs_modulus: ArrayLike, strain_amplitude: ArrayLike
) -> Floats:
    r"""Estimate of the mean flow stress of a metal under an oscillating strain, by stress superposition. [Pa]

    Parameters
    ----------
    yield_strength : array_like
        Flow stress without vibration. [Pa]
    youngs_modulus : array_like, broadcast against `yield_strength`
        Young's modulus. [Pa]
    strain_amplitude : array_like, broadcast against them
        Amplitude of the strain by the vibration, over the deformed length. []

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an amplitude is negative, another value not positive, or a value not finite.

    Notes
    -----
    .. math:: \bar\sigma = \sigma_y - E \varepsilon_a \quad (2 E \varepsilon_a \le \sigma_y)

    Superposition alone, without softening or hardening: the metal flows once a period and unloads elastically by up to
    2 E eps_a in between. Beyond that the tool loses contact for part of the period, and the mean is that of the
    remaining compression. The deformation within one period is assumed small.

    See Also
    --------
    acoustic_softening_ratio : The other effect.

    References
    ----------
    .. [1] H. O. K. Kirchner et al., Mater. Sci. Eng. 68, 197 (1985).
    .. [2] D 2.4.1.
    """
    strength = require_positive(yield_strength=yield_strength)
    E = require_positive(youngs_modulus=youngs_modulus)
    stress_amplitude = E * require_non_negative(strain_amplitude=strain_amplitude)
    depth = strength / np.maximum(stress_amplitude, np.finfo(np.float64).tiny * strength)
    contact_phase = np.arccos(1 - np.minimum(depth, 2.0))
    partial = stress_amplitude * ((depth - 1) * contact_phase + np.sin(contact_phase)) / np.pi
    return np.where(depth >= 2, strength - stress_amplitude, partial)


def acoustic_softening_ratio(*, acoustic_intensity: ArrayLike, reference_intensity: ArrayLike) -> Floats:
    r"""Estimate of the flow stress under ultrasound over that without, by acoustic softening. []

    Parameters
    ----------
    acoustic_intensity : array_like
        Acoustic intensity in the metal. [W/m2]
    reference_intensity : array_like, broadcast against `acoustic_intensity`
        Intensity at which the metal flows without load, from a test on that metal. [W/m2]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an intensity is negative, the reference not positive, or a value not finite.

    Notes
    -----
    .. math:: \frac{\bar\sigma}{\sigma} = \max\left( 1 - \sqrt{I/I_1},\, 0 \right)

    A reduction in proportion to the amplitude, as in compression tests, independent of the frequency (D 2.4.1: 15 kHz
    to 1.5 MHz). The mechanism is disputed, and tests that excluded superposition found a smaller effect.

    See Also
    --------
    reference_intensity_from_test : The intensity I_1.

    References
    ----------
    .. [1] O. Izumi, K. Oyama, Y. Suzuki, Trans. Jpn. Inst. Met. 7, 162 (1966). doi:10.2320/matertrans1960.7.162
    .. [2] B. Langenecker, IEEE Trans. Sonics Ultrason. 13, 1 (1966). doi:10.1109/T-SU.1966.29367
    """
    intensity = require_non_negative(acoustic_intensity=acoustic_intensity)
    relative = intensity / require_positive(reference_intensity=reference_intensity)
    return np.asarray(np.maximum(1 - np.sqrt(relative), 0.0))


def reference_intensity_from_test(*, stress_ratio: ArrayLike, acoustic_intensity: ArrayLike) -> Floats:
    r"""Reference intensity of acoustic softening from one test on a metal. [W/m2]

    Parameters
    ----------
    stress_ratio : array_like
        Flow stress with vibration over that without, above zero and below one. []
    acoustic_intensity : array_like, broadcast against `stress_ratio`
        Intensity of the test. [W/m2]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a ratio does not lie below one, or a value is not positive and finite.

    Notes
    -----
    .. math:: I_1 = \frac{I}{(1 - \bar\sigma/\sigma)^2}
    """
    ratio = require_positive(stress_ratio=stress_ratio)
    reduction = require_positive(stress_ratio=1 - ratio)
    return require_positive(acoustic_intensity=acoustic_intensity) / reduction**2
