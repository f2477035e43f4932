"""Correlated samples: mean and standard error by their integrated autocorrelation, and linear regression.

The regression is generalised least squares with ARMA(1,1) noise by restricted likelihood.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize
from scipy.signal import lfilter
from scipy.special import expit, logit

from sonolube.checks import Floats
from sonolube.errors import InvalidInput

_WINDOW = 5.0  # correlation times over which the autocorrelation is summed, the c of Sokal


@dataclass(frozen=True, kw_only=True, slots=True)
class CorrelatedMean:
    """Mean of correlated samples with its standard error.

    Parameters
    ----------
    mean : float
        In the unit of the samples, as the next two.
    deviation : float
        Standard deviation of the samples.
    uncertainty : float
        Standard error of the mean.
    samples : int
        Number of samples, without missing values.
    effective_samples : float
        Number of independent samples whose mean would have the same standard error.
    """

    mean: float
    deviation: float
    uncertainty: float
    samples: int
    effective_samples: float


def correlated_mean(values: ArrayLike) -> CorrelatedMean:
    r"""Mean of evenly spaced samples with a standard error that accounts for their autocorrelation.

    Parameters
    ----------
    values : array_like, shape (samples,)
        In any unit; NaN is a missing value and is left out.

    Returns
    -------
    CorrelatedMean

    Raises
    ------
    InvalidInput
        If there are fewer than two samples.

    See Also
    --------
    statistical_inefficiency : the factor g.
    mean_estimate : the mean of independent tests.

    Notes
    -----
    With the standard deviation s of n samples and their statistical inefficiency g, the standard error is

    .. math:: u = s \sqrt{g/n} .

    Where n is below about fifty g, the estimate of g itself is coarse and biased low.

    References
    ----------
    .. [1] A. Sokal, Monte Carlo methods in statistical mechanics (1997). doi:10.1007/978-1-4899-0319-8_6
    """
    x = np.asarray(values, dtype=np.float64).ravel()
    x = x[np.isfinite(x)]
    if x.size < 2:
        raise InvalidInput(f"a mean with its uncertainty needs at least two samples, got {x.size}")
    mean, deviation = float(np.mean(x)), float(np.std(x, ddof=1))
    effective = x.size / statistical_inefficiency(x)
    return CorrelatedMean(
        mean=mean,
        deviation=deviation,
        uncertainty=deviation / float(np.sqrt(effective)),
        samples=x.size,
        effective_samples=effective,
    )


def statistical_inefficiency(values: Floats) -> float:
    r"""Statistical inefficiency of evenly spaced samples: samples per independent sample, at least 1.

    Parameters
    ----------
    values : ndarray, shape (samples,)
        Evenly spaced, without NaN.

    Returns
    -------
    float

    Notes
    -----
    With the autocorrelation :math:`\rho`,

    .. math:: g = 1 + 2 \sum_{k=1}^{M} \rho(k) ,

    where Sokal's automatic window ends the sum at the first lag M of at least 5 g/2. [1]_ Values below 1, from negative
    correlation, are replaced by 1, so that no standard error is below that of independent samples.

    References
    ----------
    .. [1] A. Sokal, Monte Carlo methods in statistical mechanics (1997). doi:10.1007/978-1-4899-0319-8_6
    """
    centred = values - np.mean(values)
    spectrum = np.fft.rfft(centred, 2 ** int(np.ceil(np.log2(2 * values.size))))
    covariance = np.fft.irfft(np.abs(spectrum) ** 2)[: values.size]
    if covariance[0] <= 1e-24 * values.size * np.max(np.abs(values), initial=0.0) ** 2:
        return 1.0  # constant up to rounding
    cumulative = 2 * np.cumsum(covariance / covariance[0]) - 1
    sufficient = np.arange(values.size) >= _WINDOW * cumulative / 2
    return float(max(1.0, cumulative[int(np.argmax(sufficient))] if sufficient.any() else values.size))


_LONGEST_MEMORY = 0.9995  # autoregressive coefficient
_STARTS = [(phi, share) for phi in (0.3, 0.8, 0.97) for share in (0.1, 0.6, 0.95)]
_MAX_EVALUATIONS = 60


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CorrelatedRegression:
    """Coefficients of a linear regression with their covariance.

    Parameters
    ----------
    coefficients : ndarray, shape (columns,)
    covariance : ndarray, shape (columns, columns)
    autoregression : float
        Coefficient phi of the noise.
    moving_average : float
        Coefficient theta of the noise.
    innovations : tuple of ndarray
        Whitened residuals of each part.
    """

    coefficients: Floats
    covariance: Floats
    autoregression: float
    moving_average: float
    innovations: tuple[Floats, ...]


def correlated_regression(values: Sequence[Floats], designs: Sequence[Floats]) -> CorrelatedRegression:
    r"""Generalised least-squares fit of evenly spaced parts of a series in white and red noise.

    Parameters
    ----------
    values : sequence of ndarray, shapes (samples,)
        Parts of the series; the noise is independent between parts and alike in all.
    designs : sequence of ndarray, shapes (samples, columns)
        Columns of the regression in each part.

    Returns
    -------
    CorrelatedRegression

    Raises
    ------
    InvalidInput
        If there are no more values than columns, or the columns are linearly dependent.

    See Also
    --------
    correlated_mean : of one series without further columns, by Sokal's window.

    Notes
    -----
    White noise plus a first-order autoregression is an ARMA(1,1) process, :math:`e_t - \phi e_{t-1} = a_t - \theta
    a_{t-1}` with :math:`0 \le \theta \le \phi < 1`. [1]_ Filtering by its inverse whitens series and columns; the first
    sample of a part is weighted by its stationary variance. The coefficients phi and theta maximise the restricted
    likelihood, which allows for the columns fitted, so that the variance at low frequency is not underestimated. [2]_

    References
    ----------
    .. [1] G. E. P. Box, G. M. Jenkins, Time Series Analysis (1970).
    .. [2] D. A. Harville, J. Am. Stat. Assoc. 72, 320 (1977). doi:10.1080/01621459.1977.10480998
    """
    stacked = _stacked(values, designs)
    rows, columns = sum(part.shape[0] for part in stacked), stacked[0].shape[1] - 1
    phi, theta = _likeliest_noise(stacked)
    white = [whitened(part, phi, theta) for part in stacked]
    whole = np.concatenate(white)
    solution, _, _, _ = np.linalg.lstsq(whole[:, 1:], whole[:, 0])
    innovations = tuple(part[:, 0] - part[:, 1:] @ solution for part in white)
    variance = sum(float(e @ e) for e in innovations) / (rows - columns)
    return CorrelatedRegression(
        coefficients=np.asarray(solution, dtype=np.float64),
        covariance=variance * np.linalg.inv(whole[:, 1:].T @ whole[:, 1:]),
        autoregression=phi,
        moving_average=theta,
        innovations=innovations,
    )


def noise_of_regression(values: Sequence[Floats], designs: Sequence[Floats]) -> tuple[float, float]:
    """Phi and theta of the noise of greatest restricted likelihood; arguments, errors as `correlated_regression`."""
    return _likeliest_noise(_stacked(values, designs))


def _stacked(values: Sequence[Floats], designs: Sequence[Floats]) -> list[Floats]:
    """Series and columns of each part side by side; InvalidInput where they determine no regression."""
    stacked = [np.column_stack([y, x]) for y, x in zip(values, designs, strict=True)]
    rows, columns = sum(part.shape[0] for part in stacked), stacked[0].shape[1] - 1
    if rows <= columns:
        raise InvalidInput(f"{rows} values are too few for {columns} coefficients")
    if np.linalg.matrix_rank(np.concatenate(designs)) < columns:
        raise InvalidInput("the columns of the regression are linearly dependent")
    return stacked


def _likeliest_noise(stacked: Sequence[Floats]) -> tuple[float, float]:
    """Phi and theta of the noise by restricted likelihood."""
    objective = partial(_restricted_likelihood, stacked)
    start = min((np.array([logit(phi), logit(share)]) for phi, share in _STARTS), key=objective)
    found = minimize(objective, start, method="Nelder-Mead", options={"maxfev": _MAX_EVALUATIONS, "xatol": 0.02})
    return _noise(found.x)


def _noise(parameters: Floats) -> tuple[float, float]:
    """Phi and theta from the unbounded parameters."""
    phi = _LONGEST_MEMORY * float(expit(parameters[0]))
    return phi, phi * float(expit(parameters[1]))


def whitened(part: Floats, phi: float, theta: float) -> Floats:
    """Columns of a part filtered to white noise."""
    first = part[:1]
    ratio = stationary_ratio(phi, theta)
    rest, _ = lfilter([1.0, -phi], [1.0, -theta], part[1:], axis=0, zi=(theta * ratio - phi) * first)
    return np.concatenate([np.sqrt(ratio) * first, rest])


def stationary_ratio(phi: float, theta: float) -> float:
    """Variance of the innovations over that of the process."""
    return (1 - phi**2) / (1 + theta**2 - 2 * phi * theta)


def _restricted_likelihood(stacked: Sequence[Floats], parameters: Floats) -> float:
    """Minus twice the restricted log-likelihood, without its constant."""
    phi, theta = _noise(parameters)
    whole = np.concatenate([whitened(part, phi, theta) for part in stacked])
    triangle = np.abs(np.diag(np.linalg.qr(np.roll(whole, -1, axis=1), mode="r")))
    rows, columns = whole.shape[0], whole.shape[1] - 1
    fit = (rows - columns) * np.log(max(triangle[-1] ** 2, 1e-300))
    return float(fit + 2 * np.log(triangle[:-1]).sum() - len(stacked) * np.log(stationary_ratio(phi, theta)))
