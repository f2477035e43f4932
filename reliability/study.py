"""What a study of reliability is: seeded trials, and what is concluded from their records."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

Record = Mapping[str, object]  # of one trial; what JSON can hold


@dataclass(frozen=True, kw_only=True, slots=True)
class Measure:
    """One figure of a study beside its bar.

    Parameters
    ----------
    label : str
        The quantity, with its unit.
    value : str
        The figure as printed.
    bar : str
        What was asked for; "" for a figure that stands beside another without a bar.
    holds : bool
        Whether the figure meets its bar.
    """

    label: str
    value: str
    bar: str = ""
    holds: bool = True


@dataclass(frozen=True, kw_only=True, slots=True)
class Study:
    """Seeded trials of one kind, and the measures taken from their records.

    Parameters
    ----------
    title : str
        Heading on the page, a noun phrase.
    question : str
        What is tried and what would be a failure, one or two sentences.
    sources : tuple of str
        Globs below src/sonolube of the code under trial; records of an earlier state of it are not continued.
    trials : int
        Trials of the full study.
    sample : int
        Trials in `make test-all`: seeds 0 to sample - 1, a few seconds in all.
    trial : callable
        Record of the trial with a seed. An exception is a failed trial, which no study may have.
    measures : callable
        Measures from the records of all trials.
    sample_measures : callable, optional
        Measures to hold in `make test-all`, where bars of the full count would fail by chance; `measures` by default.
    """

    title: str
    question: str
    sources: tuple[str, ...]
    trials: int
    sample: int
    trial: Callable[[int], Record]
    measures: Callable[[Sequence[Record]], Sequence[Measure]]
    sample_measures: Callable[[Sequence[Record]], Sequence[Measure]] | None = None


def attempt(study: Study, seed: int) -> Record:
    """Record of one trial with its seed; that of a trial that raised has the key "failure"."""
    try:
        return {"seed": seed, **study.trial(seed)}
    except Exception as failure:  # any exception of any library is the finding
        return {"seed": seed, "failure": f"{type(failure).__name__}: {failure}"[:500]}


def judged(study: Study, records: Sequence[Record], *, sample: bool = False) -> list[Measure]:
    """Number of failed trials, then the study's own measures of the others."""
    failures = [record for record in records if "failure" in record]
    first = f", the first at seed {failures[0]['seed']}: {failures[0]['failure']}" if failures else ""
    whole = [record for record in records if "failure" not in record]
    own = study.sample_measures if sample and study.sample_measures is not None else study.measures
    return [
        Measure(label="failed trials", value=f"{len(failures)}{first}", bar="0", holds=not failures),
        *(own(whole) if whole else ()),
    ]
