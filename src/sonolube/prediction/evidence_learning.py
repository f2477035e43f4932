"""Learning from shipped and own published tests: posterior by importance weights, and how well it predicts unseen.

Draws from the prior are weighed by the likelihood of every rig (`posterior.Population`), so that own rigs cost as much
as shipped ones and rigs are left out at no cost.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.prediction.calibration import (
    Calibration,
    blind_calibration,
    mean_ratio_calibration,
    plane_calibration,
    population_calibration,
    prediction_of_others,
)
from sonolube.prediction.evidence import CLOSURES, TestedRig, published_rigs, tested_rig
from sonolube.prediction.evidence_posterior import EvidencePosterior, learned_sources, shipped_fingerprint
from sonolube.prediction.posterior import (
    Population,
    evidence_fingerprint,
    published_likelihood,
    rig_digits,
    systematic_rows,
)
from sonolube.prediction.published_source import PublishedRig, PublishedSource, in_order, read_source, shipped_sources
from sonolube.prediction.within_plane import (
    SPRINGS,
    PlanePopulation,
    plane_population,
    plane_posterior,
    plane_rig,
    plane_rigs,
)

_KEPT: Final = 2048  # draws of the file
_SECONDS_A_RIG: Final = 0.6
_SECONDS_A_PAIR: Final = 0.06  # of points of one rig
_SECONDS_A_POINT: Final = 0.05  # within the plane
_FEW_DRAWS: Final = 300  # effective draws below which the intervals are rough
_FEW_PLANE_DRAWS: Final = 100  # likewise, of fewer draws


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
    effective_draws, effective_draws_within_plane : float
        Effective number of the weighed draws.
    """

    posterior: EvidencePosterior
    scores: tuple[EvidenceScore, ...]
    effective_draws: float
    effective_draws_within_plane: float

    @property
    def caveats(self) -> tuple[str, ...]:
        """What the draws are worth."""
        return tuple(
            f"the tests speak for {count:.0f} of the draws from the prior {where} alone, so that intervals are rough:"
            " does a test contradict all others?"
            for where, count, few in (
                ("along the normal", self.effective_draws, _FEW_DRAWS),
                ("within the plane", self.effective_draws_within_plane, _FEW_PLANE_DRAWS),
            )
            if count < few
        )


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
    return _own_rigs(sources, is_normal=True)


def own_plane_rigs(sources: Sequence[PublishedSource]) -> tuple[TestedRig, ...]:
    """Rigs of own sources with vibration within the plane, refused as of `own_rigs`."""
    return _own_rigs(sources, is_normal=False)


def _own_rigs(sources: Sequence[PublishedSource], *, is_normal: bool) -> tuple[TestedRig, ...]:
    """Rigs of own sources in directions of one law."""
    shipped = [(rig, one) for source in shipped_sources() for rig in source.rigs for one in _taken(rig, is_normal)]
    seen = {_numbers(rig, one): f"set {one.name} that ships with sonolube" for rig, one in shipped}
    found: dict[str, TestedRig] = {}
    for source in sources:
        for rig in source.rigs:
            for one in _taken(rig, is_normal):
                name, numbers = f"{rig.section.set} of {source.title}", _numbers(rig, one)
                if numbers in seen:
                    raise InvalidInput(
                        f"{source.file}: set {rig.section.set} has the numbers of {seen[numbers]}; a test that counts"
                        " twice makes intervals too narrow: leave it out"
                    )
                if name in found:
                    raise InvalidInput(f"{source.file}: set {name} is there twice; name each set of its own")
                seen[numbers] = f"set {name}"
                found[name] = replace(one, name=name)
    return tuple(found.values())


def _taken(rig: PublishedRig, is_normal: bool) -> tuple[TestedRig, ...]:
    """Published rig as a tested one; none of another law."""
    if rig.is_normal != is_normal:
        return ()
    return (tested_rig(rig, name=rig.section.set) if is_normal else plane_rig(rig),)


def _numbers(published: PublishedRig, rig: TestedRig) -> tuple[str, ...]:
    """Direction and numbers of a rig, by which it is known under any name."""
    return published.section.path.text, *map(str, rig_digits(rig))


def expected_time(sources: Sequence[PublishedSource]) -> str:
    """Number of rigs, shipped and own, and the time that learning from them takes on one core, roughly, as text."""
    rigs = (*published_rigs(), *own_rigs(sources))
    plane = (*plane_rigs(), *own_plane_rigs(sources))
    seconds = sum(_SECONDS_A_RIG + _SECONDS_A_PAIR * rig.friction_ratio.size**2 for rig in rigs)
    seconds += sum(_SECONDS_A_POINT * rig.friction_ratio.size for rig in plane)
    return f"{len(rigs) + len(plane)} rigs, about {seconds:.0f} s"


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
        If a test is there twice.
    """
    sources = in_order(sources)
    shipped, own, own_plane = published_rigs(), own_rigs(sources), own_plane_rigs(sources)
    rigs = (*shipped, *own)
    population = Population.of(CLOSURES[0], ())
    for done, rig in enumerate(rigs):
        advance(rig.name, done, len(rigs))
        is_shipped = done < len(shipped)
        population = population.with_likelihood(published_likelihood(done)) if is_shipped else population.with_rig(rig)
    shares = population.shares()
    rows = systematic_rows(np.log(np.maximum(shares, 1e-300)), _KEPT, np.random.default_rng(0))
    plane = plane_population().with_rigs(within_plane=own_plane, along_normal=own)
    return LearnedEvidence(
        posterior=EvidencePosterior(
            hyperparameters=population.draws[rows],
            plane_hyperparameters=plane.posterior().hyperparameters if own or own_plane else None,
            fingerprint=evidence_fingerprint((*own, *plane_rigs(), *own_plane), laws=(SPRINGS,)),
            shipped_fingerprint=shipped_fingerprint(),
            sources=learned_sources(shipped_sources(), sources),
        ),
        scores=(*_scores(population, shipped, own), *_plane_scores(plane, own_plane)),
        effective_draws=effective_number(shares),
        effective_draws_within_plane=plane.effective_draws,
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
        name="shipped tests, by the other shipped ones", found=blind_calibration(), rival=mean_ratio_calibration()
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


def _plane_scores(population: PlanePopulation, own: tuple[TestedRig, ...]) -> tuple[EvidenceScore, ...]:
    """Blind scores of the shipped tests within the plane, and with own ones there of these and of all."""
    alone = EvidenceScore(
        name="shipped tests within the plane, by the other shipped ones",
        found=plane_calibration(),
        rival=mean_ratio_calibration(rigs=plane_rigs()),
    )
    if not own:
        return (alone,)
    every, rival = plane_calibration(population), mean_ratio_calibration(rigs=population.rigs)
    names = {rig.name for rig in own}
    unseen = EvidenceScore(
        name="own tests within the plane, by the shipped ones alone",
        found=prediction_of_others(plane_posterior(), own),
        rival=rival.of_rigs(lambda rig: rig in names),
    )
    parts = (
        ("shipped tests within the plane, by all others", lambda rig: rig not in names),
        ("own tests within the plane, by all others", lambda rig: rig in names),
    )
    return (
        alone,
        unseen,
        *(EvidenceScore(name=name, found=every.of_rigs(some), rival=rival.of_rigs(some)) for name, some in parts),
    )
