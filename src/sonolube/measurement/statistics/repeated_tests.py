"""Statistics of few repeated tests: Student and Fieller intervals, Welch and permutation tests."""

from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from sonolube.checks import Floats, require_finite, require_within
from sonolube.errors import InvalidInput

_MAX_PERMUTATIONS = 200_000


@dataclass(frozen=True, kw_only=True, slots=True)
class MeanEstimate:
    """Mean of independent tests with Student's confidence interval, in the unit of the tests.

    Parameters
    ----------
    mean : float
    deviation : float
        Standard deviation of the tests.
    uncertainty : float
        Standard error of the mean.
    lower, upper : float
        Limits of the confidence interval.
    tests : int
        Number of tests.
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
    """Difference between the means of two conditions, with Welch's t test and a permutation test.

    Parameters
    ----------
    difference : float
        Mean of the second less mean of the first condition, in the unit of the tests.
    lower, upper : float
        Limits of Welch's confidence interval, in the unit of the tests.
    t_statistic : float
        Welch's t; infinite where the tests do not scatter.
    degrees_of_freedom : float
        After Welch and Satterthwaite.
    welch_p : float
        Two-sided p-value of Welch's t test, for normally distributed tests.
    permutation_p : float
        p-value of the exact permutation test: fraction of all assignments of the tests to both conditions whose
        difference is at least as large.
    smallest_permutation_p : float
        Smallest p-value that a permutation test of this number of tests can attain, however large the difference: 1/3
        for two and two, 0.1 for three and three, 0.029 for four and four.
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
class RatioEstimate:
    """Ratio of two means with Fieller's confidence interval.

    Parameters
    ----------
    ratio : float
        Mean of the numerator over mean of the denominator.
    lower, upper : float
        Limits of the interval; infinite where it is unbounded.
    bounded : bool
        Whether the interval is finite.
    reason : str
        Why the interval is unbounded; empty where it is bounded.
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
    r"""Mean of independent tests with Student's confidence interval.

    Parameters
    ----------
    tests : array_like, shape (tests,)
        One value per test, in any unit.
    confidence_level : float
        Of the interval. []

    Returns
    -------
    MeanEstimate

    Raises
    ------
    InvalidInput
        If there are fewer than two tests, or a value is not finite.

    See Also
    --------
    correlated_mean : the mean of correlated samples.

    Notes
    -----
    .. math:: \bar x \pm t_{n-1}\, \frac{s}{\sqrt{n}}

    Examples
    --------
    >>> from sonolube.measurement import mean_estimate
    >>> friction = mean_estimate([0.52, 0.55, 0.49])
    >>> round(friction.mean, 3), round(friction.lower, 3), round(friction.upper, 3)  # 0.52 -+ 4.303 0.03/sqrt(3)
    (0.52, 0.445, 0.595)
    """
    x = _tests(tests, "tests")
    require_within(0.5, 0.9999, confidence_level=confidence_level)
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
    r"""Difference between two conditions with Welch's t test and an exact permutation test.

    Parameters
    ----------
    first, second : array_like, shape (tests,)
        One value per test, in one unit; such as without and with vibration.
    confidence_level : float
        Of the interval. []

    Returns
    -------
    MeanDifference

    Raises
    ------
    InvalidInput
        If a condition has fewer than two tests, a value is not finite, or there are more than 200 000 permutations.

    Notes
    -----
    With the variances of the means :math:`v_i = s_i^2/n_i`,

    .. math::

        t = \frac{\bar x_2 - \bar x_1}{\sqrt{v_1 + v_2}} , \qquad
        \nu = \frac{(v_1 + v_2)^2}{v_1^2/(n_1 - 1) + v_2^2/(n_2 - 1)} .

    References
    ----------
    .. [1] B. L. Welch, Biometrika 34, 28 (1947). doi:10.1093/biomet/34.1-2.28

    Examples
    --------
    >>> from sonolube.measurement import compare_means
    >>> change = compare_means([1.12, 1.08, 1.10, 1.15], [0.52, 0.55, 0.49, 0.57])
    >>> round(change.difference, 3), round(change.permutation_p, 4)  # 2 of 70 permutations
    (-0.58, 0.0286)
    """
    a, b = _tests(first, "first"), _tests(second, "second")
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    difference, variances = float(b.mean() - a.mean()), (a.var(ddof=1) / a.size, b.var(ddof=1) / b.size)
    error, freedom = _welch(variances, (a.size, b.size))
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


def _welch(variances: tuple[float, float], sizes: tuple[int, int]) -> tuple[float, float]:
    """Standard error of a difference of means and its degrees of freedom after Welch and Satterthwaite."""
    total = float(sum(variances))
    denominator = sum(variance**2 / (size - 1) for variance, size in zip(variances, sizes, strict=True))
    return total**0.5, float(total**2 / denominator) if denominator > 0 else float(sum(sizes) - 2)


def _permutation(a: Floats, b: Floats) -> tuple[float, float]:
    """P-value of the exact permutation test, and the smallest one that the sizes allow."""
    permutations = comb(a.size + b.size, a.size)
    if permutations > _MAX_PERMUTATIONS:
        raise InvalidInput(f"{permutations} permutations of {a.size + b.size} tests are too many for an exact test")
    pooled = np.concatenate([a, b])
    chosen = np.array(list(combinations(range(pooled.size), a.size)))
    sums = pooled[chosen].sum(axis=1)
    differences = np.abs((pooled.sum() - sums) / b.size - sums / a.size)
    observed = abs(b.mean() - a.mean())
    rounding = 1e-9 * float(np.max(np.abs(pooled), initial=1e-300))
    mirrored = 2 if a.size == b.size else 1  # swapping equal groups gives the same difference
    return float(np.mean(differences >= observed - rounding)), mirrored / permutations


def ratio_interval(numerator: ArrayLike, denominator: ArrayLike, *, confidence_level: float = 0.95) -> RatioEstimate:
    r"""Ratio of the means of two independent sets of tests with Fieller's confidence interval.

    Parameters
    ----------
    numerator, denominator : array_like, shape (tests,)
        One value per test; such as with and without vibration.
    confidence_level : float
        Of the interval. []

    Returns
    -------
    RatioEstimate
        Unbounded where the mean of the denominator does not differ significantly from zero.

    Raises
    ------
    InvalidInput
        If a set has fewer than two tests, a value is not finite, or the denominator's mean is zero.

    Notes
    -----
    With the means a and b, the variances :math:`v_a` and :math:`v_b` of the means, and Student's t with Welch's degrees
    of freedom at the estimated ratio, the interval holds every :math:`\rho` for which

    .. math:: (a - \rho b)^2 \le t^2 (v_a + \rho^2 v_b) .

    References
    ----------
    .. [1] E. C. Fieller, J. R. Stat. Soc. B 16, 175 (1954). doi:10.1111/j.2517-6161.1954.tb00159.x
    """
    x, y = _tests(numerator, "numerator"), _tests(denominator, "denominator")
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    a, b = float(x.mean()), float(y.mean())
    if b == 0:
        raise InvalidInput("denominator must not have a mean of zero")
    v_a, v_b, rho = x.var(ddof=1) / x.size, y.var(ddof=1) / y.size, a / b
    t = float(stats.t.ppf((1 + confidence_level) / 2, _welch((v_a, rho**2 * v_b), (x.size, y.size))[1]))
    lead = b * b - t * t * v_b  # leading coefficient of the quadratic in rho
    lower, upper, reason = -np.inf, np.inf, ""
    if lead > 0:
        half = t * float(np.sqrt(max(0.0, v_a * lead + v_b * a * a))) / lead
        lower, upper = a * b / lead - half, a * b / lead + half
    else:
        reason = f"the denominator, {b:.3g} with standard error {v_b**0.5:.2g}, may be zero; make more tests"
    return RatioEstimate(
        ratio=rho, lower=lower, upper=upper, bounded=lead > 0, reason=reason, confidence_level=confidence_level
    )


def _tests(values: ArrayLike, name: str) -> Floats:
    """At least two finite values as an array."""
    x = require_finite(**{name: values})
    if x.ndim != 1 or x.size < 2:
        raise InvalidInput(f"{name} must be at least two tests, got {x.size}")
    return x
