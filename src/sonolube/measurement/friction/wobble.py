"""What the wobble of a turning disc adds to the friction force, found at its rotation's harmonics and taken away."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WobbleCorrection:
    """A friction force without the part that repeats every turn.

    Parameters
    ----------
    friction_force : ndarray, shape (samples,)
        Without the wobble; NaN stays. [N]
    wobble_amplitude : ndarray, shape (harmonics,)
        Of the first and the higher harmonics. [N]
    phase : ndarray, shape (harmonics,)
        Of each as amplitude times cos(k angle - phase). [rad]
    friction_force_deviation : float
        Standard deviation of what is left about its trend. [N]
    """

    friction_force: Floats
    wobble_amplitude: Floats
    phase: Floats
    friction_force_deviation: float


def remove_wobble(
    *, revolutions: ArrayLike, friction_force: ArrayLike, harmonics: int = 3, trend_degree: int = 1
) -> WobbleCorrection:
    """Return the friction force without its harmonics of the rotation.

    Parameters
    ----------
    revolutions : array_like, shape (samples,)
        Turns made until each sample, from the speed or from the pulses of a Hall probe; gaps are allowed. []
    friction_force : array_like, shape (samples,)
        NaN where missing. [N]
    harmonics : int
        How many multiples of the rotation are taken away.
    trend_degree : int
        Degree of the polynomial fitted beside them, which stays in the force.

    Returns
    -------
    Wobble

    Raises
    ------
    InvalidInput
        If shapes differ, fewer than one turn is covered, or there are too few samples for the harmonics.

    Notes
    -----
    A least-squares fit of the trend and the harmonics over the samples present, so that gaps do not leak from one
    harmonic into another. Everything synchronous with the turning goes: also friction that a mark on the track causes.
    """
    n = require_finite(revolutions=revolutions)
    f = np.asarray(friction_force, dtype=np.float64)
    if n.ndim != 1 or f.shape != n.shape:
        raise InvalidInput(f"revolutions and friction_force must be rows of one length, got {n.shape} and {f.shape}")
    if np.isinf(f).any():
        raise InvalidInput("friction_force must be finite or NaN, got an infinite value")
    if harmonics < 1 or trend_degree < 0:
        raise InvalidInput(f"harmonics must be positive and trend_degree not negative, got {harmonics}, {trend_degree}")
    known = np.isfinite(f)
    unknowns = 2 * harmonics + trend_degree + 1
    if known.sum() <= unknowns:
        raise InvalidInput(f"friction_force holds {known.sum()} values; {unknowns} unknowns need more")
    turns = float(np.ptp(n[known]))
    if turns < 1:
        raise InvalidInput(f"revolutions cover {turns:.3g} of a turn; the wobble needs one")
    orders = np.arange(1, harmonics + 1)
    angle = 2 * np.pi * np.multiply.outer(n, orders)
    waves = np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
    middle = n[known].min() + turns / 2
    trend = np.polynomial.legendre.legvander(2 * (n - middle) / turns, trend_degree)
    design = np.concatenate([trend, waves], axis=1)
    solution, _, rank, _ = np.linalg.lstsq(design[known], f[known])
    if rank < unknowns:
        raise InvalidInput(f"revolutions are sampled too coarsely for {harmonics} harmonics; take fewer")
    of_waves = solution[trend_degree + 1 :]
    cosine, sine = of_waves[:harmonics], of_waves[harmonics:]
    left = f[known] - design[known] @ solution
    return WobbleCorrection(
        friction_force=f - waves @ of_waves,
        wobble_amplitude=np.hypot(cosine, sine),
        phase=np.arctan2(sine, cosine),
        friction_force_deviation=float(np.sqrt(left @ left / (left.size - unknowns))),
    )
