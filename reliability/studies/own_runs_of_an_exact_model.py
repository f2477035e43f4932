"""Predictions of synthetic rigs whose friction the model gives exactly: coverage before and after own runs."""

from collections.abc import Sequence

from reliability.studies.own_runs import SOURCES, coverage_measures, predictions
from reliability.study import Measure, Record, Study


def _trial(seed: int) -> Record:
    return predictions(seed, with_discrepancy=False)


def _measures(records: Sequence[Record]) -> list[Measure]:
    return coverage_measures(records, least=0.8, most=1.0, count=STUDY.trials)


STUDY = Study(
    title="Own runs on synthetic rigs without discrepancy",
    question="As before, on rigs that the friction model describes exactly: intervals that allow for its error cover"
    " more.",
    sources=SOURCES,
    trials=200,
    sample=1,
    trial=_trial,
    measures=_measures,
)
"""Own runs without discrepancy."""
