"""Weights of closures by what they predict of rigs that they have not seen."""

from typing import Final

import numpy as np
from scipy.special import logsumexp

from sonolube.checks import Floats

_MIXTURES: Final = 4096


def importance_weights(log_likelihoods: Floats, *, left_out: tuple[int, ...] = ()) -> Floats:
    """Weights of draws of a posterior, or of its prior, that turn it into that of other rigs.

    Parameters
    ----------
    log_likelihoods : ndarray, shape (h, r)
        Of each draw and each rig that counts.
    left_out : tuple of int
        Columns that do not.

    Returns
    -------
    ndarray, shape (h,)
        Sum 1.
    """
    total = np.delete(log_likelihoods, left_out, axis=1).sum(axis=1)
    return np.asarray(np.exp(total - logsumexp(total)))


def unseen_log_densities(log_likelihoods: Floats, *, left_out: tuple[int, ...] = ()) -> Floats:
    """Logarithm of the predictive density of each rig by the others, over draws from the prior.

    Parameters
    ----------
    log_likelihoods : ndarray, shape (h, r)
        Of each draw from the prior and each rig.
    left_out : tuple of int
        Columns that are used nowhere.

    Returns
    -------
    ndarray, shape (r - number left out,)
    """
    rigs = [column for column in range(log_likelihoods.shape[1]) if column not in left_out]
    densities = []
    for rig in rigs:
        weights = importance_weights(log_likelihoods, left_out=(*left_out, rig))
        highest = log_likelihoods[:, rig].max()
        densities.append(highest + np.log(weights @ np.exp(log_likelihoods[:, rig] - highest)))
    return np.array(densities)


def stacking_weights(log_densities: Floats) -> Floats:
    r"""Weights of predictive distributions: posterior mean under a uniform prior.

    Parameters
    ----------
    log_densities : ndarray, shape (k, r)
        Logarithm of the predictive density of each distribution for each unseen rig.

    Returns
    -------
    ndarray, shape (k,)
        Positive, sum 1.

    Notes
    -----
    Stacking maximises the score of the mixture,

    .. math:: \sum_r \ln \sum_k w_k p_k(y_r \mid y_{-r}) ,

    which with a handful of rigs bets on one distribution. The mean of the weights under the density proportional to the
    exponential of that score keeps the others in as far as the rigs leave it open.

    References
    ----------
    .. [1] Y. Yao, A. Vehtari, D. Simpson and A. Gelman, Bayesian Analysis 13, 917 (2018). doi:10.1214/17-BA1091
    """
    count = log_densities.shape[0]
    mixtures = np.random.default_rng(0).dirichlet(np.ones(count), _MIXTURES)
    relative = np.exp(log_densities - log_densities.max(axis=0))
    score = np.log(mixtures @ relative).sum(axis=1)
    return np.asarray(np.exp(score - logsumexp(score)) @ mixtures)
