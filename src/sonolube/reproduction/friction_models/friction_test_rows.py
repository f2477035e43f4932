"""Published friction tests: one row each by the default friction model, with every other variant beside it."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from sonolube.facts.published import PrintedNumber, PublishedValue
from sonolube.models.friction import EMPIRICAL_MEMORY_LENGTH
from sonolube.reproduction.friction_models.computed_motion import computed_motion_prediction
from sonolube.reproduction.friction_models.mechanisms import mechanism_predictions
from sonolube.reproduction.friction_models.variant_predictions import (
    DEFAULT,
    Predictions,
    is_fitted_to,
    variant_predictions,
)
from sonolube.reproduction.row import Row, default_model_row
from sonolube.validation.assessment import FITTED_SETS
from sonolube.validation.fitting import root_mean_square
from sonolube.validation.friction_model_variants import asperity_stick_slip
from sonolube.validation.published_tests import (
    FLEXTENSIONAL,
    FLEXTENSIONAL_GAINS,
    NORMAL_VIBRATION_SETS,
    FrictionTest,
    friction_tests,
    with_printed_roughness,
)

POWER_MAP: Final = "B"
"""Letter of the set of Table 4.2, of chapter 4; all others are of chapter 2."""


def tribometer_test_rows() -> Iterator[Row]:
    """Yield the rows of the friction tests of chapter 2."""
    yield from _rows("".join(NORMAL_VIBRATION_SETS).replace(POWER_MAP, ""))


def power_map_test_rows() -> Iterator[Row]:
    """Yield the rows of the friction tests of Table 4.2."""
    yield from _rows(POWER_MAP)


def roughness_caveat() -> str:
    """Doubt on the roughness of the friction tests, with the error that the printed one would leave."""
    recorded, printed = (
        root_mean_square(
            [
                float(asperity_stick_slip(test, memory_length=EMPIRICAL_MEMORY_LENGTH)) - test.friction_ratio
                for test in tests
            ]
        )
        for tests in (friction_tests(FITTED_SETS), with_printed_roughness(friction_tests(FITTED_SETS)))
    )
    return (
        "friction tests: all sets but B are computed with R_q = 6 um, which D took from comparison standards for other"
        f" tests; with what D prints of the worn surfaces of C and G, rms errors grow from {recorded:.3f} to"
        f" {printed:.3f} (asperity stick-slip, memory length 1.5 um)"
    )


def within_scatter(test: FrictionTest) -> PublishedValue:
    """Friction reduction of a test with the interval of its measurement.

    D derives a reduction from forces and prints both, the forces with their scatter. The interval is that of the
    printed reduction and that of the forces together: where they differ (E16, E17, E27) they are two readings of one
    test.
    """
    assert test.published is not None
    number, scatter = test.published.number, test.uncertainty or 0.0
    low, high = (1 - test.friction_ratio + side * scatter for side in (-1, 1))
    measured: PrintedNumber = replace(number, low=min(number.low, low), high=max(number.high, high))
    return replace(test.published, number=measured, id=f"friction-model-{DEFAULT}-{test.label}")


def _rows(sets: str) -> Iterator[Row]:
    """Yield the rows of the tests of some sets, given by their letters, that have a printed reduction."""
    for test in friction_tests(sets):
        if test.published is None:
            continue
        predictions = _predictions(test)
        ratio, note = predictions.pop(DEFAULT)
        yield default_model_row(
            within_scatter(test),
            1 - ratio,
            note,
            fitted="the memory length, with other tests" if is_fitted_to(test) else "",
            possible=_possible(test),
            alternatives={name: (1 - other, other_note) for name, (other, other_note) in predictions.items()},
        )


def _possible(test: FrictionTest) -> tuple[float, float] | None:
    """Limits of the reduction of a flextensional test over the gain at resonance, not printed. []"""
    if test.set_name != FLEXTENSIONAL:
        return None
    least, most = (
        variant_predictions(replace(test, vibration_amplitude=gain * test.vibration_amplitude))[DEFAULT][0]
        for gain in FLEXTENSIONAL_GAINS
    )
    return 1 - least, 1 - most


def _predictions(test: FrictionTest) -> Predictions:
    """Friction ratios of a test by all variants, mechanisms and motions, each with its note, by name."""
    return variant_predictions(test) | mechanism_predictions(test) | computed_motion_prediction(test)
