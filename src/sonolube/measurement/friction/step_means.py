"""Mean friction of the parts of a recording, with wobble, run-in, drift and stick-slip taken off jointly."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from sonolube.checks import Floats
from sonolube.measurement.friction.force_cycle import StickSlipEstimate
from sonolube.measurement.friction.wobble import find_rotation_speed, harmonic_columns, refined_speed, scaled_waves
from sonolube.measurement.statistics.autocorrelation import CorrelatedRegression, correlated_regression

_BLOCK = 0.016  # s, over which samples are averaged
_BLOCKS_OF_SHORTEST = 40
_MAX_BLOCKS = 20_000
_RUN_IN_TIMES = 8  # time constants that are tried
_SIGNIFICANT = 3.5  # standard errors from which run-in or drift is kept
_MIN_SHARE = 0.05  # of a part within or without bursts, from which their shift of the level is fitted
_UNEVEN = 1.5  # ratio of the noise between parts from which they are weighted


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StepMeans:
    """Mean friction of parts of a recording with their covariance.

    Parameters
    ----------
    friction_force : ndarray, shape (parts,)
        Mean of each part without wobble, run-in, and incomplete cycles of stick-slip. [N]
    covariance : ndarray, shape (parts, parts)
        Of these means, in N2.
    """

    friction_force: Floats
    covariance: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SampledParts:
    """Parts of constant level of a recording, and averages over short blocks of them.

    Parameters
    ----------
    times : tuple of ndarray
        Of the samples of each part with a known force, in s.
    forces : tuple of ndarray
        Friction force, in N.
    block_samples : int
        Samples of a block; the rest at the end of a part is left out.
    """

    times: tuple[Floats, ...]
    forces: tuple[Floats, ...]
    block_samples: int

    def averaged(self, columns: Sequence[Floats]) -> list[Floats]:
        """Averages over blocks of columns of samples, one array per part."""
        return [_block_means(column, self.block_samples) for column in columns]


def sampled_parts(parts: Sequence[slice], *, time: Floats, friction_force: Floats) -> SampledParts:
    """Parts of a recording with blocks short against the parts and against the turns of a disc.

    Parameters
    ----------
    parts : sequence of slice
        Of the samples.
    time : ndarray, shape (samples,)
        Increasing. [s]
    friction_force : ndarray, shape (samples,)
        NaN is left out. [N]

    Returns
    -------
    SampledParts
    """
    known = [np.isfinite(friction_force[part]) for part in parts]
    times = tuple(time[part][mask] for part, mask in zip(parts, known, strict=True))
    forces = tuple(friction_force[part][mask] for part, mask in zip(parts, known, strict=True))
    interval = float(np.median(np.diff(time)))
    samples = sum(t.size for t in times)
    longest = min(t.size for t in times) // _BLOCKS_OF_SHORTEST
    size = max(1, min(round(_BLOCK / interval), longest), samples // _MAX_BLOCKS)
    return SampledParts(times=times, forces=forces, block_samples=size)


def wobble_columns(
    parts: SampledParts, *, revolutions: Sequence[Floats] | None, harmonics: int, places: Sequence[Floats] | None = None
) -> tuple[list[Floats] | None, float]:
    """Harmonics of the rotation at the samples of each part, and the correction of the speed.

    Parameters
    ----------
    parts : SampledParts
    revolutions : sequence of ndarray or None
        At the samples of each part; found in the force without it. []
    harmonics : int
        Number of harmonics.
    places : sequence of ndarray or None
        In proportion to the revolutions, at the samples of each part, along which these are found; the time, in s,
        without it.

    Returns
    -------
    list of ndarray or None
        Shape (samples, 2 * harmonics) each; None where no rotation is known or found.
    float
        Factor by which given revolutions were corrected, or the speed that was found; 0 without rotation.
    """
    values = parts.averaged(parts.forces)
    sought = revolutions if revolutions is not None else places if places is not None else parts.times
    along = parts.averaged(sought)
    if revolutions is None:
        speed = find_rotation_speed(along, values, harmonics=harmonics) or 0.0
    else:
        speed = refined_speed(along, values, rotation_speed=1.0, harmonics=harmonics)
    if not speed or speed * float(along[-1][-1] - along[0][0]) < 1:
        return None, 0.0
    waves = [harmonic_columns(revolutions=speed * place, harmonics=harmonics) for place in sought]
    return _additive_or_proportional(parts, waves), speed


def _additive_or_proportional(parts: SampledParts, waves: list[Floats]) -> list[Floats]:
    """Harmonics of one amplitude in all parts, or of one in proportion to the force, whichever fits better.

    A tilted gauge adds the same wobble at every level; a load that varies with the turn, or a track that does, wobbles
    the force in proportion.
    """
    proportional = scaled_waves(waves, parts.forces)
    if proportional is None:
        return waves

    def left(columns: list[Floats]) -> float:
        """Sum of squares that remains of the blocks."""
        rest = parts.averaged(without_wobble(parts, columns))
        return float(sum(np.sum((y - y.mean()) ** 2) for y in rest))

    return min(waves, proportional, key=left)


def without_wobble(parts: SampledParts, waves: Sequence[Floats] | None) -> list[Floats]:
    """Forces of the parts without the harmonics of the rotation, by least squares with free levels. [N]"""
    if waves is None:
        return list(parts.forces)
    means = [wave.mean(axis=0) for wave in parts.averaged(waves)]
    centred = np.concatenate([w - m for w, m in zip(parts.averaged(waves), means, strict=True)])
    values = np.concatenate([y - y.mean() for y in parts.averaged(parts.forces)])
    solution, _, _, _ = np.linalg.lstsq(centred, values)
    return [force - wave @ solution for force, wave in zip(parts.forces, waves, strict=True)]


def mean_of_parts(
    parts: SampledParts, *, waves: Sequence[Floats] | None, stick_slip: Sequence[StickSlipEstimate], onset: float
) -> StepMeans:
    r"""Mean friction of each part by generalised least squares of the whole recording.

    Parameters
    ----------
    parts : SampledParts
    waves : sequence of ndarray or None
        Harmonics of the rotation at the samples, from `wobble_columns`.
    stick_slip : sequence of StickSlipEstimate
        Of each part.
    onset : float
        Time in s at which sliding begins, from which the run-in decays.

    Returns
    -------
    StepMeans

    Notes
    -----
    The averages over blocks of 16 ms are fitted by

    .. math:: F = \mu_j + \sum_k (a_k \cos k\theta + b_k \sin k\theta) + c\,e^{-(t - t_0)/\tau} + d\,t + s_j(t) ,

    with a level for each part j, the harmonics of the rotation (of one amplitude, or in proportion to the level, as
    fits better), run-in and drift where they exceed 3.5 standard errors,
    and the sawteeth :math:`s_j` of the bursts of stick-slip with their shift of the level. The mean of a part is its
    level with drift and with the share of the bursts' shifts, without run-in and wobble. Its standard error is from
    `correlated_regression` of what remains, weighted where the noise differs between parts.
    """
    values = parts.averaged(parts.forces)
    nuisances = [_burst_columns(t, estimate) for t, estimate in zip(parts.times, stick_slip, strict=True)]
    fixed, shifts = _fixed_columns(parts, waves, nuisances)
    drift = _drift_columns(parts, values, fixed, onset)
    fit = _fitted(values, fixed, drift)
    scale = np.array([np.sqrt(np.mean(e**2)) for e in fit.innovations])
    levels, count = len(values), fixed[0].shape[1]
    kept = np.repeat([_significant(fit, slice(count, count + 1)), _significant(fit, slice(count + 1, None))], [1, 2])
    uneven = bool(scale.max() > _UNEVEN * scale.min() > 0)
    if not kept.all() or uneven:
        drift = [columns[:, kept] for columns in drift]
        fit = _fitted(values, fixed, drift, scale if uneven else None)
    contrast = np.zeros((levels, fit.coefficients.size))
    contrast[:, :levels] = np.eye(levels)
    for j in range(levels):
        contrast[j, count - shifts : count] = fixed[j][:, count - shifts :].mean(axis=0)
        if kept[0]:  # the drift; the run-in after it is left out
            contrast[j, count] = drift[j][:, 0].mean()
    return StepMeans(friction_force=contrast @ fit.coefficients, covariance=contrast @ fit.covariance @ contrast.T)


def _block_means(column: Floats, size: int) -> Floats:
    """Averages over blocks of samples."""
    blocks = column.shape[0] // size
    return np.asarray(column[: blocks * size].reshape(blocks, size, *column.shape[1:]).mean(axis=1))


def _fitted(
    values: Sequence[Floats], fixed: Sequence[Floats], drift: Sequence[Floats], scale: Floats | None = None
) -> CorrelatedRegression:
    """Regression on all columns, each part over the scale of its noise."""
    weights = np.ones(len(values)) if scale is None else 1 / scale
    designs = [w * np.concatenate([a, b], axis=1) for w, a, b in zip(weights, fixed, drift, strict=True)]
    return correlated_regression([w * y for w, y in zip(weights, values, strict=True)], designs)


def _fixed_columns(
    parts: SampledParts, waves: Sequence[Floats] | None, nuisances: Sequence[tuple[Floats, Floats]]
) -> tuple[list[Floats], int]:
    """Averaged columns of levels, wobble, sawteeth and shifts, a matrix a part, and the number of shifts."""
    count = len(parts.times)
    teeth, shifts = (sum(own[k].shape[1] for own in nuisances) for k in range(2))
    columns, tooth, shift = [], 0, 0
    for j, (t, (own_teeth, own_shifts)) in enumerate(zip(parts.times, nuisances, strict=True)):
        level = np.zeros((t.size, count))
        level[:, j] = 1.0
        burst = np.zeros((t.size, teeth + shifts))
        burst[:, tooth : tooth + own_teeth.shape[1]] = own_teeth
        burst[:, teeth + shift : teeth + shift + own_shifts.shape[1]] = own_shifts
        tooth, shift = tooth + own_teeth.shape[1], shift + own_shifts.shape[1]
        columns.append(np.concatenate([level, *([] if waves is None else [waves[j]]), burst], axis=1))
    return parts.averaged(columns), shifts


def _burst_columns(t: Floats, stick_slip: StickSlipEstimate) -> tuple[Floats, Floats]:
    """Sawtooth of the bursts of a part, that of the cycles at each end, and the time within them."""
    times = [stick_slip.slip_time[(stick_slip.slip_time <= burst.end_time)] for burst in stick_slip.bursts]
    times = [s[s >= burst.start_time] for s, burst in zip(times, stick_slip.bursts, strict=True)]
    whole, before, after, within = np.zeros((4, t.size))
    for slips in times:
        if slips.size < 2:
            continue
        gap = float(slips[-1] - slips[0]) / (slips.size - 1)
        knots = np.concatenate([[slips[0] - gap], slips, [slips[-1] + gap]])
        cycle = np.searchsorted(knots, t, side="right") - 1
        inside = (cycle >= 0) & (cycle < knots.size - 1)
        start, end = knots[cycle[inside]], knots[cycle[inside] + 1]
        rise = (t[inside] - start) / (end - start) - 0.5
        first, last = cycle[inside] == 0, cycle[inside] == knots.size - 2
        whole[inside] = np.where(first | last, 0.0, rise)
        before[inside] = np.where(first, rise, 0.0)
        after[inside] = np.where(last, rise, 0.0)
        within[inside] = 1.0
    teeth = [column for column in (whole, before, after) if np.any(column)]
    share = float(within.mean())
    shift = [within] if _MIN_SHARE < share < 1 - _MIN_SHARE else []
    return np.reshape(teeth, (-1, t.size)).T, np.reshape(shift, (-1, t.size)).T


def _drift_columns(
    parts: SampledParts, values: Sequence[Floats], fixed: Sequence[Floats], onset: float
) -> list[Floats]:
    """Averaged columns of linear drift, of the run-in that fits best, and of its change by time constant."""
    times = parts.averaged(parts.times)
    first, last = times[0][0], times[-1][-1]
    linear = [(t - (first + last) / 2) / (last - first) for t in times]
    shortest, longest = np.log(0.1 * (times[0][-1] - onset)), np.log(0.5 * (times[0][-1] - onset))
    basis, _ = np.linalg.qr(np.column_stack([np.concatenate(fixed), np.concatenate(linear)]))
    whole, y = np.concatenate(times) - onset, np.concatenate(values)
    y = y - basis @ (basis.T @ y)

    def explained(logarithm: float) -> float:
        """Minus the power that a run-in of a time constant explains."""
        x = np.exp(-whole / np.exp(logarithm))
        x = x - basis @ (basis.T @ x)
        return -(float(x @ y) ** 2) / max(float(x @ x), 1e-300)

    step = (longest - shortest) / (_RUN_IN_TIMES - 1)
    near = min(np.linspace(shortest, longest, _RUN_IN_TIMES), key=explained)
    bounds = max(shortest, near - step), min(longest, near + step)
    constant = float(np.exp(minimize_scalar(explained, bounds=bounds, method="bounded").x))
    run_in = [np.exp(-(t - onset) / constant) for t in times]
    change = [(t - onset) / constant * decay for t, decay in zip(times, run_in, strict=True)]
    return [np.column_stack(columns) for columns in zip(linear, run_in, change, strict=True)]


def _significant(fit: CorrelatedRegression, which: slice) -> bool:
    """Whether coefficients differ from zero by more than chance."""
    c = fit.coefficients[which]
    return float(c @ np.linalg.solve(fit.covariance[which, which], c)) > _SIGNIFICANT**2 + 2 * (c.size - 1)
