"""Vibrometer measurements: amplitude per volt, complex amplitudes, operating deflection shapes and modal assurance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from sonolube.checks import Complexes, Floats, require_finite, require_finite_complex, require_positive, require_within
from sonolube.errors import InvalidInput

_MIN_PERIODS = 1.0
_LARGEST_CONDITION = 1e6  # of the least-squares columns, beyond which the frequency aliases


@dataclass(frozen=True, kw_only=True, slots=True)
class AmplitudePerVolt:
    """Vibration amplitude per drive voltage, with a test of proportionality.

    Parameters
    ----------
    amplitude_per_volt : float
        Slope of the regression line through the origin. [m/V]
    lower, upper : float
        Limits of its confidence interval, in m/V.
    amplitude_deviation : float
        Standard deviation of the amplitudes about the line. [m]
    curvature : float
        Slope at the highest voltage less that at zero, relative to the mean slope, of a parabola through the origin.
    curvature_p_value : float
        p-value of the curvature in the F test; a small one contradicts proportionality.
    proportional : bool
        Whether the p-value exceeds one less the confidence level.
    confidence_level : float
        Of the interval and of the test. []
    """

    amplitude_per_volt: float
    lower: float
    upper: float
    amplitude_deviation: float
    curvature: float
    curvature_p_value: float
    proportional: bool
    confidence_level: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class OperatingDeflectionShape:
    """Operating deflection shape (ODS): relative motion of the points of a surface at one frequency.

    Parameters
    ----------
    shape : ndarray, shape (points,)
        Real part at the common phase, scaled to a largest magnitude of 1.
    greatest_amplitude : float
        Amplitude of the point that moves most, in the unit of the signals.
    phase : ndarray, shape (points,)
        Phase of each point relative to the common phase. [rad]
    standing_wave_fraction : float
        Fraction of the mean square motion that is in phase or in antiphase: 1 for a standing, 1/2 for a travelling
        wave.
    """

    shape: Floats
    greatest_amplitude: float
    phase: Floats
    standing_wave_fraction: float


def amplitude_per_volt(
    *, voltage_peak_to_peak: ArrayLike, vibration_amplitude: ArrayLike, confidence_level: float = 0.95
) -> AmplitudePerVolt:
    r"""Vibration amplitude per volt by regression through the origin, with an F test of curvature.

    Parameters
    ----------
    voltage_peak_to_peak : array_like, shape (n,)
        Of the drive. [V]
    vibration_amplitude : array_like, shape (n,)
        At each voltage. [m]
    confidence_level : float
        Of the interval and of the test. []

    Returns
    -------
    AmplitudePerVolt

    Raises
    ------
    InvalidInput
        If there are fewer than three pairs, a voltage is not positive or all voltages are equal.

    Notes
    -----
    With :math:`u_i = U_i/\max U`, the residual sums of squares :math:`R_1` of the line a u and :math:`R_2` of the
    parabola :math:`b_1 u + b_2 u^2`,

    .. math::

        a = \frac{\sum u_i a_i}{\sum u_i^2} \pm t_{n-1} \sqrt{\frac{R_1}{(n - 1) \sum u_i^2}} , \qquad
        F_{1,\,n-2} = \frac{R_1 - R_2}{R_2/(n - 2)} .

    Curvature is expected: the stroke of ceramics per volt rises with the voltage, and resonances soften.

    References
    ----------
    .. [1] D Table 4.1, figures 4.45 and 4.55.

    Examples
    --------
    >>> from sonolube.measurement import amplitude_per_volt
    >>> amplitude = [0.63e-6, 1.24e-6, 2.5e-6]
    >>> found = amplitude_per_volt(voltage_peak_to_peak=[7.0, 14.0, 28.0], vibration_amplitude=amplitude)
    >>> round(1e9 * found.amplitude_per_volt, 1), found.proportional  # nm/V
    (89.2, True)
    """
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    volts = require_positive(voltage_peak_to_peak=voltage_peak_to_peak)
    amplitude = require_finite(vibration_amplitude=vibration_amplitude)
    if volts.ndim != 1 or volts.shape != amplitude.shape or volts.size < 3 or np.ptp(volts) == 0:
        raise InvalidInput(
            "three pairs of voltage and amplitude at different voltages are needed,"
            f" got {volts.size} and {amplitude.size}"
        )
    n, highest = volts.size, float(volts.max())
    u = volts / highest
    slope = float(u @ amplitude / (u @ u))
    squares_of_line = float(np.sum((amplitude - slope * u) ** 2))
    parabola, *_ = np.linalg.lstsq(np.stack([u, u**2], axis=-1), amplitude, rcond=None)
    squares_of_parabola = float(np.sum((amplitude - np.stack([u, u**2], axis=-1) @ parabola) ** 2))
    rounding = (1e-12 * float(np.abs(amplitude).max())) ** 2 * n
    least = max(squares_of_parabola, rounding, np.finfo(float).tiny)
    f_statistic = (squares_of_line - squares_of_parabola) * (n - 2) / least
    p_value = float(stats.f.sf(max(f_statistic, 0.0), 1, n - 2)) if squares_of_line > rounding else 1.0
    deviation = float(np.sqrt(squares_of_line / (n - 1)))
    half = float(stats.t.ppf((1 + confidence_level) / 2, n - 1)) * deviation / float(np.sqrt(u @ u))
    return AmplitudePerVolt(
        amplitude_per_volt=slope / highest,
        lower=(slope - half) / highest,
        upper=(slope + half) / highest,
        amplitude_deviation=deviation,
        curvature=float(2 * parabola[1] / slope) if slope else 0.0,
        curvature_p_value=p_value,
        proportional=p_value > 1 - confidence_level,
        confidence_level=confidence_level,
    )


def complex_amplitudes(*, time: ArrayLike, signals: ArrayLike, frequency: float) -> Complexes:
    r"""Complex amplitudes of signals at a known frequency by linear least squares.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    signals : array_like, shape (points, samples)
        One row per point, in any unit: displacement, velocity or voltage.
    frequency : float
        Of the drive. [Hz]

    Returns
    -------
    ndarray, shape (points,)
        In the unit of the signals. A velocity amplitude over 2 pi i f is a displacement amplitude.

    Raises
    ------
    InvalidInput
        If the samples are fewer than 4, cover less than a period or do not fit the signals, or alias at the frequency.

    Notes
    -----
    Fits :math:`x(t) = \bar x + \operatorname{Re}(X e^{2\pi i f t})` to each signal; the mean is left out of the result.
    """
    t, x = require_finite(time=time), np.atleast_2d(require_finite(signals=signals))
    omega = 2 * np.pi * float(require_positive(frequency=frequency))
    if t.ndim != 1 or t.size < 4 or x.ndim != 2 or x.shape[1] != t.size:
        raise InvalidInput(f"signals must have one sample per time in each row, got shapes {x.shape} and {t.shape}")
    if np.ptp(t) * frequency < _MIN_PERIODS:
        raise InvalidInput(f"time covers {np.ptp(t) * frequency:.2g} periods of {frequency:g} Hz; one is needed")
    columns = np.stack([np.ones_like(t), np.cos(omega * (t - t[0])), -np.sin(omega * (t - t[0]))], axis=-1)
    if np.linalg.cond(columns) > _LARGEST_CONDITION:
        raise InvalidInput(f"the samples cannot distinguish {frequency:g} Hz from a constant; sample faster")
    coefficients = np.linalg.lstsq(columns, x.T, rcond=None)[0]
    return np.asarray((coefficients[1] + 1j * coefficients[2]) * np.exp(-1j * omega * t[0]))


def operating_deflection_shape(amplitudes: ArrayLike) -> OperatingDeflectionShape:
    r"""Operating deflection shape of points from their complex amplitudes.

    Parameters
    ----------
    amplitudes : array_like, shape (points,)
        Complex, in any one unit; of points measured one after the other each divided by the drive's at the time.

    Returns
    -------
    OperatingDeflectionShape

    Raises
    ------
    InvalidInput
        If there is no point, nothing moves or a value is not finite.

    Notes
    -----
    The common phase, which maximises the real part of the motion, is half that of the sum of squares:

    .. math:: \varphi_0 = \tfrac12 \arg \sum_k X_k^2 .
    """
    x = np.atleast_1d(require_finite_complex(amplitudes=amplitudes))
    if x.ndim != 1 or not x.size or not np.any(x):
        raise InvalidInput("amplitudes must be one-dimensional and not all zero")
    greatest = float(np.abs(x).max())
    scaled = x / greatest
    in_phase = scaled * np.exp(-0.5j * np.angle(np.sum(scaled**2)))
    largest = int(np.argmax(np.abs(in_phase)))
    in_phase = in_phase * (-1.0 if in_phase[largest].real < 0 else 1.0)
    return OperatingDeflectionShape(
        shape=np.asarray(in_phase.real / np.abs(in_phase.real).max()),
        greatest_amplitude=greatest,
        phase=np.angle(in_phase),
        standing_wave_fraction=float(np.sum(in_phase.real**2) / np.sum(np.abs(in_phase) ** 2)),
    )


def modal_assurance_criterion(first: ArrayLike, second: ArrayLike) -> Floats:
    r"""Modal assurance criterion (MAC) of each shape of one set with each of another.

    Parameters
    ----------
    first : array_like, shape (points,) or (points, shapes)
        Such as operating deflection shapes, real or complex, one per column.
    second : array_like, shape (points,) or (points, other_shapes)
        Such as computed modes at the same points.

    Returns
    -------
    ndarray, shape (shapes, other_shapes)
        From 0, orthogonal, to 1, proportional.

    Raises
    ------
    InvalidInput
        If the points differ in number, or a shape is zero or not finite.

    Notes
    -----
    .. math:: \mathrm{MAC}(a, b) = \frac{|a^{\mathsf H} b|^2}{(a^{\mathsf H} a)(b^{\mathsf H} b)}

    independent of scale and common phase. It is not weighted by mass: computed modes that are orthogonal in mass need
    not have zero MAC among themselves, and few points do not distinguish similar modes.

    References
    ----------
    .. [1] R. J. Allemang, Sound and Vibration 37(8), 14 (2003).

    Examples
    --------
    >>> from sonolube.measurement import modal_assurance_criterion
    >>> modal_assurance_criterion([1.0, 2.0, 3.0], [[2.0, 3.0], [4.0, 0.0], [6.0, -1.0]]).round(3).tolist()
    [[1.0, 0.0]]
    """
    a, b = (_unit_shapes(name, value) for name, value in (("first", first), ("second", second)))
    if a.shape[0] != b.shape[0]:
        raise InvalidInput(f"shapes must have the same points, got {a.shape[0]} and {b.shape[0]}")
    return np.asarray(np.abs(a.conj().T @ b) ** 2)


def _unit_shapes(name: str, value: ArrayLike) -> Complexes:
    """Shapes as columns of unit norm; refuse zero shapes."""
    shapes = require_finite_complex(**{name: value})
    shapes = shapes[:, np.newaxis] if shapes.ndim == 1 else shapes
    greatest = np.abs(shapes).max(axis=0) if shapes.ndim == 2 and shapes.size else np.zeros(1)
    if shapes.ndim != 2 or np.any(greatest == 0):
        raise InvalidInput(f"{name} must be shapes in columns, none of them zero, got shape {shapes.shape}")
    scaled = shapes / greatest
    return np.asarray(scaled / np.linalg.norm(scaled, axis=0))
