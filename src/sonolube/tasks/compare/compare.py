"""Task `compare`: models of friction under vibration against published tests, and on a rig."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from math import hypot, isfinite
from typing import TYPE_CHECKING, Annotated, Any

from sonolube.measurement.run_columns import runs_help
from sonolube.report import Drawing
from sonolube.rig import FrictionPoint, Rig, friction_point
from sonolube.tasks.answer import Answer, answer
from sonolube.tasks.blocks import Block, Table
from sonolube.tasks.compare.own_runs import run_blocks, runs_object
from sonolube.tasks.own_tables import MappedRuns, runs_of
from sonolube.tasks.parameters import OptionalRig, Parameter, RunsSource, Stop, Watch, optional_rig
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task
from sonolube.units import format_si
from sonolube.validation.comparison import (
    DATA_SETS,
    ONLY_PREDICTED,
    ComparedFit,
    FittedParameter,
    Prediction,
    RigPrediction,
    compare_models,
    compared_models,
    predict_rig,
)
from sonolube.validation.figures import comparison_figures, rig_chart
from sonolube.validation.rig_conditions import vibrated_rig
from sonolube.validation.run_conditions import RunsTable, run_conditions
from sonolube.validation.runs_comparison import RunsPrediction, predict_runs
from sonolube.validation.runs_figures import runs_prediction_chart
from sonolube.validation.tables import comparison_csv, comparison_dataset, parameter_text

if TYPE_CHECKING:
    import xarray as xr


_PREDICTED = ("friction_ratio", "raw_friction_ratio", "uncertainty", "reason")
_RUNS = Parameter(
    help=runs_help("Own measured runs, which each model predicts as published tests fitted it"),
    kind="RUNS.csv",
    is_file=True,
)


@task
def compare(
    rig: OptionalRig = None,
    *,
    model: Annotated[Sequence[str], Parameter(help="Only this model; may come again.", kind="NAME")] = (),
    runs: Annotated[RunsSource, _RUNS] = None,
    mapping: MappedRuns = None,
    progress: Watch = None,
    cancelled: Stop = None,
) -> "ComparisonAnswer":
    """Models of friction under vibration against every published test: fitted, cross-validated, and on your rig.

    Example: sonolube compare examples/rigs/tribometer.toml --model asperity-stick-slip --model kinematic
    """
    known, own_runs = optional_rig(rig), runs_of(runs, mapping)
    point = None if known is None else vibrated_rig(known)
    table = None if own_runs is None else run_conditions(own_runs, known)
    with stage("comparing") as advance:
        fits = compare_models(compared_models(model), advance=advance)
        predictions = () if point is None else predict_rig(fits, point)
    return ComparisonAnswer(
        fits=fits,
        rig=known,
        own=None if known is None else friction_point(known),
        predictions=predictions,
        table=table,
        of_runs=() if table is None else predict_runs(fits, table),
    )


@answer
class ComparisonAnswer(Answer):
    """Errors of models on published tests, fitted and cross-validated, and their predictions of a rig."""

    fits: tuple[ComparedFit, ...]
    rig: Rig | None
    own: FrictionPoint | None
    predictions: tuple[RigPrediction, ...]
    table: RunsTable | None = None
    of_runs: tuple[RunsPrediction, ...] = ()

    def blocks(self) -> Sequence[Block]:
        """Errors and fitted parameters of each model, refused tests, and predictions of the rig."""
        tests, assessed = self.fits[0].predictions, [one for one in self.fits if one.assessment]
        heads = ("model", "sets", "tests", "k", "rms", "unseen", "median", "AICc")
        return [
            f"{len(self.fits)} models, {len(tests)} tests in sets {', '.join(DATA_SETS)}; errors of the friction ratio,"
            " unseen: of each set by what has not seen it",
            Table(heads, [_error_row(one) for one in assessed]),
            *[f"  {one.model.name}: {text}" for one in assessed for text in _parameter_texts(one)],
            *[f"  not fitted: set {letter}: {reason}" for letter, reason in ONLY_PREDICTED.items()],
            *[f"  not reached: {line}" for one in self.fits for line in _refusals(one)],
            *([] if self.rig is None or self.own is None else _rig_blocks(self.rig, self.own, self.predictions)),
            *([] if self.table is None else run_blocks(self.table, self.of_runs)),
        ]

    def object(self) -> dict[str, Any]:
        """Errors, fitted parameters and predictions of each model, and the predictions of the rig."""
        content: dict[str, Any] = {
            "sets": dict(DATA_SETS),
            "only_predicted": dict(ONLY_PREDICTED),
            "models": [_model_object(one) for one in self.fits],
        }
        if self.table is not None:
            content["runs"] = runs_object(self.table, self.of_runs)
        if self.rig is None or self.own is None:
            return content
        return content | {"rig": _rig_object(self.rig, self.own, self.predictions)}

    def caveats(self) -> Sequence[str]:
        """Those of the rig at its operating point, and of own runs."""
        own = () if self.own is None else self.own.caveats
        return own if self.table is None else (*own, *self.table.caveats)

    def figures(self) -> Mapping[str, Drawing]:
        """Predicted against measured ratios, ratios over speed and amplitude, and the predictions of the rig."""
        drawings = {}
        if any(one.assessment for one in self.fits):
            every = comparison_figures(lambda: self.fits)
            drawings = {figure.name: Drawing(chart=figure.chart, caption=figure.caption) for figure in every}
        if self.rig is not None and any(one.friction_ratio is not None for one in self.predictions):
            drawings["models-on-the-rig"] = Drawing(chart=lambda: rig_chart(self._dataset()))
        table = self.table
        if table is not None and any(one.rms is not None for one in self.of_runs):
            drawings["models-on-own-runs"] = Drawing(chart=lambda: runs_prediction_chart(self.of_runs, table))
        return drawings

    def files(self) -> "Mapping[str, str | xr.Dataset]":
        """Errors as CSV, and every ratio as netCDF."""
        return {"models.csv": comparison_csv(self.fits), "models.nc": self._dataset()}

    def _dataset(self) -> "xr.Dataset":
        """Every ratio and error over models and tests, and the predictions of the rig."""
        labelled = comparison_dataset(self.fits, self.predictions)
        return labelled if self.rig is None else labelled.assign_attrs(rig=self.rig.title)


def _error_row(one: ComparedFit) -> tuple[str, ...]:
    """Errors of a model."""
    assert one.assessment is not None
    fitted, held_out = one.assessment.fit_errors, one.assessment.cross_validation_errors
    reached = f"{fitted.count}/{fitted.count + len(fitted.out_of_range)}" if fitted.out_of_range else str(fitted.count)
    aicc = "" if one.aicc is None else f"{one.aicc:.1f}"
    errors = f"{fitted.rms:.3f}", f"{held_out.rms:.3f}", f"{100 * fitted.median_relative:.0f} %"
    return (one.model.name, one.sets, reached, f"{len(one.parameters)}", *errors, aicc)


def _parameter_texts(one: ComparedFit) -> Iterator[str]:
    """Fitted parameters of a model, and what its default has seen."""
    for parameter in one.parameters:
        yield parameter_text(parameter)
    if one.model.seen is not None:
        yield f"rms and AICc in sample: a default has seen sets {', '.join(one.model.seen.sets)}; unseen by refits"


def _refusals(one: ComparedFit) -> Iterator[str]:
    """Each reason for which a model does not apply to tests, once, with the tests."""
    reasons: dict[str, list[str]] = {}
    for prediction in one.predictions:
        if prediction.reason:
            reasons.setdefault(prediction.reason, []).append(prediction.test.label)
    for reason, labels in reasons.items():
        if one.assessment is None or not reason.startswith("needs "):
            yield f"{one.model.name}: {reason} ({', '.join(labels) if len(labels) < 6 else f'{len(labels)} tests'})"


def _rig_blocks(rig: Rig, own: FrictionPoint, predictions: tuple[RigPrediction, ...]) -> Iterator[Block]:
    """Friction ratio and force of a rig by its own model, as other tasks have it, and by each applicable one."""
    yield (
        f"{rig.title}, {format_si(rig.normal_load, 'N')}, {format_si(rig.sliding_speed, 'm/s')}, "
        f"{format_si(own.vibration_amplitude, 'm')}: {own.amplitude_origin}"
    )
    ratio = own.reason or f"ratio {own.friction_ratio:.3f}"
    force = "" if own.reason else f"friction {format_si(own.friction_force, 'N')}"
    rows = [(f"{own.friction_model}, its own", ratio, force)]
    steady = rig.friction_coefficient * rig.normal_load
    for one in predictions:
        if one.friction_ratio is not None:
            error = ", error not known" if one.uncertainty is None else f" +- {one.uncertainty:.2f}"
            force = format_si(one.friction_ratio * steady, "N")
            rows.append((one.model.name, f"ratio {one.friction_ratio:.3f}{error}", f"friction {force}"))
    yield Table(("", "", ""), rows)
    yield from _disagreement(predictions)
    for one in predictions:
        if one.reason:
            yield f"  not applicable: {one.model.name}: {one.reason}"


def _disagreement(predictions: tuple[RigPrediction, ...]) -> Iterator[str]:
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
    if farthest is not None and distance(farthest) > 1:
        texts = [f"{name} {ratio:.2f} +- {error:.2f}" for name, ratio, error in farthest]
        yield f"  models differ by more than their errors: {', '.join(texts)}"


def _model_object(one: ComparedFit) -> dict[str, Any]:
    """Model for JSON with its errors, fitted parameters and predictions."""
    errors = None
    if one.assessment is not None:
        fitted = one.assessment.fit_errors
        errors = {
            "rms": _finite(fitted.rms),
            "rms_cross_validated": _finite(one.assessment.cross_validation_errors.rms),
            "largest_error": _finite(fitted.largest),
            "median_relative": _finite(fitted.median_relative),
            "aicc": one.aicc,
            "out_of_range": list(fitted.out_of_range),
        }
    return {
        "name": one.model.name,
        "description": one.model.description,
        "source": one.model.source,
        "required_inputs": list(one.model.required_inputs),
        "sets": list(one.sets),
        "seen_by_default": [] if one.model.seen is None else list(one.model.seen.sets),
        "errors": errors,
        "fitted": [_parameter_object(parameter) for parameter in one.parameters],
        "predictions": [_prediction_object(prediction) for prediction in one.predictions],
    }


def _parameter_object(fitted: FittedParameter) -> dict[str, Any]:
    """Fitted parameter for JSON."""
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


def _prediction_object(prediction: Prediction) -> dict[str, Any]:
    """Prediction of a test for JSON."""
    return {
        "test": prediction.test.label,
        "measured": prediction.test.friction_ratio,
        "fitted": prediction.fitted,
        "cross_validated": prediction.cross_validated,
        "reason": prediction.reason,
    }


def _rig_object(rig: Rig, own: FrictionPoint, predictions: tuple[RigPrediction, ...]) -> dict[str, Any]:
    """Predictions of a rig for JSON."""
    return {
        "title": rig.title,
        "own_model": {
            "model": own.friction_model,
            "friction_ratio": _finite(own.friction_ratio),
            "reason": own.reason,
            "amplitude_source": own.amplitude_source,
            "amplitude_origin": own.amplitude_origin,
            "vibration_amplitude": own.vibration_amplitude,
        },
        "disagreement": list(_disagreement(predictions)),
        "predictions": [
            {"model": one.model.name} | {name: getattr(one, name) for name in _PREDICTED} for one in predictions
        ],
        "assumptions": dict(rig.assumptions),
    }


def _finite(value: float) -> float | None:
    """Value, or None where JSON has no notation for it."""
    return value if isfinite(value) else None
