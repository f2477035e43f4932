"""Metal forming under vibration: estimates of how much less stress a metal flows at."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive

ZINC_STRESS_RATIO = 0.6
"""Flow stress of a zinc single crystal under ultrasound over that without. []

The 40 % less force of F. Blaha, B. Langenecker, Naturwissenschaften 42, 556 (1955). doi:10.1007/BF00623773; in D 2.4.1.
The crystal, not metals at large: no constant of `softened_stress_ratio` follows without the intensity in it."""


def acoustic_intensity(
    *, density: ArrayLike, wave_speed: ArrayLike, frequency: ArrayLike, vibration_amplitude: ArrayLike
) -> Floats:
    """Return the power per area of a travelling wave, rho c (2 pi f a)^2/2. [W/m2]

    Parameters
    ----------
    density : array_like
        Mass density of the metal. [kg/m3]
    wave_speed : array_like, broadcast against `density`
        Speed of axial waves in it. [m/s]
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
    """
    impedance = require_positive(density=density) * require_positive(wave_speed=wave_speed)
    velocity = 2 * np.pi * require_positive(frequency=frequency)
    return impedance * (velocity * require_non_negative(vibration_amplitude=vibration_amplitude)) ** 2 / 2


def superposed_mean_stress(
    *, yield_strength: ArrayLike, youngs_modulus: ArrayLike, strain_amplitude: ArrayLike
) -> Floats:
    """Return the mean stress of a metal that flows under an oscillating strain: an estimate. [Pa]

    Parameters
    ----------
    yield_strength : array_like
        Stress at which it flows without vibration. [Pa]
    youngs_modulus : array_like, broadcast against `yield_strength`
        Young's modulus. [Pa]
    strain_amplitude : array_like, broadcast against them
        Amplitude of the strain that the vibration imposes, over the length deformed. []

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an amplitude is negative, another value not positive, or a value not finite.

    Notes
    -----
    Estimate of the superposition effect alone: the metal neither softens nor hardens. Once a period it flows, otherwise
    it unloads elastically by up to 2 E eps; the tool leaves it rather than pull. While it stays in touch the mean lies
    E eps below yield. Forming between two periods is taken for slow.

    References
    ----------
    .. [1] H. O. K. Kirchner et al., Mater. Sci. Eng. 68, 197 (1985).
    .. [2] D 2.4.1.
    """
    strength = require_positive(yield_strength=yield_strength)
    swing = require_positive(youngs_modulus=youngs_modulus) * require_non_negative(strain_amplitude=strain_amplitude)
    depth = strength / np.maximum(swing, np.finfo(np.float64).tiny * strength)
    touching_until = np.arccos(1 - np.minimum(depth, 2.0))
    partly = swing * ((depth - 1) * touching_until + np.sin(touching_until)) / np.pi
    return np.where(depth >= 2, strength - swing, partly)


def softened_stress_ratio(*, acoustic_intensity: ArrayLike, reference_intensity: ArrayLike) -> Floats:
    """Return flow stress under ultrasound over that without, by acoustic softening: an estimate. []

    Parameters
    ----------
    acoustic_intensity : array_like
        Power of the wave per area. [W/m2]
    reference_intensity : array_like, broadcast against `acoustic_intensity`
        Intensity at which the metal would flow without load; from a test on that metal. [W/m2]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an intensity is negative, the reference not positive, or a value not finite.

    Notes
    -----
    Estimate: the fall is taken in proportion to the amplitude, the square root of the intensity, as compression tests
    found it, at any frequency (D 2.4.1: 15 kHz to 1.5 MHz). No mechanism is agreed upon, and tests that took the
    superposition out found less.

    References
    ----------
    .. [1] O. Izumi, K. Oyama, Y. Suzuki, Trans. Jpn. Inst. Met. 7, 162 (1966). doi:10.2320/matertrans1960.7.162
    .. [2] B. Langenecker, IEEE Trans. Sonics Ultrason. 13, 1 (1966). doi:10.1109/T-SU.1966.29367
    """
    intensity = require_non_negative(acoustic_intensity=acoustic_intensity)
    relative = intensity / require_positive(reference_intensity=reference_intensity)
    return np.asarray(np.maximum(1 - np.sqrt(relative), 0.0))


def intensity_for_stress_ratio(*, stress_ratio: ArrayLike, acoustic_intensity: ArrayLike) -> Floats:
    """Return the reference intensity that one test on a metal gives. [W/m2]

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
    """
    ratio = require_positive(stress_ratio=stress_ratio)
    fallen = require_positive(stress_ratio=1 - ratio)
    return require_positive(acoustic_intensity=acoustic_intensity) / fallen**2
