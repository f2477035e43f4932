"""Prediction of one rig: draws of its friction ratio, checks of its own runs, and the rigs of one laboratory.

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
from sonolube.prediction.evidence import Conditions, TestedRig, UncertainConditions
from sonolube.prediction.hierarchy import bounded_normals, bounded_share, log_normal_density, standard_normals
from sonolube.prediction.posterior import Posterior, RigDraws, rig_draws, systematic_rows

_FREEDOM: Final = 2.0  # degrees of freedom of the errors of runs
_FEWEST: Final = 4  # runs from which each is checked against the others
_FEW_RUNS: Final = 12  # up to which draws from the population do for that
_COMPARED: Final = 1024  # draws of the prediction that runs are compared with
_LARGEST: Final = 1.4  # ratio that anything else than the prediction may give
_MIN_REPLICATES: Final = 200  # of runs drawn from the prediction
_PRODUCTS: Final = 2e7  # of densities, to bound the time
_CONTRADICTION: Final = 0.05  # probability below which runs contradict the prediction
_OUTLIER: Final = 0.05  # probability, over all runs, below which one disagrees with the others


class RunCheck:
    """Own runs against the prediction before them, and against each other.

    Parameters
    ----------
    before, after : RigDraws
        Draws before and after the runs.
    own : TestedRig
        The runs.

    Attributes
    ----------
    probability : float
        That runs as predicted speak as much against the prediction as these do.
    lows, highs : ndarray, shape (n,)
        95 % interval of each run as predicted before any.
    left_out : ndarray, shape (n,)
        Ratio of each run as predicted by the others; NaN for fewer than four runs.
    outlier_probability : ndarray, shape (n,)
        Two-sided, of each run given the others; 1 for fewer than four runs.
    """

    def __init__(self, before: RigDraws, after: RigDraws, own: TestedRig) -> None:
        count = own.friction_ratio.size
        seen = replace(before.taken(np.arange(min(before.rows.size, _COMPARED))), own=own)
        means = seen.means(own.at.conditions)
        factors = np.asarray(np.linalg.cholesky(seen.covariance(means)))
        self.left_out, self.outlier_probability = np.full(count, np.nan), np.ones(count)
        if count >= _FEWEST:
            self.left_out, deviation = _left_out(before, after, own)
            z = np.abs(own.friction_ratio - self.left_out) / deviation
            from scipy.special import stdtr

            self.outlier_probability = np.asarray(2 * stdtr(count - 1, -z))
        drawn = means + np.einsum("pij,pj->pi", factors, np.random.default_rng(3).standard_normal(means.shape))
        self.probability = _predictive_probability(means, factors, drawn, own)
        lows, self.highs = np.quantile(drawn, [0.025, 0.975], axis=0)
        self.lows = np.maximum(lows, 0.0)

    @property
    def contradicted(self) -> bool:
        """Whether the runs contradict the prediction before them."""
        return self.probability < _CONTRADICTION

    @property
    def outliers(self) -> tuple[int, ...]:
        """Places of the runs that disagree with the others, by Bonferroni's bound over all runs."""
        limit = _OUTLIER / self.outlier_probability.size
        return tuple(int(place) for place in np.flatnonzero(self.outlier_probability < limit))


def student_weights(before: RigDraws, after: RigDraws, own: TestedRig) -> Floats:
    """Weights (nu+1)/(nu+z^2) of the runs under Student's errors; 1 for fewer than four runs.

    z^2 is what the squared deviation of a run from the others exceeds their prediction by, over its squared noise.
    """
    if own.friction_ratio.size < _FEWEST:
        return np.ones(own.friction_ratio.size)
    middle, deviation = _left_out(before, after, own)
    noise = own.uncertainty**2
    z_squared = np.maximum((own.friction_ratio - middle) ** 2 - (deviation**2 - noise), 0.0) / noise
    return np.asarray(np.minimum((_FREEDOM + 1) / (_FREEDOM + z_squared), 1.0))


def _predictive_probability(means: Floats, factors: Floats, drawn: Floats, own: TestedRig) -> float:
    """Probability that runs drawn from the prediction speak as much for anything else as the measured ones do.

    By the ratio of two densities of all runs: that under anything else, and that under the prediction. Anything else
    is, with equal weights, vibration without effect, one ratio whatever the conditions, or a ratio of its own for each
    run, the last two even over 0 to 1.4.
    """
    count = int(np.clip(_PRODUCTS / means.size / means.shape[1], _MIN_REPLICATES, len(drawn)))
    replicates = drawn[np.random.default_rng(4).permutation(len(drawn))[:count]]
    outcomes = np.vstack([own.friction_ratio, replicates])
    predicted = _mixture_log_density(outcomes, means, factors)
    ratio = _log_density_of_anything_else(outcomes, own.uncertainty) - predicted
    return float(max(np.mean(ratio[1:] >= ratio[0]), 1 / count))


def _mixture_log_density(outcomes: Floats, means: Floats, factors: Floats) -> Floats:
    """Logarithm of the mean density of outcomes under normal distributions, shape (outcomes,).

    Each logarithm is a polynomial of second degree in the outcomes, so that all are one product of matrices.
    """
    inverse = np.linalg.inv(factors)
    precision = np.swapaxes(inverse, 1, 2) @ inverse
    linear = np.einsum("pij,pj->pi", precision, means)
    logs = np.log(np.diagonal(factors, axis1=1, axis2=2)).sum(axis=1) + 0.5 * means.shape[1] * np.log(2 * np.pi)
    constant = -0.5 * np.einsum("pi,pi->p", linear, means) - logs
    squares = (outcomes[:, :, None] * outcomes[:, None, :]).reshape(len(outcomes), -1)
    each = -0.5 * squares @ precision.reshape(len(means), -1).T + outcomes @ linear.T + constant
    return np.asarray(np.logaddexp.reduce(each, axis=1) - np.log(len(means)))


def _log_density_of_anything_else(outcomes: Floats, noise: Floats) -> Floats:
    """Logarithm of the density of runs without effect, of one ratio, or of any, shape (outcomes,)."""
    constant = np.linspace(0.0, _LARGEST, 281)
    z = (outcomes[:, None, :] - constant[:, None]) / noise
    logs = np.sum(-0.5 * z**2 - np.log(noise * np.sqrt(2 * np.pi)), axis=2)
    none = logs[:, np.searchsorted(constant, 1.0)]
    one = np.logaddexp.reduce(logs, axis=1) - np.log(constant.size)
    any_ratio = np.full(one.shape, -noise.size * np.log(_LARGEST))
    return np.asarray(np.logaddexp.reduce([none, one, any_ratio], axis=0) - np.log(3))


def _left_out(before: RigDraws, after: RigDraws, own: TestedRig) -> tuple[Floats, Floats]:
    """Mean and standard deviation of each run by the others, over draws weighed without it.

    With the inverse Q of the covariance of all runs, run i deviates from its mean by the others by (Q r)_i/Q_ii, with
    the variance 1/Q_ii, of which the stated noise of the run takes the place of the one that it counts with; a draw
    counts by the inverse of the density that it gives the run. Draws are those before the runs, weighed by all of them;
    of many runs, for which few of these would count, those after.
    """
    assert after.own is not None
    measured = own.friction_ratio
    few = measured.size <= _FEW_RUNS
    draws = replace(before, own=after.own) if few else after
    seen = draws.means(own.at.conditions)
    covariance = draws.covariance(seen)
    precision = np.linalg.inv(covariance)
    variance = 1 / np.diagonal(precision, axis1=1, axis2=2)
    gap = np.einsum("pij,pj->pi", precision, measured - seen) * variance
    logs = 0.5 * gap**2 / variance + 0.5 * np.log(variance)
    if few:
        logs += log_normal_density(measured - seen, covariance)[:, None]
    else:
        logs = np.minimum(logs, np.quantile(logs, 0.98, axis=0))  # truncated importance weights
    weights = np.exp(logs - np.logaddexp.reduce(logs, axis=0))
    middle = np.sum(weights * (measured - gap), axis=0)
    spread = np.sum(weights * (variance + (measured - gap - middle) ** 2), axis=0)
    return middle, np.sqrt(spread - after.own.uncertainty**2 + own.uncertainty**2)


DRAWS: Final = 4000
"""Equally probable outcomes of a prediction, where no other number is asked for."""

_BEFORE: Final = 4096  # draws of the population, against which runs are checked
_ROUNDS: Final = 4  # of weighing runs that disagree with the others


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RigPrediction:
    """Distribution of the friction ratio of one rig at any conditions.

    Parameters
    ----------
    draws : RigDraws
    check : RunCheck or None
        Own runs against the population and against each other; None without runs.
    count : int
        Equally probable outcomes.
    """

    draws: RigDraws
    check: RunCheck | None
    count: int

    def ratios(self, at: Conditions) -> Floats:
        """Friction ratios at conditions, equally probable.

        Shape (count, m). Within the bounds of the closure, but where own tests lie beyond them; one normal deviate of
        the discrepancy a draw, so that curves are smooth.
        """
        fresh = standard_normals(self.count, columns=1, seed=5)
        return self.with_deviates(at, fresh[np.random.default_rng(6).permutation(self.count)])

    def with_deviates(self, at: Conditions, deviates: Floats) -> Floats:
        """Friction ratios with given normal deviates of the discrepancy, shape (count, m) or (count, 1)."""
        mean, deviation = self.draws.normals(at)
        low, high = self.draws.bounds(at)
        rows = np.arange(self.count) % len(mean)
        return bounded_normals(mean[rows], deviation[rows], deviates, low=low[rows], high=high[rows])

    def chances(self, at: Conditions, *, friction_ratio: float) -> Floats:
        """Probability at each of m conditions that the friction ratio is no larger than a value, shape (m,)."""
        mean, deviation = self.draws.normals(at)
        low, high = self.draws.bounds(at)
        return np.asarray(bounded_share(mean, deviation, friction_ratio, low=low, high=high).mean(axis=0))


def rig_prediction(
    posterior: Posterior, at: UncertainConditions, *, count: int, seed: int = 0, own: TestedRig | None = None
) -> RigPrediction:
    """Distribution of the friction ratio of a rig that is none of those learned from.

    Draws from the population are conditioned on the own tests; the discrepancy follows from its conditional
    distribution. Errors of four or more tests are Student's with 2 degrees of freedom, by weights of each test that
    follow from its deviation from the others (expectation maximisation).

    Source: K. L. Lange, R. J. A. Little and J. M. G. Taylor, J. Am. Stat. Assoc. 84, 881 (1989).
    """
    draws = rig_draws(posterior, at, count=count, seed=seed, own=own)
    if own is None:
        return RigPrediction(draws=draws, check=None, count=count)
    before = rig_draws(posterior, at, count=_BEFORE, seed=seed)
    for _ in range(_ROUNDS):
        weights = student_weights(before, draws, own)
        uncertainty = own.uncertainty / np.sqrt(weights)
        assert draws.own is not None
        if np.allclose(uncertainty, draws.own.uncertainty, rtol=0.1):
            break
        draws = rig_draws(posterior, at, count=count, seed=seed, own=replace(own, uncertainty=uncertainty))
    return RigPrediction(draws=draws, check=RunCheck(before, draws, own), count=count)


def ratio_draws(
    posterior: Posterior, at: UncertainConditions, *, count: int, seed: int = 0, own: TestedRig | None = None
) -> Floats:
    """Draws of the friction ratio of a rig at conditions, shape (count, m), as `rig_prediction` has them."""
    return rig_prediction(posterior, at, count=count, seed=seed, own=own).ratios(at.conditions)


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
        return f"published tests and {self.rigs_in_words}"

    @property
    def rigs_in_words(self) -> str:
        """Number of its rigs whose runs entered, in words."""
        count = len(self.taught_by)
        return f"{count} {'rig' if count == 1 else 'rigs'} of the laboratory"

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
