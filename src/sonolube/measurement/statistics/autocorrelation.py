"""Mean and standard error of correlated samples by their integrated autocorrelation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

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
