"""Friction ratios of the published tests by the fitted variants of the friction models."""

from functools import cache
from typing import Final

from sonolube.validation.assessment import FITTED_SETS, SETS_WITHOUT_POWER_MAP
from sonolube.validation.fitting import Fit, fit_variant
from sonolube.validation.free_parameters import RIGS
from sonolube.validation.friction_model_variants import FRICTION_MODEL_VARIANTS
from sonolube.validation.model_variant import ModelVariant
from sonolube.validation.published_tests import FrictionTest

DEFAULT: Final = "asperity-stick-slip-fitted"
"""Variant of the default friction model: the least cross-validation error of all."""

REPORTED: Final = ("dong-2015-full-period", DEFAULT, "asperity-stick-slip-in-plane", "bristle-with-holder-per-rig")
"""Variants in the rows of the report; its figures show all."""

Predictions = dict[str, tuple[float, str]]
"""Friction ratios of a test, each with the note on its computation, by the name of the model."""


def variant_predictions(test: FrictionTest) -> Predictions:
    """Friction ratios of a test by the reported variants that reach it."""
    predictions: Predictions = {}
    for fit in reported_fits():
        ratio = fit.predict(test) if fit.variant.name in REPORTED else None
        if ratio is not None:
            fitted = parameters_text(fit, test.set_name) or "no parameter applies to this rig"
            sets = f"; fitted on sets {', '.join(fit.sets)}: {fitted}" if fit.sets else "; nothing fitted"
            note = f"{capitalised(fit.variant.description)}{sets}. {ratio_text(ratio, test.friction_ratio)}"
            predictions[fit.variant.name] = (ratio, note)
    return predictions


@cache
def reported_fits() -> tuple[Fit, ...]:
    """Every variant fitted without Table 4.2, or with it if a parameter applies to its rig alone."""
    return tuple(fit_variant(variant, _fitted_sets(variant)) for variant in FRICTION_MODEL_VARIANTS)


def is_fitted_to(test: FrictionTest) -> bool:
    """Whether the default model is fitted to the set of a test."""
    return any(fit.variant.name == DEFAULT and test.set_name in fit.sets for fit in reported_fits())


def parameters_text(fit: Fit, sets: str) -> str:
    """Fitted parameters that apply to sets as text."""
    return ", ".join(
        f"{parameter.name} {value:.3g} {parameter.unit}".rstrip()
        for parameter, value in zip(fit.variant.parameters, fit.values, strict=True)
        if parameter.applies_to(sets)
    )


def ratio_text(computed: float, measured: float) -> str:
    """Computed and a measured friction ratio as a sentence."""
    return f"Ratio {computed:.3f}, measured {measured:.3f}."


def capitalised(text: str) -> str:
    """Text with a capital first letter."""
    return text[0].upper() + text[1:]


def _fitted_sets(variant: ModelVariant) -> str:
    """Letters of the sets that a variant is fitted to for the report."""
    of_power_map = any(parameter.applicable_sets == RIGS["power map"] for parameter in variant.parameters)
    return FITTED_SETS if of_power_map else SETS_WITHOUT_POWER_MAP
