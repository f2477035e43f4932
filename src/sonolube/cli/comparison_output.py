"""What the command `compare` says and writes."""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Any

from sonolube.figure import publication_style, write_figure
from sonolube.files import write_atomically
from sonolube.rig import Rig, write_netcdf
from sonolube.units import format_si
from sonolube.validation.compare import (
    DATA_SETS,
    ONLY_PREDICTED,
    ComparedFit,
    FittedParameter,
    Prediction,
    RigPrediction,
)
from sonolube.validation.figures import comparison_figures, rig_figure
from sonolube.validation.table import comparison_csv, comparison_dataset, parameter_said

Predictions = tuple[RigPrediction, ...] | None


def comparison_lines(
    fits: tuple[ComparedFit, ...], rig: Rig | None, predictions: Predictions, written: list[Path]
) -> list[str]:
    """Return what a comparison shows as lines."""
    tests = fits[0].predictions
    width = max(len(one.model.name) for one in fits)
    return [
        f"{len(fits)} models, {len(tests)} tests in sets {', '.join(DATA_SETS)}; errors of the friction ratio",
        f"  {'model':<{width}}  sets      tests  k     rms  unseen  median    AICc",
        *[f"  {line}" for one in fits if one.judgement for line in _error_lines(one, width)],
        *[f"  not fitted: set {letter}: {reason}" for letter, reason in ONLY_PREDICTED.items()],
        *[f"  not reached: {line}" for one in fits for line in _refusals(one)],
        *(_rig_lines(rig, predictions, width) if rig and predictions is not None else ()),
        *[f"  {path}" for path in written],
    ]


def comparison_object(
    fits: tuple[ComparedFit, ...], rig: Rig | None, predictions: Predictions, written: list[Path]
) -> dict[str, Any]:
    """Return a comparison as it goes into JSON."""
    said = {} if rig is None or predictions is None else {"rig": _rig_object(rig, predictions)}
    return {
        "sets": dict(DATA_SETS),
        "only_predicted": dict(ONLY_PREDICTED),
        "models": [_model_object(one) for one in fits],
        **said,
        "files": [str(path) for path in written],
    }


def write_comparison(
    fits: tuple[ComparedFit, ...], rig: Rig | None, predictions: Predictions, *, folder: Path
) -> list[Path]:
    """Write figures, table and netCDF, and return the files."""
    import matplotlib.pyplot as plt

    files: list[Path] = []
    with publication_style():
        judged = any(one.judgement for one in fits)
        drawn = {figure.name: figure.draw() for figure in comparison_figures(lambda: fits) if judged}
        if rig is not None and predictions and any(one.friction_ratio is not None for one in predictions):
            drawn["models-on-the-rig"] = rig_figure(predictions, rig.title)
        for name, figure in drawn.items():
            files += write_figure(figure, folder=folder, name=name)
            plt.close(figure)
    return [
        *files,
        write_atomically(folder / "models.csv", comparison_csv(fits)),
        write_netcdf(comparison_dataset(fits), path=folder / "models.nc"),
    ]


def _error_lines(one: ComparedFit, width: int) -> Iterator[str]:
    assert one.judgement is not None
    seen, unseen = one.judgement.seen, one.judgement.unseen
    reached = f"{seen.count}/{seen.count + len(seen.missed)}" if seen.missed else str(seen.count)
    akaike = "" if one.akaike is None else f"{one.akaike:.1f}"
    yield (
        f"{one.model.name:<{width}}  {one.sets:<7}  {reached:>6} {len(one.parameters):>2}"
        f"  {seen.rms:6.3f}  {unseen.rms:6.3f}  {100 * seen.median_relative:4.0f} %  {akaike:>6}"
    )
    for told in one.parameters:
        yield f"    {parameter_said(told)}"


def _refusals(one: ComparedFit) -> Iterator[str]:
    """Yield each reason once with the tests it holds for, of the sets that a model is meant for or of all."""
    reasons: dict[str, list[str]] = {}
    for prediction in one.predictions:
        if prediction.refusal:
            reasons.setdefault(prediction.refusal, []).append(prediction.test.label)
    for reason, labels in reasons.items():
        if one.judgement is None or not reason.startswith("needs "):
            yield f"{one.model.name}: {reason} ({', '.join(labels) if len(labels) < 6 else f'{len(labels)} tests'})"


def _rig_lines(rig: Rig, predictions: tuple[RigPrediction, ...], width: int) -> Iterator[str]:
    yield (
        f"{rig.title}, {format_si(rig.normal_load, 'N')}, {format_si(rig.sliding_speed, 'm/s')}, "
        f"{format_si(rig.vibration_amplitude, 'm')}"
    )
    steady = rig.friction_coefficient * rig.normal_load
    for one in predictions:
        if one.friction_ratio is None:
            continue
        error = ", error not known," if one.uncertainty is None else f" +- {one.uncertainty:.2f}"
        force = format_si(one.friction_ratio * steady, "N")
        yield f"  {one.model.name:<{width}}  ratio {one.friction_ratio:.3f}{error}  friction {force}"
    for one in predictions:
        if one.refusal:
            yield f"  not applicable: {one.model.name}: {one.refusal}"


def _model_object(one: ComparedFit) -> dict[str, Any]:
    judgement = one.judgement
    errors = (
        {
            "rms": _finite(judgement.seen.rms),
            "rms_unseen": _finite(judgement.unseen.rms),
            "worst": _finite(judgement.seen.worst),
            "median_relative": _finite(judgement.seen.median_relative),
            "akaike": one.akaike,
            "missed": list(judgement.seen.missed),
        }
        if judgement
        else None
    )
    return {
        "name": one.model.name,
        "meaning": one.model.variant.meaning,
        "source": one.model.source,
        "needs": list(one.model.needs),
        "sets": list(one.sets),
        "errors": errors,
        "fitted": [_parameter_object(told) for told in one.parameters],
        "predictions": [_prediction_object(prediction) for prediction in one.predictions],
    }


def _parameter_object(told: FittedParameter) -> dict[str, Any]:
    return {
        "name": told.parameter.name,
        "matters_in": list(told.parameter.matters_in),
        "value": told.value,
        "unit": told.parameter.unit,
        "interval": told.interval,
        "left_out_range": told.left_out_range,
        "bounds": (told.parameter.low, told.parameter.high),
        "at_bound": told.at_bound,
        "why_these_bounds": told.parameter.reason,
    }


def _prediction_object(prediction: Prediction) -> dict[str, Any]:
    return {
        "test": prediction.test.label,
        "measured": prediction.test.friction_ratio,
        "fitted": prediction.fitted,
        "unseen": prediction.unseen,
        "reason": prediction.refusal,
    }


def _rig_object(rig: Rig, predictions: tuple[RigPrediction, ...]) -> dict[str, Any]:
    return {
        "title": rig.title,
        "predictions": [
            {
                "model": one.model.name,
                "friction_ratio": one.friction_ratio,
                "uncertainty": one.uncertainty,
                "reason": one.refusal,
            }
            for one in predictions
        ],
        "assumptions": dict(rig.assumptions),
    }


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None
