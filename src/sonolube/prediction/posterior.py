"""Posterior of the hyperparameters given the published tests: draws and weights by closure, shipped as data."""

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
from sonolube.files import write_atomically
from sonolube.prediction.closures import CLOSURES, Closure
from sonolube.prediction.evidence import TestedRig, published_rigs
from sonolube.prediction.hierarchy import HYPERPARAMETERS, RigLikelihood, hyperprior, standard_normals
from sonolube.prediction.stacking import importance_weights, stacking_weights, unseen_log_densities
from sonolube.prediction.wear import WEAR_HYPERPARAMETERS, WearPosterior, published_wear

LEARNED_FILE: Final = "learned.json"
"""Name of the data in this package."""

PRIOR_DRAWS: Final = 16384
"""Evenly spread draws from the prior, with which rigs are left out."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Posterior:
    """Posterior of one closure.

    Parameters
    ----------
    closure : Closure
    weight : float
        Of the closure, sum 1 over all.
    hyperparameters : ndarray, shape (h, 5)
        Draws, equally probable: logarithms, in the order of `HYPERPARAMETERS`.
    """

    closure: Closure
    weight: float
    hyperparameters: Floats


@dataclass(frozen=True, kw_only=True, slots=True)
class Learned:
    """What was learned from the published tests.

    Parameters
    ----------
    friction : tuple of Posterior
        By closure.
    wear : WearPosterior
    """

    friction: tuple[Posterior, ...]
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
    friction = tuple(
        Posterior(
            closure=known[name],
            weight=entry["weight"],
            hyperparameters=np.column_stack([entry["draws"][each] for each in HYPERPARAMETERS]),
        )
        for name, entry in content["friction"].items()
    )
    wear = np.column_stack([content["wear"]["draws"][each] for each in WEAR_HYPERPARAMETERS])
    return Learned(friction=friction, wear=WearPosterior(hyperparameters=wear))


def write_learned(path: Path, *, friction: Mapping[str, tuple[float, Floats]], wear: Floats) -> None:
    """Write weight and draws of each closure, and the draws for wear, with the fingerprint of the tests."""
    content = {
        "evidence": evidence_fingerprint(),
        "friction": {
            name: {"weight": round(weight, 4), "draws": _columns(HYPERPARAMETERS, draws)}
            for name, (weight, draws) in friction.items()
        },
        "wear": {"draws": _columns(WEAR_HYPERPARAMETERS, wear)},
    }
    write_atomically(path, json.dumps(content).replace("], ", "],\n") + "\n")  # one column a line


def evidence_fingerprint() -> str:
    """Hash of the published tests and the priors, by which stale data are recognised."""
    numbers: list[Any] = [[closure.name, *np.round(np.ravel(hyperprior(closure)), 6)] for closure in CLOSURES]
    numbers += [_digits(rig) for rig in published_rigs()]
    numbers += [[pair.name, *np.round(pair.wear_rate_ratio, 6), pair.uncertainty] for pair in published_wear()]
    return sha256(repr([list(map(str, row)) for row in numbers]).encode()).hexdigest()[:16]


def posteriors_without(
    log_likelihoods: Mapping[str, Floats], *, left_out: tuple[int, ...] = (), closures: Sequence[Closure] = CLOSURES
) -> tuple[Posterior, ...]:
    """Posteriors and weights by all rigs but some, by importance resampling of draws from the prior.

    Parameters
    ----------
    log_likelihoods : mapping of str to ndarray, shape (h, r)
        By name of the closure, as `published_log_likelihoods` returns them.
    left_out : tuple of int
        Columns of rigs.
    closures : sequence of Closure

    Returns
    -------
    tuple of Posterior
    """
    densities = [unseen_log_densities(log_likelihoods[each.name], left_out=left_out) for each in closures]
    weights = stacking_weights(np.array(densities))
    rng = np.random.default_rng(0)
    found = []
    for closure, weight in zip(closures, weights, strict=True):
        share = importance_weights(log_likelihoods[closure.name], left_out=left_out)
        rows = rng.choice(share.size, size=share.size, p=share)
        found.append(Posterior(closure=closure, weight=float(weight), hyperparameters=prior_draws(closure)[rows]))
    return tuple(found)


def prior_draws(closure: Closure) -> Floats:
    """Draws from the prior of the hyperparameters evenly spread, shape (`PRIOR_DRAWS`, 5)."""
    means, deviations = hyperprior(closure)
    return means + deviations * standard_normals(PRIOR_DRAWS, columns=len(HYPERPARAMETERS), seed=2)


def rig_log_likelihoods(closure: Closure, rigs: Sequence[TestedRig]) -> Floats:
    """Logarithm of the likelihood of each rig at each draw from the prior, shape (h, r)."""
    return np.column_stack([RigLikelihood.of(closure, rig)(prior_draws(closure)) for rig in rigs])


@cache
def published_log_likelihoods() -> Mapping[str, Floats]:
    """Logarithm of the likelihood of each published rig at each draw from the prior, by name of the closure.

    Returns
    -------
    mapping of str to ndarray, shape (h, r)
    """
    return {closure.name: rig_log_likelihoods(closure, published_rigs()) for closure in CLOSURES}


def _columns(names: Sequence[str], draws: Floats) -> dict[str, list[float]]:
    """Columns of draws by name, to four decimals of the logarithm."""
    return {name: np.round(column, 4).tolist() for name, column in zip(names, draws.T, strict=True)}


def _digits(rig: TestedRig) -> list[Any]:
    """Numbers of a rig, rounded to what a rounding error of another processor leaves the same."""
    at = rig.at.conditions
    arrays = (at.vibration_amplitude, at.frequency, at.sliding_speed, at.decay_length, rig.friction_ratio)
    logs = [f"{value:.6g}" for array in (*arrays, rig.uncertainty) for value in array]
    return [rig.name, *logs, rig.at.decay_length_spread, rig.at.amplitude_spread, rig.at.amplitude_factor]
