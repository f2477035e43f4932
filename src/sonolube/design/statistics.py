"""Sample statistics of an outcome with intervals by sectioning, and variance-based sensitivity by Sobol indices."""

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


SUBSEQUENCES = 16
"""Number of consecutive subsequences of a sample, each a digital net itself, for intervals by sectioning."""

_MARGIN = 2.0**-54  # distance from 0 and 1, at which a normal distribution has no finite quantile
_MIN_ROWS = 32
_INTERVAL = (0.025, 0.975)
_RESAMPLED_NUMBERS = 4_000_000  # at a time; bounds the memory of the bootstrap


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SobolIndices:
    """First-order and total-order Sobol indices of an outcome.

    Parameters
    ----------
    first_order : ndarray, shape (inputs,)
        Fraction of the variance that is due to each input alone: its mean reduction were the input known.
    total_order : ndarray, shape (inputs,)
        Fraction of the variance that remains on average were all other inputs known; it exceeds `first_order` by the
        interactions of the input.
    first_order_interval, total_order_interval : ndarray, shape (inputs, 2)
        Limits of the 95 % bootstrap intervals.
    standard_deviation : float
        Standard deviation of the outcome.
    rows : int
        Number of rows of the sample that were used.
    """

    first_order: Floats
    total_order: Floats
    first_order_interval: Floats
    total_order_interval: Floats
    standard_deviation: float
    rows: int


def sobol_sample(inputs: int, *, samples: int, seed: int = 0) -> tuple[Floats, NDArray[np.intp]]:
    """Scrambled Sobol sequence in the unit cube.

    Parameters
    ----------
    inputs : int
        Dimension of the cube.
    samples : int
        Least number of points; rounded up to a power of two.
    seed : int
        Seed of the scrambling.

    Returns
    -------
    points : ndarray, shape (samples, inputs)
        Strictly inside the cube.
    subsequence : ndarray of int, shape (samples,)
        Index of the sixteenth of the sequence that each point belongs to.

    Raises
    ------
    InvalidInput
        If there are no inputs, or fewer than 32 samples.

    See Also
    --------
    saltelli_sample, sample_statistics

    References
    ----------
    .. [1] A. B. Owen, J. Complexity 14, 466 (1998). doi:10.1006/jcom.1998.0487
    """
    if inputs < 1:
        raise InvalidInput(f"inputs must be at least 1, got {inputs}")
    if samples < _MIN_ROWS:
        raise InvalidInput(f"samples must be at least {_MIN_ROWS}, got {samples}")
    power = int(np.ceil(np.log2(samples)))
    from scipy.stats import qmc

    points = qmc.Sobol(d=inputs, rng=np.random.default_rng(seed)).random_base2(power)
    return np.clip(points, _MARGIN, 1 - _MARGIN), np.repeat(np.arange(SUBSEQUENCES), 2**power // SUBSEQUENCES)


def saltelli_sample(inputs: int, *, samples: int, seed: int = 0) -> tuple[Floats, NDArray[np.intp]]:
    r"""Sample matrices A, B and A_B of Saltelli's scheme, from one scrambled Sobol sequence of twice the dimension.

    Parameters
    ----------
    inputs : int
        Number of inputs.
    samples : int
        Least number of rows of each matrix; rounded up to a power of two.
    seed : int
        Seed of the scrambling.

    Returns
    -------
    points : ndarray, shape (inputs + 2, samples, inputs)
        :math:`A`, :math:`B`, then :math:`A_B^{(i)}` for each input: :math:`A` with column i taken from :math:`B`.
    subsequence : ndarray of int, shape (samples,)
        Index of the sixteenth of the sequence that each row belongs to.

    Raises
    ------
    InvalidInput
        If there are no inputs, or fewer than 32 samples.

    See Also
    --------
    sobol_indices, sobol_sample

    References
    ----------
    .. [1] A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010). doi:10.1016/j.cpc.2009.09.018
    """
    both, subsequence = sobol_sample(2 * inputs, samples=samples, seed=seed)
    a, b = both[:, :inputs], both[:, inputs:]
    a_b = np.repeat(a[np.newaxis], inputs, axis=0)
    for i in range(inputs):
        a_b[i, :, i] = b[:, i]
    return np.concatenate([a[np.newaxis], b[np.newaxis], a_b]), subsequence


def sobol_indices(outcomes: ArrayLike, *, resamples: int = 1000, seed: int = 0) -> SobolIndices:
    r"""Sobol indices of an outcome by the estimators of Saltelli (first order) and Jansen (total order).

    Parameters
    ----------
    outcomes : array_like, shape (inputs + 2, samples)
        Outcome at the points of `saltelli_sample`; a row of the sample in which any is NaN is left out.
    resamples : int
        Number of bootstrap resamples.
    seed : int
        Seed of the bootstrap.

    Returns
    -------
    SobolIndices
        Zeros where the outcome does not vary.

    Raises
    ------
    InvalidInput
        If fewer than 32 rows of the sample remain.

    See Also
    --------
    saltelli_sample

    Notes
    -----
    With the outcomes :math:`y` counted from their mean over :math:`A` and :math:`B`,

    .. math::

        S_i \operatorname{Var} y &\approx \frac1n \sum y_B \bigl(y_{A_B^{(i)}} - y_A\bigr)

        S_{Ti} \operatorname{Var} y &\approx \frac1{2n} \sum \bigl(y_A - y_{A_B^{(i)}}\bigr)^2

    (table 2, b and f of [2]_; the latter is that of [1]_ and never negative), with the variance over :math:`A` and
    :math:`B` together. Inputs must be independent. The intervals are percentiles of a bootstrap of the rows, which
    treats them as random; rows of a Sobol sequence fill the cube more evenly, so that the intervals are conservative.

    References
    ----------
    .. [1] M. J. W. Jansen, Comput. Phys. Commun. 117, 35 (1999). doi:10.1016/S0010-4655(98)00154-4
    .. [2] A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010). doi:10.1016/j.cpc.2009.09.018
    """
    valid = np.asarray(outcomes, dtype=np.float64)
    valid = valid[:, np.all(np.isfinite(valid), axis=0)]
    rows = valid.shape[1]
    if rows < _MIN_ROWS:
        raise InvalidInput(f"indices need at least {_MIN_ROWS} rows with a result, got {rows}")
    terms = _row_terms(valid)
    first, total, variance = _indices_from_means(terms.mean(axis=1))
    random = np.random.default_rng(seed)
    resampled, step = [], max(1, _RESAMPLED_NUMBERS // rows)
    for start in range(0, resamples, step):
        counts = random.multinomial(rows, np.full(rows, 1 / rows), size=min(step, resamples - start))
        resampled.append(np.stack(_indices_from_means(terms @ counts.T / rows)[:2]))
    low, high = np.quantile(np.concatenate(resampled, axis=-1), _INTERVAL, axis=-1)
    return SobolIndices(
        first_order=first,
        total_order=total,
        first_order_interval=np.stack([low[0], high[0]], axis=-1),
        total_order_interval=np.stack([low[1], high[1]], axis=-1),
        standard_deviation=float(np.sqrt(variance)),
        rows=rows,
    )


def _row_terms(outcomes: Floats) -> Floats:
    """Summands of the estimators by row: outcome, its square, then those of first and total order of each input."""
    a, b, a_b = outcomes[0], outcomes[1], outcomes[2:]
    mean = (a.mean() + b.mean()) / 2
    a, b, a_b = a - mean, b - mean, a_b - mean
    return np.concatenate([[(a + b) / 2, (a**2 + b**2) / 2], b * (a_b - a), (a - a_b) ** 2 / 2])


def _indices_from_means(means: Floats) -> tuple[Floats, Floats, Floats]:
    """First-order and total-order indices, and the variance, from the means of the summands over the rows."""
    variance = np.maximum(means[1] - means[0] ** 2, 0.0)
    indices = np.divide(means[2:], variance, out=np.zeros_like(means[2:]), where=variance > 0)
    return indices[: len(indices) // 2], indices[len(indices) // 2 :], variance
