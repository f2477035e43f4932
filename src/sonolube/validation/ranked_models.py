"""Model variants fitted to own runs, with each condition predicted unseen, and whether the runs tell them apart."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.validation.assessment import InformationCriteria, gaussian_criteria, leave_one_set_out_fits
from sonolube.validation.comparison import FittedParameter, fitted_parameters
from sonolube.validation.fitting import SMALLEST_RMS, Fit, fit_variant, root_mean_square
from sonolube.validation.model_variant import ModelVariant
from sonolube.validation.run_conditions import RunConditions

_SMALLEST_ERROR: Final = 1e-3  # of a friction ratio, below which no rig tells models apart
_LEVEL: Final = 0.05  # of the test of equal errors


@dataclass(frozen=True, kw_only=True, slots=True)
class RankedModel:
    """Model variant fitted to own runs.

    Parameters
    ----------
    fit : Fit
        To all conditions.
    parameters : tuple of FittedParameter
        With the range of the fits with conditions left out; one or two parameters have 95 % intervals.
    fitted, unseen : tuple of float or None
        Friction ratio of each condition by the fit to all, and by the fit without it; None outside the range.
    rms_fit, rms_unseen : float
        Root mean square errors of these over the conditions within the range.
    information : InformationCriteria or None
        None where a condition is outside the range.
    probability : float or None
        Of paired errors so unlike those of the first model if both predicted alike; None for the first and where
        conditions are outside the range.
    tied : bool
        Whether the runs do not tell the model from the first.
    """

    fit: Fit
    parameters: tuple[FittedParameter, ...]
    fitted: tuple[float | None, ...]
    unseen: tuple[float | None, ...]
    rms_fit: float
    rms_unseen: float
    information: InformationCriteria | None
    probability: float | None = None
    tied: bool = False

    @property
    def name(self) -> str:
        """Name of the variant."""
        return self.fit.variant.name

    @property
    def reached(self) -> int:
        """Number of conditions within the range of the model."""
        return sum(ratio is not None for ratio in self.unseen)

    @property
    def aicc(self) -> float | None:
        """Corrected Akaike criterion; None where the conditions are too few or some are out of range."""
        return None if self.information is None or self.information.aicc == float("inf") else self.information.aicc


def own_rig_variants(models: Iterable[ModelVariant]) -> tuple[ModelVariant, ...]:
    """Model variants whose parameters of single published rigs are those of one rig, whose runs none has seen.

    Each parameter once, and each combination of model and parameters once, by its first name.
    """
    distinct: dict[object, ModelVariant] = {}
    for model in models:
        parameters = {each.name: replace(each, applicable_sets="") for each in model.parameters}
        own = replace(model, parameters=tuple(parameters.values()), seen=None)
        distinct.setdefault((model.ratio, frozenset(parameters)), own)
    return tuple(distinct.values())


def ranked_model(variant: ModelVariant, conditions: tuple[RunConditions, ...]) -> RankedModel:
    """Variant fitted to all conditions, with each predicted by a fit to the others."""
    sets = "".join(dict.fromkeys(one.set_name for one in conditions))
    fit = replace(fit_variant(variant, sets, tests=conditions), sets=sets)
    left_out = dict(zip(sets, leave_one_set_out_fits(variant, sets, tests=conditions), strict=True))
    fitted = tuple(fit.predict(one) for one in conditions)
    unseen = tuple(left_out[one.set_name].predict(one) for one in conditions)
    rms = root_mean_square(_errors(fitted, conditions))
    within, count, free = None not in fitted, len(conditions), len(conditions) - len(fit.values)
    from scipy.stats import t as student

    quantile = count * float(np.log1p(student.ppf(0.975, free) ** 2 / free)) if within and free > 0 else None
    return RankedModel(
        fit=fit,
        parameters=fitted_parameters(fit, left_out, conditions, largest_excess=quantile),
        fitted=fitted,
        unseen=unseen,
        rms_fit=rms,
        rms_unseen=root_mean_square(_errors(unseen, conditions)),
        information=gaussian_criteria(max(rms, SMALLEST_RMS), count=count, parameter_count=len(variant.parameters))
        if within
        else None,
    )


def _errors(predicted: tuple[float | None, ...], conditions: tuple[RunConditions, ...]) -> Floats:
    """Predicted minus measured ratios of the conditions within the range."""
    pairs = zip(predicted, conditions, strict=True)
    return np.array([ratio - one.friction_ratio for ratio, one in pairs if ratio is not None])


def with_probabilities(models: list[RankedModel], conditions: tuple[RunConditions, ...]) -> tuple[RankedModel, ...]:
    """Ranked models with the probabilities that they predict as the first does."""
    if not models:
        return ()
    best, count = models[0], len(conditions)
    ranked = [best]
    for model in models[1:]:
        if best.reached < count or model.reached < count:
            ranked.append(model)
            continue
        probability = _probability_of_equal_errors(*(_errors(one.unseen, conditions) for one in (best, model)))
        alike = model.rms_unseen < _SMALLEST_ERROR or probability > _LEVEL
        ranked.append(replace(model, probability=probability, tied=alike))
    return tuple(ranked)


def _probability_of_equal_errors(first: Floats, second: Floats) -> float:
    """Two-sided probability of paired errors so unlike if both had one variance about zero."""
    sums, differences = first + second, second - first
    norms = float(np.sum(sums**2) * np.sum(differences**2))
    if norms <= _SMALLEST_ERROR**8:
        return 1.0
    correlation = float(np.clip(np.sum(sums * differences) / np.sqrt(norms), -1, 1))
    if abs(correlation) == 1:
        return 0.0
    value = correlation / np.sqrt((1 - correlation**2) / (first.size - 1))
    from scipy.stats import t as student

    return float(2 * student.sf(abs(value), first.size - 1))
