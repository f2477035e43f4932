"""Wobble of the disc in a friction force: its rotation found by the harmonics of a constant speed, and its removal.

Harmonics of the rotation are fitted by least squares.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import median_filter
from scipy.optimize import minimize_scalar

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput
from sonolube.measurement.time_series import require_equal_length

FASTEST_ROTATION = 5.0
"""Highest rotational speed that is sought, in turns per second."""

_MIN_TURNS = 2.0
_NOISE_BAND = 1.0  # Hz on either side, of the running median
_OVERSAMPLING = 8
_SIGNIFICANCE = 50.0  # of the sum over harmonics of power over noise, chi-squared with two degrees each
_CANDIDATES = 6
_REACH = 0.5  # turns of the recording, by which a speed is corrected at most
_MAX_REACH = 0.05  # of the speed, likewise: over few turns, a freer wobble would pass for the run-in
_COHERENT_SHARE = 0.7  # of the time, in parts in which one wobble of constant phase explains the force better
_AS_GOOD = 0.98  # of the best explained power, at which a faster rotation is preferred to its subharmonics


def harmonic_columns(*, revolutions: Floats, harmonics: int) -> Floats:
    """Cosines and sines of the harmonics of the rotation.

    Parameters
    ----------
    revolutions : ndarray, shape (samples,)
        Revolutions made until each sample. []
    harmonics : int
        Number of harmonics.

    Returns
    -------
    ndarray, shape (samples, 2 * harmonics)
    """
    angle = 2 * np.pi * np.multiply.outer(revolutions, np.arange(1, harmonics + 1))
    return np.concatenate([np.cos(angle), np.sin(angle)], axis=1)


def find_rotation_speed(times: Sequence[Floats], forces: Sequence[Floats], *, harmonics: int = 3) -> float | None:
    r"""Rotational speed whose harmonics stand out in a friction force; None where none does. [1/s]

    Parameters
    ----------
    times : sequence of ndarray
        Of the samples of each part of constant level, in the order of time, in s.
    forces : sequence of ndarray
        Friction force; the mean of each part is free, in N.
    harmonics : int
        Number of harmonics.

    Returns
    -------
    float or None

    Notes
    -----
    At each frequency the power P is that explained by cosine and sine beside the means of the parts, and the noise S
    its running median. The sum of :math:`P/S` over the harmonics must exceed 50, and the wobble must improve the fit in
    70 % of the time with one phase and one amplitude, or one in proportion to the level: stick-slip keeps no phase. Of
    equally good speeds the highest is taken, since subharmonics explain as much. Sought are 2 turns per recording to 5
    turns per second.
    """
    t, y = np.concatenate(times), np.concatenate([force - force.mean() for force in forces])
    duration = float(t[-1] - t[0])
    frequency, power = _explained_power(times, forces)
    width = min(int(2 * _NOISE_BAND / frequency[1]), frequency.size - 1)
    noise = median_filter(power, width | 1, mode="reflect") / np.log(2)
    relative = power / np.maximum(noise, 1e-300)
    slowest = int(np.ceil(_MIN_TURNS / duration / frequency[1]))
    fastest = int(min(FASTEST_ROTATION / frequency[1], (frequency.size - 1) / harmonics))
    if fastest <= slowest:
        return None
    index = np.arange(slowest, fastest)
    total = np.sum([relative[order * index] for order in range(1, harmonics + 1)], axis=0)
    candidates: list[float] = []
    while len(candidates) < _CANDIDATES and total.max() > _SIGNIFICANCE:
        best = int(np.argmax(total))
        candidates.append(
            refined_speed(times, forces, rotation_speed=float(frequency[index[best]]), harmonics=harmonics)
        )
        total[max(0, best - _OVERSAMPLING) : best + _OVERSAMPLING + 1] = 0.0
    if not candidates:
        return None
    explained = [float(y @ y) - _misfit(times, forces, speed, harmonics) for speed in candidates]
    speed = max(s for s, gain in zip(candidates, explained, strict=True) if gain >= _AS_GOOD * max(explained))
    return speed if _coherent(times, forces, speed, harmonics) else None


def refined_speed(
    times: Sequence[Floats], forces: Sequence[Floats], *, rotation_speed: float, harmonics: int = 3
) -> float:
    """Rotational speed of least misfit within half a turn per recording, and a twentieth, of a given one. [1/s]

    Parameters
    ----------
    times, forces
        As in `find_rotation_speed`.
    rotation_speed : float
        Near the speed. [1/s]
    harmonics : int
        Number of harmonics.

    Returns
    -------
    float
    """
    reach = min(_REACH / float(times[-1][-1] - times[0][0]), _MAX_REACH * rotation_speed)
    bounds = max(rotation_speed - reach, rotation_speed / 2), rotation_speed + reach
    found = minimize_scalar(
        lambda speed: _misfit(times, forces, float(speed), harmonics), bounds=bounds, method="bounded"
    )
    return float(found.x)


def _explained_power(times: Sequence[Floats], forces: Sequence[Floats]) -> tuple[Floats, Floats]:
    """Frequencies and the power that each explains beside the means of the parts."""
    start, interval = times[0][0], float(np.median(np.concatenate([np.diff(t) for t in times])))
    places = [np.round((t - start) / interval).astype(np.int64) for t in times]
    size = 1 << int(np.ceil(np.log2(_OVERSAMPLING * (places[-1][-1] + 1))))
    signal, known = np.zeros(size), np.zeros(size)
    cosines, sines, products = np.zeros(size // 2 + 1), np.zeros(size // 2 + 1), np.zeros(size // 2 + 1)
    for place, force in zip(places, forces, strict=True):
        signal[place] = force - force.mean()
        part = np.zeros(size)
        part[place] = 1.0
        known += part
        mean = np.fft.rfft(part) / np.sqrt(place.size)
        cosines, sines, products = cosines + mean.real**2, sines + mean.imag**2, products + mean.real * mean.imag
    wave, double = np.fft.rfft(signal), np.fft.rfft(known)
    half = np.arange(size // 4 + 1)  # the Gram matrix of a frequency has its double
    cosine = (known.sum() + double[2 * half].real) / 2 - cosines[half]
    sine = (known.sum() - double[2 * half].real) / 2 - sines[half]
    cross = double[2 * half].imag / 2 - products[half]
    determinant = cosine * sine - cross**2
    a, b = wave[half].real, wave[half].imag
    power = (a**2 * sine - 2 * a * b * cross + b**2 * cosine) / np.where(determinant > 1e-9, determinant, np.inf)
    return half / (size * interval), np.asarray(power)


def scaled_waves(waves: Sequence[Floats], forces: Sequence[Floats]) -> list[Floats] | None:
    """Harmonics in proportion to the level of each part, 1 at the highest; None where a level is not positive.

    `waves` has shape (samples, columns).
    """
    levels = np.array([force.mean() for force in forces])
    if not (levels > 0).all():
        return None
    return [wave * level / levels.max() for wave, level in zip(waves, levels, strict=True)]


def _residuals(times: Sequence[Floats], forces: Sequence[Floats], speed: float, harmonics: int) -> list[Floats]:
    """Residual of each part after levels and harmonics, with one amplitude or one in proportion to the level.

    The one that leaves less is taken: a tilted gauge adds the same wobble at every level, a load that varies with the
    turn wobbles the force in proportion, and of one amplitude would be worse than none where vibration takes most of
    the friction away.
    """
    waves = [harmonic_columns(revolutions=speed * t, harmonics=harmonics) for t in times]
    tried = [each for each in (waves, scaled_waves(waves, forces)) if each is not None]
    return min((_left(each, forces) for each in tried), key=lambda left: sum(float(e @ e) for e in left))


def _left(waves: Sequence[Floats], forces: Sequence[Floats]) -> list[Floats]:
    """Residuals of the fit of levels and columns in each part."""
    centred = np.concatenate([wave - wave.mean(axis=0) for wave in waves])
    y = np.concatenate([force - force.mean() for force in forces])
    solution, _, _, _ = np.linalg.lstsq(centred, y)
    ends = np.cumsum([force.size for force in forces])[:-1]
    return np.split(y - centred @ solution, ends)


def _misfit(times: Sequence[Floats], forces: Sequence[Floats], speed: float, harmonics: int) -> float:
    """Sum of squares that levels and harmonics leave."""
    return sum(float(e @ e) for e in _residuals(times, forces, speed, harmonics))


def _coherent(times: Sequence[Floats], forces: Sequence[Floats], speed: float, harmonics: int) -> bool:
    """Whether one wobble improves the fit in most of the time."""
    residuals = _residuals(times, forces, speed, harmonics)
    size = max(1, min(t.size for t in times))
    better, pieces = 0, 0
    for e, f in zip(residuals, forces, strict=True):
        y = f - f.mean()
        for piece in range(max(1, f.size // size)):
            part = slice(piece * size, (piece + 1) * size)
            better += float(e[part] @ e[part]) < float(y[part] @ y[part])
            pieces += 1
    return better >= _COHERENT_SHARE * pieces


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WobbleCorrection:
    """Friction force without its harmonics of the rotation, and the amplitudes and phases of these.

    Parameters
    ----------
    friction_force : ndarray, shape (samples,)
        Corrected for wobble; NaN stays. [N]
    wobble_amplitude : ndarray, shape (harmonics,)
        Of the first and the higher harmonics of the rotation. [N]
    phase : ndarray, shape (harmonics,)
        Phase of each harmonic, written as amplitude times cos(k angle - phase). [rad]
    friction_force_deviation : float
        Standard deviation of the corrected force about its trend. [N]
    """

    friction_force: Floats
    wobble_amplitude: Floats
    phase: Floats
    friction_force_deviation: float


def remove_wobble(
    *, revolutions: ArrayLike, friction_force: ArrayLike, harmonics: int = 3, trend_degree: int = 1
) -> WobbleCorrection:
    r"""Friction force without its harmonics of the rotation, by linear least squares.

    Parameters
    ----------
    revolutions : array_like, shape (samples,)
        Revolutions made until each sample, from the speed or from the pulses of a Hall probe; gaps are allowed. []
    friction_force : array_like, shape (samples,)
        NaN where missing. [N]
    harmonics : int
        Number of harmonics of the rotation that are removed.
    trend_degree : int
        Degree of the polynomial trend fitted with them, which stays in the force.

    Returns
    -------
    WobbleCorrection

    Raises
    ------
    InvalidInput
        If shapes differ, fewer than one revolution is covered, or there are too few samples for the harmonics.

    Notes
    -----
    With the revolutions N, Legendre polynomials P over their range and K harmonics, the fit over the known samples is

    .. math:: F_t = \sum_{j=0}^{d} c_j P_j + \sum_{k=1}^{K} \left[ a_k \cos 2\pi k N + b_k \sin 2\pi k N \right] ,

    so that gaps do not couple the harmonics. The whole rotation-synchronous part is removed: also friction caused by a
    mark on the track.

    References
    ----------
    .. [1] D 2.3.3 and 4.1.2 on the wobble of the disc.
    """
    n = require_finite(revolutions=revolutions)
    f = np.asarray(friction_force, dtype=np.float64)
    require_equal_length(revolutions=n, friction_force=f)
    if np.isinf(f).any():
        raise InvalidInput("friction_force must be finite or NaN, got an infinite value")
    if harmonics < 1 or trend_degree < 0:
        raise InvalidInput(f"harmonics must be positive and trend_degree not negative, got {harmonics}, {trend_degree}")
    known = np.isfinite(f)
    unknowns = 2 * harmonics + trend_degree + 1
    if known.sum() <= unknowns:
        raise InvalidInput(f"friction_force holds {known.sum()} values; {unknowns} unknowns need more")
    covered = float(np.ptp(n[known]))
    if covered < 1:
        raise InvalidInput(f"revolutions cover {covered:.3g} of a revolution; the wobble needs one")
    waves = harmonic_columns(revolutions=n, harmonics=harmonics)
    centre = n[known].min() + covered / 2
    trend = np.polynomial.legendre.legvander(2 * (n - centre) / covered, trend_degree)
    design = np.concatenate([trend, waves], axis=1)
    solution, _, rank, _ = np.linalg.lstsq(design[known], f[known])
    if rank < unknowns:
        raise InvalidInput(f"revolutions are sampled too coarsely for {harmonics} harmonics; use fewer")
    wave_coefficients = solution[trend_degree + 1 :]
    cosine, sine = wave_coefficients[:harmonics], wave_coefficients[harmonics:]
    residual = f[known] - design[known] @ solution
    return WobbleCorrection(
        friction_force=f - waves @ wave_coefficients,
        wobble_amplitude=np.hypot(cosine, sine),
        phase=np.arctan2(sine, cosine),
        friction_force_deviation=float(np.sqrt(residual @ residual / (residual.size - unknowns))),
    )
