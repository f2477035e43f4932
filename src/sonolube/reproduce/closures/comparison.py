"""Published friction reductions beside each friction model's prediction."""

from collections.abc import Iterator
from dataclasses import replace

from sonolube.reproduce.row import Row, compare
from sonolube.validation.closure_comparison import REPORTED, fits
from sonolube.validation.fit import Fit
from sonolube.validation.friction_tests import friction_tests


def rows() -> Iterator[Row]:
    """Yield one row for each published friction reduction and each closure reported."""
    for fit in fits():
        if fit.variant.name not in REPORTED:
            continue
        for test in friction_tests():
            ratio = fit.predict(test)
            if test.published is None or ratio is None:
                continue
            published = replace(test.published, id=f"closure-{fit.variant.name}-{test.label}")
            note = f"{_note(fit, test.set_name)} Ratio {ratio:.3f}, measured {test.friction_ratio:.3f}."
            yield compare(published, 1 - ratio, note)


def _note(fit: Fit, set_name: str) -> str:
    told = ", ".join(
        f"{parameter.name} {value:.3g} {parameter.unit}".rstrip()
        for parameter, value in zip(fit.variant.parameters, fit.values, strict=True)
        if parameter.matters_to(set_name)
    )
    seen = f"; fitted on sets {', '.join(fit.sets)}: {told}" if fit.sets else "; nothing fitted"
    return f"{fit.variant.meaning[0].upper()}{fit.variant.meaning[1:]}{seen}."
