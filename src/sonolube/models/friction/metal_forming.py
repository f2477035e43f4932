"""Metal forming under vibration: estimates of the mean flow stress and of a drawing stress.

Flow stress by superposition and by acoustic softening; drawing stress of a wire through a die that vibrates along it.
"""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive, require_within

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


def drawing_stress(
    *, yield_strength: ArrayLike, area_reduction: ArrayLike, friction_coefficient: ArrayLike, die_half_angle: ArrayLike
) -> Floats:
    r"""Stress that draws a wire through a conical die, by Sachs' slab method. [Pa]

    Parameters
    ----------
    yield_strength : array_like
        Mean flow stress of the metal in the die. [Pa]
    area_reduction : array_like, broadcast against `yield_strength`
        Reduction of the cross-section over the cross-section before the die, from 0 to below 1. []
    friction_coefficient : array_like, broadcast against them
        Coefficient of friction of wire and die. []
    die_half_angle : array_like, broadcast against them
        Angle between axis and wall of the die, up to 60 degrees. [rad]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a stress is not positive, a coefficient negative, a reduction or an angle outside its range, or a value not
        finite.

    Notes
    -----
    .. math:: \sigma_d = Y\, \frac{1 + B}{B} \left[ 1 - (1 - r)^B \right], \qquad B = \mu \cot\alpha

    and Y ln[1/(1 - r)] without friction: equilibrium of slabs between plane sections, with the die pressure Y minus the
    axial stress. Redundant shear, hardening within the die, its cylindrical land and back tension are left out. From
    Y on the wire would yield behind the die.

    See Also
    --------
    vibrated_drawing_stress : The mean where the die vibrates.

    References
    ----------
    .. [1] G. Sachs, Z. angew. Math. Mech. 7, 235 (1927).
    .. [2] G. E. Dieter, Mechanical Metallurgy, chapter 19, Drawing of Rods, Wires and Tubes.
    .. [3] FOSSEE textbook companion to [2]_, chapter 19, example 19.1.

    Examples
    --------
    Example 19.1 of [2]_, with K = 1300 MPa, n = 0.3 and so 638 MPa on average: 240.4 MPa by its worked solution [3]_.

    >>> from math import log, radians
    >>> from sonolube.models.friction import drawing_stress
    >>> mean = 1300e6 * log(1 / 0.8) ** 0.3 / 1.3
    >>> die = {"area_reduction": 0.2, "friction_coefficient": 0.09, "die_half_angle": radians(6)}
    >>> round(1e-6 * float(drawing_stress(yield_strength=mean, **die)), 1)
    240.4
    """
    strength, friction, strain = _drawing(yield_strength, area_reduction, friction_coefficient, die_half_angle)
    return strength * _slab_stress(friction, strain)


def vibrated_drawing_stress(
    *,
    yield_strength: ArrayLike,
    area_reduction: ArrayLike,
    friction_coefficient: ArrayLike,
    die_half_angle: ArrayLike,
    drawing_speed: ArrayLike,
    vibration_velocity: ArrayLike,
) -> Floats:
    r"""Mean stress that draws a wire through a die that vibrates along it, by the reversal of friction alone. [Pa]

    Parameters
    ----------
    yield_strength : array_like
        Mean flow stress of the metal in the die. [Pa]
    area_reduction : array_like, broadcast against `yield_strength`
        Reduction of the cross-section over the cross-section before the die, from 0 to below 1. []
    friction_coefficient : array_like, broadcast against them
        Coefficient of friction of wire and die. []
    die_half_angle : array_like, broadcast against them
        Angle between axis and wall of the die, up to 60 degrees. [rad]
    drawing_speed : array_like, broadcast against them
        Speed of the wire behind the die. [m/s]
    vibration_velocity : array_like, broadcast against them
        Peak velocity of the die along the wire, zero for none. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is outside its range or not finite.

    Notes
    -----
    Coulomb friction has the direction of the relative velocity, so that B of `drawing_stress` changes its sign while
    the die is faster than the wire:

    .. math:: \bar\sigma_d = s\,\sigma_d(B) + (1 - s)\,\sigma_d(-B), \qquad
              s = \frac12 + \frac1\pi \arcsin\frac{v}{v_1} \quad (v < v_1)

    The mean friction is (2/pi) arcsin(v/v_1) of that without vibration, and from the critical speed v = v_1 on nothing
    changes. The speed behind the die is taken for the whole cone. The wire is slower before it: with its own speed at
    each section the stress lies between this one and that for (1 - r) v. Quasi-static and rigid: no waves in the
    wire, no elastic deformation between reversals.

    See Also
    --------
    superposed_mean_stress : The other effect, by which alone some tests are explained.

    References
    ----------
    .. [1] K. Siegert, J. Ulmer, J. Eng. Mater. Technol. 123, 517 (2001), by its abstract: reversal of the friction.
    .. [2] C. E. Winsper, D. H. Sansome, A study of the mechanics of wire drawing with a superimposed ultrasonic stress,
       by its abstract: superposition explains all of the reduction at 18.7 kHz.
    """
    strength, friction, strain = _drawing(yield_strength, area_reduction, friction_coefficient, die_half_angle)
    speed = require_positive(drawing_speed=drawing_speed)
    peak = require_non_negative(vibration_velocity=vibration_velocity)
    forward = 0.5 + np.arcsin(speed / np.maximum(peak, speed)) / np.pi
    return strength * (forward * _slab_stress(friction, strain) + (1 - forward) * _slab_stress(-friction, strain))


def _drawing(
    yield_strength: ArrayLike, area_reduction: ArrayLike, friction_coefficient: ArrayLike, die_half_angle: ArrayLike
) -> tuple[Floats, Floats, Floats]:
    """Checked flow stress, B = mu cot(alpha), and strain ln 1/(1 - r)."""
    strength = require_positive(yield_strength=yield_strength)
    reduction = require_within(0, 1 - 1e-9, area_reduction=area_reduction)
    angle = require_within(1e-3, np.pi / 3, die_half_angle=die_half_angle)
    friction = require_non_negative(friction_coefficient=friction_coefficient) / np.tan(angle)
    return strength, friction, -np.log1p(-reduction)


def _slab_stress(friction: Floats, strain: Floats) -> Floats:
    """Drawing stress over flow stress at B of either sign: (1 + B) (1 - exp(-B strain))/B."""
    exponent = friction * strain
    is_small = np.abs(exponent) < 1e-12
    safe = np.where(is_small, 1.0, exponent)
    return (1 + friction) * strain * np.where(is_small, 1.0, -np.expm1(-safe) / safe)
