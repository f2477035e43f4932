"""Posterior of the hyperparameters given the published tests: draws by friction model, shipped as data."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.prediction.closures import CLOSURES, Closure
from sonolube.prediction.evidence import REFERENCE_DECAY_LENGTH, TestedRig, published_rigs
from sonolube.prediction.hierarchy import HYPERPARAMETERS, POPULATION_PRIOR, Prior, RigLikelihood, standard_normals
from sonolube.prediction.wear import WEAR_HYPERPARAMETERS, WearPosterior, published_wear
from sonolube.storage.files import write_atomically

LEARNED_FILE: Final = "learned.json"
"""Name of the data in this package."""

PRIOR_DRAWS: Final = 16384
"""Evenly spread draws from the prior, with which rigs are left out."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Posterior:
    """Posterior of one friction model.

    Parameters
    ----------
    closure : Closure
    hyperparameters : ndarray, shape (h, 6)
        Draws, equally probable: logarithms, in the order of `HYPERPARAMETERS`.
    """

    closure: Closure
    hyperparameters: Floats

    def decay_length(self) -> tuple[float, float]:
        """Median of the decay length of a worn contact on a further rig, in m, and the deviation of its logarithm."""
        kappa, tau_l = self.hyperparameters[:, 1], self.hyperparameters[:, 3]
        median = REFERENCE_DECAY_LENGTH * float(np.exp(np.median(kappa)))
        return median, float(np.sqrt(np.var(kappa) + np.mean(np.exp(2 * tau_l))))


@dataclass(frozen=True, kw_only=True, slots=True)
class Learned:
    """Posterior distribution given the published tests.

    Parameters
    ----------
    friction : Posterior
        Of the friction model that predicts.
    compared : tuple of Posterior
        Of all friction models that a test plan tells apart.
    wear : WearPosterior
    """

    friction: Posterior
    compared: tuple[Posterior, ...]
    wear: WearPosterior


@cache
def learned() -> Learned:
    """Posterior as shipped with the package.

    Returns
    -------
    Learned
    """
    content = json.loads(files(__package__).joinpath(LEARNED_FILE).read_text(encoding="utf-8"))
    known = {closure.name: closure for closure in CLOSURES}
    compared = tuple(
        Posterior(
            closure=known[name], hyperparameters=np.column_stack([entry["draws"][each] for each in HYPERPARAMETERS])
        )
        for name, entry in content["friction"].items()
    )
    wear = np.column_stack([content["wear"]["draws"][each] for each in WEAR_HYPERPARAMETERS])
    return Learned(friction=compared[0], compared=compared, wear=WearPosterior(hyperparameters=wear))


def write_learned(path: Path, *, friction: Mapping[str, Floats], wear: Floats) -> None:
    """Write the draws of each friction model, and those for wear, with the fingerprint of the tests."""
    content = {
        "evidence": evidence_fingerprint(),
        "friction": {name: {"draws": _columns(HYPERPARAMETERS, draws)} for name, draws in friction.items()},
        "wear": {"draws": _columns(WEAR_HYPERPARAMETERS, wear)},
    }
    write_atomically(path, json.dumps(content).replace("], ", "],\n") + "\n")  # one column a line


def evidence_fingerprint() -> str:
    """Hash of the published tests and the priors, by which stale data are recognised."""
    numbers: list[Any] = [[closure.name, *np.round(np.ravel(POPULATION_PRIOR.of(closure)), 6)] for closure in CLOSURES]
    numbers += [_digits(rig) for rig in published_rigs()]
    numbers += [[pair.name, *np.round(pair.wear_rate_ratio, 6), pair.uncertainty] for pair in published_wear()]
    return sha256(repr([list(map(str, row)) for row in numbers]).encode()).hexdigest()[:16]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Population:
    """Draws from the prior of one friction model with their likelihoods, by which rigs are left out at no cost.

    Parameters
    ----------
    closure : Closure
    draws : ndarray, shape (h, 6)
        From the prior, evenly spread.
    log_likelihoods : ndarray, shape (h, r)
        Of each draw and each rig.
    """

    closure: Closure
    draws: Floats
    log_likelihoods: Floats

    @classmethod
    def of(cls, closure: Closure, rigs: Sequence[TestedRig], *, prior: Prior = POPULATION_PRIOR) -> "Population":
        """Population of some rigs under a prior."""
        means, deviations = prior.of(closure)
        draws = means + deviations * standard_normals(PRIOR_DRAWS, columns=len(HYPERPARAMETERS), seed=2)
        logs = np.column_stack([RigLikelihood.of(closure, rig)(draws) for rig in rigs])
        return cls(closure=closure, draws=draws, log_likelihoods=logs)

    def posterior(self, *, without: tuple[int, ...] = ()) -> Posterior:
        """Posterior by all rigs but some, by importance resampling of the draws."""
        total = np.delete(self.log_likelihoods, without, axis=1).sum(axis=1)
        share = np.exp(total - np.logaddexp.reduce(total))
        rows = np.random.default_rng(0).choice(share.size, size=share.size, p=share)
        return Posterior(closure=self.closure, hyperparameters=self.draws[rows])


@cache
def published_population() -> Population:
    """Population of the published rigs under the friction model that predicts."""
    return Population.of(CLOSURES[0], published_rigs())


def _columns(names: Sequence[str], draws: Floats) -> dict[str, list[float]]:
    """Columns of draws by name, to four decimals of the logarithm."""
    return {name: np.round(column, 4).tolist() for name, column in zip(names, draws.T, strict=True)}


def _digits(rig: TestedRig) -> list[Any]:
    """Numbers of a rig, rounded to what a rounding error of another processor leaves the same."""
    at = rig.at.conditions
    arrays = (at.vibration_amplitude, at.frequency, at.sliding_speed, at.decay_length, rig.friction_ratio)
    logs = [f"{value:.6g}" for array in (*arrays, rig.uncertainty) for value in array]
    return [rig.name, *logs, rig.at.decay_length_spread, rig.at.amplitude_spread, rig.at.amplitude_factor]
