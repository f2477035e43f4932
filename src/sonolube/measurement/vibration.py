"""Vibration as a vibrometer sees it: amplitude per volt, operating shapes, and how they resemble computed modes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from sonolube.checks import Complexes, Floats, require_finite, require_finite_complex, require_positive, require_within
from sonolube.errors import InvalidInput

_LEAST_PERIODS = 1.0


@dataclass(frozen=True, kw_only=True, slots=True)
class AmplitudePerVolt:
    """Amplitude in proportion to the drive voltage, and whether it is.

    Parameters
    ----------
    amplitude_per_volt : float
        Slope of the line through the origin. [m/V]
    lower, upper : float
        Ends of its confidence interval, in m/V.
    amplitude_deviation : float
        Standard deviation of the amplitudes about the line. [m]
    curvature : float
        By how much the slope at the highest voltage exceeds that at zero, as a share of the mean slope, by a parabola
        through the origin.
    curvature_p_value : float
        Chance of as much curvature or more by scatter alone; small speaks against proportion.
    proportional : bool
        Whether that chance exceeds one less the confidence level.
    confidence_level : float
        Of interval and verdict. []
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
    """How the points of a surface move together at one frequency.

    Parameters
    ----------
    shape : ndarray, shape (points,)
        Real, greatest magnitude 1: motion in step with the whole.
    greatest_amplitude : float
        Amplitude at the point that moves most, in the unit of the signals.
    phase : ndarray, shape (points,)
        Of each point, from the motion of the whole. [rad]
    standing_wave_fraction : float
        Share of the mean square that moves in step or opposed: 1 for a standing, half for a running wave.
    """

    shape: Floats
    greatest_amplitude: float
    phase: Floats
    standing_wave_fraction: float


def amplitude_per_volt(
    *, voltage_peak_to_peak: ArrayLike, vibration_amplitude: ArrayLike, confidence_level: float = 0.95
) -> AmplitudePerVolt:
    """Return the amplitude per volt peak to peak, with a test of proportion.

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
        If there are fewer than three pairs, a voltage is not positive or all are one.

    Notes
    -----
    The test compares the line through the origin with a parabola through the origin, by Fisher's F with one degree of
    freedom: ceramics stroke more per volt, and resonances soften, as the voltage rises.

    References
    ----------
    .. [1] D Table 4.1, figures 4.45 and 4.55.
    """
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    volts = require_positive(voltage_peak_to_peak=voltage_peak_to_peak)
    amplitude = require_finite(vibration_amplitude=vibration_amplitude)
    if volts.ndim != 1 or volts.shape != amplitude.shape or volts.size < 3 or np.ptp(volts) == 0:
        raise InvalidInput(
            "three pairs of voltage and amplitude at different voltages are needed,"
            f" got {volts.size} and {amplitude.size}"
        )
    n, top = volts.size, float(volts.max())
    u = volts / top
    line = float(u @ amplitude / (u @ u))
    left = float(np.sum((amplitude - line * u) ** 2))
    parabola, *_ = np.linalg.lstsq(np.stack([u, u**2], axis=-1), amplitude, rcond=None)
    left_by_parabola = float(np.sum((amplitude - np.stack([u, u**2], axis=-1) @ parabola) ** 2))
    rounding = (1e-12 * float(np.abs(amplitude).max())) ** 2 * n
    fisher = (left - left_by_parabola) * (n - 2) / max(left_by_parabola, rounding, np.finfo(float).tiny)
    chance = float(stats.f.sf(max(fisher, 0.0), 1, n - 2)) if left > rounding else 1.0
    deviation = float(np.sqrt(left / (n - 1)))
    half = float(stats.t.ppf((1 + confidence_level) / 2, n - 1)) * deviation / float(np.sqrt(u @ u))
    return AmplitudePerVolt(
        amplitude_per_volt=line / top,
        lower=(line - half) / top,
        upper=(line + half) / top,
        amplitude_deviation=deviation,
        curvature=float(2 * parabola[1] / line) if line else 0.0,
        curvature_p_value=chance,
        proportional=chance > 1 - confidence_level,
        confidence_level=confidence_level,
    )


def complex_amplitudes(*, time: ArrayLike, signals: ArrayLike, frequency: float) -> Complexes:
    """Return the complex amplitudes of signals at a known frequency, as least squares see them.

    Parameters
    ----------
    time : array_like, shape (samples,)
        Increasing. [s]
    signals : array_like, shape (points, samples)
        One a point, in any unit: displacement, velocity or voltage.
    frequency : float
        Of the drive. [Hz]

    Returns
    -------
    ndarray, shape (points,)
        X of x = Re(X exp(2 pi i f t)); the mean of each signal is left out. A velocity over 2 pi i f is a displacement.

    Raises
    ------
    InvalidInput
        If the samples are fewer than 4, cover less than a period or do not fit the signals, or alias at the frequency.
    """
    t, x = require_finite(time=time), np.atleast_2d(require_finite(signals=signals))
    omega = 2 * np.pi * float(require_positive(frequency=frequency))
    if t.ndim != 1 or t.size < 4 or x.ndim != 2 or x.shape[1] != t.size:
        raise InvalidInput(f"signals must be rows of as many samples as time, got shapes {x.shape} and {t.shape}")
    if np.ptp(t) * frequency < _LEAST_PERIODS:
        raise InvalidInput(f"time covers {np.ptp(t) * frequency:.2g} periods of {frequency:g} Hz; one is needed")
    columns = np.stack([np.ones_like(t), np.cos(omega * (t - t[0])), -np.sin(omega * (t - t[0]))], axis=-1)
    if np.linalg.cond(columns) > 1e6:
        raise InvalidInput(f"the samples cannot tell {frequency:g} Hz from a constant; sample faster")
    found = np.linalg.lstsq(columns, x.T, rcond=None)[0]
    return np.asarray((found[1] + 1j * found[2]) * np.exp(-1j * omega * t[0]))


def operating_deflection_shape(amplitudes: ArrayLike) -> OperatingDeflectionShape:
    """Return the shape in which points move, from their complex amplitudes.

    Parameters
    ----------
    amplitudes : array_like, shape (points,)
        Complex, in any one unit; of points measured one after the other each over that of the drive at the time.

    Returns
    -------
    OperatingDeflectionShape

    Raises
    ------
    InvalidInput
        If there is no point, nothing moves or a value is not finite.

    Notes
    -----
    The common phase is half that of the sum of squares, with which most of the motion is real.
    """
    x = np.atleast_1d(require_finite_complex(amplitudes=amplitudes))
    if x.ndim != 1 or not x.size or not np.any(x):
        raise InvalidInput("a shape needs a row of amplitudes that are not all zero")
    greatest = float(np.abs(x).max())
    unit = x / greatest
    turned = unit * np.exp(-0.5j * np.angle(np.sum(unit**2)))
    top = int(np.argmax(np.abs(turned)))
    turned = turned * (-1.0 if turned[top].real < 0 else 1.0)
    return OperatingDeflectionShape(
        shape=np.asarray(turned.real / np.abs(turned.real).max()),
        greatest_amplitude=greatest,
        phase=np.angle(turned),
        standing_wave_fraction=float(np.sum(turned.real**2) / np.sum(np.abs(turned) ** 2)),
    )


def modal_assurance_criterion(first: ArrayLike, second: ArrayLike) -> Floats:
    """Return the modal assurance criterion of each shape of one set with each of another.

    Parameters
    ----------
    first : array_like, shape (points,) or (points, shapes)
        Such as operating shapes, real or complex, one a column.
    second : array_like, shape (points,) or (points, other_shapes)
        Such as computed modes at the same points.

    Returns
    -------
    ndarray, shape (shapes, other_shapes)
        From 0, orthogonal, to 1, in proportion.

    Raises
    ------
    InvalidInput
        If the points differ in number, or a shape is zero or not finite.

    Notes
    -----
    abs(a^H b)^2/((a^H a)(b^H b)), blind to scale and common phase. It does not weigh by mass: computed modes that are
    orthogonal in mass need not give zero among themselves, nor do few points tell alike modes apart.

    References
    ----------
    .. [1] R. J. Allemang, Sound and Vibration 37(8), 14 (2003).
    """
    a, b = (_shapes(name, value) for name, value in (("first", first), ("second", second)))
    if a.shape[0] != b.shape[0]:
        raise InvalidInput(f"shapes must have the same points, got {a.shape[0]} and {b.shape[0]}")
    return np.asarray(np.abs(a.conj().T @ b) ** 2)


def _shapes(name: str, value: ArrayLike) -> Complexes:
    shapes = require_finite_complex(**{name: value})
    shapes = shapes[:, np.newaxis] if shapes.ndim == 1 else shapes
    greatest = np.abs(shapes).max(axis=0) if shapes.ndim == 2 and shapes.size else np.zeros(1)
    if shapes.ndim != 2 or np.any(greatest == 0):
        raise InvalidInput(f"{name} must be shapes in columns, none of them zero, got shape {shapes.shape}")
    unit = shapes / greatest
    return np.asarray(unit / np.linalg.norm(unit, axis=0))
