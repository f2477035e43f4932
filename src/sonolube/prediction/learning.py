"""Posterior of the hyperparameters, sampled with emcee: `python -m sonolube.prediction.learning` writes it.

emcee is a sampler of the test environment; nothing else in the package needs it, and this module imports it when run.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.prediction.evidence import CLOSURES, Closure, TestedRig, published_rigs
from sonolube.prediction.hierarchy import POPULATION_PRIOR, RigLikelihood, log_hyperprior
from sonolube.prediction.posterior import LEARNED_FILE, write_learned
from sonolube.prediction.wear import WEAR_PRIOR, log_wear_posterior, published_wear

__all__: list[str] = []

_WALKERS: Final = 32
_DRAWS: Final = 1024  # kept of each posterior


def sampled_hyperparameters(
    closure: Closure, rigs: tuple[TestedRig, ...], *, steps: int = 3000, seed: int = 0
) -> Floats:
    """Draws from the posterior of one friction model, shape (draws, 6), the first third of the steps left out."""
    likelihoods = [RigLikelihood(closure, rig) for rig in rigs]

    def log_density(rows: Floats) -> Floats:
        prior = log_hyperprior(closure, rows)
        return np.asarray(prior + np.sum([likelihood(rows) for likelihood in likelihoods], axis=0))

    return ensemble_draws(log_density, POPULATION_PRIOR.of(closure), steps=steps, seed=seed)


def ensemble_draws(
    log_density: Callable[[Floats], Floats], start: tuple[Floats, Floats], *, steps: int, seed: int
) -> Floats:
    """Draws of emcee's affine-invariant ensemble, thinned to some thousand.

    Shape (draws, dimensions).

    Source: D. Foreman-Mackey, D. W. Hogg, D. Lang and J. Goodman, PASP 125, 306 (2013). doi:10.1086/670067
    """
    import emcee

    means, deviations = start
    rng = np.random.default_rng(seed)
    walkers = means + 0.5 * deviations * rng.standard_normal((_WALKERS, len(means)))
    sampler = emcee.EnsembleSampler(_WALKERS, len(means), log_density, vectorize=True)
    sampler.random_state = np.random.RandomState(seed).get_state()
    sampler.run_mcmc(walkers, steps)
    draws = np.asarray(sampler.get_chain(discard=steps // 3, flat=True))
    return draws[rng.choice(len(draws), size=min(_DRAWS, len(draws)), replace=False)]


def learn(path: Path) -> None:
    """Sample all posteriors and write what was learned."""
    friction = {closure.name: sampled_hyperparameters(closure, published_rigs()) for closure in CLOSURES}
    centres, deviations = np.array(WEAR_PRIOR)
    wear = ensemble_draws(
        lambda rows: log_wear_posterior(rows, published_wear()), (centres, deviations), steps=3000, seed=0
    )
    write_learned(path, friction=friction, wear=wear)


if __name__ == "__main__":
    learn(Path(__file__).parent / LEARNED_FILE)
