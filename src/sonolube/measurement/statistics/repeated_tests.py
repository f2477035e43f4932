"""Honest statistics for few tests: how sure a mean, a difference, a ratio and a repetition are."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from sonolube.checks import Floats, require_finite, require_within
from sonolube.errors import InvalidInput

_MOST_ARRANGEMENTS = 200_000


@dataclass(frozen=True, kw_only=True, slots=True)
class MeanEstimate:
    """The mean of independent tests with its confidence interval, in the unit of the tests.

    Parameters
    ----------
    mean : float
    deviation : float
        Standard deviation of the tests.
    uncertainty : float
        Standard error of the mean.
    lower, upper : float
        Ends of the confidence interval.
    tests : int
    confidence_level : float
        Of the interval. []
    """

    mean: float
    deviation: float
    uncertainty: float
    lower: float
    upper: float
    tests: int
    confidence_level: float


@dataclass(frozen=True, kw_only=True, slots=True)
class MeanDifference:
    """Whether tests under two conditions differ, in the unit of the tests.

    Parameters
    ----------
    difference : float
        Mean of the second less mean of the first.
    lower, upper : float
        Ends of Welch's confidence interval.
    t_statistic : float
        Welch's t; infinite where the tests do not scatter.
    degrees_of_freedom : float
        After Welch and Satterthwaite.
    welch_p : float
        Two-sided probability of so large a t without a difference, for normal scatter.
    permutation_p : float
        Share of all ways to deal the tests to both conditions that give at least so large a difference.
    smallest_permutation_p : float
        What this number of tests can reach at best: 1/3 for two and two, 0.1 for three and three, 0.029 for four and
        four. Below it no permutation test can fall, however large the difference.
    confidence_level : float
        Of the interval. []
    """

    difference: float
    lower: float
    upper: float
    t_statistic: float
    degrees_of_freedom: float
    welch_p: float
    permutation_p: float
    smallest_permutation_p: float
    confidence_level: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Repeatability:
    """Scatter within and between groups of tests, in the unit of the tests.

    Parameters
    ----------
    mean : float
        Over all groups.
    within : float
        Repeatability standard deviation.
    between : float
        Standard deviation between groups; 0 where the groups differ no more than the scatter within explains.
    reproducibility : float
        Standard deviation of a test in another group.
    repeatability_limit : float
        Two tests of a group differ by less in 95 % of cases: 2.8 times `within`.
    reproducibility_limit : float
        So for tests of two groups: 2.8 times `reproducibility`.
    groups, tests : int
    """

    mean: float
    within: float
    between: float
    reproducibility: float
    repeatability_limit: float
    reproducibility_limit: float
    groups: int
    tests: int


@dataclass(frozen=True, kw_only=True, slots=True)
class RatioEstimate:
    """The ratio of two means with its confidence interval.

    Parameters
    ----------
    ratio : float
    lower, upper : float
        Ends of the interval; infinite where it has none.
    bounded : bool
        Whether the interval is finite.
    reason : str
        Why not; empty when bounded.
    confidence_level : float
        Of the interval. []
    """

    ratio: float
    lower: float
    upper: float
    bounded: bool
    reason: str
    confidence_level: float


def mean_estimate(tests: ArrayLike, *, confidence_level: float = 0.95) -> MeanEstimate:
    """Return the mean of independent tests with Student's confidence interval.

    Parameters
    ----------
    tests : array_like, shape (tests,)
        One value a test, in any unit.
    confidence_level : float
        Of the interval. []

    Returns
    -------
    MeanEstimate

    Raises
    ------
    InvalidInput
        If there are fewer than two tests, or a value is not finite.
    """
    x = _tests(tests, "tests")
    _require_level(confidence_level)
    mean, deviation = float(x.mean()), float(x.std(ddof=1))
    error = deviation / x.size**0.5
    half = error * float(stats.t.ppf((1 + confidence_level) / 2, x.size - 1))
    return MeanEstimate(
        mean=mean,
        deviation=deviation,
        uncertainty=error,
        lower=mean - half,
        upper=mean + half,
        tests=x.size,
        confidence_level=confidence_level,
    )


def compare_means(first: ArrayLike, second: ArrayLike, *, confidence_level: float = 0.95) -> MeanDifference:
    """Return whether tests under two conditions differ: Welch's t and an exact permutation test.

    Parameters
    ----------
    first, second : array_like, shape (tests,)
        One value a test, in one unit; such as without and with vibration.
    confidence_level : float
        Of the interval. []

    Returns
    -------
    Difference

    Raises
    ------
    InvalidInput
        If a condition has fewer than two tests, a value is not finite, or there are more than 200 000 ways to deal.

    References
    ----------
    .. [1] B. L. Welch, Biometrika 34, 28 (1947). doi:10.1093/biomet/34.1-2.28
    """
    a, b = _tests(first, "first"), _tests(second, "second")
    _require_level(confidence_level)
    difference, errors = float(b.mean() - a.mean()), (a.var(ddof=1) / a.size, b.var(ddof=1) / b.size)
    error, freedom = _welch(errors, (a.size, b.size))
    t = difference / error if error > 0 else float(np.copysign(np.inf, difference)) if difference else 0.0
    half = error * float(stats.t.ppf((1 + confidence_level) / 2, freedom))
    permutation, smallest = _permutation(a, b)
    return MeanDifference(
        difference=difference,
        lower=difference - half,
        upper=difference + half,
        t_statistic=t,
        degrees_of_freedom=freedom,
        welch_p=float(2 * stats.t.sf(abs(t), freedom)),
        permutation_p=permutation,
        smallest_permutation_p=smallest,
        confidence_level=confidence_level,
    )


def _welch(errors: tuple[float, float], sizes: tuple[int, int]) -> tuple[float, float]:
    """Standard error of a difference of means and its degrees of freedom."""
    total = float(sum(errors))
    spread = sum(error**2 / (size - 1) for error, size in zip(errors, sizes, strict=True))
    return total**0.5, float(total**2 / spread) if spread > 0 else float(sum(sizes) - 2)


def _permutation(a: Floats, b: Floats) -> tuple[float, float]:
    arrangements = comb(a.size + b.size, a.size)
    if arrangements > _MOST_ARRANGEMENTS:
        raise InvalidInput(f"{arrangements} ways to deal {a.size + b.size} tests are too many for an exact test")
    pooled = np.concatenate([a, b])
    chosen = np.array(list(combinations(range(pooled.size), a.size)))
    sums = pooled[chosen].sum(axis=1)
    differences = np.abs((pooled.sum() - sums) / b.size - sums / a.size)
    observed = abs(b.mean() - a.mean())
    rounding = 1e-9 * float(np.max(np.abs(pooled), initial=1e-300))
    mirrored = 2 if a.size == b.size else 1  # swapping equal groups gives the same difference
    return float(np.mean(differences >= observed - rounding)), mirrored / arrangements


def repeatability(groups: Sequence[ArrayLike]) -> Repeatability:
    """Return the scatter within and between groups of tests, such as days, discs or laboratories.

    Parameters
    ----------
    groups : sequence of array_like
        The tests of each group; groups may differ in size.

    Returns
    -------
    Repeatability

    Raises
    ------
    InvalidInput
        If there are fewer than two groups, no group has two tests, or a value is not finite.

    References
    ----------
    .. [1] ISO 5725-2:2019, 7.4.5: one-way analysis of variance.
    """
    samples = [np.atleast_1d(require_finite(group=group)) for group in groups]
    sizes = np.array([sample.size for sample in samples])
    if sizes.size < 2 or sizes.sum() <= sizes.size or sizes.min() < 1:
        raise InvalidInput(f"repeatability needs two groups and one with two tests, got sizes {sizes.tolist()}")
    means = np.array([sample.mean() for sample in samples])
    mean = float(np.average(means, weights=sizes))
    squares = sum(float(np.sum((sample - own) ** 2)) for sample, own in zip(samples, means, strict=True))
    within = squares / (sizes.sum() - sizes.size)
    of_groups = float(np.sum(sizes * (means - mean) ** 2)) / (sizes.size - 1)
    tests_a_group = float((sizes.sum() - np.sum(sizes**2) / sizes.sum()) / (sizes.size - 1))
    between = max(0.0, (of_groups - within) / tests_a_group)
    return Repeatability(
        mean=mean,
        within=within**0.5,
        between=between**0.5,
        reproducibility=(within + between) ** 0.5,
        repeatability_limit=2.8 * within**0.5,
        reproducibility_limit=2.8 * (within + between) ** 0.5,
        groups=int(sizes.size),
        tests=int(sizes.sum()),
    )


def ratio_interval(numerator: ArrayLike, denominator: ArrayLike, *, confidence_level: float = 0.95) -> RatioEstimate:
    """Return the ratio of the means of two independent sets of tests with Fieller's interval.

    Parameters
    ----------
    numerator, denominator : array_like, shape (tests,)
        One value a test; such as with and without vibration.
    confidence_level : float
        Of the interval. []

    Returns
    -------
    RatioEstimate
        Unbounded where the denominator's mean is not surely different from zero.

    Raises
    ------
    InvalidInput
        If a set has fewer than two tests, a value is not finite, or the denominator's mean is zero.

    Notes
    -----
    The interval holds every rho for which mean(numerator) - rho mean(denominator) is no further from zero than t
    standard errors, t with Welch's degrees of freedom at the ratio found.

    References
    ----------
    .. [1] E. C. Fieller, J. R. Stat. Soc. B 16, 175 (1954). doi:10.1111/j.2517-6161.1954.tb00159.x
    """
    x, y = _tests(numerator, "numerator"), _tests(denominator, "denominator")
    _require_level(confidence_level)
    a, b = float(x.mean()), float(y.mean())
    if b == 0:
        raise InvalidInput("denominator must not have a mean of zero")
    v_a, v_b, rho = x.var(ddof=1) / x.size, y.var(ddof=1) / y.size, a / b
    t = float(stats.t.ppf((1 + confidence_level) / 2, _welch((v_a, rho**2 * v_b), (x.size, y.size))[1]))
    lead = b * b - t * t * v_b  # of the quadratic in rho
    if lead <= 0:
        return RatioEstimate(
            ratio=rho,
            lower=-np.inf,
            upper=np.inf,
            bounded=False,
            reason=f"the denominator, {b:.3g} with standard error {v_b**0.5:.2g}, may be zero; make more tests",
            confidence_level=confidence_level,
        )
    half = t * float(np.sqrt(max(0.0, v_a * lead + v_b * a * a))) / lead
    middle = a * b / lead
    return RatioEstimate(
        ratio=rho, lower=middle - half, upper=middle + half, bounded=True, reason="", confidence_level=confidence_level
    )


def _tests(values: ArrayLike, name: str) -> Floats:
    x = require_finite(**{name: values})
    if x.ndim != 1 or x.size < 2:
        raise InvalidInput(f"{name} must be at least two tests, got {x.size}")
    return x


def _require_level(confidence_level: float) -> None:
    require_within(0.5, 0.9999, confidence_level=confidence_level)
