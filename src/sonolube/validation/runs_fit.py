"""Own measured runs against every model variant: fitted, predicted unseen, ranked, and what would separate the leaders.

The repeats of a condition are averaged, and each condition is predicted by a fit to the others. The errors of two
models, paired by condition, say whether the runs tell them apart.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.validation.comparison import COMPARED_MODELS
from sonolube.validation.fitting import root_mean_square
from sonolube.validation.model_variant import REQUIRED_INPUTS, ModelVariant
from sonolube.validation.ranked_models import RankedModel, own_rig_variants, ranked_model, with_probabilities
from sonolube.validation.run_conditions import RunsTable, run_conditions
from sonolube.validation.separating_condition import NextCondition, next_conditions

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.rig import Rig

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
