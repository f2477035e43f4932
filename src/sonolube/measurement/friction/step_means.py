"""Mean friction of the parts of a recording, with wobble, run-in, drift and stick-slip taken off jointly."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats
from sonolube.measurement.friction.force_cycle import StickSlipEstimate
from sonolube.measurement.friction.wobble import find_rotation_speed, harmonic_columns, refined_speed, scaled_waves
from sonolube.measurement.statistics.autocorrelation import correlated_regression
from sonolube.measurement.statistics.averaged_regression import Alternative, averaged_regression

_BLOCK = 0.016  # s, over which samples are averaged
_BLOCKS_OF_SHORTEST = 40
_MAX_BLOCKS = 20_000
_RUN_INS = tuple(range(1, 13))  # columns of run-in, each with a time constant; after them their changes with it
_CONSTANTS = 0.05, 1.0  # least and greatest of these, over the time until the end of the first part
_RUN_IN = 0.1  # standard deviation of the prior of a run-in, over the level
_DRIFT = 0.01, 0.1  # standard deviations of that of a drift over the recording, likewise
_RUNS_IN, _DRIFTS = 0.5, 0.1  # probabilities that there is one
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

    .. math:: F = \mu_j \left(1 + c\,e^{-(t - t_0)/\tau}\right) + d\,t
        + \sum_k (a_k \cos k\theta + b_k \sin k\theta) + s_j(t) ,

    with a level for each part j, the harmonics of the rotation (of one amplitude, or in proportion to the level, as
    fits better), and the sawteeth :math:`s_j` of the bursts of stick-slip with their shift of the level. The mean of a
    part is its level with drift and with the share of the bursts' shifts, without run-in and wobble.

    Whether there is a run-in or a drift is not decided but weighed, by `averaged_regression`: a threshold would leave a
    run-in just below it in the mean, and its uncertainty out. Before the force is seen, there is a run-in with one
    chance in two, c being normal with a standard deviation of 0.1, as friction changes in running in [1]_, and ln tau
    even from a twentieth to the whole of the time until the end of the first part; a drift with one chance in ten, with
    a standard deviation over the recording of 0.01 or 0.1 of the level. A slower run-in is part of the mean. Between
    two time constants of the grid the run-in is linear in ln tau. Noise is weighted where it differs between parts.

    References
    ----------
    .. [1] P. J. Blau, Tribol. Int. 38, 1007 (2005). doi:10.1016/j.triboint.2005.07.020; D Table 2.3.
    """
    values = parts.averaged(parts.forces)
    nuisances = [_burst_columns(t, estimate) for t, estimate in zip(parts.times, stick_slip, strict=True)]
    fixed, shifts = _fixed_columns(parts, waves, nuisances)
    trends = _trend_columns(parts, values, onset)
    weights = 1 / _noise_scale(values, fixed, trends)
    levels, count = len(values), fixed[0].shape[1]
    wanted = np.zeros((levels, count + trends[0].shape[1]))
    wanted[:, :levels] = np.eye(levels)
    wanted[:, count - shifts : count] = [columns[:, count - shifts :].mean(axis=0) for columns in fixed]
    wanted[:, count] = [columns[:, 0].mean() for columns in trends]  # the drift; run-in is left out
    found = averaged_regression(
        *([w * part for w, part in zip(weights, each, strict=True)] for each in (values, fixed)),
        offered=[w * part for w, part in zip(weights, trends, strict=True)],
        alternatives=_trends(float(max(abs(y.mean()) for y in values))),
        beside=((), (0,), _RUN_INS, (0, *_RUN_INS)),
        functions=wanted,
    )
    return StepMeans(friction_force=found.means, covariance=found.covariance)


def _block_means(column: Floats, size: int) -> Floats:
    """Averages over blocks of samples."""
    blocks = column.shape[0] // size
    return np.asarray(column[: blocks * size].reshape(blocks, size, *column.shape[1:]).mean(axis=1))


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


def _trend_columns(parts: SampledParts, values: Sequence[Floats], onset: float) -> list[Floats]:
    """Averaged columns of drift, of run-in in proportion to the level by time constant, and of its change with that."""
    times = parts.averaged(parts.times)
    first, last = times[0][0], times[-1][-1]
    constants = np.geomspace(*_CONSTANTS, len(_RUN_INS)) * (times[0][-1] - onset)
    levels = np.array([y.mean() for y in values])
    shares = levels / max(np.abs(levels).max(), 1e-300)
    found = []
    for t, share in zip(times, shares, strict=True):
        since = (t[:, np.newaxis] - onset) / constants
        run_in = share * np.exp(-since)
        found.append(np.column_stack([(t - (first + last) / 2) / (last - first), run_in, since * run_in]))
    return found


def _noise_scale(values: Sequence[Floats], fixed: Sequence[Floats], trends: Sequence[Floats]) -> Floats:
    """Noise of each part over that of the whole; ones where it differs little."""
    columns = [np.column_stack([a, b[:, [0, 1 + len(_RUN_INS) // 2]]]) for a, b in zip(fixed, trends, strict=True)]
    fit = correlated_regression(values, columns)
    scale = np.array([np.sqrt(np.mean(e**2)) for e in fit.innovations])
    uneven = bool(scale.max() > _UNEVEN * scale.min() > 0)
    return np.asarray(scale / np.sqrt(np.mean(scale**2)) if uneven else np.ones(scale.size))


def _trends(level: float) -> list[Alternative]:
    """Nothing, drift, run-in, or both, of each size and time constant, with their probabilities."""
    drifts = [((), (), 1 - _DRIFTS), *(((0,), (size * level,), _DRIFTS / len(_DRIFT)) for size in _DRIFT)]
    width = np.log(_CONSTANTS[1] / _CONSTANTS[0]) / (len(_RUN_INS) - 1) / np.sqrt(12)  # within a step of the logarithm
    run_ins = [
        ((), (), 1 - _RUNS_IN),
        *(
            ((k, k + len(_RUN_INS)), (_RUN_IN * level, _RUN_IN * level * width), _RUNS_IN / len(_RUN_INS))
            for k in _RUN_INS
        ),
    ]
    return [
        Alternative(columns=(*a, *b), deviations=(*c, *d), probability=p * q)
        for a, c, p in drifts
        for b, d, q in run_ins
    ]
