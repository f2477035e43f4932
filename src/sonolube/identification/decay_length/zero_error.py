"""Evidence for a zero error of the load cell from readings with the pin lifted, and its effect on the decay length."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.special import logsumexp

from sonolube.checks import Floats
from sonolube.identification.decay_length.run_model import interpolated_ratio, relaxation, zero_free_ratio
from sonolube.identification.decay_length.switch_table import SwitchConditions, SwitchTable
from sonolube.models.friction.models.asperity_stick_slip_sine import EMPIRICAL_MEMORY_LENGTH

_TRUE_ZERO: Final = 0.03  # standard deviation of a good zero over the friction force
_FALSE_ZERO: Final = 0.35  # of one that is off
_WANDERS: Final = (0.005, 0.015, 0.05)  # standard deviations of the slow wander of any zero, likewise
_LENGTHS: Final = (0.1, 0.3, 1.0)  # of this wander over the distance of the run
_RELAXATIONS: Final = (0.05, 0.2, 0.5, 2.0)  # distances in which a zero goes off, over that of the run
_DRAWS: Final = 400
_NORMAL_QUARTILE: Final = 0.4549  # median of a chi-squared variable with one degree of freedom


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ZeroEvidence:
    """Zero of the force over a run, and how it would bias the decay length where it is not subtracted.

    Parameters
    ----------
    log_ratio : float
        Natural logarithm of the evidence of a zero that is off over that of a good one.
    rows : ndarray of int
        Switches that have a zero.
    force_zero : ndarray, shape (zeros,)
        Smoothed zero. [N]
    factor : ndarray, shape (draws,)
        Factor by which the decay length without the zero subtracted is wrong, where it is most, as draws.
    """

    log_ratio: float
    rows: np.ndarray
    force_zero: Floats
    factor: Floats


def zero_evidence(table: SwitchTable, conditions: SwitchConditions, *, seed: int = 0) -> ZeroEvidence:
    """Evidence of a zero that is off, from the beginning or over the run, against a good one.

    A good zero has a standard deviation of 0.03, one that is off of 0.35 of the friction force without vibration, about
    no error; one that is off may also go there over the run. Any zero may wander slowly by 0.005 to 0.05 of that force.
    The density of a zero that is off is that normal one times its square (a moment prior [1]_), for an error that is
    nearly none is none.

    Source: V. E. Johnson and D. Rossell, J. R. Stat. Soc. B 72, 143 (2010). doi:10.1111/j.1467-9868.2009.00730.x
    """
    rows = np.flatnonzero(np.isfinite(table.force_zero))
    zero, s = table.force_zero[rows], table.sliding_distance[rows]
    force = float(np.nanmedian(table.intrinsic_friction_force - table.force_zero))
    white = np.diag(np.full(zero.size, _white_variance(zero, table.force_zero_uncertainty, rows)))
    gaps = np.abs(np.subtract.outer(s, s)) / s[-1]
    wanders = [(share * force) ** 2 * np.exp(-gaps / length) for share in _WANDERS for length in _LENGTHS]
    courses = relaxation(s, reach=s[-1] * np.array(_RELAXATIONS))
    level = np.ones((zero.size, 1))
    shapes = [level, *(np.column_stack([level, course]) for course in courses)]
    good = [_log_evidence(zero, white + wander, level, _TRUE_ZERO * force)[0] for wander in wanders]
    off = [(shape, wander) for shape in shapes for wander in wanders]
    found = [_log_evidence(zero, white + wander, shape, _FALSE_ZERO * force) for shape, wander in off]
    off_logs = [plain + np.log(moment) for plain, moment in found]
    shape, wander = off[int(np.argmax(off_logs))]
    prior = (_FALSE_ZERO * force) ** 2 * shape @ shape.T + wander
    gain = prior @ np.linalg.inv(white + prior)
    smoothed = gain @ zero
    left = prior - gain @ prior
    factor = np.linalg.cholesky(left + 1e-9 * np.trace(prior) / zero.size * np.eye(zero.size))
    draws = smoothed + np.random.default_rng(seed).standard_normal((_DRAWS, zero.size)) @ factor.T
    return ZeroEvidence(
        log_ratio=float(logsumexp(off_logs) - logsumexp(good) - np.log(len(off) / len(good))),
        rows=rows,
        force_zero=smoothed,
        factor=_apparent_factor(table, conditions, draws, rows, force),
    )


def _white_variance(zero: Floats, uncertainty: Floats | None, rows: np.ndarray) -> float:
    """Variance of a reading of the zero: by the differences of neighbours, at least as stated."""
    scatter = float(np.median(np.diff(zero) ** 2)) / (2 * _NORMAL_QUARTILE)
    stated = 0.0 if uncertainty is None else float(np.nanmean(uncertainty[rows] ** 2))
    return max(scatter, stated, (1e-4 * float(np.ptp(zero)) + 1e-9) ** 2)


def _log_evidence(zero: Floats, noise: Floats, shape: Floats, deviation: float) -> tuple[float, float]:
    """Logarithm of the evidence of coefficients of a standard deviation, and their mean square over the prior one."""
    covariance = noise + deviation**2 * shape @ shape.T
    factor = np.linalg.cholesky(covariance)
    rest = np.linalg.solve(factor, zero)
    log_evidence = float(-0.5 * rest @ rest - np.log(np.diag(factor)).sum())
    gain = deviation**2 * shape.T @ np.linalg.inv(covariance)
    spread = deviation**2 * np.eye(shape.shape[1]) - deviation**2 * gain @ shape
    square = float(np.sum((gain @ zero) ** 2) + np.trace(spread))
    return log_evidence, square / (shape.shape[1] * deviation**2)


def _apparent_factor(
    table: SwitchTable, conditions: SwitchConditions, draws: Floats, rows: np.ndarray, force: float
) -> Floats:
    """Factor between decay lengths with and without the zero subtracted at the switch of the largest, for each draw."""
    lengths = np.geomspace(0.1e-6, 20e-6, 300)
    a, omega = conditions.vibration_amplitude, 2 * np.pi * conditions.frequency
    speed = conditions.sliding_speed * lengths / (omega * a * EMPIRICAL_MEMORY_LENGTH)
    ratios = interpolated_ratio(relative_amplitude=a / lengths, reduced_speed=speed)
    rising = np.maximum.accumulate(ratios) + 1e-9 * np.arange(ratios.size)
    true = float(np.nanmedian(zero_free_ratio(table)[0]))
    apparent = (true * force + draws) / np.maximum(force + draws, 1e-3 * force)
    found = np.interp(apparent, rising, np.log(lengths)) - np.interp(true, rising, np.log(lengths))
    worst = int(np.argmax(np.mean(np.abs(found), axis=0)))
    return np.asarray(np.exp(np.abs(found[:, worst])))
