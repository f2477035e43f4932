"""Simulation-based calibration: ranks of true parameters in posteriors of tests generated from the prior."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import logsumexp
from scipy.stats import kstest

from reliability.study import Measure, Record, Study
from sonolube.checks import Floats
from sonolube.prediction.evidence import CLOSURES, Closure, TestedRig, published_rigs
from sonolube.prediction.hierarchy import (
    HYPERPARAMETERS,
    OWN_DEVIATES,
    POPULATION_PRIOR,
    OwnParameters,
    covariance_of_tests,
    discrepancy_deviation,
)
from sonolube.prediction.posterior import Population
from sonolube.prediction.predictive import ratio_draws

_LEVEL = 0.05  # of all tests of uniformity together
_FEWEST = 20  # effective draws, below which a posterior is too coarse for a rank
_NEW_RIG = "A"


def _trial(seed: int) -> Record:
    rng = np.random.default_rng(seed)
    closure = CLOSURES[seed % len(CLOSURES)]
    means, deviations = POPULATION_PRIOR.of(closure)
    true = means + deviations * rng.standard_normal(means.size)
    rigs = {rig.name: _generated(closure, rig, true, rng) for rig in published_rigs()}
    unseen = rigs.pop(_NEW_RIG)
    population = Population.of(closure, tuple(rigs.values()))
    total = population.log_likelihoods.sum(axis=1)
    weights = np.exp(total - logsumexp(total))
    record: dict[str, object] = {"closure": closure.name, "effective_draws": float(1 / np.sum(weights**2))}
    record |= {
        name: float(weights @ (column < value))
        for name, column, value in zip(HYPERPARAMETERS, population.draws.T, true, strict=True)
    }
    predicted = ratio_draws(population.posterior(), unseen.at, count=2000, seed=seed)[:, 0]
    measured = predicted + unseen.uncertainty[0] * rng.standard_normal(predicted.size)
    return record | {"prediction": float(np.mean(measured < unseen.friction_ratio[0]))}


def _generated(closure: Closure, rig: TestedRig, hyperparameters: Floats, rng: np.random.Generator) -> TestedRig:
    """Rig of the same conditions with friction ratios drawn from the model."""
    own = OwnParameters(hyperparameters, rng.standard_normal(OWN_DEVIATES), rig.at)
    at = rig.at.conditions.scaled(decay_length=np.exp(own.log_factor))
    ratio = closure.ratio(own.log_parameter, at)
    exact = replace(rig, uncertainty=np.full(ratio.size, 1e-6))
    deviation = discrepancy_deviation(
        ratio, rig.at.conditions, log_discrepancy=own.log_discrepancy, effect=closure.effect(own.log_parameter, at)
    )
    covariance = covariance_of_tests(deviation, exact, log_length=np.asarray(hyperparameters[5]))
    generated = ratio + np.linalg.cholesky(covariance) @ rng.standard_normal(ratio.size)
    if rig.name == _NEW_RIG:
        generated = np.maximum(generated, 0.0)  # as predictions are; the likelihood has no such limit
    measured = generated + rig.uncertainty * rng.standard_normal(ratio.size)
    return replace(rig, friction_ratio=measured)


def _measures(records: Sequence[Record]) -> list[Measure]:
    fine = [record for record in records if float(str(record["effective_draws"])) >= _FEWEST]
    names = (*HYPERPARAMETERS, "prediction")
    measures = [
        Measure(
            label="posteriors fine enough for a rank",
            value=f"{len(fine)} of {len(records)}",
            bar="at least 95 %",
            holds=len(fine) >= 0.95 * len(records),
        )
    ]
    for name in names:
        p_value = float(kstest([float(str(record[name])) for record in fine], "uniform").pvalue)
        measures.append(
            Measure(
                label=f"ranks of {name.replace('_', ' ')}: probability of such a deviation from uniform",
                value=f"{p_value:.3f}",
                bar=f"at least {_LEVEL / len(names):.3f}",
                holds=p_value >= _LEVEL / len(names),
            )
        )
    return measures


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    inside = [record for record in records if 0 <= float(str(record["prediction"])) <= 1]
    return [Measure(label="ranks", value=str(len(inside)), bar=str(len(records)), holds=len(inside) == len(records))]


STUDY = Study(
    title="Ranks in posteriors of generated friction tests",
    question="Hyperparameters are drawn from the prior and friction tests generated at the published conditions."
    " The rank of each true value in its posterior, and of an unseen test in its prediction, fails where not uniform.",
    sources=tuple(f"prediction/{name}.py" for name in ("evidence", "hierarchy", "posterior", "predictive")),
    trials=300,
    sample=1,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
