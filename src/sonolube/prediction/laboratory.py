"""Rigs of one laboratory: what runs of some of them tell of the decay length, and of its scatter, on the next.

The variance of the logarithm of the decay length is split: a share rho is between laboratories, the rest between the
rigs of one laboratory. With the hyperparameters kappa and tau_l of the population,

    kappa_L = kappa + sqrt(rho) tau_l z,    tau_L = sqrt(1 - rho) tau_l,    z ~ N(0, 1),    rho ~ U(0, 1).

A single rig of a laboratory without tests has the distribution of a rig of the population, whatever rho. Draws of each
rig's parameters, conditioned on its runs under the population, are weighed by their density under a laboratory over
that under the population; the mean of these weights is the likelihood of the laboratory.

References
----------
D. W. Hogg, A. D. Myers and J. Bovy, Astrophys. J. 725, 2166 (2010), eq. (5). doi:10.1088/0004-637X/725/2/2166
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.prediction.closures import UncertainConditions
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.posterior import Posterior
from sonolube.prediction.predictive import rig_prediction
from sonolube.prediction.rig_draws import systematic_rows

_LABORATORIES: Final = 8192  # drawn
_KEPT: Final = 2048  # of them after weighing
_RIG_DRAWS: Final = 512  # of the parameters of one rig


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Laboratory:
    """Population of the rigs of one laboratory.

    Parameters
    ----------
    posterior : Posterior
        Whose hyperparameters are those of the laboratory.
    taught_by : tuple of str
        Titles of the rigs whose runs entered.
    contradicting : tuple of str
        Titles of the rigs whose runs contradict every model; they do not enter.
    """

    posterior: Posterior
    taught_by: tuple[str, ...]
    contradicting: tuple[str, ...]

    @property
    def known_from(self) -> str:
        """Tests that the population is known from, in words."""
        count = len(self.taught_by)
        return f"published tests and {count} {'rig' if count == 1 else 'rigs'} of the laboratory"

    @property
    def caveats(self) -> tuple[str, ...]:
        """A sentence on each rig whose runs did not enter."""
        return tuple(
            f"{name}: its runs contradict every model, so that they tell nothing of the laboratory's other rigs"
            for name in self.contradicting
        )


def laboratory(population: Posterior, rigs: Sequence[TestedRig], *, seed: int = 0) -> Laboratory:
    """Population of the rigs of a laboratory from own runs of some of them."""
    laboratories = _drawn(population.hyperparameters, seed=seed)
    logs = np.zeros(len(laboratories))
    taught, contradicting = [], []
    for rig in rigs:
        found = rig_prediction(population, rig.at, count=_RIG_DRAWS, seed=seed, own=rig)
        if found.check is not None and found.check.contradicted:
            contradicting.append(rig.name)
            continue
        taught.append(rig.name)
        own = found.draws.parameters
        some = np.linspace(0, own.log_factor.size - 1, min(_RIG_DRAWS, own.log_factor.size)).astype(int)
        pairs = np.column_stack([own.log_parameter, own.log_factor])[some]
        before = np.logaddexp.reduce(_log_density(pairs, population.hyperparameters, rig.at), axis=0)
        logs += np.logaddexp.reduce(_log_density(pairs, laboratories, rig.at) - before, axis=1)
    rows = systematic_rows(logs, _KEPT, np.random.default_rng(seed + 1))
    return Laboratory(
        posterior=replace(population, hyperparameters=laboratories[rows]),
        taught_by=tuple(taught),
        contradicting=tuple(contradicting),
    )


def _drawn(hyperparameters: Floats, *, seed: int) -> Floats:
    """Hyperparameters of laboratories of the population, shape (laboratories, 6)."""
    rng = np.random.default_rng(seed)
    drawn = hyperparameters[rng.integers(0, len(hyperparameters), _LABORATORIES)].copy()
    between, deviates = rng.random(_LABORATORIES), rng.standard_normal(_LABORATORIES)
    drawn[:, 1] += np.sqrt(between) * np.exp(drawn[:, 3]) * deviates
    drawn[:, 3] += 0.5 * np.log1p(-between)
    return drawn


def _log_density(pairs: Floats, hyperparameters: Floats, at: UncertainConditions) -> Floats:
    """Logarithm, but for a constant, of the density of (ln theta, ln l/a) by each row, shape (rows, pairs).

    A decay length that was measured on the rig says nothing of the laboratory's.
    """
    mu, kappa, tau, tau_l = hyperparameters[:, :4, None].swapaxes(0, 1)
    logs = -0.5 * ((pairs[:, 0] - mu) / np.exp(tau)) ** 2 - tau
    if at.decay_length_spread is None:
        spread = np.hypot(np.exp(tau_l), at.amplitude_spread)
        logs = logs - 0.5 * ((pairs[:, 1] + np.log(at.amplitude_factor) - kappa) / spread) ** 2 - np.log(spread)
    return np.asarray(logs)
