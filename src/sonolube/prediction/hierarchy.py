"""Hierarchical model of friction ratios: population of rigs, rigs, tests; its likelihood and its prior.

For one closure with the parameter theta, test i on rig r has the friction ratio

    R_i = f(x_i; theta_r, l_r) + delta_r(x_i) + e_i,    e_i ~ N(0, u_i^2),
    ln theta_r ~ N(mu, tau^2),    ln (a/l)_r ~ N(ln (a/l) - kappa, s_l^2 + s_a^2),
    delta_r = w(f) g_r,    g_r ~ Gaussian process, sigma^2 exp(-d^2 / (2 lambda^2)), d the distance in (ln a, ln v).

The factor exp(kappa) on the decay length l is common to all rigs: l follows from an assumed distribution of heights.
The discrepancy delta vanishes with the reduction, such as without vibration: w rises from 0 at f = 1 to 1 at f <= 0.8.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import logsumexp, ndtri

from sonolube.checks import Floats, Integers
from sonolube.prediction.closures import Closure, Conditions
from sonolube.prediction.evidence import TestedRig

HYPERPARAMETERS: Final = ("parameter", "length_factor", "rig_spread", "discrepancy", "correlation_length")
"""Their logarithms, in this order, are the columns of every array of hyperparameters: mu, kappa, tau, sigma, lambda."""

_MEDIANS: Final = (1.0, 0.1, 0.08, 0.7)  # prior medians of exp(kappa), tau, sigma and lambda
_SPREADS: Final = (0.5, 0.7, 0.5, 0.6)  # and the standard deviations of their logarithms
_FULL_DISCREPANCY: Final = 0.2  # reduction from which the discrepancy is as large as it becomes
_NODES: Final = 64  # of the integral over what one rig has of its own
_PARAMETERS: Final = np.linspace(-5.0, 5.0, 81)  # of ln theta from its prior median, where f is tabulated
_LENGTHS: Final = np.linspace(-3.0, 3.0, 49)  # of the logarithm of the factor on the decay length, likewise
_BATCH: Final = 256  # rows of hyperparameters at a time, to bound memory


def standard_normals(count: int, *, columns: int, seed: int) -> Floats:
    r"""Standard normal numbers that fill the space more evenly than random ones.

    Parameters
    ----------
    count : int
    columns : int
    seed : int
        Of the shift of each column.

    Returns
    -------
    ndarray, shape (count, columns)

    Notes
    -----
    Additive recurrence :math:`u_{nk} = u_{0k} + n\, g^{-k} \bmod 1` with the real root g > 1 of
    :math:`g^{d+1} = g + 1` in d dimensions, and the normal quantiles of u.

    References
    ----------
    .. [1] H. Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, SIAM 1992, chapter 3.
    """
    root = 2.0
    for _ in range(50):
        root = (1 + root) ** (1 / (columns + 1))
    steps = root ** -np.arange(1.0, columns + 1)
    shift = np.random.default_rng(seed).random(columns)
    return np.asarray(ndtri((shift + np.arange(1, count + 1)[:, None] * steps) % 1.0))


def hyperprior(closure: Closure) -> tuple[Floats, Floats]:
    """Means and standard deviations of the normal prior of the logarithms of the hyperparameters.

    Parameters
    ----------
    closure : Closure

    Returns
    -------
    means, deviations : ndarray, shape (5,)
    """
    means = np.log([closure.median, *_MEDIANS])
    return means, np.array([closure.spread, *_SPREADS])


def log_hyperprior(closure: Closure, hyperparameters: Floats) -> Floats:
    """Logarithm of the prior density, but for a constant, of each row of hyperparameters."""
    means, deviations = hyperprior(closure)
    return np.asarray(-0.5 * np.sum(((hyperparameters - means) / deviations) ** 2, axis=-1))


def squared_distances(one: Conditions, other: Conditions) -> Floats:
    """Squared distances of conditions in the logarithms of amplitude and speed, over which a discrepancy decays.

    Parameters
    ----------
    one, other : Conditions
        Of n and of m tests.

    Returns
    -------
    ndarray, shape (n, m)
    """
    return np.asarray(
        np.log(one.vibration_amplitude[:, None] / other.vibration_amplitude) ** 2
        + np.log(one.sliding_speed[:, None] / other.sliding_speed) ** 2
    )


@dataclass(frozen=True, slots=True)
class RigLikelihood:
    """Likelihood of the tests of one rig under one closure, integrated over what the rig has of its own.

    Parameters
    ----------
    closure : Closure
    rig : TestedRig
    deviates : ndarray, shape (j, 2)
        Standard normal deviates of ln theta and of ln (l/a), over which is averaged.
    table : ndarray, shape (p, q, n)
        Friction ratio of each test over logarithms of theta and of the factor on l/a.
    """

    closure: Closure
    rig: TestedRig
    deviates: Floats
    table: Floats

    @classmethod
    def of(cls, closure: Closure, rig: TestedRig) -> "RigLikelihood":
        """Likelihood with the friction ratios tabulated."""
        at = rig.at.conditions.scaled(decay_length=np.exp(_LENGTHS)[:, None])
        table = closure.ratio(np.log(closure.median) + _PARAMETERS[:, None, None], at)
        return cls(closure, rig, standard_normals(_NODES, columns=2, seed=1), table)

    def __call__(self, hyperparameters: Floats) -> Floats:
        """Logarithm of the likelihood of each row of hyperparameters.

        Parameters
        ----------
        hyperparameters : ndarray, shape (h, 5)
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
        mu, kappa, tau, sigma, length = hyperparameters.T
        ratio = self._ratios(
            mu[:, None] + np.exp(tau)[:, None] * self.deviates[:, 0],
            kappa[:, None] + at.log_length_factor + at.length_spread * self.deviates[:, 1],
        )
        residual = self.rig.friction_ratio - ratio
        distances = squared_distances(at.conditions, at.conditions)
        correlated = discrepancy_covariance(distances, log_deviation=sigma, log_length=length)
        room = headroom(ratio)
        covariance = correlated[:, None] * room[..., :, None] * room[..., None, :] + np.diag(self.rig.uncertainty**2)
        return np.asarray(logsumexp(log_normal_density(residual, covariance), axis=1) - np.log(_NODES))

    def _ratios(self, logs: Floats, log_factors: Floats) -> Floats:
        """Friction ratios at logarithms of theta and of the factor on l/a, shape (h, j), bilinear in the table."""
        i, right = _place(logs - np.log(self.closure.median), _PARAMETERS)
        k, up = _place(log_factors, _LENGTHS)
        low = self.table[i, k] * (1 - right) + self.table[i + 1, k] * right
        high = self.table[i, k + 1] * (1 - right) + self.table[i + 1, k + 1] * right
        return np.asarray(low * (1 - up) + high * up)


def _place(values: Floats, grid: Floats) -> tuple[Integers, Floats]:
    """Index of the grid point below each value, and the share of the step above it, with an axis for tests."""
    steps = np.clip((values - grid[0]) / (grid[1] - grid[0]), 0, grid.size - 1.001)
    below = steps.astype(int)
    return below, (steps - below)[..., None]


def discrepancy_covariance(distances: Floats, *, log_deviation: ArrayLike, log_length: ArrayLike) -> Floats:
    """Covariances of the discrepancy for each pair of hyperparameters.

    Parameters
    ----------
    distances : ndarray, shape (n, m)
        By `squared_distances`.
    log_deviation, log_length : array_like, shape (h,)
        Logarithms of standard deviation sigma and correlation length lambda.

    Returns
    -------
    ndarray, shape (h, n, m)
    """
    variance, length = (np.exp(2 * np.asarray(each))[:, None, None] for each in (log_deviation, log_length))
    return np.asarray(variance * np.exp(-0.5 * distances / length))


def headroom(ratio: Floats) -> Floats:
    """Standard deviation of the discrepancy over sigma: 0 without a reduction of friction, 1 from one of 0.2 on. []"""
    return np.clip((1 - ratio) / _FULL_DISCREPANCY, 0.0, 1.0)


def log_normal_density(residual: Floats, covariance: Floats) -> Floats:
    """Logarithm of the density of a multivariate normal distribution.

    Parameters
    ----------
    residual : ndarray, shape (..., n)
    covariance : ndarray, shape (..., n, n)

    Returns
    -------
    ndarray, shape (...)
    """
    factor = np.linalg.cholesky(covariance)
    scaled = np.linalg.solve(factor, residual[..., None])[..., 0]
    logs = np.log(np.diagonal(factor, axis1=-2, axis2=-1))
    return np.asarray(-0.5 * np.sum(scaled**2 + np.log(2 * np.pi), axis=-1) - np.sum(logs, axis=-1))
