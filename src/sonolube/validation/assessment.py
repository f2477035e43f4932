"""Assessment of model variants: least-squares fits, leave-one-set-out cross-validation and information criteria.

Sets A and C to G are fitted without Table 4.2 (set B) and with it. The cross-validation error predicts each set by a
fit to the others: it is the error to expect on a rig that was not fitted. A set that a fixed constant was taken from is
predicted with that constant fitted to the others it was taken from, so that no error is of tests that a default has
seen.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, least_squares

from sonolube.checks import Floats
from sonolube.models.friction import FrictionModel
from sonolube.validation.friction_model_variants import FRICTION_MODEL_VARIANTS
from sonolube.validation.model_variant import FreeParameter, ModelVariant, SeenSets
from sonolube.validation.published_tests import Conditions, MeasuredConditions, Tests, friction_tests, in_plane_tests

_OUT_OF_RANGE_RESIDUAL: Final = 1.0  # residual of a test outside the range of the model, in fits only
SMALLEST_RMS: Final = 1e-6
"""Root mean square error of ratios that a model reproduces exactly. []"""
CHI_SQUARED_95: Final = 3.841
"""95 % quantile of chi squared with one degree of freedom."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Fit:
    """Model variant with values of its free parameters.

    Parameters
    ----------
    variant : ModelVariant
    sets : str
        Letters of the fitted sets; empty where nothing was fitted.
    values : tuple of float
        Values of the free parameters, in SI.
    """

    variant: ModelVariant
    sets: str
    values: tuple[float, ...]

    def predict(self, conditions: Conditions) -> float | None:
        """Friction ratio under some conditions; None outside the range of the model. []"""
        return self.variant.predict(conditions, *self.values)


def select_tests(sets: str, tests: Tests | None = None) -> Tests:
    """Tests that belong to the sets of the given letters, from all published tests if None are given."""
    everything: Tests = (*friction_tests(), *in_plane_tests()) if tests is None else tests
    return tuple(test for test in everything if test.set_name in sets)


@cache
def fit_variant(
    variant: ModelVariant, sets: str, *, initial: tuple[float, ...] | None = None, tests: Tests | None = None
) -> Fit:
    r"""Model variant fitted by least squares to the measured friction ratios of some sets.

    Parameters that apply to none of the sets keep their defaults.

    .. math:: \min_p \sum_i \left(R_i(p) - R_i^{\mathrm{measured}}\right)^2

    within the bounds of the parameters p. A test outside the range of the model has a residual of 1.
    """
    selected = select_tests(sets, tests)
    free = [index for index, parameter in enumerate(variant.parameters) if parameter.applies_to(sets)]
    if initial is None:
        start = _initial_guess(variant, selected)
    else:
        start = np.array([parameter.default for parameter in variant.parameters])
        start[free] = np.array(initial)[free]
    values = _minimise(variant, selected, free, start)
    return Fit(variant=variant, sets=sets if free else "", values=tuple(values.tolist()))


def profile_likelihood_interval(
    fit: Fit, index: int, *, tests: Tests | None = None, largest_excess: float = CHI_SQUARED_95
) -> tuple[float, float]:
    r"""95 % profile likelihood interval of one parameter, truncated at its bounds.

    .. math:: n \ln\frac{S(p)}{S(\hat p)} \le 3.841

    with the sum of squares S, minimised over the other parameters, of n tests with Gaussian errors of unknown variance.


    Source: D. J. Venzon and S. H. Moolgavkar, Appl. Stat. 37, 87 (1988). doi:10.2307/2347496
    """
    variant, best, selected = fit.variant, fit.values[index], select_tests(fit.sets, tests)
    parameter = variant.parameters[index]
    others = [other for other, one in enumerate(variant.parameters) if other != index and one.applies_to(fit.sets)]
    least = max(root_mean_square(_residuals(variant, selected, fit.values)), SMALLEST_RMS)

    def excess(value: float) -> float:
        values = np.array(fit.values)
        values[index] = value
        values = _minimise(variant, selected, others, values)
        rms = max(root_mean_square(_residuals(variant, selected, values)), SMALLEST_RMS)
        return 2 * len(selected) * float(np.log(rms / least)) - largest_excess

    reach = np.pi if parameter.is_angle else np.inf
    limits = max(parameter.low, best - reach), min(parameter.high, best + reach)
    low, high = (limit if excess(limit) < 0 else brentq(excess, best, limit, rtol=1e-3) for limit in limits)
    return float(low), float(high)


def root_mean_square(residuals: ArrayLike) -> float:
    """Root mean square of residuals; infinite if there are none. []"""
    squares = np.square(residuals)
    return float(np.sqrt(np.mean(squares))) if squares.size else float("inf")


def _initial_guess(variant: ModelVariant, tests: Tests) -> Floats:
    """Best initial values of each group of parameters with the same sets, the common group first."""
    values = np.array([parameter.default for parameter in variant.parameters])
    for group in sorted({parameter.applicable_sets for parameter in variant.parameters}):
        group_tests = tuple(test for test in tests if not group or test.set_name in group)
        if not group_tests:
            continue
        indices = [index for index, one in enumerate(variant.parameters) if one.applicable_sets == group]
        trials = []
        for initial in product(*(variant.parameters[index].initial_values for index in indices)):
            trial = _with_values(values, indices, np.array(initial))
            trials.append((root_mean_square(_residuals(variant, group_tests, trial)), initial))
        values[indices] = min(trials)[1]
    return values


def _minimise(variant: ModelVariant, tests: Tests, free: list[int], start: Floats) -> Floats:
    """Start with the parameters of some indices fitted by bounded least squares (dogbox)."""
    if not free:
        return start
    parameters = [variant.parameters[index] for index in free]
    scales = np.array([abs(parameter.high) for parameter in parameters])

    def residuals(scaled: Floats) -> Floats:
        return _residuals(variant, tests, _with_values(start, free, scaled * scales))

    low, high = (np.array([getattr(parameter, end) for parameter in parameters]) / scales for end in ("low", "high"))
    run = least_squares(
        residuals,
        np.clip(start[free] / scales, low, high),
        bounds=(low, high),
        method="dogbox",
        diff_step=1e-3,
        xtol=1e-4,
        ftol=1e-5,
        max_nfev=30,
    )
    return _with_values(
        start, free, np.array([_wrapped(*pair) for pair in zip(parameters, run.x * scales, strict=True)])
    )


def _wrapped(parameter: FreeParameter, value: float) -> float:
    """Value of a parameter, an angle wrapped to minus pi to pi."""
    return float((value + np.pi) % (2 * np.pi) - np.pi) if parameter.is_angle else float(value)


def _with_values(values: Floats, indices: list[int], replaced: Floats) -> Floats:
    """Copy of an array with some elements replaced."""
    changed = values.copy()
    changed[indices] = replaced
    return changed


def _residuals(variant: ModelVariant, tests: Tests, values: ArrayLike) -> Floats:
    """Predicted minus measured friction ratios. []"""
    predicted = variant.predict_all(tests, *np.asarray(values).tolist())
    return np.array(
        [
            _OUT_OF_RANGE_RESIDUAL if ratio is None else ratio - test.friction_ratio
            for ratio, test in zip(predicted, tests, strict=True)
        ]
    )


SETS_WITHOUT_POWER_MAP: Final = "ACDEFG"
"""Fitted sets of D without Table 4.2."""

FITTED_SETS: Final = "ABCDEFG"
"""Fitted sets of D; for set H the amplitude is not known."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ErrorStatistics:
    """Statistics of the errors, predicted minus measured friction ratio; all are pure numbers.

    Parameters
    ----------
    rms : float
        Root mean square error over the tests inside the range of the model.
    largest : float
        Error of the largest absolute value.
    median_relative : float
        Median of the absolute error over the measured ratio.
    count : int
        Number of tests inside the range of the model.
    out_of_range : tuple of str
        Labels of the tests outside it.
    """

    rms: float
    largest: float
    median_relative: float
    count: int
    out_of_range: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class InformationCriteria:
    """Information criteria of a fit with Gaussian errors of one unknown variance; comparable on the same tests only.

    Parameters
    ----------
    aicc : float
        Akaike information criterion, corrected for small samples.
    bic : float
        Bayesian information criterion.
    parameter_count : int
        Number of fitted parameters, without the variance.
    """

    aicc: float
    bic: float
    parameter_count: int


@dataclass(frozen=True, kw_only=True, slots=True)
class Assessment:
    """Assessment of one model variant on some sets.

    Parameters
    ----------
    fit : Fit
        Fit to all of the sets.
    fit_errors : ErrorStatistics
        Errors of that fit.
    cross_validation_errors : ErrorStatistics
        Errors with each set predicted by what has not seen it.
    information : InformationCriteria or None
        Criteria of the fit; None where a test is outside the range of the model.
    """

    fit: Fit
    fit_errors: ErrorStatistics
    cross_validation_errors: ErrorStatistics
    information: InformationCriteria | None


def assess_variant(variant: ModelVariant, sets: str, *, tests: Tests | None = None) -> Assessment:
    """Assessment of a model variant on some sets."""
    fit, selected = fit_variant(variant, sets, tests=tests), select_tests(sets, tests)
    return Assessment(
        fit=fit,
        fit_errors=prediction_errors(fit, selected),
        cross_validation_errors=cross_validation_errors(variant, sets, tests=tests),
        information=information_criteria(fit, selected),
    )


def prediction_errors(fit: Fit, tests: Iterable[MeasuredConditions]) -> ErrorStatistics:
    """Error statistics of a fit over some tests."""
    return error_statistics((test, fit.predict(test)) for test in tests)


def error_statistics(predicted: Iterable[tuple[MeasuredConditions, float | None]]) -> ErrorStatistics:
    """Error statistics of predicted friction ratios, None being outside the range of the model."""
    pairs = list(predicted)
    in_range = [(test, ratio) for test, ratio in pairs if ratio is not None]
    measured = np.array([test.friction_ratio for test, _ in in_range])
    errors = np.array([ratio for _, ratio in in_range]) - measured
    return ErrorStatistics(
        rms=root_mean_square(errors),
        largest=float(errors[np.argmax(np.abs(errors))]) if in_range else float("inf"),
        median_relative=float(np.median(np.abs(errors) / measured)) if in_range else float("inf"),
        count=len(in_range),
        out_of_range=tuple(test.label for test, ratio in pairs if ratio is None),
    )


def leave_one_set_out_fits(variant: ModelVariant, sets: str, *, tests: Tests | None = None) -> tuple[Fit, ...]:
    """For each set, in order, the fit that has not seen it: to all the others, from the fit to all.

    Where the set is one that a fixed constant was taken from, that constant is fitted to the rest of these sets.
    """
    initial = fit_variant(variant, sets, tests=tests).values
    return tuple(
        _refit_without(variant.seen, one, tests)
        if variant.seen is not None and one in variant.seen.sets
        else fit_variant(variant, sets.replace(one, ""), initial=initial, tests=tests)
        for one in sets
    )


def _refit_without(seen: SeenSets, one: str, tests: Tests | None) -> Fit:
    """Model with its constant fitted to the sets that it was taken from, without one of them."""
    others = seen.sets.replace(one, "")
    return fit_variant(seen.refitted, others, tests=tests if select_tests(others, tests) else None)


def cross_validation_errors(variant: ModelVariant, sets: str, *, tests: Tests | None = None) -> ErrorStatistics:
    """Error statistics with each set predicted by a fit that has not seen it."""
    fits = zip(sets, leave_one_set_out_fits(variant, sets, tests=tests), strict=True)
    return error_statistics((test, fit.predict(test)) for one, fit in fits for test in select_tests(one, tests))


def unseen_error(model: FrictionModel) -> ErrorStatistics | None:
    """Error statistics of a friction model on published tests that it has not seen, as `compare` has them.

    None for parameters other than the defaults, and for a model without a variant to fit, of which no error is known.
    """
    if model != type(model)():
        return None
    variants = {variant.name: variant for variant in FRICTION_MODEL_VARIANTS}
    variant = variants.get(model.name.replace("_", "-"))
    return None if variant is None else cross_validation_errors(variant, FITTED_SETS)


def information_criteria(fit: Fit, tests: Tests) -> InformationCriteria | None:
    """Information criteria of a fit on some tests; None where one is outside the range of the model.

    A fixed constant that was taken from published tests counts as a fitted parameter.
    """
    errors = prediction_errors(fit, tests)
    if errors.out_of_range:
        return None
    sets = "".join(test.set_name for test in tests)
    fitted = sum(parameter.applies_to(sets) for parameter in fit.variant.parameters) if fit.sets else 0
    return gaussian_criteria(errors.rms, count=len(tests), parameter_count=fitted + fit.variant.seen_constants)


def gaussian_criteria(rms: float, *, count: int, parameter_count: int) -> InformationCriteria:
    r"""Information criteria for Gaussian errors of unknown variance.

    .. math::

        \mathrm{AICc} = 2 n \ln s + 2 k + \frac{2 k (k + 1)}{n - k - 1}, \qquad \mathrm{BIC} = 2 n \ln s + k \ln n

    with the rms error s of n tests and k parameters, the variance counted. [1]_ [2]_ AICc is infinite for n <= k + 1.

    References
    ----------
    .. [1] C. M. Hurvich and C.-L. Tsai, Biometrika 76, 297 (1989). doi:10.1093/biomet/76.2.297
    .. [2] G. Schwarz, Ann. Stat. 6, 461 (1978). doi:10.1214/aos/1176344136
    """
    deviance = 2 * count * np.log(rms)
    k = parameter_count + 1
    return InformationCriteria(
        aicc=float(deviance + 2 * k + 2 * k * (k + 1) / (count - k - 1)) if count > k + 1 else float("inf"),
        bic=float(deviance + k * np.log(count)),
        parameter_count=parameter_count,
    )
