"""Learning from shipped and own published tests: posterior by importance weights, and how well it predicts unseen.

Draws from the prior are weighed by the likelihood of every rig (`posterior.Population`), so that own rigs cost as much
as shipped ones and rigs are left out at no cost.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.prediction.calibration import (
    Calibration,
    mean_ratio_calibration,
    population_calibration,
    prediction_of_others,
)
from sonolube.prediction.evidence import CLOSURES, TestedRig, published_rigs, tested_rig
from sonolube.prediction.evidence_posterior import EvidencePosterior, learned_sources
from sonolube.prediction.posterior import Population, evidence_fingerprint, rig_digits, systematic_rows
from sonolube.prediction.published_source import PublishedSource, in_order, read_source, shipped_sources

_KEPT: Final = 2048  # draws of the file
_SECONDS_A_RIG: Final = 0.6
_SECONDS_A_PAIR: Final = 0.06  # of points of one rig
_FEW_DRAWS: Final = 300  # effective draws below which the intervals are rough


@dataclass(frozen=True, kw_only=True, slots=True)
class EvidenceScore:
    """Scores of blind predictions of some tests.

    Parameters
    ----------
    name : str
        Which tests, and what they were predicted from.
    found : Calibration
    rival : Calibration
        The mean ratio of the other tests with its scatter, of the same tests.
    """

    name: str
    found: Calibration
    rival: Calibration


@dataclass(frozen=True, kw_only=True, slots=True)
class LearnedEvidence:
    """What was learned.

    Parameters
    ----------
    posterior : EvidencePosterior
    scores : tuple of EvidenceScore
        Those of the shipped tests by the shipped ones first.
    effective_draws : float
        Effective number of the weighed draws.
    within_plane : tuple of str
        Own rigs whose vibration is within the plane, from which nothing was learned.
    """

    posterior: EvidencePosterior
    scores: tuple[EvidenceScore, ...]
    effective_draws: float
    within_plane: tuple[str, ...]

    @property
    def caveats(self) -> tuple[str, ...]:
        """What the draws are worth, what was left out, and what is not learned."""
        found = [
            f"{name}: vibration within the plane, of which nothing is learned yet; it was only checked"
            for name in self.within_plane
        ]
        if self.effective_draws < _FEW_DRAWS:
            found.append(
                f"the tests speak for {self.effective_draws:.0f} of the draws from the prior alone, so that intervals"
                " are rough: does a test contradict all others?"
            )
        return tuple(found)


def read_sources(places: Sequence[str | Path]) -> tuple[PublishedSource, ...]:
    """Read files of published tests, and all such files of folders.

    Parameters
    ----------
    places : sequence of str or Path
        Files, or folders whose files that end in .toml are taken.

    Returns
    -------
    tuple of PublishedSource
        In an order that does not depend on the names of the files.

    Raises
    ------
    InvalidInput
        If there is no such folder or file, a folder has none, or a file cannot be read.
    """
    return in_order([read_source(path) for path in source_paths(places)])


def source_paths(places: Sequence[str | Path]) -> list[Path]:
    """Paths of files of published tests, folders replaced by those that they hold."""
    found: list[Path] = []
    for place in map(Path, places):
        inside = sorted(path for path in place.glob("*.toml") if not path.name.startswith("."))
        if place.is_dir() and not inside:
            raise InvalidInput(f"{place}: has no file of published tests, such as kumar_2004.toml")
        found += inside if place.is_dir() else [place]
    return list(dict.fromkeys(found))


def own_rigs(sources: Sequence[PublishedSource]) -> tuple[TestedRig, ...]:
    """Rigs of own sources with vibration along the normal.

    Raises
    ------
    InvalidInput
        If a rig is there twice, or is a shipped one.
    """
    seen = {tuple(map(str, rig_digits(rig))): f"set {rig.name} that ships with sonolube" for rig in published_rigs()}
    found: dict[str, TestedRig] = {}
    for source in sources:
        for rig in source.rigs:
            name = f"{rig.section.set} of {source.title}"
            one = tested_rig(rig, name=name) if rig.is_normal else None
            if one is None:
                continue
            digits = tuple(map(str, rig_digits(one)))
            if digits in seen:
                raise InvalidInput(
                    f"{source.file}: set {rig.section.set} has the numbers of {seen[digits]}; a test that counts twice"
                    " makes intervals too narrow: leave it out"
                )
            if name in found:
                raise InvalidInput(f"{source.file}: set {name} is there twice; name each set of its own")
            seen[digits] = f"set {name}"
            found[name] = one
    return tuple(found.values())


def expected_time(sources: Sequence[PublishedSource]) -> str:
    """Number of rigs, shipped and own, and the time that learning from them takes on one core, roughly, as text."""
    rigs = (*published_rigs(), *own_rigs(sources))
    seconds = sum(_SECONDS_A_RIG + _SECONDS_A_PAIR * rig.friction_ratio.size**2 for rig in rigs)
    return f"{len(rigs)} rigs, about {seconds:.0f} s"


def learn_evidence(
    sources: Sequence[PublishedSource] = (), *, advance: Callable[[str, int, int], None] = lambda *_: None
) -> LearnedEvidence:
    """Learn from the shipped tests and from own ones.

    Parameters
    ----------
    sources : sequence of PublishedSource
        Own ones, in any order.
    advance : callable
        Called with the name of the rig, the number of rigs done and their total.

    Returns
    -------
    LearnedEvidence

    Raises
    ------
    InvalidInput
        If a test is there twice, or no own one has vibration along the normal.
    """
    sources = in_order(sources)
    shipped, own = published_rigs(), own_rigs(sources)
    if sources and not own:
        raise InvalidInput(
            "no test has vibration along the normal, of which alone this is learned; tests within the plane can be"
            " checked and drawn"
        )
    rigs = (*shipped, *own)
    population = Population.of(CLOSURES[0], ())
    for done, rig in enumerate(rigs):
        advance(rig.name, done, len(rigs))
        population = population.with_rig(rig)
    shares = population.shares()
    rows = systematic_rows(np.log(np.maximum(shares, 1e-300)), _KEPT, np.random.default_rng(0))
    return LearnedEvidence(
        posterior=EvidencePosterior(
            hyperparameters=population.draws[rows],
            fingerprint=evidence_fingerprint(own),
            shipped_fingerprint=evidence_fingerprint(),
            sources=learned_sources(shipped_sources(), sources),
        ),
        scores=_scores(population, shipped, own),
        effective_draws=effective_number(shares),
        within_plane=tuple(
            f"{rig.section.set} of {source.title}" for source in sources for rig in source.rigs if not rig.is_normal
        ),
    )


def effective_number(shares: Floats) -> float:
    """Effective number of draws by their probabilities. []"""
    return float(1 / np.sum(shares**2))


def _scores(
    population: Population, shipped: tuple[TestedRig, ...], own: tuple[TestedRig, ...]
) -> tuple[EvidenceScore, ...]:
    """Blind scores of the shipped tests, and with own ones of these and of all."""
    before = population.of_first(len(shipped))
    alone = EvidenceScore(
        name="shipped tests, by the other shipped ones",
        found=population_calibration("", before, shipped),
        rival=mean_ratio_calibration(),
    )
    if not own:
        return (alone,)
    rigs = (*shipped, *own)
    every = population_calibration("", population, rigs)
    rival = mean_ratio_calibration(rigs=rigs)
    names = {rig.name for rig in own}
    parts = (
        ("shipped tests, by all others", lambda rig: rig not in names),
        ("own tests, by all others", lambda rig: rig in names),
        ("all tests, by all others", lambda rig: True),
    )
    unseen = EvidenceScore(
        name="own tests, by the shipped ones alone",
        found=prediction_of_others(before.posterior(), own),
        rival=rival.of_rigs(lambda rig: rig in names),
    )
    return (
        alone,
        unseen,
        *(EvidenceScore(name=name, found=every.of_rigs(some), rival=rival.of_rigs(some)) for name, some in parts),
    )
