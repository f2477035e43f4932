"""Least squares over the logarithms of positive parameters, with confidence confidence_intervals of all that follows from them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy import stats

from sonolube.checks import Floats
from sonolube.measurement.statistics.autocorrelation import statistical_inefficiency

_ROUNDING = 1e-10  # residuals below which nothing fits better
_EVALUATIONS = 60  # for each parameter
_STEP = 1e-6  # of central differences, in a logarithm

Quantities = Callable[[Floats], Mapping[str, float]]


@dataclass(frozen=True, kw_only=True, slots=True)
class ConfidenceInterval:
    """A number with its confidence interval.

    Parameters
    ----------
    value : float
        Most likely value.
    lower, upper : float
        Ends of the interval.
    """

    value: float
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LogParameterFit:
    """Where a sum of squares is least.

    Parameters
    ----------
    logarithms : ndarray, shape (parameters,)
        Of the parameters.
    covariance : ndarray, shape (parameters, parameters)
        Of the logarithms, for independent residuals of one variance; infinite where the data do not say.
    residuals : ndarray, shape (samples,)
        At that place.
    converged : bool
        Whether the search ended there by itself.
    """

    logarithms: Floats
    covariance: Floats
    residuals: Floats
    converged: bool

    @property
    def sum_of_squares(self) -> float:
        """Sum of the squares of the residuals."""
        return float(np.sum(self.residuals**2))

    @property
    def information_criterion(self) -> float:
        """Bayesian information criterion, up to a constant of the data."""
        n = self.residuals.size
        mean_square = max(self.sum_of_squares / n, _ROUNDING**2)
        return n * float(np.log(mean_square)) + self.logarithms.size * float(np.log(n))


def fit_log_parameters(residuals: Callable[[Floats], Floats], start: Floats) -> LogParameterFit:
    """Return where the sum of squares of residuals is least, sought from one place.

    Parameters
    ----------
    residuals : callable
        Takes logarithms of the parameters, returns residuals of one variance.
    start : ndarray, shape (parameters,)
        Logarithms to start from.

    Returns
    -------
    LogParameterFit
    """
    import lmfit

    parameters = lmfit.Parameters()
    for place, value in enumerate(start):
        parameters.add(f"p{place}", value=float(value))

    def cost(trial: "lmfit.Parameters") -> Floats:
        with np.errstate(all="ignore"):
            found = residuals(np.array(list(trial.valuesdict().values())))
        return np.clip(np.nan_to_num(found, nan=1e6), -1e6, 1e6)

    found = lmfit.minimize(
        cost, parameters, method="leastsq", ftol=1e-12, xtol=1e-12, max_nfev=_EVALUATIONS * (start.size + 1)
    )
    covariance = getattr(found, "covar", None)
    return LogParameterFit(
        logarithms=np.array(list(found.params.valuesdict().values())),
        covariance=np.full((start.size,) * 2, np.inf) if covariance is None else np.asarray(covariance),
        residuals=np.asarray(found.residual, dtype=np.float64),
        converged=bool(found.success),
    )


def residual_inefficiency(fit: LogParameterFit, *, rows: int) -> float:
    """Return by how much neighbouring residuals resemble each other: samples over independent samples, at least 1.

    Parameters
    ----------
    fit : LogParameterFit
    rows : int
        Residuals come in so many rows of equal length, one after the other.

    Returns
    -------
    float
    """
    parts = fit.residuals.reshape(rows, -1)
    return max(statistical_inefficiency(row) if np.ptp(row) > _ROUNDING else 1.0 for row in parts)


def confidence_intervals(
    fit: LogParameterFit, quantities: Quantities, *, correlation: float, confidence_level: float
) -> dict[str, ConfidenceInterval]:
    """Return confidence intervals of positive quantities that follow from the parameters.

    Parameters
    ----------
    fit : LogParameterFit
    quantities : callable
        Takes logarithms of the parameters, returns the quantities by name.
    correlation : float
        Samples over independent samples, by which the covariance grows.
    confidence_level : float
        Of the intervals. []

    Returns
    -------
    dict of str to Interval

    Notes
    -----
    First order in the covariance, on a logarithmic scale: Student's t with as many degrees of freedom as independent
    residuals exceed the parameters.
    """
    size = fit.logarithms.size
    freedom = max(1.0, fit.residuals.size / correlation - size)
    t = float(stats.t.ppf((1 + confidence_level) / 2, freedom))
    values = quantities(fit.logarithms)
    slopes = np.stack(
        [
            (_logs(quantities(fit.logarithms + step)) - _logs(quantities(fit.logarithms - step))) / (2 * _STEP)
            for step in _STEP * np.eye(size)
        ],
        axis=-1,
    )
    known = np.isfinite(fit.covariance).all()
    variance = np.einsum("qi,ij,qj->q", slopes, fit.covariance, slopes) if known else np.full(len(slopes), np.inf)
    with np.errstate(over="ignore"):
        factors = np.exp(t * np.sqrt(np.maximum(variance, 0.0) * correlation))
    return {
        name: ConfidenceInterval(value=value, lower=float(value / factor), upper=float(value * factor))
        for (name, value), factor in zip(values.items(), factors, strict=True)
    }


def _logs(values: Mapping[str, float]) -> Floats:
    return np.asarray(np.log(np.maximum(np.array(list(values.values())), np.finfo(float).tiny)))
