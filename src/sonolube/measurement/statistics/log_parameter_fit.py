"""Least squares over the logarithms of positive parameters, with confidence intervals of derived quantities."""

import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.measurement.statistics.autocorrelation import statistical_inefficiency

_ROUNDING = 1e-10  # residuals below which fits do not differ
_NEGLIGIBLE = 0.05  # mean square of a series over the largest, below which its correlation does not count
_EVALUATIONS = 60  # for each parameter
_TERMS = (3, 4, 5, 6, 8, 10)  # of the rational approximations whose poles are tried
_STEP = 1e-6  # of central differences, in a logarithm

Quantities = Callable[[Floats], Mapping[str, float]]
"""Function that computes positive quantities by name from the logarithms of the parameters."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ConfidenceInterval:
    """An estimate with its confidence interval.

    Parameters
    ----------
    value : float
        The estimate.
    lower, upper : float
        Limits of the interval.
    """

    value: float
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LogParameterFit:
    """Least-squares estimate of the logarithms of positive parameters.

    Parameters
    ----------
    logarithms : ndarray, shape (parameters,)
        Of the parameters.
    covariance : ndarray, shape (parameters, parameters)
        Of the logarithms, for independent residuals of equal variance; infinite where the data do not determine it.
    residuals : ndarray, shape (samples,)
        At the estimate.
    converged : bool
        Whether the minimisation converged.
    """

    logarithms: Floats
    covariance: Floats
    residuals: Floats
    converged: bool

    @property
    def sum_of_squares(self) -> float:
        """Sum of squares of the residuals."""
        return float(np.sum(self.residuals**2))

    @property
    def information_criterion(self) -> float:
        r"""Bayesian information criterion n ln(RSS/n) + k ln n for n residuals and k parameters."""
        n = self.residuals.size
        mean_square = max(self.sum_of_squares / n, _ROUNDING**2)
        return n * float(np.log(mean_square)) + self.logarithms.size * float(np.log(n))


def fit_log_parameters(residuals: Callable[[Floats], Floats], start: Floats) -> LogParameterFit:
    """Local least-squares estimate of log-parameters by the Levenberg-Marquardt method.

    Parameters
    ----------
    residuals : callable
        Takes logarithms of the parameters, returns residuals of equal variance.
    start : ndarray, shape (parameters,)
        Logarithms at which the minimisation starts.

    Returns
    -------
    LogParameterFit
    """
    import lmfit

    parameters = lmfit.Parameters()
    for place, value in enumerate(start):
        parameters.add(f"p{place}", value=float(value))

    def bounded_residuals(trial: "lmfit.Parameters") -> Floats:
        with np.errstate(all="ignore"):
            found = residuals(np.array(list(trial.valuesdict().values())))
        return np.clip(np.nan_to_num(found, nan=1e6), -1e6, 1e6)

    most = _EVALUATIONS * (start.size + 1)
    minimum = lmfit.minimize(bounded_residuals, parameters, method="leastsq", ftol=1e-12, xtol=1e-12, max_nfev=most)
    covariance = getattr(minimum, "covar", None)
    return LogParameterFit(
        logarithms=np.array(list(minimum.params.valuesdict().values())),
        covariance=np.full((start.size,) * 2, np.inf) if covariance is None else np.asarray(covariance),
        residuals=np.asarray(minimum.residual, dtype=np.float64),
        converged=bool(minimum.success),
    )


def rational_poles(x: Complexes | Floats, values: Complexes | Floats, *, scale: float) -> list[complex]:
    """Poles, times a scale, of AAA approximations of few to many terms, as first guesses of resonances."""
    from scipy.interpolate import AAA

    found: list[complex] = []
    for terms in _TERMS:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore", RuntimeWarning)  # about the limited number of terms
            found.extend(complex(pole) for pole in scale * AAA(x, values, max_terms=terms, rtol=1e-10).poles())
    return found


def distinct_modes(ranked: Iterable[tuple[float, Floats]], *, widths: float) -> list[Floats]:
    """Logarithms of frequency, quality factor and more of candidates by rank, those left out that lie near a better."""
    distinct: list[Floats] = []
    for _, candidate in sorted(ranked, key=lambda pair: pair[0]):
        if all(abs(candidate[0] - other[0]) > widths * np.exp(-other[1]) for other in distinct):
            distinct.append(candidate)
    return distinct


def residual_inefficiency(fit: LogParameterFit, *, rows: int) -> float:
    """Statistical inefficiency of the residuals of a fit: samples per independent sample, at least 1.

    Parameters
    ----------
    fit : LogParameterFit
    rows : int
        Number of series of equal length that the residuals hold, one after the other.

    Returns
    -------
    float
        The largest one of all series whose mean square is at least a twentieth of the largest: what a fit leaves of a
        series that has hardly any noise is the error of the estimate, which is smooth.

    See Also
    --------
    statistical_inefficiency : of one series.
    """
    every = fit.residuals.reshape(rows, -1)
    squares = np.mean(every**2, axis=1)
    series = every[squares >= _NEGLIGIBLE * squares.max()]
    return max(statistical_inefficiency(row) if np.ptp(row) > _ROUNDING else 1.0 for row in series)


def confidence_intervals(
    fit: LogParameterFit, quantities: Quantities, *, correlation: float, confidence_level: float
) -> dict[str, ConfidenceInterval]:
    r"""Confidence intervals of positive quantities derived from the parameters of a fit.

    Parameters
    ----------
    fit : LogParameterFit
    quantities : callable
        Takes logarithms of the parameters, returns the quantities by name.
    correlation : float
        Statistical inefficiency g of the residuals, `residual_inefficiency`, by which the covariance is multiplied.
    confidence_level : float
        Of the intervals. []

    Returns
    -------
    dict of str to ConfidenceInterval

    Notes
    -----
    First-order propagation of the covariance C of the log-parameters p to the logarithms of the quantities q,

    .. math:: \ln q \pm t_\nu \sqrt{g\, J C J^{\mathsf T}} , \qquad J = \frac{\partial \ln q}{\partial p} ,

    with Student's t of :math:`\nu = n/g - k` degrees of freedom for n residuals and k parameters.
    """
    from scipy import stats

    p = fit.logarithms
    freedom = max(1.0, fit.residuals.size / correlation - p.size)
    t = float(stats.t.ppf((1 + confidence_level) / 2, freedom))
    values = quantities(p)
    rises = [_logarithms(quantities(p + step)) - _logarithms(quantities(p - step)) for step in _STEP * np.eye(p.size)]
    slopes = np.stack(rises, axis=-1) / (2 * _STEP)
    determined = np.isfinite(fit.covariance).all()
    variance = np.einsum("qi,ij,qj->q", slopes, fit.covariance, slopes) if determined else np.full(len(slopes), np.inf)
    with np.errstate(over="ignore"):
        factors = np.exp(t * np.sqrt(np.maximum(variance, 0.0) * correlation))
    return {
        name: ConfidenceInterval(value=value, lower=float(value / factor), upper=float(value * factor))
        for (name, value), factor in zip(values.items(), factors, strict=True)
    }


def spanning_intervals(
    chosen: Mapping[str, ConfidenceInterval], others: Iterable[Mapping[str, ConfidenceInterval]]
) -> dict[str, ConfidenceInterval]:
    """Intervals of one fit, extended over those of others to the same data."""
    intervals = [chosen, *others]
    return {
        name: replace(
            one, lower=min(each[name].lower for each in intervals), upper=max(each[name].upper for each in intervals)
        )
        for name, one in chosen.items()
    }


def _logarithms(values: Mapping[str, float]) -> Floats:
    """Logarithms of quantities, those of zero as of the smallest positive float."""
    return np.asarray(np.log(np.maximum(np.array(list(values.values())), np.finfo(float).tiny)))
