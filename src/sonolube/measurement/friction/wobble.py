"""Removal of the disc's wobble from a friction force: least-squares fit of the harmonics of the rotation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.wobble_search import harmonic_columns
from sonolube.measurement.time_series import require_equal_length


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
