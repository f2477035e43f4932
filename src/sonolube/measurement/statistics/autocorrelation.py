"""How well a mean is known when neighbouring samples are alike."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput

_WINDOW = 5.0  # correlation times over which the autocorrelation is summed


@dataclass(frozen=True, kw_only=True, slots=True)
class CorrelatedMean:
    """A mean over correlated samples.

    Parameters
    ----------
    mean : float
        In the unit of the samples, as the next two.
    deviation : float
        Standard deviation of the samples.
    uncertainty : float
        Standard error of the mean.
    samples : int
        Samples that hold a value.
    effective_samples : float
        Independent samples that would know the mean as well.
    """

    mean: float
    deviation: float
    uncertainty: float
    samples: int
    effective_samples: float


def correlated_mean(values: ArrayLike) -> CorrelatedMean:
    """Return the mean of evenly spaced samples with a standard error that heeds their correlation.

    Parameters
    ----------
    values : array_like, shape (samples,)
        In any unit; NaN is passed over.

    Returns
    -------
    CorrelatedMean

    Raises
    ------
    InvalidInput
        If fewer than two samples hold a value.

    Notes
    -----
    The standard error is s sqrt(g/n), g = 1 + 2 sum of rho(k), summed to the first lag beyond 5 g/2 [1]_. g is at least
    1: an error smaller than that of independent samples is never claimed. Where n is below some fifty g, the estimate
    of g itself is coarse and tends to be too small.

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
    """Return how many samples are worth one independent one, 1 + 2 sum of the autocorrelation; at least 1.

    Parameters
    ----------
    values : ndarray, shape (samples,)
        Evenly spaced, without NaN.

    Returns
    -------
    float
    """
    centred = values - np.mean(values)
    spectrum = np.fft.rfft(centred, 2 ** int(np.ceil(np.log2(2 * values.size))))
    covariance = np.fft.irfft(np.abs(spectrum) ** 2)[: values.size]
    if covariance[0] <= 1e-24 * values.size * np.max(np.abs(values), initial=0.0) ** 2:
        return 1.0  # constant up to rounding
    summed = 2 * np.cumsum(covariance / covariance[0]) - 1
    enough = np.arange(values.size) >= _WINDOW * summed / 2
    return float(max(1.0, summed[int(np.argmax(enough))] if enough.any() else values.size))


def correlation_time(values: Floats, *, sample_interval: float) -> float:
    """Return the integrated correlation time of evenly spaced samples. [s]

    Parameters
    ----------
    values : ndarray, shape (samples,)
        In any unit, without NaN.
    sample_interval : float
        Time between samples. [s]

    Returns
    -------
    float
        Half a sample for independent samples.

    Raises
    ------
    InvalidInput
        If the interval is not positive.
    """
    require_positive(sample_interval=sample_interval)
    return statistical_inefficiency(values) / 2 * sample_interval
