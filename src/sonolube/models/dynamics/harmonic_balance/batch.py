"""Batch of steady states: the problem, the solution, and numbers of harmonics and time samples estimated beforehand."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, Integers
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw
from sonolube.models.dynamics.harmonic_balance.equations import CONTACT_PER_FORCE, PoleResidueModel
from sonolube.models.dynamics.harmonic_balance.harmonic_kernel import Truncation


class BatchProblem(NamedTuple):
    """Steady states to compute: one structure and contact law, p operating points, and options of the solver."""

    model: PoleResidueModel
    gap_law: GapLaw
    omega: Floats  # (p,) rad/s, angular frequency of the drive
    load: Floats  # (p,) N, dead load
    voltage: Complexes  # (p, K) V, harmonics of the drive
    static_displacement: Floats  # (p,) m, mean displacement without contact force
    minimum_harmonics: int  # least number of harmonics of the contact, fully coupled
    upper_branch: bool  # whether to return the larger of coexisting vibrations
    stability: bool  # whether to compute stability
    tolerance: float  # largest relative error of amplitude and force

    def select(self, points: NDArray[np.intp] | slice) -> "BatchProblem":
        """Problem of some of the points."""
        return self._replace(
            omega=self.omega[points],
            load=self.load[points],
            voltage=self.voltage[points],
            static_displacement=self.static_displacement[points],
        )


class BatchSolution(NamedTuple):
    """Steady states of a batch, one row of each array per point; NaN for a point without solution."""

    mean_displacement: Floats  # (p,) m
    harmonics: Complexes  # (p, H) m, of the displacement
    mean_normal_force: Floats  # (p,) N
    charge_harmonics: Complexes  # (p, K) C, of the charge on the stack
    vibration_amplitude: Floats  # (p,) m
    extremum_phases: Floats  # (p, 2) rad, of maximum and minimum displacement; NaN with more than two extrema
    lowest_displacement: Floats  # (p,) m
    highest_normal_force: Floats  # (p,) N
    lowest_normal_force: Floats  # (p,) N
    contact_loss_fraction: Floats  # (p,)
    unstable: NDArray[np.bool_]  # (p,)
    coexisting_amplitude: Floats  # (p,) m, of another stable steady state; NaN where none was found
    harmonic_count: Integers  # (p,)


def concatenate(parts: list[BatchSolution]) -> BatchSolution:
    """Solution of a batch from those of its consecutive chunks."""
    if len(parts) == 1:
        return parts[0]
    capacity = max(part.harmonics.shape[1] for part in parts)
    harmonics = np.zeros((sum(part.mean_displacement.size for part in parts), capacity), dtype=np.complex128)
    start = 0
    for part in parts:
        harmonics[start : start + part.mean_displacement.size, : part.harmonics.shape[1]] = part.harmonics
        start += part.mean_displacement.size
    narrow = (part._replace(harmonics=part.harmonics[:0, :1]) for part in parts)
    joined = BatchSolution(*(np.concatenate(columns) for columns in zip(*narrow, strict=True)))
    return joined._replace(harmonics=harmonics)


_MAX_HARMONICS = 64
_FREQUENCY_STEP = 0.02  # ratio of neighbouring frequencies, less one, at which receptances are bounded
_COUPLING = 0.02  # receptance times contact stiffness above which a harmonic belongs into Newton's matrix


def sinusoidal_truncation(
    model: PoleResidueModel,
    omega: Floats,
    load: Floats,
    decay_lengths: Floats,
    amplitude: Floats,
    tolerance: float,
    follows_force: bool,
) -> Truncation:
    r"""Truncation of points with a sinusoidal drive and a smooth, nearly exponential contact force.

    Under a sinusoidal displacement of :math:`\beta` decay lengths the force harmonics are

    .. math::
        \Phi_k = 2 F_N \frac{I_k(\beta)}{I_0(\beta)}, \qquad
        \frac{I_k}{I_{k-1}} \lesssim \frac{\beta}{k - \frac12 + \sqrt{(k + \frac12)^2 + \beta^2}}

    with an upper bound of the ratio The receptance at a frequency is bounded by its largest value at any higher
    frequency, so that each criterion decreases with the order and orders can be counted.

    Source: D. E. Amos, Math. Comp. 28, 239 (1974). doi:10.1090/S0025-5718-1974-0333287-7
    """
    beta = amplitude / decay_lengths
    force_order = np.searchsorted(_order_thresholds(tolerance), beta)
    place = np.log(omega) / np.log1p(_FREQUENCY_STEP)
    first = int(np.floor(place.min()))
    bound = _receptance_bound(model, first, _MAX_HARMONICS * omega.max())
    place -= first
    truncated, coupling = 0.25 * tolerance * amplitude / load, 0.5 * _COUPLING * decay_lengths / load
    share, least = np.ones_like(beta), np.minimum(truncated, coupling)
    harmonics, coupled = np.zeros((2, beta.size), dtype=np.uint8)
    for k in range(1, int(force_order.max()) + 1):
        share *= _bessel_ratio_bound(beta, k)
        response = share * bound[(place + np.log(k) / np.log1p(_FREQUENCY_STEP)).astype(np.int32)]
        if not np.any(response > least):
            break
        harmonics += (response > truncated).view(np.uint8)
        coupled += (response > coupling).view(np.uint8)
    n = np.clip(coupled.astype(np.int64), 1, np.maximum(force_order, 1))
    h = np.maximum(np.minimum(harmonics.astype(np.int64), force_order), np.maximum(n, 2))
    needed = force_order + h + 6 if follows_force else 2 * (force_order + 3)
    return Truncation(h, n, np.maximum(4 * h, 2 * (needed // 2)))


@lru_cache(maxsize=64)
def _order_thresholds(tolerance: float) -> Floats:
    """Amplitudes over the decay length at which force harmonics 1, 2, ... exceed a tolerance."""
    beta = np.geomspace(1e-7, 1e4, 2000)
    shares = np.cumprod([_bessel_ratio_bound(beta, k) for k in range(1, _MAX_HARMONICS)], axis=0)
    return np.asarray(beta[np.argmax(shares >= tolerance, axis=1)])


def _bessel_ratio_bound(beta: Floats, order: int) -> Floats:
    """Upper bound of I_k/I_(k-1) by Amos."""
    return np.asarray(beta / (order - 0.5 + np.sqrt((order + 0.5) ** 2 + np.square(beta))))


def default_truncation(points: int, drive_harmonics: int) -> Truncation:
    """Truncation to start with where no estimate exists: non-smooth forces and periodic drives."""
    harmonics = max(8, drive_harmonics)
    sizes = harmonics, min(harmonics, 8), max(64, 4 * harmonics)
    return Truncation(*(np.full(points, size, dtype=np.int64) for size in sizes))


def _receptance_bound(model: PoleResidueModel, first: int, highest: float) -> Floats:
    """Upper bounds of the contact receptance at and above each of a geometric series of frequencies, in m/N.

    The series are the powers, from the first on, of one ratio, and end beyond the highest natural frequency, so that
    the bound at a frequency does not depend on the other points of a batch.
    """
    natural = float(np.sqrt(np.abs(model.determinant).max()))
    last = int(np.log(max(highest, 2 * natural)) / np.log1p(_FREQUENCY_STEP)) + 2
    w = np.exp(np.log1p(_FREQUENCY_STEP) * np.arange(first, last + 1))[:, np.newaxis]
    constant, slope = model.numerator_constant[CONTACT_PER_FORCE], model.numerator_slope[CONTACT_PER_FORCE]
    numerator = np.abs(constant) + np.abs(slope) * w[1:]
    detuning = model.determinant - np.square(w)
    nearest = np.minimum(np.abs(detuning[:-1]), np.abs(detuning[1:]))
    nearest[detuning[:-1] * detuning[1:] < 0] = 0.0
    denominator = np.sqrt(np.square(nearest) + np.square(model.trace * w[:-1]))
    within = np.sum(numerator / np.maximum(denominator, np.finfo(np.float64).tiny), axis=1)
    return np.asarray(np.maximum.accumulate(within[::-1])[::-1])
