"""Own measured runs as predicted by model variants that were fitted to published tests."""

from dataclasses import dataclass

import numpy as np

from sonolube.validation.comparison import ComparedFit
from sonolube.validation.fitting import root_mean_square
from sonolube.validation.model_variant import ModelVariant
from sonolube.validation.run_conditions import RunsTable


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
    return tuple(sorted((_prediction(one, table) for one in fits), key=_rank))


def _prediction(one: ComparedFit, table: RunsTable) -> RunsPrediction:
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


def _rank(one: RunsPrediction) -> tuple[int, float]:
    """Sort key of a prediction: conditions that it does not reach, then its error."""
    return len(one.ratios) - one.reached, float("inf") if one.rms is None else one.rms
