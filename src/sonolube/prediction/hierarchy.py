"""Hierarchical model of friction ratios: population of rigs, rigs, tests; likelihood, prior, scores of predictions.

For one friction model f with the parameter theta, test i on rig r has the friction ratio

    R_i = f(x_i; theta_r, l_r) + delta_r(x_i) + e_i,    e_i ~ N(0, u_i^2),
    ln theta_r ~ N(mu, tau^2),    ln (l/a)_r ~ N(ln (l_0/a) + kappa, tau_l^2 + s_a^2),
    delta_r = s_r w g_r,  g_r ~ Gaussian process, sigma^2 exp(-d^2 / (2 lambda^2)), d the distance in (ln a, ln v),
    s_r^2 = nu / chi^2_nu.

The decay length l of a worn contact is a quantity of each rig: l_0 is a reference, exp(kappa) the factor on it common
to all rigs, tau_l the scatter between rigs. Where l was measured it takes the place of l_0 exp(kappa), its error that
of tau_l. The discrepancy delta is least without a reduction: a factor of w rises from 0.25 at f = 1 to 1 at
f <= 0.8. Outside the range of the published tests it grows with the distance D from it, in logarithms: that factor is
at least 0.25 + D/2, and sigma is larger by sqrt(1 + D^2). All of it is multiplied by what vibration can do
(`Closure.effect`), so that it vanishes with the amplitude and against fast sliding, however far that is from the
tests. Its scale s_r is heavy-tailed, so that runs of a rig that no parameter explains widen the discrepancy instead of
the noise. The likelihood takes delta as normal; a prediction leaves out of it what physics forbids (`Closure.bounds`).
"""

from dataclasses import dataclass
from functools import cache, lru_cache
from math import erfc, sqrt
from statistics import NormalDist
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers
from sonolube.prediction.evidence import FULL_EFFECT, Closure, Conditions, TestedRig, UncertainConditions

PROBABILITIES: Final = (0.5, 0.8, 0.95)
"""Of the predictive intervals that are told and judged."""

LEVELS: Final = (0.025, 0.1, 0.25, 0.5, 0.75, 0.9, 0.975)
"""Ends of these intervals and the median, as probabilities, in rising order."""


def central_interval(draws: Floats, probability: float) -> tuple[Floats, Floats]:
    """Ends of the interval between equal tails.

    `draws` has shape (draws, ...). Shape (...).
    """
    low, high = np.quantile(draws, [(1 - probability) / 2, (1 + probability) / 2], axis=0)
    return low, high


def sorted_quantiles(ordered: Floats, probabilities: ArrayLike) -> Floats:
    """Quantiles along the first axis of sorted draws, equal to those of `numpy.quantile` in a fifth of its time."""
    places = np.asarray(probabilities, dtype=np.float64) * (len(ordered) - 1)
    below = places.astype(np.intp)
    low, high = ordered[below], ordered[np.minimum(below + 1, len(ordered) - 1)]
    share = (places - below).reshape(-1, *[1] * (ordered.ndim - 1))
    return np.where(share < 0.5, low + (high - low) * share, high - (high - low) * (1 - share))


def continuous_ranked_probability_score(draws: Floats, measured: float) -> float:
    r"""Continuous ranked probability score (CRPS): 0 for a certain and right prediction, in the unit of the quantity.

    .. math:: \langle |X - y| \rangle - \tfrac12 \langle |X - X'| \rangle

    over independent draws X and X'.

    Source: T. Gneiting and A. E. Raftery, J. Am. Stat. Assoc. 102, 359 (2007). doi:10.1198/016214506000001437
    """
    ordered, n = np.sort(draws), draws.size
    spread = np.sum((2 * np.arange(1, n + 1) - n - 1) * ordered) / n**2
    return float(np.mean(np.abs(ordered - measured)) - spread)


def interval_score(draws: Floats, measured: float, *, probability: float = 0.8) -> float:
    r"""Interval score: width of the central interval, and a penalty for what lies outside it.

    .. math:: (h - l) + \frac{2}{1 - p}\left[(l - y)_+ + (y - h)_+\right]

    Source: T. Gneiting and A. E. Raftery, J. Am. Stat. Assoc. 102, 359 (2007), equation 43.
    """
    low, high = central_interval(draws, probability)
    outside = max(float(low) - measured, 0.0) + max(measured - float(high), 0.0)
    return float(high - low) + 2 / (1 - probability) * outside


def binomial_interval(successes: int, trials: int) -> tuple[float, float]:
    """95 % interval of a share by Clopper and Pearson."""
    from scipy.stats import binomtest

    found = binomtest(successes, trials).proportion_ci(0.95)
    return float(found.low), float(found.high)


HYPERPARAMETERS: Final = (
    *("parameter", "length_factor", "parameter_spread", "length_spread"),
    *("discrepancy", "correlation_length"),
)
"""Their logarithms are the columns of every array of hyperparameters: mu, kappa, tau, tau_l, sigma, lambda."""

OWN_DEVIATES: Final = 3
"""Number of standard normal deviates of one rig: of ln theta, of ln l/a, of the scale of the discrepancy."""

_MIN_DISCREPANCY: Final = 0.25  # share of it without a reduction
_PER_DISTANCE: Final = 0.5  # rise of that share with the distance from the published tests
_FARTHEST: Final = 7.0  # deviates of the scale of the discrepancy, whose degrees of freedom nu are 4
_NODES: Final = 64  # of the integral over what one rig has of its own
_PARAMETERS: Final = np.linspace(-5.0, 5.0, 81)  # of ln theta from its prior median, where f is tabulated
_LENGTHS: Final = np.linspace(-5.0, 5.0, 81)  # of the logarithm of the factor on the decay length, likewise
_BATCH: Final = 256  # rows of hyperparameters at a time, to bound memory


@dataclass(frozen=True, kw_only=True, slots=True)
class Prior:
    """Lognormal priors of the hyperparameters other than the parameter: median, and deviation of the logarithm.

    Fields are named as in `HYPERPARAMETERS`; `parameter_deviation` is that of the logarithm of the parameter, by the
    friction model where None.
    """

    length_factor: tuple[float, float] = (1.0, 0.7)
    parameter_spread: tuple[float, float] = (0.3, 0.6)
    length_spread: tuple[float, float] = (0.7, 0.5)
    discrepancy: tuple[float, float] = (0.08, 0.5)
    correlation_length: tuple[float, float] = (0.7, 0.6)
    parameter_deviation: float | None = None

    def of(self, closure: Closure) -> tuple[Floats, Floats]:
        """Means and standard deviations of the normal prior of the logarithms, each of shape (6,)."""
        others = [getattr(self, name) for name in HYPERPARAMETERS[1:]]
        means = np.log([closure.median, *(median for median, _ in others)])
        own = closure.spread if self.parameter_deviation is None else self.parameter_deviation
        return means, np.array([own, *(deviation for _, deviation in others)])


POPULATION_PRIOR: Final[Prior] = Prior()
"""Prior with decay lengths unknown: weak, and the same for every way that was compared."""


@lru_cache(maxsize=8)
def standard_normals(count: int, *, columns: int, seed: int) -> Floats:
    r"""Standard normal numbers that fill the space more evenly than random ones.

    Shape (count, columns). Not writable, since it is kept for the next call.

    Additive recurrence :math:`u_{nk} = u_{0k} + n\, g^{-k} \bmod 1` with the real root g > 1 of
    :math:`g^{d+1} = g + 1` in d dimensions, and the normal quantiles of u.

    Source: H. Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, SIAM 1992, chapter 3.
    """
    root = 2.0
    for _ in range(50):
        root = (1 + root) ** (1 / (columns + 1))
    steps = root ** -np.arange(1.0, columns + 1)
    shift = np.random.default_rng(seed).random(columns)
    shares = (shift + np.arange(1, count + 1)[:, None] * steps) % 1.0
    quantile = (
        NormalDist().inv_cdf
    )  # of the standard library, since importing scipy.special takes as long as predicting
    normals = np.array([quantile(share) for share in shares.ravel().tolist()]).reshape(shares.shape)
    normals.flags.writeable = False
    return normals


_NORMAL_GRID: Final = np.linspace(-8.0, 8.0, 4097)
_LEAST_DEVIATION: Final = 1e-12  # in place of none


@cache
def _normal_shares() -> Floats:
    """Distribution function of the standard normal distribution on its grid."""
    return np.array([0.5 * erfc(-z / sqrt(2)) for z in _NORMAL_GRID.tolist()])


def bounded_normals(
    mean: Floats, deviation: Floats, normals: Floats, *, low: Floats | float, high: Floats | float
) -> Floats:
    r"""Normally distributed numbers given that they lie between bounds, rising with standard normal deviates.

    All arguments broadcast; `high` may be infinite. A mean far outside gives the bound next to it.

    .. math:: m - s\,\Phi^{-1}\left[b + \Phi(-z)\,(c - b)\right], \qquad
              b = \Phi\frac{m - h}{s}, \quad c = \Phi\frac{m - g}{s}

    between g and h, with the distribution function interpolated: shares to 1e-6, deviates beyond 8 left out.
    """
    side = np.maximum(deviation, _LEAST_DEVIATION)
    above = _normal_share((mean - high) / side)
    found = above + _normal_share(-normals) * (_normal_share((mean - low) / side) - above)
    return np.clip(mean - side * np.interp(found, _normal_shares(), _NORMAL_GRID), low, high)


def bounded_share(
    mean: Floats, deviation: Floats, value: float, *, low: Floats | float, high: Floats | float
) -> Floats:
    """Share of the numbers of `bounded_normals` that are no larger than a value."""
    side = np.maximum(deviation, _LEAST_DEVIATION)
    above, all_of_them = _normal_share((mean - high) / side), _normal_share((mean - low) / side)
    between = np.maximum(all_of_them - above, 0.0)
    certain = np.where(np.clip(mean, low, high) <= value, 1.0, 0.0)
    share = (all_of_them - _normal_share((mean - np.clip(value, low, high)) / side)) / np.maximum(between, 1e-9)
    share = np.where(np.asarray(low) > value, 0.0, np.where(np.asarray(high) <= value, 1.0, share))
    return np.where(between > 1e-9, share, certain)


def _normal_share(deviates: Floats) -> Floats:
    """Distribution function of the standard normal distribution, interpolated."""
    steps = np.clip((np.asarray(deviates) + 8.0) * 256.0, 0.0, 4095.999)
    below, shares = steps.astype(np.intp), _normal_shares()
    return np.asarray(shares[below] + (steps - below) * (shares[below + 1] - shares[below]))


def log_hyperprior(closure: Closure, hyperparameters: Floats, prior: Prior = POPULATION_PRIOR) -> Floats:
    """Logarithm of the prior density, but for a constant, of each row of hyperparameters."""
    means, deviations = prior.of(closure)
    return np.asarray(-0.5 * np.sum(((hyperparameters - means) / deviations) ** 2, axis=-1))


class OwnParameters:
    """Parameters of one rig, from hyperparameters, shape (..., 6), and standard normal deviates, shape (..., 3).

    Attributes
    ----------
    log_parameter : ndarray, shape (...)
        Of the friction model.
    log_factor : ndarray, shape (...)
        On decay length over amplitude.
    log_discrepancy : ndarray, shape (...)
        Of the standard deviation of the discrepancy, s_r sigma.
    """

    def __init__(self, hyperparameters: Floats, deviates: Floats, at: UncertainConditions) -> None:
        mu, kappa, tau, tau_l, sigma, _ = np.moveaxis(hyperparameters, -1, 0)
        self.log_parameter = np.asarray(mu + np.exp(tau) * deviates[..., 0])
        self.log_factor = at.log_length_factor(length_factor=kappa, length_spread=tau_l, deviates=deviates[..., 1])
        self.log_discrepancy = np.asarray(sigma + log_discrepancy_scale(deviates[..., 2]))


def log_discrepancy_scale(deviates: Floats) -> Floats:
    """Logarithm of the scale s = sqrt(nu/chi^2_nu) of the discrepancy of a rig, rising with its normal deviate."""
    return np.interp(deviates, *_scale_table())


@cache
def _scale_table() -> tuple[Floats, Floats]:
    """Deviates, and the logarithm of the scale with 4 degrees of freedom at each.

    With t = chi^2/2 the scale is sqrt(2/t), and the share above it is that of deviates below: exp(-t) (1 + t) = Phi(z).
    """
    deviates = np.linspace(-_FARTHEST, _FARTHEST, 2801)
    shares = np.array([0.5 * erfc(-z / sqrt(2)) for z in deviates.tolist()])
    low, high = np.full(shares.shape, 1e-12), np.full(shares.shape, 60.0)
    for _ in range(60):
        middle = np.sqrt(low * high)
        above = np.exp(-middle) * (1 + middle) > shares
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return deviates, 0.5 * np.log(2 / low)


def squared_distances(one: Conditions, other: Conditions) -> Floats:
    """Squared distances of conditions in the logarithms of amplitude and speed, over which a discrepancy decays.

    Shape (n, m).
    """
    return np.asarray(
        np.log(one.vibration_amplitude[:, None] / other.vibration_amplitude) ** 2
        + np.log(one.sliding_speed[:, None] / other.sliding_speed) ** 2
    )


class RigLikelihood:
    """Likelihood of the tests of one rig under one friction model, marginalised over the parameters of the rig.

    Parameters
    ----------
    closure : Closure
    rig : TestedRig
    """

    def __init__(self, closure: Closure, rig: TestedRig) -> None:
        self.closure, self.rig = closure, rig
        at = rig.at.conditions.scaled(decay_length=np.exp(_LENGTHS)[:, None])
        self.table = closure.ratio(np.log(closure.median) + _PARAMETERS[:, None, None], at)
        self.deviates = standard_normals(_NODES, columns=OWN_DEVIATES, seed=1)

    def __call__(self, hyperparameters: Floats) -> Floats:
        """Logarithm of the likelihood of each row of hyperparameters.

        Parameters
        ----------
        hyperparameters : ndarray, shape (h, 6)
            Logarithms, in the order of `HYPERPARAMETERS`.

        Returns
        -------
        ndarray, shape (h,)
        """
        batches = range(0, len(hyperparameters), _BATCH)
        return np.concatenate([self._batch(hyperparameters[start : start + _BATCH]) for start in batches])

    def _batch(self, hyperparameters: Floats) -> Floats:
        """Logarithm of the likelihood of not too many rows."""
        at = self.rig.at
        own = OwnParameters(hyperparameters[:, None], self.deviates, at)
        ratio = self._ratios(own)
        residual = self.rig.friction_ratio - ratio
        effect = self.closure.effect(
            own.log_parameter[..., None], at.conditions.scaled(decay_length=np.exp(own.log_factor)[..., None])
        )
        covariance = covariance_of_tests(
            discrepancy_deviation(ratio, at.conditions, log_discrepancy=own.log_discrepancy, effect=effect),
            self.rig,
            log_length=hyperparameters[:, None, 5],
        )
        return np.asarray(np.logaddexp.reduce(log_normal_density(residual, covariance), axis=1) - np.log(_NODES))

    def _ratios(self, own: OwnParameters) -> Floats:
        """Friction ratios, shape (h, j, n), bilinear in the table."""
        i, right = _place(own.log_parameter - np.log(self.closure.median), _PARAMETERS)
        k, up = _place(own.log_factor, _LENGTHS)
        low = self.table[i, k] * (1 - right) + self.table[i + 1, k] * right
        high = self.table[i, k + 1] * (1 - right) + self.table[i + 1, k + 1] * right
        return np.asarray(low * (1 - up) + high * up)


def _place(values: Floats, grid: Floats) -> tuple[Integers, Floats]:
    """Index of the grid point below each value, and the share of the step above it, with an axis for tests."""
    steps = np.clip((values - grid[0]) / (grid[1] - grid[0]), 0, grid.size - 1.001)
    below = steps.astype(int)
    return below, (steps - below)[..., None]


def covariance_of_tests(deviation: Floats, rig: TestedRig, *, log_length: Floats) -> Floats:
    """Covariance of the measured ratios of a rig about those of a friction model.

    `deviation`, of the discrepancy, has shape (..., n). Shape (..., n, n).
    """
    at = rig.at.conditions
    near = discrepancy_correlation(at, at, log_length=log_length)
    return np.asarray(near * deviation[..., :, None] * deviation[..., None, :] + np.diag(rig.uncertainty**2))


def discrepancy_correlation(one: Conditions, other: Conditions, *, log_length: ArrayLike) -> Floats:
    """Correlation exp(-d^2/(2 lambda^2)) of the discrepancy, shape (..., n, m), for each correlation length."""
    inverse = np.exp(-2 * np.asarray(log_length))[..., None, None]
    return np.asarray(np.exp(-0.5 * squared_distances(one, other) * inverse))


def discrepancy_deviation(ratio: Floats, at: Conditions, *, log_discrepancy: Floats, effect: Floats | float) -> Floats:
    """Standard deviation of the discrepancy at conditions; `ratio` and `effect` have shape (..., n)."""
    distance = at.distance()
    least = np.minimum(_MIN_DISCREPANCY + _PER_DISTANCE * distance, 1.0)
    share = np.clip((1 - ratio) / FULL_EFFECT, least, 1.0) * np.sqrt(1 + distance**2) * effect
    return np.asarray(np.exp(log_discrepancy)[..., None] * share)


def log_normal_density(residual: Floats, covariance: Floats) -> Floats:
    """Logarithm of the density of a multivariate normal distribution.

    `residual` has shape (..., n). `covariance` has shape (..., n, n). Shape (...).
    """
    factor = np.linalg.cholesky(covariance)
    scaled = np.linalg.solve(factor, residual[..., None])[..., 0]
    logs = np.log(np.diagonal(factor, axis1=-2, axis2=-1))
    return np.asarray(-0.5 * np.sum(scaled**2 + np.log(2 * np.pi), axis=-1) - np.sum(logs, axis=-1))
