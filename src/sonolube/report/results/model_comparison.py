"""Friction models compared with published tests and ranked by own runs, and earlier studies: rows, lines and JSON."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from math import hypot
from typing import Any

from sonolube.errors import InvalidInput
from sonolube.facts.published import PreviousStudy, Statement
from sonolube.report.blocks import Block, Table
from sonolube.report.results.record_object import finite, picked
from sonolube.rig import FrictionPoint, Rig, friction_point, steady_vibration
from sonolube.text.units import format_si
from sonolube.validation.comparison import (
    DATA_SETS,
    ONLY_PREDICTED,
    ComparedFit,
    FittedParameter,
    RigPrediction,
    RunsPrediction,
)
from sonolube.validation.previous_study_map import StudyPoint
from sonolube.validation.run_conditions import RunsTable
from sonolube.validation.runs_fit import NextCondition, RankedModel, RunsFit
from sonolube.validation.tables import parameter_text
from sonolube.vocabulary import quantity, unit_of

_PREDICTED = ("friction_ratio", "raw_friction_ratio", "uncertainty", "reason")


def error_row(one: ComparedFit) -> tuple[str, ...]:
    """Name, sets, tests, number of parameters and errors of a model that was assessed."""
    assert one.assessment is not None
    fitted, held_out = one.assessment.fit_errors, one.assessment.cross_validation_errors
    reached = f"{fitted.count}/{fitted.count + len(fitted.out_of_range)}" if fitted.out_of_range else str(fitted.count)
    aicc = "" if one.aicc is None else f"{one.aicc:.1f}"
    errors = f"{fitted.rms:.3f}", f"{held_out.rms:.3f}", f"{100 * fitted.median_relative:.0f} %"
    return (one.model.name, one.sets, reached, f"{len(one.parameters)}", *errors, aicc)


def _fitted_parameter_lines(one: ComparedFit) -> Iterator[str]:
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
        *[f"  {one.model.name}: {text}" for one in assessed for text in _fitted_parameter_lines(one)],
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


_OF_PUBLISHED_SETS = ("applicable_sets", "bounds", "bounds_reason")


def error_rows(fit: RunsFit) -> list[tuple[str, ...]]:
    """Errors of each model, and of the mean of the other conditions."""
    rows = []
    for model in fit.models:
        aicc = "" if model.aicc is None else f"{model.aicc:.1f}"
        missed = len(fit.table.conditions) - model.reached
        about = "tied" if model.tied else f"out of range: {missed} conditions" if missed else ""
        errors = f"{model.rms_unseen:.3f}", f"{model.rms_fit:.3f}"
        rows.append((model.name, f"{len(model.parameters)}", *errors, aicc, about))
    return [*rows, ("mean of the other conditions", "0", f"{fit.rms_of_mean:.3f}", "", "", "")]


def parameter_lines(fit: RunsFit) -> list[str]:
    """Fitted parameters of each model."""
    return [
        f"  {model.name}: {parameter_text(parameter, left_out='one condition')}"
        for model in fit.models
        for parameter in model.parameters
    ]


def inapplicable_lines(fit: RunsFit) -> list[str]:
    """Each reason for which models do not apply once, with the models."""
    reasons = by_reason((reason, name) for name, reason in fit.inapplicable.items())
    return [f"  not applicable: {', '.join(names)}: {reason}" for reason, names in reasons.items()]


def volts_per_amplitude(rig: Rig) -> float | None:
    """Peak-to-peak voltage per amplitude along the normal, in V/m; None where the rig states no voltage."""
    volts = None if rig.drive is None else rig.drive.voltage_peak_to_peak
    amplitude = steady_vibration(rig).vibration_amplitude
    return None if volts is None or not amplitude > 0 else volts / amplitude


def next_line(one: NextCondition, volts_per_amplitude: float | None) -> str:
    """Next condition to measure, with its voltage where that is known."""
    where, amplitude = ", beyond the runs" if one.is_beyond else "", one.condition.vibration_amplitude
    if volts_per_amplitude is not None and amplitude is not None:
        where = f" ({format_si(volts_per_amplitude * amplitude, 'V')} peak to peak){where}"
    return (
        f"  measure next: {one.condition.settings}{where}: {one.first} has {one.first_ratio:.2f},"
        f" {one.second} {one.second_ratio:.2f}, {one.contrast:.1f} of their errors apart"
    )


def fit_object(fit: RunsFit) -> dict[str, Any]:
    """Models with errors, parameters and predictions, the verdict and the next conditions."""
    return {
        "runs": fit.table.runs,
        "conditions": [
            picked(one, "label", "friction_ratio", "uncertainty", "repeats") for one in fit.table.conditions
        ],
        "scatter": fit.table.scatter,
        "models": list(map(_model_object, fit.models)),
        "rms_of_mean": fit.rms_of_mean,
        "verdict": fit.verdict,
        "decided": fit.is_decided,
        "measure_next": list(map(_next_object, fit.next_conditions)),
        "not_applicable": fit.inapplicable,
    }


def _model_object(model: RankedModel) -> dict[str, Any]:
    """Model with its errors, parameters and predictions."""
    parameters = [parameter_object(parameter).items() for parameter in model.parameters]
    return {
        "name": model.name,
        "source": model.fit.variant.source,
        "rms_unseen": finite(model.rms_unseen),
        "rms": finite(model.rms_fit),
        **picked(model, "aicc", "probability", "tied"),
        "conditions_in_range": model.reached,
        "fitted": [{name: value for name, value in each if name not in _OF_PUBLISHED_SETS} for each in parameters],
        "unseen_ratio": list(model.unseen),
        "fitted_ratio": list(model.fitted),
    }


def _next_object(one: NextCondition) -> dict[str, Any]:
    """Next condition with the ratios of both models."""
    return {
        **picked(one.condition, "vibration_amplitude", "vibration_velocity", "sliding_speed"),
        "models": [one.first, one.second],
        "friction_ratios": [one.first_ratio, one.second_ratio],
        "contrast": one.contrast,
        "beyond_the_runs": one.is_beyond,
    }


def point_of_rig(rig: Rig) -> tuple[StudyPoint, str | None]:
    """Rig as a point of the map of studies, and why its reduction has no number."""
    speed = rig.sliding_speed
    if not speed > 0:
        raise InvalidInput(f"{rig.file or rig.title}: the map needs a sliding.sliding_speed above 0")
    friction = friction_point(rig)
    point = StudyPoint(
        label=rig.name,
        direction="perpendicular",
        friction_reduction=friction.friction_reduction,
        sliding_speed=(speed, speed),
        nominal_pressure=rig.normal_load / rig.contact.nominal_area,
    )
    return point, friction.reason


def own_point_line(point: StudyPoint) -> str:
    """Friction reduction of a point of an own table, with direction, speed and pressure as far as known."""
    parts = [f"friction reduction {100 * point.friction_reduction:.0f} %", point.direction or "direction not stated"]
    if point.sliding_speed is not None:
        parts.append(format_si(point.sliding_speed[1], "m/s"))
    if point.nominal_pressure is not None:
        parts.append(format_si(point.nominal_pressure, "Pa"))
    return f"{point.label}, own table: {', '.join(parts)}"


def study_lines(study: PreviousStudy) -> list[str]:
    """Author, direction, references, text and numbers of a study."""
    lines = [
        f"{study.study}, {study.direction or 'direction not stated'}, D {study.section} {list(study.references)}",
        f"  {study.summary}",
    ]
    numbers = "; ".join(map(_number, study.numbers))
    return [*lines, f"  {numbers}"] if numbers else lines


def _number(entry: Statement) -> str:
    """Number of a study with its meaning, relation and unit as printed."""
    meaning = quantity(entry.quantity).meaning if entry.quantity else entry.meaning
    relation = "" if entry.relation == "=" else f"{entry.relation} "
    return f"{meaning} {relation}{entry.number.text} {entry.unit}".rstrip()


def study_object(study: PreviousStudy) -> dict[str, Any]:
    """Study with its numbers by quantity."""
    return {
        **picked(study, "study", "section"),
        "references": list(study.references),
        **picked(study, "direction", "summary"),
        **{
            entry.quantity: {
                "value": entry.number.value,
                "relation": entry.relation,
                "printed": f"{entry.number.text} {entry.unit}".strip(),
                "unit": unit_of(entry.quantity),
            }
            for entry in study.numbers
            if entry.quantity
        },
    }
