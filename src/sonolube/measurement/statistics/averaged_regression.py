"""Linear regression in correlated noise, averaged over alternatives of what else the series holds.

Each alternative adds columns whose coefficients have a normal prior; its weight is its marginal likelihood.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.optimize import brentq
from scipy.special import logsumexp
from scipy.stats import norm

from sonolube.checks import Floats
from sonolube.measurement.statistics.autocorrelation import noise_of_regression, stationary_ratio, whitened

_KEPT: Final = 1e-3  # of the largest singular value of columns, above which a direction of theirs counts
_ROUNDING: Final = 1e-28  # least variance of the innovations, over the mean square of the series
_OUTSIDE: Final = 0.05  # of the mixture, beyond its interval
_LEAST: Final = 1e-200  # deviation of a number that an alternative lacks, above zero for divisions
_NORMAL: Final = float(norm.isf(_OUTSIDE / 2))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Alternative:
    """Columns that a series may have beside those that it has.

    Parameters
    ----------
    columns : tuple of int
        Among those that are offered.
    deviations : tuple of float
        Standard deviation of the normal prior of each coefficient, about zero, in the unit of the series over that of
        the column.
    probability : float
        Before the series is seen.
    """

    columns: tuple[int, ...]
    deviations: tuple[float, ...]
    probability: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class AveragedRegression:
    """Linear functions of the coefficients, averaged over alternatives.

    Parameters
    ----------
    means : ndarray, shape (functions,)
    covariance : ndarray, shape (functions, functions)
        Within the alternatives and between them, for 95 % intervals.
    probabilities : ndarray, shape (alternatives,)
        After the series is seen.
    """

    means: Floats
    covariance: Floats
    probabilities: Floats


def averaged_regression(
    values: Sequence[Floats],
    designs: Sequence[Floats],
    *,
    offered: Sequence[Floats],
    alternatives: Sequence[Alternative],
    beside: Sequence[tuple[int, ...]],
    functions: Floats,
) -> AveragedRegression:
    r"""Generalised least squares with further columns whose presence is weighed.

    Parameters
    ----------
    values : sequence of ndarray, shapes (samples,)
        Parts of the series, as in `correlated_regression`.
    designs : sequence of ndarray, shapes (samples, columns)
        Columns that the series has.
    offered : sequence of ndarray, shapes (samples, offered)
        Columns that it may have.
    alternatives : sequence of Alternative
        Which of them it has together, and how large they are.
    beside : sequence of tuple of int
        Sets of offered columns: the noise has the greatest restricted likelihood beside one of them, each as likely.
    functions : ndarray, shape (functions, columns + offered)
        Weights of the coefficients in each wanted number; a coefficient that an alternative lacks is zero in it.

    Returns
    -------
    AveragedRegression

    Raises
    ------
    InvalidInput
        If there are no more values than columns, or the columns are linearly dependent.

    Notes
    -----
    With the whitened series y, its columns X and the columns Z of alternative m, of prior variances S, the variance of
    the innovations :math:`\sigma^2` and n - p degrees of freedom, the marginal likelihood with flat priors of the
    columns that the series has is

    .. math:: -2 \ln L_m = (n - p) \ln \sigma^2 + \frac{y_\perp^T y_\perp - b^T (A + \sigma^2 S^{-1})^{-1} b}{\sigma^2}
        + \ln \lvert 1 + S A / \sigma^2 \rvert + \ln \lvert X^T X \rvert ,

    where :math:`y_\perp` and :math:`Z_\perp` are orthogonal to X, :math:`A = Z_\perp^T Z_\perp` and :math:`b =
    Z_\perp^T y_\perp`. [1]_ The weight of an alternative is its prior probability times L; means and covariances are
    those of the mixture, so that what is not decided between alternatives counts as uncertainty. [2]_ A mixture is not
    normal: an unlikely alternative of great width would rule its standard deviation. The covariance is scaled to state
    the standard deviation of the normal density whose 95 % interval is as wide as that of the mixture about its mean.

    References
    ----------
    .. [1] D. J. C. MacKay, Neural Comput. 4, 415 (1992). doi:10.1162/neco.1992.4.3.415
    .. [2] J. A. Hoeting et al., Stat. Sci. 14, 382 (1999). doi:10.1214/ss/1009212519
    """
    noises = [
        noise_of_regression(values, [np.hstack(both) for both in zip(designs, directions, strict=True)])
        for directions in (_directions([part[:, list(columns)] for part in offered]) for columns in beside)
    ]
    whole = [np.column_stack([x, z, y]) for y, x, z in zip(values, designs, offered, strict=True)]
    rows, fixed = sum(part.shape[0] for part in whole), designs[0].shape[1]
    logs, means, covariances = [], [], []
    for phi, theta in noises:
        triangle = _triangle(np.concatenate([whitened(part, phi, theta) for part in whole]))
        constant = len(whole) * float(np.log(stationary_ratio(phi, theta)))
        for each in alternatives:
            log, mean, covariance = _posterior(triangle, each, functions, rows=rows, fixed=fixed)
            logs.append(log + constant / 2 + np.log(each.probability))
            means.append(mean)
            covariances.append(covariance)
    weights = np.exp(np.array(logs) - logsumexp(logs))
    centre = weights @ np.array(means)
    away = np.array(means) - centre
    covariance = np.tensordot(weights, np.array(covariances), 1) + (weights * away.T) @ away
    within = np.maximum(np.sqrt(np.diagonal(np.array(covariances), axis1=1, axis2=2)), _LEAST)
    stated = np.array([_half_width(weights, *each) for each in zip(away.T, within.T, strict=True)]) / _NORMAL
    factor = stated / np.maximum(np.sqrt(np.diag(covariance)), _LEAST)
    return AveragedRegression(
        means=np.asarray(centre),
        covariance=factor[:, np.newaxis] * covariance * factor,
        probabilities=np.sum(weights.reshape(len(noises), -1), axis=0),
    )


def _half_width(weights: Floats, centres: Floats, deviations: Floats) -> float:
    """Half the width of the interval about zero that holds 95 % of a mixture of normal densities."""

    def outside(half: float) -> float:
        """Probability beyond it, less that wanted."""
        beyond = norm.sf((half - centres) / deviations) + norm.sf((half + centres) / deviations)
        return float(weights @ beyond) - _OUTSIDE

    farthest = float(np.max(np.abs(centres) + 6 * deviations))
    return float(brentq(outside, 0.0, farthest, rtol=1e-6))


def _triangle(columns: Floats) -> Floats:
    """Upper triangle R of the QR decomposition."""
    return np.asarray(np.linalg.qr(columns, mode="r"), dtype=np.float64)


def _directions(parts: Sequence[Floats]) -> list[Floats]:
    """Orthonormal directions of columns, without those that others leave nothing of."""
    whole = np.concatenate(parts)
    left, sizes, _ = np.linalg.svd(whole, full_matrices=False)
    kept = left[:, sizes > _KEPT * sizes.max(initial=0.0)]
    return np.split(kept, np.cumsum([len(part) for part in parts])[:-1])


def _posterior(
    triangle: Floats, alternative: Alternative, functions: Floats, *, rows: int, fixed: int
) -> tuple[float, Floats, Floats]:
    """Logarithm of the marginal likelihood, and mean and covariance of the wanted numbers, with an alternative."""
    chosen = [fixed + column for column in alternative.columns]
    known, series = triangle[:, [*range(fixed), *chosen]], triangle[:, -1]
    rest = _triangle(np.column_stack([known, series]))
    added, freedom = len(chosen), rows - fixed - len(chosen)
    variance = max(float(rest[-1, -1] ** 2) / freedom, _ROUNDING * float(series @ series) / rows)
    own, target = rest[fixed:-1, fixed:-1], rest[fixed:-1, -1]
    deviations = np.array(alternative.deviations)
    scaled = own * deviations
    within = np.eye(added) + scaled.T @ scaled / variance
    explained = float(target @ scaled @ np.linalg.solve(within, scaled.T @ target)) / variance
    size = float(target @ target) + float(rest[-1, -1] ** 2)
    log = -0.5 * (
        (rows - fixed) * np.log(variance)
        + (size - explained) / variance
        + np.linalg.slogdet(within)[1]
        + 2 * np.log(np.abs(np.diag(rest)[:fixed])).sum()
    )
    precision = known.T @ known
    precision[range(fixed, fixed + added), range(fixed, fixed + added)] += variance / deviations**2
    inverse = np.linalg.inv(precision)
    weights = functions[:, [*range(fixed), *chosen]]
    return float(log), weights @ inverse @ known.T @ series, variance * weights @ inverse @ weights.T
