"""Predictions of synthetic rigs before and after own runs: coverage, width, contradictions and outliers."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from reliability.study import Measure, Record, Study
from reliability.synthetic_rigs import SyntheticRig, synthetic_rig
from sonolube.checks import Floats
from sonolube.prediction.evidence import REFERENCE_DECAY_LENGTH, Conditions, TestedRig, UncertainConditions
from sonolube.prediction.hierarchy import binomial_interval, central_interval
from sonolube.prediction.posterior import learned, rig_draws
from sonolube.prediction.predictive import RigPrediction, rig_prediction

COUNTS = (0, 1, 3, 10, 30)
_BARS = {1: 0.85, 3: 0.65, 10: 0.45, 30: 0.30}  # median width over that without runs
_DRAWS = 2000
_CONSTANTS = ((1.0, 3), (1.2, 3), (0.05, 3), (1.2, 1))  # ratio, and number of runs that all have it
_SCATTERS = {"exact": 0.0, "scattered": 1.0}  # of these runs, in their stated uncertainties
_IMPROBABLE = 0.05
_OUTLIER = 0.4  # by which one of six runs is off, towards the middle of 0 to 1
_MAX_MOVED = 0.08


def predictions(seed: int, *, with_discrepancy: bool) -> Record:
    """Width and hit of the 80 % interval at an unseen setting after some numbers of runs, and flags of these."""
    rng = np.random.default_rng([seed, int(with_discrepancy)])
    draws = learned().friction.hyperparameters
    rig = synthetic_rig(rng, draws[rng.integers(len(draws))], runs=max(COUNTS), with_discrepancy=with_discrepancy)
    record: dict[str, object] = {}
    for count in COUNTS:
        found = _predicted(rig, count)
        low, high = central_interval(found.ratios(stated_conditions(rig, slice(0, 1)).conditions)[:, 0], 0.8)
        record[f"width_{count}"] = float(high - low)
        record[f"inside_{count}"] = bool(low <= rig.truth[0] <= high)
        if found.check is not None:
            record[f"contradicted_{count}"] = found.check.contradicted
    return record


def coverage_measures(records: Sequence[Record], *, least: float, most: float, count: int) -> list[Measure]:
    """Coverage after each number of runs, with a bar on all of it."""
    measures = []
    for runs in COUNTS:
        inside = sum(bool(record[f"inside_{runs}"]) for record in records)
        share, (low, high) = inside / len(records), binomial_interval(inside, len(records))
        measures.append(
            Measure(
                label=f"unseen settings within their 80 % interval after {runs} runs (95 % binomial interval)",
                value=f"{100 * share:.1f} % ({100 * low:.1f} to {100 * high:.1f})",
                bar=f"{100 * least:.0f} to {100 * most:.0f} %" if most < 1 else f"at least {100 * least:.0f} %",
                holds=least <= share <= most or len(records) < count,
            )
        )
    return measures


def _trial(seed: int) -> Record:
    record = dict(predictions(seed, with_discrepancy=True))
    rng = np.random.default_rng([seed, 7])
    draws = learned().friction.hyperparameters
    rig = synthetic_rig(rng, draws[rng.integers(len(draws))], runs=6)
    good, bad = _predicted(rig, 6), _predicted(_with_outlier(rig), 6)
    at = stated_conditions(rig, slice(0, 1)).conditions
    record["moved"] = float(abs(np.median(good.ratios(at)) - np.median(bad.ratios(at))))
    for ratio, count in _CONSTANTS:
        for name, noise in _SCATTERS.items():
            record[f"flagged_{ratio:g}_{count}_{name}"] = _flagged(rng, rig, ratio, count, noise=noise * rig.noise)
    return record


def _with_outlier(rig: SyntheticRig) -> SyntheticRig:
    """Rig whose third run is far off."""
    measured = rig.measured.copy()
    measured[3] += _OUTLIER if measured[3] < 0.5 else -_OUTLIER
    return replace(rig, measured=np.maximum(measured, 0.0))


def _flagged(rng: np.random.Generator, rig: SyntheticRig, ratio: float, count: int, *, noise: float) -> bool | None:
    """Whether runs of one ratio over a factor of four are flagged; None where the prediction holds it for probable."""
    ends = np.log(2) * np.concatenate([[-1.0, 1.0], rng.uniform(-1, 1, max(count - 2, 0))])[:count]
    a = np.exp(ends) * np.median(rig.vibration_amplitude)
    v = np.exp(rng.permutation(ends)) * np.median(rig.sliding_speed)
    changed = replace(rig, vibration_amplitude=a, sliding_speed=v)
    at = stated_conditions(changed, slice(0, count))
    before = rig_draws(learned().friction, at, count=_DRAWS)
    mean, deviation = before.normals(at.conditions)
    drawn = mean + np.hypot(deviation, rig.noise) * rng.standard_normal((len(mean), 1))
    tail = np.minimum(np.mean(drawn >= ratio, axis=0), np.mean(drawn <= ratio, axis=0))
    if tail.min() >= _IMPROBABLE:
        return None
    measured = np.maximum(ratio + noise * rng.standard_normal(count), 0.0)
    own = TestedRig(name="own", at=at, friction_ratio=measured, uncertainty=np.full(count, rig.noise))
    check = rig_prediction(learned().friction, at, count=_DRAWS, own=own).check
    return check is not None and check.contradicted


def _predicted(rig: SyntheticRig, count: int) -> RigPrediction:
    """Prediction after the first runs of a rig, its setting 0 kept unseen."""
    own = None
    if count:
        rows = slice(1, count + 1)
        own = TestedRig(
            name="own",
            at=stated_conditions(rig, rows),
            friction_ratio=rig.measured[rows],
            uncertainty=np.full(count, rig.noise),
        )
    return rig_prediction(learned().friction, stated_conditions(rig, slice(0, 1)), count=_DRAWS, own=own)


def stated_conditions(rig: SyntheticRig, rows: slice) -> UncertainConditions:
    """Some settings of a rig as they are stated."""
    a, v = rig.vibration_amplitude[rows], rig.sliding_speed[rows]
    conditions = Conditions(
        vibration_amplitude=a,
        frequency=np.full(a.size, rig.frequency),
        sliding_speed=v,
        decay_length=np.full(a.size, REFERENCE_DECAY_LENGTH),
    )
    return UncertainConditions(conditions=conditions, decay_length_spread=None, amplitude_spread=0.05)


def _measures(records: Sequence[Record]) -> list[Measure]:
    widths = {count: _column(records, f"width_{count}") for count in COUNTS}
    measures = coverage_measures(records, least=0.74, most=0.86, count=STUDY.trials)
    measures += [
        Measure(
            label=f"median width after {count} runs over that without",
            value=f"{np.median(widths[count]) / np.median(widths[0]):.2f}",
            bar=f"at most {bar:.2f}",
            holds=bool(np.median(widths[count]) <= bar * np.median(widths[0])),
        )
        for count, bar in _BARS.items()
    ]
    flags = [bool(record[f"contradicted_{count}"]) for record in records for count in COUNTS[1:]]
    low, high = binomial_interval(sum(flags), len(flags))
    measures.append(
        Measure(
            label="runs of the population that are called a contradiction (95 % binomial interval)",
            value=f"{100 * np.mean(flags):.1f} % ({100 * low:.1f} to {100 * high:.1f})",
            bar="at most 5 %",
            holds=bool(np.mean(flags) <= 0.05),
        )
    )
    for ratio, count in _CONSTANTS:
        measures += [_flag_measure(records, ratio, count, name) for name in _SCATTERS]
    moved = _column(records, "moved")
    measures.append(
        Measure(
            label=f"move of an unseen median by one of six runs that is off by {_OUTLIER:g}: median, 90 % of rigs, all",
            value=f"{np.median(moved):.3f}, {np.quantile(moved, 0.9):.3f}, {moved.max():.3f}",
            bar=f"at most {_MAX_MOVED:g} in 90 %",
            holds=bool(np.quantile(moved, 0.9) <= _MAX_MOVED),
        )
    )
    return measures


def _flag_measure(records: Sequence[Record], ratio: float, count: int, name: str) -> Measure:
    """Share of rigs on which runs of one ratio are flagged; the bar is on runs that are just that."""
    found = [bool(value) for each in records if (value := each[f"flagged_{ratio:g}_{count}_{name}"]) is not None]
    share = float(np.mean(found)) if found else 1.0
    exact = name == "exact"
    return Measure(
        label=f"{count} runs at a ratio of {ratio:g}{'' if exact else ' with a scatter of 0.05'} called a"
        " contradiction, where below 5 % at one of them",
        value=f"{100 * share:.0f} % of {len(found)}",
        bar="at least 90 %" if exact else "",
        holds=share >= 0.9 or not exact,
    )


def _column(records: Sequence[Record], name: str) -> Floats:
    """A number of each record."""
    return np.array([float(str(record[name])) for record in records])


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    narrower = [float(str(record["width_30"])) < float(str(record["width_0"])) + 0.02 for record in records]
    return [Measure(label="narrower after 30 runs", value=str(sum(narrower)), holds=all(narrower))]


SOURCES = tuple(
    f"prediction/{name}" for name in ("evidence.py", "hierarchy.py", "learned.json", "posterior.py", "predictive.py")
)
"""Code that predictions after own runs rest on."""

STUDY = Study(
    title="Own runs on synthetic rigs",
    question="Rigs are drawn from the learned population, discrepancy and decay length included, by code outside the"
    " package. An unseen setting of each is predicted after 0 to 30 runs; runs that contradict the prediction, and one"
    " outlier in six, are put in.",
    sources=SOURCES,
    trials=200,
    sample=1,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
"""Own runs."""
