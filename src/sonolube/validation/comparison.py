"""Comparison of model variants on published tests: fits, cross-validation, predictions of a rig and of own runs.

A variant is fitted to the friction ratios of all tests whose conditions have its required inputs; then each set of
tests is left out in turn and predicted by a fit to the others. This cross-validation error, not that of the fit, is the
uncertainty of a prediction on another rig, and ranks the variants.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from sonolube.errors import UnknownName
from sonolube.validation.assessment import (
    CHI_SQUARED_95,
    FITTED_SETS,
    Assessment,
    ErrorStatistics,
    Fit,
    assess_variant,
    error_statistics,
    leave_one_set_out_fits,
    profile_likelihood_interval,
    root_mean_square,
    select_tests,
)
from sonolube.validation.coulomb_and_spring_variants import COULOMB_AND_SPRING_VARIANTS
from sonolube.validation.dahl_and_lugre_variants import DAHL_AND_LUGRE_VARIANTS
from sonolube.validation.friction_model_variants import FRICTION_MODEL_VARIANTS
from sonolube.validation.model_variant import FreeParameter, ModelVariant, VibratedRig
from sonolube.validation.published_tests import (
    IN_PLANE_VIBRATION_SETS,
    NORMAL_VIBRATION_SETS,
    MeasuredConditions,
    Tests,
)
from sonolube.validation.run_conditions import RunsTable

Advance = Callable[[str, int, int], None]

COMPARED_MODELS: Final[tuple[ModelVariant, ...]] = (
    *FRICTION_MODEL_VARIANTS,
    *COULOMB_AND_SPRING_VARIANTS,
    *DAHL_AND_LUGRE_VARIANTS,
)
"""All model variants: of the friction models of this program and of the literature."""

DATA_SETS: Final[dict[str, str]] = {**NORMAL_VIBRATION_SETS, **IN_PLANE_VIBRATION_SETS}
"""Content of each set of tests, by its letter."""

ONLY_PREDICTED: Final = {"H": "its amplitude at resonance is not known; it is predicted only"}
"""Sets to which no variant is fitted, with the reason."""

_MAX_PROFILED: Final = 2  # parameters of a variant whose intervals are computed; with more, each point takes a long fit


@dataclass(frozen=True, kw_only=True, slots=True)
class FittedParameter:
    """Fitted value of one free parameter with its uncertainty, in SI.

    Parameters
    ----------
    parameter : FreeParameter
    value : float
        Value fitted to all sets.
    interval : tuple of float or None
        95 % profile likelihood interval, truncated at the bounds; None for variants of more than two parameters.
    leave_one_out_range : tuple of float or None
        Smallest and largest value of the fits with one set left out; None where no such fit determines the parameter.
    """

    parameter: FreeParameter
    value: float
    interval: tuple[float, float] | None
    leave_one_out_range: tuple[float, float] | None

    @property
    def at_bound(self) -> bool:
        """Whether the value is at a physical bound."""
        if self.parameter.is_angle:
            return False
        slack = 1e-3 * (self.parameter.high - self.parameter.low)
        return min(self.value - self.parameter.low, self.parameter.high - self.value) < slack


@dataclass(frozen=True, kw_only=True, slots=True)
class Prediction:
    """Friction ratios of one test by one model variant.

    Parameters
    ----------
    test : MeasuredConditions
    fitted : float or None
        Friction ratio by the fit to all sets; None where the variant does not apply.
    cross_validated : float or None
        Friction ratio by what has not seen the set: the fit to the other sets.
    reason : str or None
        Reason why the variant does not apply to the test, or why its ratio, here always that of the formula, is outside
        the range of the friction model.
    """

    test: MeasuredConditions
    fitted: float | None
    cross_validated: float | None
    reason: str | None


@dataclass(frozen=True, kw_only=True, slots=True)
class ComparedFit:
    """Model variant with its assessment and its predictions of the tests.

    Parameters
    ----------
    model : ModelVariant
    sets : str
        Letters of the sets that it was fitted to and assessed on.
    assessment : Assessment or None
        Errors and information criteria; None where no set has its required inputs.
    parameters : tuple of FittedParameter
    predictions : tuple of Prediction
        Predictions of all tests, those of other sets included.
    """

    model: ModelVariant
    sets: str
    assessment: Assessment | None
    parameters: tuple[FittedParameter, ...]
    predictions: tuple[Prediction, ...]

    @property
    def fit(self) -> Fit:
        """Fit to all sets; the defaults of all parameters where there is none."""
        defaults = tuple(parameter.default for parameter in self.model.parameters)
        return self.assessment.fit if self.assessment else Fit(variant=self.model, sets="", values=defaults)

    @property
    def aicc(self) -> float | None:
        """Corrected Akaike criterion; None where a test is out of range or the tests are too few for it."""
        criteria = self.assessment.information if self.assessment else None
        return None if criteria is None or criteria.aicc == float("inf") else criteria.aicc

    def errors_in(self, set_name: str) -> ErrorStatistics | None:
        """Error statistics of the fit in one set; None where all its tests are out of range."""
        of_set = [one for one in self.predictions if one.test.set_name == set_name]
        errors = error_statistics((one.test, one.fitted) for one in of_set)
        return errors if errors.count else None


@dataclass(frozen=True, kw_only=True, slots=True)
class RigPrediction:
    """Friction ratio of a rig by one model variant.

    Parameters
    ----------
    model : ModelVariant
    friction_ratio : float or None
        Friction with vibration over friction without; None where the variant does not apply. []
    raw_friction_ratio : float or None
        That ratio by the formula, also outside the range of the friction model. []
    uncertainty : float or None
        Root mean square cross-validation error; None where the variant was assessed on fewer than two sets, or some
        of their tests are outside its range.
    reason : str or None
        Reason why the variant does not apply to the rig.
    """

    model: ModelVariant
    friction_ratio: float | None
    raw_friction_ratio: float | None
    uncertainty: float | None
    reason: str | None


def compared_models(names: Iterable[str] = ()) -> tuple[ModelVariant, ...]:
    """Model variants of some names in the order of `COMPARED_MODELS`; all of them if no name is given."""
    known = {model.name: model for model in COMPARED_MODELS}
    selected = list(names)
    for name in selected:
        if name not in known:
            raise UnknownName.among(known, kind="model", name=name)
    return tuple(model for model in COMPARED_MODELS if not selected or model.name in selected)


def compare_models(
    models: tuple[ModelVariant, ...] = COMPARED_MODELS,
    *,
    tests: Tests | None = None,
    advance: Advance = lambda name, done, total: None,
) -> tuple[ComparedFit, ...]:
    """Model variants fitted to and assessed on the tests that have their required inputs.

    Those that reach the most tests first; of these in increasing order of their cross-validation error.

    Errors and information criteria are comparable on the same tests only, not between variants assessed on different
    sets.
    """
    fits = []
    for done, model in enumerate(models, start=1):
        fits.append(_compared_fit(model, tests))
        advance(model.name, done, len(models))
    return tuple(sorted(fits, key=_rank))


def predict_rig(fits: tuple[ComparedFit, ...], rig: VibratedRig) -> tuple[RigPrediction, ...]:
    """Friction ratio of a rig by every fitted variant, in increasing order of the uncertainty.

    Those that do not apply come last.

    Parameters specific to one rig of the tests, such as in-plane motion, keep their defaults.
    """
    return tuple(sorted((_rig_prediction(one, rig) for one in fits), key=_rig_rank))


def _compared_fit(model: ModelVariant, tests: Tests | None) -> ComparedFit:
    """One variant fitted to, and assessed on, the sets whose tests have its required inputs."""
    selected = select_tests("".join(DATA_SETS), tests)
    applicable = {test.set_name for test in selected if model.inapplicability(test) is None}
    sets = "".join(letter for letter in (*FITTED_SETS, *IN_PLANE_VIBRATION_SETS) if letter in applicable)
    if not sets:
        predictions = tuple(
            Prediction(test=test, fitted=None, cross_validated=None, reason=model.inapplicability(test))
            for test in selected
        )
        return ComparedFit(model=model, sets="", assessment=None, parameters=(), predictions=predictions)
    assessment = assess_variant(model, sets, tests=tests)
    left_out = dict(zip(sets, leave_one_set_out_fits(model, sets, tests=tests), strict=True))
    return ComparedFit(
        model=model,
        sets=sets,
        assessment=assessment,
        parameters=fitted_parameters(assessment.fit, left_out, tests),
        predictions=tuple(
            _prediction(test, assessment.fit, left_out.get(test.set_name, assessment.fit)) for test in selected
        ),
    )


def fitted_parameters(
    fit: Fit, left_out: dict[str, Fit], tests: Tests | None, *, largest_excess: float | None = CHI_SQUARED_95
) -> tuple[FittedParameter, ...]:
    """Fitted parameters with ranges over the fits with one set left out, and with intervals of an excess of deviance.

    Without intervals where no excess is given, or where each of their points would take a long fit.
    """
    parameters, found = fit.variant.parameters, []
    for index, (parameter, value) in enumerate(zip(parameters, fit.values, strict=True)):
        others = [
            other.values[index]
            for letter, other in left_out.items()
            if parameter.applies_to("".join(left_out).replace(letter, ""))
        ]
        interval = None
        if largest_excess is not None and len(parameters) <= _MAX_PROFILED:
            interval = profile_likelihood_interval(fit, index, tests=tests, largest_excess=largest_excess)
        span = (min(others), max(others)) if others else None
        found.append(FittedParameter(parameter=parameter, value=value, interval=interval, leave_one_out_range=span))
    return tuple(found)


def _prediction(test: MeasuredConditions, fit: Fit, left_out: Fit) -> Prediction:
    """Prediction of one test by the fit to all sets and by that to the other sets."""
    missing = fit.variant.inapplicability(test)
    if missing:
        return Prediction(test=test, fitted=None, cross_validated=None, reason=missing)
    fitted = fit.predict(test)
    return Prediction(
        test=test,
        fitted=fitted,
        cross_validated=left_out.predict(test),
        reason=fit.variant.range_violation(test, *fit.values) or fit.variant.range_objection(test, fitted),
    )


def _rig_prediction(one: ComparedFit, rig: VibratedRig) -> RigPrediction:
    """Friction ratio of a rig by one fitted variant, its cross-validation error as the uncertainty."""
    missing = one.model.inapplicability(rig)
    raw = None if missing else one.fit.predict(rig)
    objection = one.model.range_objection(rig, raw)
    ratio = None if objection else raw
    errors = one.assessment.cross_validation_errors if one.assessment else None
    known = errors is not None and not errors.out_of_range and len(one.sets) > 1 and ratio is not None
    return RigPrediction(
        model=one.model,
        friction_ratio=ratio,
        raw_friction_ratio=raw,
        uncertainty=errors.rms if errors and known else None,
        reason=missing or objection or one.model.range_violation(rig, *one.fit.values),
    )


def _rig_rank(one: RigPrediction) -> tuple[bool, float]:
    """Sort key of a prediction: whether it is missing, then its uncertainty."""
    return one.friction_ratio is None, float("inf") if one.uncertainty is None else one.uncertainty


def _rank(one: ComparedFit) -> tuple[int, float]:
    """Sort key of a fit: the tests that it reaches, most first, then its cross-validation error."""
    unseen = None if one.assessment is None else one.assessment.cross_validation_errors
    return (0, float("inf")) if unseen is None else (-unseen.count, unseen.rms)


@dataclass(frozen=True, kw_only=True, slots=True)
class RunsPrediction:
    """Friction ratios of own conditions by one variant as published tests fitted it.

    Parameters
    ----------
    model : ModelVariant
    ratios : tuple of float or None
        Of each condition; None where the variant does not apply.
    rms : float or None
        Root mean square error over the conditions to which it applies; None where there is none.
    mean : float or None
        Mean error, predicted minus measured.
    cross_validated_rms : float or None
        Error to expect, by the published sets left out in turn.
    reason : str or None
        Why the variant does not apply to some condition.
    """

    model: ModelVariant
    ratios: tuple[float | None, ...]
    rms: float | None
    mean: float | None
    cross_validated_rms: float | None
    reason: str | None

    @property
    def reached(self) -> int:
        """Number of conditions to which it applies."""
        return sum(ratio is not None for ratio in self.ratios)


def predict_runs(fits: tuple[ComparedFit, ...], table: RunsTable) -> tuple[RunsPrediction, ...]:
    """Friction ratios of own conditions by every variant fitted to published tests.

    Those that apply to most conditions first, by their error.
    """
    return tuple(sorted((_runs_prediction(one, table) for one in fits), key=_runs_rank))


def _runs_prediction(one: ComparedFit, table: RunsTable) -> RunsPrediction:
    """Friction ratios of own conditions by one variant."""
    missing = next(filter(None, map(one.model.inapplicability, table.conditions)), None)
    ratios = [
        None if one.model.inapplicability(condition) else one.fit.predict(condition) for condition in table.conditions
    ]
    pairs = zip(ratios, table.conditions, strict=True)
    errors = np.array([ratio - condition.friction_ratio for ratio, condition in pairs if ratio is not None])
    beyond = None
    if not missing and None in ratios:
        beyond = one.model.range_violation(table.conditions[ratios.index(None)], *one.fit.values)
    return RunsPrediction(
        model=one.model,
        ratios=tuple(ratios),
        rms=root_mean_square(errors) if errors.size else None,
        mean=float(np.mean(errors)) if errors.size else None,
        cross_validated_rms=one.assessment.cross_validation_errors.rms if one.assessment else None,
        reason=missing or beyond,
    )


def _runs_rank(one: RunsPrediction) -> tuple[int, float]:
    """Sort key of a prediction: conditions that it does not reach, then its error."""
    return len(one.ratios) - one.reached, float("inf") if one.rms is None else one.rms
