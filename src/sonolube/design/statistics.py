"""Sample statistics of an outcome, mean, standard deviation and quantiles, with confidence intervals by sectioning."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtrit

from sonolube.checks import Floats
from sonolube.errors import InvalidInput

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Probabilities of the quantiles in `SampleStatistics`."""

_CONVERGENCE_THRESHOLD = 0.05  # relative error below which a sample counts as converged


@dataclass(frozen=True, kw_only=True, slots=True)
class IntervalEstimate:
    """Point estimate of a statistic with its confidence interval.

    Parameters
    ----------
    value : float
        Point estimate.
    lower, upper : float
        Limits of the 95 % confidence interval.
    """

    value: float
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, slots=True)
class SampleStatistics:
    """Mean, standard deviation and quantiles of an uncertain outcome.

    Parameters
    ----------
    samples : int
        Number of samples.
    valid_samples : int
        Number of samples with a result, to which the statistics refer.
    mean : IntervalEstimate
    standard_deviation : IntervalEstimate
    quantiles : mapping of float to IntervalEstimate
        By probability, the keys of `QUANTILES`.
    """

    samples: int
    valid_samples: int
    mean: IntervalEstimate
    standard_deviation: IntervalEstimate
    quantiles: Mapping[float, IntervalEstimate]

    @property
    def relative_error(self) -> float:
        """Largest half-width of the intervals of mean, median, 5 and 95 % quantile, over the 90 % range."""
        estimates = (self.mean, *(self.quantiles[probability] for probability in (0.05, 0.5, 0.95)))
        width = self.quantiles[0.95].value - self.quantiles[0.05].value
        return max((each.upper - each.lower) / 2 for each in estimates) / width if width > 0 else 0.0

    @property
    def has_converged(self) -> bool:
        """Whether the relative error is below 5 %."""
        return self.relative_error < _CONVERGENCE_THRESHOLD


def sample_statistics(outcomes: ArrayLike, *, subsequence: NDArray[np.intp]) -> SampleStatistics:
    r"""Mean, standard deviation and quantiles of a sample, with 95 % confidence intervals by sectioning.

    Parameters
    ----------
    outcomes : array_like, shape (samples,)
        NaN where a sample has no result.
    subsequence : ndarray of int, shape (samples,)
        Index of the subsequence that each sample belongs to, as `sobol_sample` returns it.

    Returns
    -------
    SampleStatistics

    Raises
    ------
    InvalidInput
        If fewer than two subsequences have at least two results.

    See Also
    --------
    sobol_sample, sobol_indices

    Notes
    -----
    The point estimate :math:`\hat\theta` is that of the whole sample. Its interval comes from the standard deviation
    :math:`s` of the same statistic over the :math:`K` subsequences, by Student's distribution (sectioning [1]_):

    .. math:: \hat\theta \pm t_{K-1,\,0.975}\, \frac{s}{\sqrt K}

    Subsequences of a scrambled Sobol sequence complement each other, so that the whole sample is more accurate than
    independent ones would be, and the interval is conservative.

    References
    ----------
    .. [1] S. Asmussen, P. W. Glynn, Stochastic Simulation: Algorithms and Analysis, Springer (2007), section III.5.
    """
    values = np.asarray(outcomes, dtype=np.float64)
    sections = [values[(subsequence == each) & np.isfinite(values)] for each in np.unique(subsequence)]
    sections = [section for section in sections if section.size > 1]
    if len(sections) < 2:
        raise InvalidInput("too few samples have a result for statistics: see their reasons, or take more samples")
    valid = np.concatenate(sections)

    def estimate(statistic: Callable[[Floats], Any]) -> IntervalEstimate:
        value = float(statistic(valid))
        by_section = np.array([statistic(section) for section in sections])
        half_width = float(stdtrit(len(sections) - 1, 0.975) * by_section.std(ddof=1) / np.sqrt(len(sections)))
        return IntervalEstimate(value=value, lower=value - half_width, upper=value + half_width)

    return SampleStatistics(
        samples=values.size,
        valid_samples=valid.size,
        mean=estimate(np.mean),
        standard_deviation=estimate(partial(np.std, ddof=1)),
        quantiles=MappingProxyType(
            {probability: estimate(partial(np.quantile, q=probability)) for probability in QUANTILES}
        ),
    )
