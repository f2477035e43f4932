"""Fit of own runs as a labelled dataset."""

from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube import __version__
from sonolube.validation.runs_fit import RunsFit
from sonolube.validation.tables import variable
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

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
