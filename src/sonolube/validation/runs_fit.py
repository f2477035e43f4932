"""Own measured runs against every model variant: fitted, predicted unseen, ranked, and what would separate the leaders.

The repeats of a condition are averaged, and each condition is predicted by a fit to the others. The errors of two
models, paired by condition, say whether the runs tell them apart.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from math import hypot
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.validation.assessment import (
    SMALLEST_RMS,
    Fit,
    InformationCriteria,
    fit_variant,
    gaussian_criteria,
    leave_one_set_out_fits,
    root_mean_square,
)
from sonolube.validation.comparison import COMPARED_MODELS, FittedParameter, fitted_parameters
from sonolube.validation.model_variant import REQUIRED_INPUTS, ModelVariant
from sonolube.validation.run_conditions import RunConditions, RunsTable, run_conditions

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.rig import Rig

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


_SMALLEST_RMS: Final = 1e-3  # of a friction ratio, below which no rig measures
_LEADERS: Final = 5  # models between which the next condition decides
_STEPS: Final = 13  # of the candidates along strength and speed
_BEYOND: Final = 2.0  # factor by which candidates may lie beyond the runs
_MUCH_BETTER: Final = 1.5  # of a candidate beyond the runs over the best within them


@dataclass(frozen=True, kw_only=True, slots=True)
class NextCondition:
    """Condition under which two leading models differ most for their errors.

    Parameters
    ----------
    condition : RunConditions
    first, second : str
        Names of the models.
    first_ratio, second_ratio : float
        Friction ratios that they predict.
    contrast : float
        Their difference over the root sum square of their unseen errors.
    is_beyond : bool
        Whether the condition is beyond the strengths and speeds of the runs.
    """

    condition: RunConditions
    first: str
    second: str
    first_ratio: float
    second_ratio: float
    contrast: float
    is_beyond: bool


def next_conditions(
    models: tuple[RankedModel, ...], conditions: tuple[RunConditions, ...]
) -> tuple[NextCondition, ...]:
    """Conditions that separate the leading models most, within the runs and beyond them.

    Beyond the runs, by at most a factor of two, only where that separates much better; empty for one model.
    """
    leaders = models[:1] + tuple(one for one in models[1:] if one.tied)
    leaders = (leaders if len(leaders) > 1 else models)[:_LEADERS]
    found = [_most_separating(leaders, conditions, beyond) for beyond in (1.0, _BEYOND)]
    within, beyond = found
    if beyond is None or (within is not None and beyond.contrast < _MUCH_BETTER * within.contrast):
        return () if within is None else (within,)
    return (beyond,) if within is None else (within, beyond)


def _most_separating(
    models: tuple[RankedModel, ...], conditions: tuple[RunConditions, ...], beyond: float
) -> NextCondition | None:
    """Condition of a grid over strength and speed, widened by a factor, that separates two models most."""
    base = conditions[0]
    strengths, speeds = (
        _grid([getattr(one, name) for one in conditions], beyond) for name in ("strength", "sliding_speed")
    )
    best: NextCondition | None = None
    for strength in strengths:
        for speed in speeds:
            place = base.at(strength=strength, sliding_speed=speed)
            ratios = [(model, ratio) for model in models if (ratio := model.fit.predict(place)) is not None]
            for (first, one), (second, other) in combinations(ratios, 2):
                contrast = abs(one - other) / max(hypot(first.rms_unseen, second.rms_unseen), _SMALLEST_RMS)
                if best is None or contrast > best.contrast:
                    best = NextCondition(
                        condition=place,
                        first=first.name,
                        second=second.name,
                        first_ratio=one,
                        second_ratio=other,
                        contrast=contrast,
                        is_beyond=beyond > 1,
                    )
    return best


def _grid(values: list[float | None], beyond: float) -> list[float | None]:
    """Values from the lowest to the highest of the runs, widened by a factor."""
    known = [value for value in values if value is not None]
    if not known:
        return [None]
    low, high = min(known) / beyond, max(known) * beyond
    return [low] if low == high else np.geomspace(low, high, _STEPS).tolist()


_MIN_CONDITIONS = 5  # from which a ranking counts as decided
Advance = Callable[[str, int, int], None]


@dataclass(frozen=True, kw_only=True, slots=True)
class RunsFit:
    """Own runs against model variants.

    Parameters
    ----------
    table : RunsTable
    models : tuple of RankedModel
        Those that reach every condition first, by their unseen error.
    inapplicable : dict of str to str
        Reason by the name of the model, with what to add.
    rms_of_mean : float
        Root mean square error of the mean of the other conditions, which needs no model.
    next_conditions : tuple of NextCondition
        Within the runs, then beyond them where that is much better; empty for one model.
    """

    table: RunsTable
    models: tuple[RankedModel, ...]
    inapplicable: dict[str, str]
    rms_of_mean: float
    next_conditions: tuple[NextCondition, ...]

    @property
    def tied(self) -> tuple[RankedModel, ...]:
        """Models that the runs do not tell from the first."""
        return tuple(model for model in self.models if model.tied)

    @property
    def is_decided(self) -> bool:
        """Whether the runs tell the first model from every other, and it predicts better than their mean."""
        return bool(self.models) and not list(self._doubts())

    @property
    def verdict(self) -> str:
        """Whether the ranking is decided, in a sentence."""
        if not self.models:
            return "no model applies to these runs"
        best, doubts = self.models[0].name, list(self._doubts())
        if doubts:
            return f"not decided: {'; '.join(doubts)}"
        if len(self.models) == 1:
            return f"only {best} applies, and predicts unseen conditions better than the mean of the others"
        return f"decided: {best} predicts unseen conditions better than every other, by paired errors"

    def _doubts(self) -> Iterator[str]:
        """Yield each reason for which the first model does not win."""
        best, count = self.models[0], len(self.table.conditions)
        if count < _MIN_CONDITIONS:
            yield f"{count} conditions are too few to rank models; {best.name} leads"
        elif self.tied:
            yield f"{count} conditions do not tell {best.name} from {_listed([one.name for one in self.tied])}"
        if best.reached < count:
            yield f"no model reaches every condition; {best.name} reaches {best.reached} of {count}"
        elif best.rms_unseen >= self.rms_of_mean:
            yield (
                f"no model predicts better than the mean of the other conditions; {best.name}, the best, errs by"
                f" {best.rms_unseen:.3f}, the mean by {self.rms_of_mean:.3f}"
            )


def fit_runs(
    runs: "xr.Dataset",
    rig: "Rig | None" = None,
    *,
    models: Iterable[ModelVariant] = COMPARED_MODELS,
    advance: Advance = lambda name, done, total: None,
) -> RunsFit:
    r"""Own measured runs against every applicable model variant, ranked by what each predicts unseen.

    Each condition counts once, as the mean of its repeats. Conditions are left out one at a time, in twelve groups
    where there are more. A model is tied with the first where the test of Morgan, Granger and Newbold does not
    reject equal unseen errors at 5 %: with the sums x and differences z of the paired errors,

    .. math:: r = \frac{\sum x z}{\sqrt{\sum x^2 \sum z^2}}, \qquad t = \frac{r}{\sqrt{(1 - r^2)/(n - 1)}}

    follows Student's t with n - 1 degrees of freedom. Errors below 0.001 count as equal. Intervals of parameters are of
    the profile likelihood, with the quantile that is exact for a linear model: n ln(1 + t^2/(n - k)) for n conditions
    and k parameters.

    Source: F. X. Diebold and R. S. Mariano, J. Bus. Econ. Stat. 13, 253 (1995). doi:10.2307/1392185
    """
    table = run_conditions(runs, rig)
    count = len(table.conditions)
    if count < 2:
        raise InvalidInput(
            f"{table.title}: {table.runs} run{'s' * (table.runs > 1)} under one condition"
            f" ({table.conditions[0].settings}) rank no models: vary amplitude or speed"
        )
    variants = own_rig_variants(models)
    inapplicable = {variant.name: reason for variant in variants if (reason := _inapplicability(variant, table))}
    ranked = []
    for done, variant in enumerate(variants, start=1):
        if variant.name not in inapplicable:
            ranked.append(ranked_model(variant, table.conditions))
        advance(variant.name, done, len(variants))
    for model in ranked:
        if not model.reached:
            inapplicable[model.name] = "every condition is outside its range"
    reaching = [model for model in ranked if model.reached]
    ordered = with_probabilities(sorted(reaching, key=lambda one: (-one.reached, one.rms_unseen)), table.conditions)
    measured = np.array([one.friction_ratio for one in table.conditions])
    others = (np.sum(measured) - measured) / (count - 1)
    return RunsFit(
        table=table,
        models=ordered,
        inapplicable=inapplicable,
        rms_of_mean=root_mean_square(others - measured),
        next_conditions=next_conditions(ordered, table.conditions),
    )


def _inapplicability(variant: ModelVariant, table: RunsTable) -> str | None:
    """Why a variant does not apply to the runs, with what to add; None where it does."""
    lacking = {name for one in table.conditions for name in variant.required_inputs if getattr(one, name, None) is None}
    if lacking:
        return "needs " + "; ".join(
            dict.fromkeys(REQUIRED_INPUTS[name]["remedy"] for name in variant.required_inputs if name in lacking)
        )
    least = len(variant.parameters) + 2 if variant.parameters else 2
    if len(table.conditions) < least:
        return f"fits {len(variant.parameters)} parameters: needs {least} conditions, has {len(table.conditions)}"
    return None


def _listed(names: list[str]) -> str:
    """Names in a sentence, at most four of them."""
    if len(names) > 4:
        return f"{', '.join(names[:3])} and {len(names) - 3} others"
    return ", ".join(names[:-1]) + (" and " if len(names) > 1 else "") + names[-1]
