"""Comparison of model variants as a labelled dataset, as CSV and as text, and the fit of own runs as a dataset."""

import csv
import io
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube import __version__
from sonolube.text.units import format_si
from sonolube.validation.comparison import DATA_SETS, ComparedFit, FittedParameter, RigPrediction
from sonolube.validation.model_variant import RIGS
from sonolube.validation.runs_fit import RunsFit
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_HEADS = (
    "model",
    "source",
    "sets",
    "fitted_parameters",
    "rms",
    "rms_cross_validated",
    "largest_error",
    "median_relative",
    "aicc",
)


def variable(dimensions: Any, values: Iterable[Any], long_name: str, units: str = "1") -> Any:
    """Numbers with their dimensions and attributes as a variable of a dataset; NaN for None."""
    return dimensions, np.array([*values], dtype=np.float64), {"units": units, "long_name": long_name}


def comparison_dataset(fits: tuple[ComparedFit, ...], predictions: tuple[RigPrediction, ...] = ()) -> "xr.Dataset":
    """Measured, fitted and cross-validated friction ratios over models and tests, with error statistics.

    Missing values are NaN; `reason` states why.
    """
    import xarray as xr

    tests = [one.test for one in fits[0].predictions]
    grid, assessments = ("model", "test"), [one.assessment for one in fits]

    rig_variables: dict[str, Any] = {}
    of_model = {one.model.name: one for one in predictions}
    predictions = tuple(of_model[one.model.name] for one in fits if one.model.name in of_model)
    if predictions:
        rig_variables = {
            "rig_friction_ratio": variable(
                "model", (one.friction_ratio for one in predictions), "Friction ratio of the rig by the fit to all sets"
            ),
            "rig_uncertainty": variable(
                "model", (one.uncertainty for one in predictions), "Root mean square error of the cross-validation"
            ),
            "rig_reason": ("model", [one.reason or "" for one in predictions], {"long_name": "Why there is no ratio"}),
        }
    return xr.Dataset(
        {
            "friction_ratio": variable(
                "test",
                (test.friction_ratio for test in tests),
                "Friction with vibration over friction without, measured",
            ),
            "set": ("test", [DATA_SETS[test.set_name] for test in tests], {"long_name": "Set of the test"}),
            "fitted_ratio": variable(
                grid, ([p.fitted for p in one.predictions] for one in fits), "Friction ratio by the fit to all sets"
            ),
            "cross_validated_ratio": variable(
                grid,
                ([p.cross_validated for p in one.predictions] for one in fits),
                "Friction ratio by the fit to the other sets",
            ),
            "reason": (
                grid,
                [[p.reason or "" for p in one.predictions] for one in fits],
                {"long_name": "Reason why a model does not apply"},
            ),
            "rms": variable(
                "model", (one and one.fit_errors.rms for one in assessments), "Root mean square error of the fit"
            ),
            "rms_cross_validated": variable(
                "model",
                (one and one.cross_validation_errors.rms for one in assessments),
                "Root mean square error with each set predicted by a fit that has not seen it",
            ),
            "fitted_parameters": ("model", [len(one.parameters) for one in fits], {"long_name": "Fitted parameters"}),
            "aicc": variable("model", (one.aicc for one in fits), "Akaike criterion corrected for small samples"),
            **rig_variables,
        },
        coords={"model": [one.model.name for one in fits], "test": [test.label for test in tests]},
        attrs={
            "result": "comparison",
            "title": "Models of friction under vibration against experiment",
            "source": f"sonolube {__version__}",
        },
    )


def comparison_csv(fits: tuple[ComparedFit, ...]) -> str:
    """Table as CSV with one row for each model: errors, criterion, and fitted parameters."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow((*_HEADS, *(f"rms_in_{letter}" for letter in DATA_SETS), "fitted"))
    for one in fits:
        errors: tuple[float | None, ...] = (None,) * 4
        if one.assessment:
            fitted, cross_validated = one.assessment.fit_errors, one.assessment.cross_validation_errors
            errors = (fitted.rms, cross_validated.rms, fitted.largest, fitted.median_relative)
        in_sets = [one.errors_in(letter) for letter in DATA_SETS]
        numbers = (*errors, one.aicc, *(of_set.rms if of_set else None for of_set in in_sets))
        writer.writerow(
            (
                one.model.name,
                one.model.source,
                one.sets,
                len(one.parameters),
                *("" if number is None else f"{number:.4g}" for number in numbers),
                "; ".join(map(parameter_text, one.parameters)),
            )
        )
    return text.getvalue()


def parameter_text(fitted: FittedParameter, *, left_out: str = "one set") -> str:
    """Fitted parameter as text: rig, value, and interval or leave-one-out range."""
    parameter = fitted.parameter
    rig = next((name for name, letters in RIGS.items() if letters == parameter.applicable_sets), None)

    def text_of(value: float) -> str:
        return format_si(value, parameter.unit)

    text = f"{parameter.name}{f' of the {rig} rig' if rig else ''} {text_of(fitted.value)}"
    if fitted.interval:
        text += f" (95 %: {' to '.join(map(text_of, fitted.interval))})"
    elif fitted.leave_one_out_range:
        text += f" ({left_out} left out: {' to '.join(map(text_of, fitted.leave_one_out_range))})"
    return text + (", at its bound" if fitted.at_bound else "")


_SETTINGS = ("vibration_amplitude", "vibration_velocity", "frequency", "sliding_speed", "normal_load")


def runs_fit_dataset(result: RunsFit) -> "xr.Dataset":
    """Measured, fitted and unseen friction ratios over models and conditions, with errors and parameters.

    Missing values are NaN; `parameter` runs over the names of the parameters of all models.
    """
    import xarray as xr

    models, conditions = result.models, result.table.conditions
    names = list(dict.fromkeys(fitted.parameter.name for model in models for fitted in model.parameters))
    known = [{fitted.parameter.name: fitted for fitted in model.parameters} for model in models]
    grid, fitted_grid = ("model", "condition"), ("model", "parameter")

    def over_parameters(value: Any, long_name: str) -> Any:
        rows = [[value(one[name]) if name in one else None for name in names] for one in known]
        array = np.array(rows, dtype=np.float64).reshape(len(models), len(names))
        return fitted_grid, array, {"long_name": f"{long_name}, in SI"}

    data = {
        name: variable(
            "condition", (getattr(one, name) for one in conditions), quantity(name).meaning, quantity(name).unit or "1"
        )
        for name in _SETTINGS
    }
    data |= {
        "friction_ratio": variable("condition", (one.friction_ratio for one in conditions), "Measured friction ratio"),
        "friction_ratio_uncertainty": variable(
            "condition", (one.uncertainty for one in conditions), "Standard uncertainty of the measured friction ratio"
        ),
        "repeats": variable("condition", (one.repeats for one in conditions), "Number of runs"),
        "fitted_ratio": variable(grid, (model.fitted for model in models), "Friction ratio by the fit to all"),
        "unseen_ratio": variable(grid, (model.unseen for model in models), "Friction ratio by the fit to the others"),
        "rms": variable("model", (model.rms_fit for model in models), "Root mean square error of the fit"),
        "rms_unseen": variable(
            "model", (model.rms_unseen for model in models), "Root mean square error of conditions left out"
        ),
        "aicc": variable("model", (model.aicc for model in models), "Akaike criterion corrected for small samples"),
        "probability": variable(
            "model", (model.probability for model in models), "Probability of such errors if it predicts as the first"
        ),
        "value": over_parameters(lambda one: one.value, "Fitted value"),
        "lowest": over_parameters(lambda one: one.interval and one.interval[0], "Lower end of the 95 % interval"),
        "highest": over_parameters(lambda one: one.interval and one.interval[1], "Upper end of the 95 % interval"),
    }
    return xr.Dataset(
        data,
        coords={
            "model": [model.name for model in models],
            "condition": [one.label for one in conditions],
            "parameter": names,
        },
        attrs={
            "title": f"Models of friction under vibration fitted to {result.table.title}",
            "source": f"sonolube {__version__}",
            "verdict": result.verdict,
            "rms_of_mean": result.rms_of_mean,
        },
    )
