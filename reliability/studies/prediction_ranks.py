"""Simulation-based calibration: ranks of true parameters in posteriors of tests generated from the prior."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import kstest

from reliability.study import Measure, Record, Study
from sonolube.checks import Floats
from sonolube.prediction.closures import CLOSURES, Closure
from sonolube.prediction.evidence import TestedRig, published_rigs
from sonolube.prediction.hierarchy import (
    HYPERPARAMETERS,
    discrepancy_covariance,
    headroom,
    hyperprior,
    squared_distances,
)
from sonolube.prediction.posterior import Posterior, prior_draws, rig_log_likelihoods
from sonolube.prediction.predictive import ratio_draws
from sonolube.prediction.stacking import importance_weights

_LEVEL = 0.05  # of all tests of uniformity together
_FEWEST = 20  # effective draws, below which a posterior is too coarse for a rank
_NEW_RIG = "A"


def _trial(seed: int) -> Record:
    rng = np.random.default_rng(seed)
    closure = CLOSURES[seed % len(CLOSURES)]
    means, deviations = hyperprior(closure)
    true = means + deviations * rng.standard_normal(means.size)
    rigs = {rig.name: _generated(closure, rig, true, rng) for rig in published_rigs()}
    unseen = rigs.pop(_NEW_RIG)
    weights = importance_weights(rig_log_likelihoods(closure, tuple(rigs.values())))
    draws = prior_draws(closure)
    record: dict[str, object] = {"closure": closure.name, "effective_draws": float(1 / np.sum(weights**2))}
    record |= {
        name: float(weights @ (column < value))
        for name, column, value in zip(HYPERPARAMETERS, draws.T, true, strict=True)
    }
    rows = rng.choice(len(draws), size=2048, p=weights)
    posterior = Posterior(closure=closure, weight=1.0, hyperparameters=draws[rows])
    predicted = ratio_draws([posterior], unseen.at, count=2000, seed=seed).friction_ratio[:, 0]
    measured = predicted + unseen.uncertainty[0] * rng.standard_normal(predicted.size)
    return record | {"prediction": float(np.mean(measured < unseen.friction_ratio[0]))}


def _generated(closure: Closure, rig: TestedRig, hyperparameters: Floats, rng: np.random.Generator) -> TestedRig:
    """Rig of the same conditions with friction ratios drawn from the model."""
    mu, kappa, tau, sigma, length = hyperparameters
    at = rig.at
    log_parameter = mu + np.exp(tau) * rng.standard_normal()
    log_factor = kappa + at.log_length_factor + at.length_spread * rng.standard_normal()
    ratio = closure.ratio(log_parameter, at.conditions.scaled(decay_length=np.exp(np.array([log_factor]))))
    covariance = discrepancy_covariance(
        squared_distances(at.conditions, at.conditions), log_deviation=np.array([sigma]), log_length=np.array([length])
    )[0]
    deviate = np.linalg.cholesky(covariance + 1e-12 * np.eye(ratio.size)) @ rng.standard_normal(ratio.size)
    generated = ratio + headroom(ratio) * deviate
    if rig.name == _NEW_RIG:
        generated = np.clip(generated, 0.0, 1.0)  # as predictions are; the likelihood has no such limits
    measured = generated + rig.uncertainty * rng.standard_normal(ratio.size)
    return TestedRig(name=rig.name, at=at, friction_ratio=measured, uncertainty=rig.uncertainty)


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
    sources=tuple(f"prediction/{name}.py" for name in ("closures", "evidence", "hierarchy", "predictive", "stacking")),
    trials=300,
    sample=1,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
