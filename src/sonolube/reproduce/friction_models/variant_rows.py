"""Rows of the published friction reductions by the variants of the friction models."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from sonolube.reproduce.row import Row, comparison_row
from sonolube.validation.assessment import FITTED_SETS, SETS_WITHOUT_POWER_MAP
from sonolube.validation.fitting import Fit, fit_variant
from sonolube.validation.free_parameters import RIGS
from sonolube.validation.friction_model_variants import FRICTION_MODEL_VARIANTS
from sonolube.validation.model_variant import ModelVariant
from sonolube.validation.published_tests import friction_tests

DEFAULT: Final = "asperity-stick-slip-fitted"
"""Variant of the default friction model: the least cross-validation error of all."""

REPORTED: Final = ("dong-2015-full-period", DEFAULT, "asperity-stick-slip-in-plane", "bristle-with-holder-per-rig")
"""Variants with rows in the report; its figures show all."""


def variant_rows() -> Iterator[Row]:
    """Yield one row for each published friction reduction and each reported variant."""
    for fit in reported_fits():
        if fit.variant.name not in REPORTED:
            continue
        for test in friction_tests():
            ratio = fit.predict(test)
            if test.published is None or ratio is None:
                continue
            published = replace(test.published, id=f"friction-model-{fit.variant.name}-{test.label}")
            fitted = parameters_text(fit, test.set_name) or "no parameter applies to this rig"
            sets = f"; fitted on sets {', '.join(fit.sets)}: {fitted}" if fit.sets else "; nothing fitted"
            note = f"{capitalised(fit.variant.description)}{sets}. {ratio_text(ratio, test.friction_ratio)}"
            yield comparison_row(published, 1 - ratio, note)


def reported_fits() -> tuple[Fit, ...]:
    """Return every variant fitted without Table 4.2, or with it if a parameter applies to its rig alone."""
    return tuple(fit_variant(variant, _fitted_sets(variant)) for variant in FRICTION_MODEL_VARIANTS)


def parameters_text(fit: Fit, sets: str) -> str:
    """Return the fitted parameters that apply to sets as text."""
    return ", ".join(
        f"{parameter.name} {value:.3g} {parameter.unit}".rstrip()
        for parameter, value in zip(fit.variant.parameters, fit.values, strict=True)
        if parameter.applies_to(sets)
    )


def ratio_text(computed: float, measured: float) -> str:
    """Return a computed and a measured friction ratio as a sentence."""
    return f"Ratio {computed:.3f}, measured {measured:.3f}."


def capitalised(text: str) -> str:
    """Return a text with a capital first letter."""
    return text[0].upper() + text[1:]


def _fitted_sets(variant: ModelVariant) -> str:
    """Return the letters of the sets that a variant is fitted to for the report."""
    of_power_map = any(parameter.applicable_sets == RIGS["power map"] for parameter in variant.parameters)
    return FITTED_SETS if of_power_map else SETS_WITHOUT_POWER_MAP
