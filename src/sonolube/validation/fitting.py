"""Least-squares fits of model variants to measured friction ratios, and profile likelihood intervals of parameters."""

from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, least_squares

from sonolube.checks import Floats
from sonolube.validation.free_parameters import FreeParameter
from sonolube.validation.model_variant import ModelVariant
from sonolube.validation.published_tests import Conditions, Tests, friction_tests, in_plane_tests

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
