"""Scores of predictive distributions given as draws: coverage, CRPS and interval score."""

from typing import Final

import numpy as np

from sonolube.checks import Floats

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
