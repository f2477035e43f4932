"""Every applicable model on every applicable set of published tests: fitted, cross-validated, and with nothing fitted.

A model is fitted by least squares to the friction ratios of all tests that it can be asked about and whose
circumstances are known; then each set of tests is left out in turn and predicted by a fit to the others. That unseen
error, not the error of the fit, is what a new rig has to expect.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Final

from sonolube.validation.closure_comparison import ALL_FITTED, Judgement, judged
from sonolube.validation.earlier_tests import EARLIER_SETS
from sonolube.validation.fit import Errors, Fit, errors_between, left_out, profile_interval, taken
from sonolube.validation.friction_tests import SETS, Circumstances, Measured
from sonolube.validation.models import COMPARED_MODELS, ComparedModel
from sonolube.validation.parameters import Parameter
from sonolube.validation.vibrated_rig import VibratedRig

Advance = Callable[[str, int, int], None]

DATA_SETS: Final = {**SETS, **EARLIER_SETS}
"""What each set of tests is, by its letter."""

ONLY_PREDICTED: Final = {"H": "its amplitude at resonance is not known; it is predicted only"}
"""Sets that no model is fitted to, and why."""

_PROFILED: Final = 2  # parameters of a model whose intervals are computed; beyond, each point is a fit of its own


@dataclass(frozen=True, kw_only=True, slots=True)
class FittedParameter:
    """What a fit made of one free parameter, SI.

    Parameters
    ----------
    parameter : Parameter
    value : float
        Its value fitted to all sets.
    interval : tuple of float or None
        With 95 %, the others fitted anew, cut at the bounds; None for models of more than two parameters.
    left_out_range : tuple of float or None
        From least to most over the fits with one set left out; None where no fit without one can tell it.
    """

    parameter: Parameter
    value: float
    interval: tuple[float, float] | None
    left_out_range: tuple[float, float] | None

    @property
    def at_bound(self) -> bool:
        """Whether the fit would go on past the physical bounds."""
        if self.parameter.is_angle:
            return False
        slack = 1e-3 * (self.parameter.high - self.parameter.low)
        return min(self.value - self.parameter.low, self.parameter.high - self.value) < slack


@dataclass(frozen=True, kw_only=True, slots=True)
class Prediction:
    """What a model says of one test.

    Parameters
    ----------
    test : Measured
    fitted : float or None
        Friction ratio by the fit to all sets; None where the model does not reach.
    unseen : float or None
        Friction ratio by the fit to the other sets.
    refusal : str or None
        Why it does not reach the test.
    """

    test: Measured
    fitted: float | None
    unseen: float | None
    refusal: str | None


@dataclass(frozen=True, kw_only=True, slots=True)
class ComparedFit:
    """One model against the tests.

    Parameters
    ----------
    model : ComparedModel
    sets : str
        Letters of the sets it was fitted to and judged on.
    judgement : Judgement or None
        Its errors and criteria; None where no set suits it.
    parameters : tuple of FittedParameter
    predictions : tuple of Prediction
        Of every test, those of other sets too.
    """

    model: ComparedModel
    sets: str
    judgement: Judgement | None
    parameters: tuple[FittedParameter, ...]
    predictions: tuple[Prediction, ...]

    @property
    def fit(self) -> Fit:
        """The fit to all sets; all parameters at rest where there is none."""
        rest = tuple(parameter.rest for parameter in self.model.variant.parameters)
        return self.judgement.fit if self.judgement else Fit(variant=self.model.variant, sets="", values=rest)

    @property
    def akaike(self) -> float | None:
        """Akaike's corrected criterion; None where the model misses a test or the tests are too few for it."""
        known = self.judgement.information if self.judgement else None
        return None if known is None or known.akaike == float("inf") else known.akaike

    def errors_in(self, set_name: str) -> Errors | None:
        """Return the errors of the fit in one set; None where the model reaches none of its tests."""
        of_set = [one for one in self.predictions if one.test.set_name == set_name]
        errors = errors_between((one.test, one.fitted) for one in of_set)
        return errors if errors.count else None


@dataclass(frozen=True, kw_only=True, slots=True)
class RigPrediction:
    """What a model says of a rig.

    Parameters
    ----------
    model : ComparedModel
    friction_ratio : float or None
        Friction with vibration over friction without; None where the model does not apply. []
    uncertainty : float or None
        Rms error of the model in sets of tests that its fit had not seen; None where it was judged on fewer than
        two sets, or does not reach all their tests.
    refusal : str or None
        Why it does not apply.
    """

    model: ComparedModel
    friction_ratio: float | None
    uncertainty: float | None
    refusal: str | None


def compare_models(
    models: tuple[ComparedModel, ...] = COMPARED_MODELS,
    *,
    among: tuple[Measured, ...] | None = None,
    advance: Advance = lambda what, done, total: None,
) -> tuple[ComparedFit, ...]:
    """Return every model fitted to and judged on the tests it can be asked about.

    Parameters
    ----------
    models : tuple of ComparedModel
    among : tuple of Measured, optional
        Tests; all published ones where absent.
    advance : callable
        Told after each model what was done, how many are done, and of how many.

    Returns
    -------
    tuple of ComparedFit
        The least criterion of Akaike first; after them those without one, by their unseen error.

    Notes
    -----
    Criteria compare models on the same tests only: those of a model that misses a test, or was judged on other sets,
    stand for themselves.
    """
    found = []
    for done, model in enumerate(models, start=1):
        found.append(_compared(model, among))
        advance(model.name, done, len(models))
    return tuple(sorted(found, key=_rank))


@cache
def published_comparison() -> tuple[ComparedFit, ...]:
    """Return every model against all published tests."""
    return compare_models()


def predict_rig(fits: tuple[ComparedFit, ...], rig: VibratedRig) -> tuple[RigPrediction, ...]:
    """Return what every model says of a rig, each with its unseen error as the uncertainty; the least of these first.

    Notes
    -----
    Parameters that belong to one rig of the tests, such as a parasitic motion, stay at rest: nothing tells them here.
    """
    return tuple(sorted((_of_rig(one, rig) for one in fits), key=_trust))


def _compared(model: ComparedModel, among: tuple[Measured, ...] | None) -> ComparedFit:
    tests = taken("".join(DATA_SETS), among)
    known = {test.set_name for test in tests if model.inapplicable(test) is None}
    sets = "".join(letter for letter in (*ALL_FITTED, *EARLIER_SETS) if letter in known)
    if not sets:
        predictions = tuple(
            Prediction(test=test, fitted=None, unseen=None, refusal=model.inapplicable(test)) for test in tests
        )
        return ComparedFit(model=model, sets="", judgement=None, parameters=(), predictions=predictions)
    judgement = judged(model.variant, sets, among=among)
    without = dict(zip(sets, left_out(model.variant, sets, among=among), strict=True))
    return ComparedFit(
        model=model,
        sets=sets,
        judgement=judgement,
        parameters=_parameters(judgement.fit, without, among),
        predictions=tuple(
            _predicted(model, test, judgement.fit, without.get(test.set_name, judgement.fit)) for test in tests
        ),
    )


def _parameters(fit: Fit, without: dict[str, Fit], among: tuple[Measured, ...] | None) -> tuple[FittedParameter, ...]:
    free, found = fit.variant.parameters, []
    for place, (parameter, value) in enumerate(zip(free, fit.values, strict=True)):
        others = [
            other.values[place]
            for letter, other in without.items()
            if parameter.matters_to("".join(without).replace(letter, ""))
        ]
        found.append(
            FittedParameter(
                parameter=parameter,
                value=value,
                interval=profile_interval(fit, place, among=among) if len(free) <= _PROFILED else None,
                left_out_range=(min(others), max(others)) if others else None,
            )
        )
    return tuple(found)


def _predicted(model: ComparedModel, test: Measured, fit: Fit, without: Fit) -> Prediction:
    unknown = model.inapplicable(test)
    if unknown:
        return Prediction(test=test, fitted=None, unseen=None, refusal=unknown)
    return Prediction(
        test=test,
        fitted=fit.predict(test),
        unseen=without.predict(test),
        refusal=model.variant.refusal(test, *fit.values),
    )


def _of_rig(one: ComparedFit, rig: Circumstances) -> RigPrediction:
    unknown = one.model.inapplicable(rig)
    ratio = None if unknown else one.fit.predict(rig)
    unseen = one.judgement.unseen if one.judgement else None
    return RigPrediction(
        model=one.model,
        friction_ratio=ratio,
        uncertainty=unseen.rms if unseen and not unseen.missed and len(one.sets) > 1 and ratio is not None else None,
        refusal=unknown or one.model.variant.refusal(rig, *one.fit.values),
    )


def _trust(one: RigPrediction) -> tuple[bool, float]:
    return one.friction_ratio is None, float("inf") if one.uncertainty is None else one.uncertainty


def _rank(one: ComparedFit) -> tuple[bool, float]:
    if one.akaike is not None:
        return False, one.akaike
    return True, one.judgement.unseen.rms if one.judgement else float("inf")
