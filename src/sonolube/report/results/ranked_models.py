"""Models ranked by own runs and the conditions to measure next: rows, lines and objects for JSON."""

from typing import Any

from sonolube.report.results.model_comparison import by_reason, parameter_object
from sonolube.report.results.record_object import finite, picked
from sonolube.rig import Rig, steady_vibration
from sonolube.text.units import format_si
from sonolube.validation.ranked_models import RankedModel
from sonolube.validation.runs_fit import RunsFit
from sonolube.validation.separating_condition import NextCondition
from sonolube.validation.tables import parameter_text

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
