"""Wear under vibration by pair of materials: published ratios, their population, and its predictions."""

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.published import si_value

WEAR_HYPERPARAMETERS: Final = ("wear_rate_ratio", "pair_spread", "test_spread")
"""Their logarithms: mean M of ln ratio over pairs, its deviation T between pairs, and s between tests of a pair."""

WEAR_PRIOR: Final = ((np.log(0.7), np.log(0.5), np.log(0.1)), (0.7, 0.7, 0.7))
"""Means and standard deviations of the normal prior of these logarithms."""

_PRINTED: Final = 0.02  # standard uncertainty of ln of a ratio of printed wear rates, from their digits
_IN_WORDS: Final = 0.2  # of "no reduction", taken as a ratio of 1


@dataclass(frozen=True, kw_only=True, slots=True)
class WearPair:
    """Wear with vibration over that without, of one pair of materials.

    Parameters
    ----------
    name : str
        Pin on disc.
    wear_rate_ratio : ndarray, shape (n,)
        Of each test. []
    uncertainty : float
        Standard uncertainty of its logarithm as printed.
    source : str
    """

    name: str
    wear_rate_ratio: Floats
    uncertainty: float
    source: str


@cache
def published_wear() -> tuple[WearPair, ...]:
    """Pairs of materials worn with and without vibration, D sections 2.3 to 2.5.

    Returns
    -------
    tuple of WearPair

    Notes
    -----
    For both pairs with a titanium disc D states in words that wear was not reduced; that is a ratio of 1, uncertain.
    """
    speeds = [1 - si_value(f"table-2.5-wear_reduction-{row}") for row in (1, 2, 3)]
    distances = [1 - si_value(f"table-2.7-wear_reduction-{row}") for row in (1, 2, 3)]
    pairs = [("stainless steel on aluminium", [*speeds, *distances], _PRINTED, "Tables 2.5 and 2.7")]
    pairs += [
        (name, [1 - si_value(f"table-2.14-wear_reduction-{row}")], _PRINTED, "Table 2.14")
        for name, row in (
            ("stainless steel on stainless steel", 2),
            ("ceramic on M50 tool steel", 5),
            ("M50 tool steel on M50 tool steel", 6),
        )
    ]
    pairs += [
        (name, [1.0], _IN_WORDS, "Table 2.14, in words")
        for name in ("stainless steel on titanium", "titanium on titanium")
    ]
    return tuple(
        WearPair(name=name, wear_rate_ratio=np.array(ratios), uncertainty=uncertainty, source=source)
        for name, ratios, uncertainty, source in pairs
    )


def log_wear_posterior(hyperparameters: Floats, pairs: tuple[WearPair, ...]) -> Floats:
    r"""Logarithm of the posterior density, but for a constant, of rows of `WEAR_HYPERPARAMETERS`.

    Parameters
    ----------
    hyperparameters : ndarray, shape (h, 3)
    pairs : tuple of WearPair

    Returns
    -------
    ndarray, shape (h,)

    Notes
    -----
    The logarithms of the n ratios of a pair are normal about the mean of the pair with the variance s^2 + u^2, and the
    means of pairs about M with T^2, so that those of one pair have the covariance :math:`T^2 + (s^2+u^2)\,\delta_{ij}`.
    """
    mean, between, within = hyperparameters.T
    centres, deviations = np.array(WEAR_PRIOR)
    total = -0.5 * np.sum(((hyperparameters - centres) / deviations) ** 2, axis=1)
    for pair in pairs:
        residual = np.log(pair.wear_rate_ratio) - mean[:, None]
        own, shared, n = np.exp(2 * within) + pair.uncertainty**2, np.exp(2 * between), pair.wear_rate_ratio.size
        alone = np.sum(residual**2, axis=1) / own
        together = shared * np.sum(residual, axis=1) ** 2 / (own * (own + n * shared))
        total += -0.5 * (alone - together + (n - 1) * np.log(own) + np.log(own + n * shared))
    return np.asarray(total)


@dataclass(frozen=True, kw_only=True, slots=True)
class WearPosterior:
    """Draws of the hyperparameters of wear.

    Parameters
    ----------
    hyperparameters : ndarray, shape (h, 3)
        Equally probable: logarithms, in the order of `WEAR_HYPERPARAMETERS`.
    """

    hyperparameters: Floats

    def wear_rate_ratios(self, count: int, *, measured: Floats | None = None, seed: int = 0) -> Floats:
        """Draws of the mean wear rate ratio of a pair of materials that is none of the published.

        Parameters
        ----------
        count : int
        measured : ndarray, shape (n,)
            Own ratios of the pair, if any; each is one test. []
        seed : int

        Returns
        -------
        ndarray, shape (count,)
        """
        own_ratios = np.empty(0) if measured is None else measured
        rng = np.random.default_rng(seed)
        mean, between, within = self.hyperparameters[rng.integers(0, len(self.hyperparameters), count)].T
        shared, own = np.exp(2 * between), np.exp(2 * within)
        share = own_ratios.size * shared / (own_ratios.size * shared + own)
        if own_ratios.size:
            mean = mean + share * (np.log(own_ratios).mean() - mean)
        return np.asarray(np.exp(mean + np.sqrt(shared * (1 - share)) * rng.standard_normal(count)))
