"""Predictions of a further rig of a synthetic laboratory, before and after runs on its other rigs."""

from collections.abc import Sequence

import numpy as np

from reliability.studies.own_runs import SOURCES, stated_conditions
from reliability.study import Measure, Record, Study
from reliability.synthetic_rigs import synthetic_rig
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.hierarchy import binomial_interval, central_interval
from sonolube.prediction.posterior import learned
from sonolube.prediction.predictive import laboratory, ratio_draws

_RIGS, _RUNS = 4, 3  # of which the runs teach, and how many on each
_DRAWS = 4000
_BETWEEN = {"assumed": None, "alike": 0.9, "unlike": 0.1}  # share of the variance between laboratories; None is any


def _trial(seed: int) -> Record:
    rng = np.random.default_rng([seed, 21])
    population = learned().friction
    row = population.hyperparameters[rng.integers(len(population.hyperparameters))]
    record: dict[str, object] = {}
    for name, share in _BETWEEN.items():
        own, between = row.copy(), rng.random() if share is None else share
        own[1] += np.sqrt(between) * np.exp(row[3]) * rng.standard_normal()
        own[3] += 0.5 * np.log(1 - between)
        rigs = [synthetic_rig(rng, own, runs=_RUNS) for _ in range(_RIGS + 1)]
        tested = [
            TestedRig(
                name=f"rig {place}",
                at=stated_conditions(rig, slice(1, None)),
                friction_ratio=rig.measured[1:],
                uncertainty=np.full(_RUNS, rig.noise),
            )
            for place, rig in enumerate(rigs[1:])
        ]
        at, truth = stated_conditions(rigs[0], slice(0, 1)), float(rigs[0].truth[0])
        for way, posterior in (
            ("population", population),
            ("laboratory", laboratory(population, tested, seed=seed).posterior),
        ):
            low, high = central_interval(ratio_draws(posterior, at, count=_DRAWS)[:, 0], 0.8)
            record[f"inside_{name}_{way}"] = bool(low <= truth <= high)
            record[f"width_{name}_{way}"] = float(high - low)
    return record


def _measures(records: Sequence[Record]) -> list[Measure]:
    measures = []
    for name, between in _BETWEEN.items():
        part = "a share drawn as assumed" if between is None else f"{100 * between:.0f} %"
        of = f"where {part} of the variance is between laboratories"
        for way in ("population", "laboratory"):
            inside = sum(bool(record[f"inside_{name}_{way}"]) for record in records)
            share, (low, high) = inside / len(records), binomial_interval(inside, len(records))
            measures.append(
                Measure(
                    label=f"ratios of a further rig within the 80 % interval of the {way}, {of}",
                    value=f"{100 * share:.1f} % ({100 * low:.1f} to {100 * high:.1f})",
                    bar="74 to 86 %" if between is None else "",
                    holds=0.74 <= share <= 0.86 or between is not None or len(records) < STUDY.trials,
                )
            )
        widths = [
            np.median([float(str(record[f"width_{name}_{way}"])) for record in records])
            for way in ("laboratory", "population")
        ]
        measures.append(
            Measure(
                label=f"median width by the laboratory over that by the population, {of}",
                value=f"{widths[0] / widths[1]:.2f}",
            )
        )
    return measures


STUDY = Study(
    title="A further rig of a laboratory",
    question=f"Laboratories of {_RIGS + 1} rigs are drawn by code outside the package, with decay lengths that are"
    f" alike within a laboratory or not. One rig is predicted before and after {_RUNS} runs on each other.",
    sources=(*SOURCES, "prediction/predictive.py"),
    trials=200,
    sample=1,
    trial=_trial,
    measures=_measures,
)
"""Own laboratory."""
