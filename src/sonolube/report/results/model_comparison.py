"""Models compared with published tests, on a rig and on own runs: rows, lines and objects for JSON."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from math import hypot
from typing import Any

from sonolube.report.blocks import Block, Table
from sonolube.report.results.record_object import finite, picked
from sonolube.rig import FrictionPoint, Rig
from sonolube.text.units import format_si
from sonolube.validation.comparison import DATA_SETS, ONLY_PREDICTED, ComparedFit, FittedParameter, RigPrediction
from sonolube.validation.run_conditions import RunsTable
from sonolube.validation.runs_comparison import RunsPrediction
from sonolube.validation.tables import parameter_text

_PREDICTED = ("friction_ratio", "raw_friction_ratio", "uncertainty", "reason")


def error_row(one: ComparedFit) -> tuple[str, ...]:
    """Name, sets, tests, number of parameters and errors of a model that was assessed."""
    assert one.assessment is not None
    fitted, held_out = one.assessment.fit_errors, one.assessment.cross_validation_errors
    reached = f"{fitted.count}/{fitted.count + len(fitted.out_of_range)}" if fitted.out_of_range else str(fitted.count)
    aicc = "" if one.aicc is None else f"{one.aicc:.1f}"
    errors = f"{fitted.rms:.3f}", f"{held_out.rms:.3f}", f"{100 * fitted.median_relative:.0f} %"
    return (one.model.name, one.sets, reached, f"{len(one.parameters)}", *errors, aicc)


def parameter_lines(one: ComparedFit) -> Iterator[str]:
    """Fitted parameters of a model, and the tests that its default was fitted to."""
    yield from map(parameter_text, one.parameters)
    if one.model.seen is not None:
        yield f"rms and AICc in sample: a default has seen sets {', '.join(one.model.seen.sets)}; unseen by refits"


def refusal_lines(one: ComparedFit) -> Iterator[str]:
    """Each reason for which a model does not apply to tests, once, with the tests."""
    refused = ((prediction.reason, prediction.test.label) for prediction in one.predictions)
    for reason, labels in by_reason(refused).items():
        if one.assessment is None or not reason.startswith("needs "):
            yield f"{one.model.name}: {reason} ({', '.join(labels) if len(labels) < 6 else f'{len(labels)} tests'})"


def by_reason(refused: Iterable[tuple[str | None, str]]) -> dict[str, list[str]]:
    """Names by the reason for which they were refused; without those that have none."""
    reasons: dict[str, list[str]] = {}
    for reason, name in refused:
        if reason:
            reasons.setdefault(reason, []).append(name)
    return reasons


def rig_rows(rig: Rig, own: FrictionPoint, predictions: Sequence[RigPrediction]) -> list[tuple[str, str, str]]:
    """Friction ratio and force of a rig by its own model, as other tasks have it, and by each applicable one."""
    ratio = own.reason or f"ratio {own.friction_ratio:.3f}"
    force = "" if own.reason else f"friction {format_si(own.friction_force, 'N')}"
    rows = [(f"{own.friction_model}, its own", ratio, force)]
    steady = rig.friction_coefficient * rig.normal_load
    for one in predictions:
        if one.friction_ratio is not None:
            error = ", error not known" if one.uncertainty is None else f" +- {one.uncertainty:.2f}"
            force = format_si(one.friction_ratio * steady, "N")
            rows.append((one.model.name, f"ratio {one.friction_ratio:.3f}{error}", f"friction {force}"))
    return rows


def disagreement(predictions: Sequence[RigPrediction]) -> list[str]:
    """Line where the two models that differ most for their errors differ by more than these."""
    known = [
        (one.model.name, one.friction_ratio, one.uncertainty)
        for one in predictions
        if one.friction_ratio is not None and one.uncertainty
    ]

    def distance(pair: tuple[tuple[str, float, float], tuple[str, float, float]]) -> float:
        (_, ratio, error), (_, other_ratio, other_error) = pair
        return abs(ratio - other_ratio) / hypot(error, other_error)

    farthest = max(combinations(known, 2), key=distance, default=None)
    if farthest is None or distance(farthest) <= 1:
        return []
    texts = [f"{name} {ratio:.2f} +- {error:.2f}" for name, ratio, error in farthest]
    return [f"  models differ by more than their errors: {', '.join(texts)}"]


def model_object(one: ComparedFit) -> dict[str, Any]:
    """Model with its errors, fitted parameters and predictions of the tests."""
    errors = None
    if one.assessment is not None:
        fitted = one.assessment.fit_errors
        errors = {
            "rms": finite(fitted.rms),
            "rms_cross_validated": finite(one.assessment.cross_validation_errors.rms),
            "largest_error": finite(fitted.largest),
            "median_relative": finite(fitted.median_relative),
            "aicc": one.aicc,
            "out_of_range": list(fitted.out_of_range),
        }
    return {
        **picked(one.model, "name", "description", "source"),
        "required_inputs": list(one.model.required_inputs),
        "sets": list(one.sets),
        "seen_by_default": [] if one.model.seen is None else list(one.model.seen.sets),
        "errors": errors,
        "fitted": list(map(parameter_object, one.parameters)),
        "predictions": [
            {"test": prediction.test.label, "measured": prediction.test.friction_ratio}
            | picked(prediction, "fitted", "cross_validated", "reason")
            for prediction in one.predictions
        ],
    }


def parameter_object(fitted: FittedParameter) -> dict[str, Any]:
    """Fitted parameter with its interval and bounds."""
    return {
        "name": fitted.parameter.name,
        "applicable_sets": list(fitted.parameter.applicable_sets),
        "value": fitted.value,
        "unit": fitted.parameter.unit,
        "interval": fitted.interval,
        "leave_one_out_range": fitted.leave_one_out_range,
        "bounds": (fitted.parameter.low, fitted.parameter.high),
        "at_bound": fitted.at_bound,
        "bounds_reason": fitted.parameter.reason,
    }


def rig_object(rig: Rig, own: FrictionPoint, predictions: Sequence[RigPrediction]) -> dict[str, Any]:
    """Predictions of a rig by its own and by each model."""
    return {
        "title": rig.title,
        "own_model": {
            "model": own.friction_model,
            "friction_ratio": finite(own.friction_ratio),
            **picked(own, "reason", "amplitude_source", "amplitude_origin", "vibration_amplitude"),
        },
        "disagreement": disagreement(predictions),
        "predictions": [{"model": one.model.name} | picked(one, *_PREDICTED) for one in predictions],
        "assumptions": dict(rig.assumptions),
    }


def runs_rows(table: RunsTable, predictions: Sequence[RunsPrediction]) -> list[tuple[str, ...]]:
    """Error of each model on own runs, beside the one to expect."""
    rows: list[tuple[str, ...]] = []
    for one in predictions:
        if one.rms is not None and one.mean is not None:
            expected = "" if one.cross_validated_rms is None else f"{one.cross_validated_rms:.3f}"
            reached = f"{one.reached}/{len(table.conditions)}"
            rows.append((one.model.name, reached, f"{one.rms:.3f}", f"{one.mean:+.3f}", expected))
    return rows


def runs_object(table: RunsTable, predictions: Sequence[RunsPrediction]) -> dict[str, Any]:
    """Own runs: conditions with measured ratios, and the ratios and errors of each model."""
    return {
        "runs": table.runs,
        "conditions": [picked(one, "label", "friction_ratio") for one in table.conditions],
        "predictions": [
            {
                "model": one.model.name,
                "friction_ratios": list(one.ratios),
                "rms": one.rms,
                "mean_error": one.mean,
                "expected_rms": one.cross_validated_rms,
                "reason": one.reason,
            }
            for one in predictions
        ],
    }


def fit_blocks(fits: Sequence[ComparedFit]) -> list[Block]:
    """Errors and fitted parameters of each model, and refused tests."""
    tests, assessed = fits[0].predictions, [one for one in fits if one.assessment]
    heads = ("model", "sets", "tests", "k", "rms", "unseen", "median", "AICc")
    return [
        f"{len(fits)} models, {len(tests)} tests in sets {', '.join(DATA_SETS)}; errors of the friction ratio,"
        " unseen: of each set by what has not seen it",
        Table(heads, list(map(error_row, assessed))),
        *[f"  {one.model.name}: {text}" for one in assessed for text in parameter_lines(one)],
        *[f"  not fitted: set {letter}: {reason}" for letter, reason in ONLY_PREDICTED.items()],
        *[f"  not reached: {line}" for one in fits for line in refusal_lines(one)],
    ]


def rig_blocks(rig: Rig, own: FrictionPoint, predictions: Sequence[RigPrediction]) -> Iterator[Block]:
    """Friction of the rig by its own model and by each applicable one."""
    yield (
        f"{rig.title}, {format_si(rig.normal_load, 'N')}, {format_si(rig.sliding_speed, 'm/s')}, "
        f"{format_si(own.vibration_amplitude, 'm')}: {own.amplitude_origin}"
    )
    yield Table(("", "", ""), rig_rows(rig, own, predictions))
    yield from disagreement(predictions)
    for one in predictions:
        if one.reason:
            yield f"  not applicable: {one.model.name}: {one.reason}"


def runs_blocks(table: RunsTable, of_runs: Sequence[RunsPrediction]) -> Iterator[Block]:
    """Error of each model on own runs, and why others do not apply."""
    head = f"{table.title}: {table.runs} runs under {len(table.conditions)} conditions"
    yield f"{head}, by models as published tests fitted them"
    yield Table(("model", "reached", "rms", "mean", "expected"), runs_rows(table, of_runs))
    reasons = by_reason((one.reason, one.model.name) for one in of_runs)
    yield from (f"  own runs not reached: {', '.join(names)}: {reason}" for reason, names in reasons.items())
