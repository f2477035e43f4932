"""The comparison of models as a labelled dataset, and as tables of text."""

import csv
import io
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from sonolube import __version__
from sonolube.validation.compare import DATA_SETS, ComparedFit, FittedParameter
from sonolube.validation.parameters import RIGS

if TYPE_CHECKING:
    import xarray as xr

_HEADS = ("model", "source", "sets", "fitted_parameters", "rms", "rms_unseen", "worst", "median_relative", "akaike")


def comparison_dataset(fits: tuple[ComparedFit, ...]) -> "xr.Dataset":
    """Return measured, fitted and unseen friction ratios over models and tests, and each model's errors.

    Notes
    -----
    Empty places are not-a-number; `reason` says why each is empty.
    """
    import xarray as xr

    tests = [one.test for one in fits[0].predictions]
    grid = ("model", "test")

    def ratios(values: Iterable[Iterable[float | None]], told: str) -> tuple[tuple[str, str], object, dict[str, str]]:
        array = np.array([[np.nan if one is None else one for one in row] for row in values])
        return grid, array, {"units": "1", "long_name": told}

    def errors(values: list[float | None], told: str) -> tuple[str, object, dict[str, str]]:
        array = np.array([np.nan if one is None else one for one in values])
        return "model", array, {"units": "1", "long_name": told}

    return xr.Dataset(
        {
            "friction_ratio": (
                "test",
                np.array([test.friction_ratio for test in tests]),
                {"units": "1", "long_name": "Friction with vibration over friction without, measured"},
            ),
            "set": ("test", [DATA_SETS[test.set_name] for test in tests], {"long_name": "Set of the test"}),
            "fitted_ratio": ratios(
                ([p.fitted for p in one.predictions] for one in fits), "Friction ratio by the fit to all sets"
            ),
            "unseen_ratio": ratios(
                ([p.unseen for p in one.predictions] for one in fits), "Friction ratio by the fit to the other sets"
            ),
            "reason": (
                grid,
                [[p.refusal or "" for p in one.predictions] for one in fits],
                {"long_name": "Why a model gives no ratio"},
            ),
            "rms": errors([one.judgement.seen.rms if one.judgement else None for one in fits], "Rms error of the fit"),
            "rms_unseen": errors(
                [one.judgement.unseen.rms if one.judgement else None for one in fits],
                "Rms error where each set is predicted by a fit to the others",
            ),
            "akaike": errors([one.akaike for one in fits], "Akaike's criterion, corrected for few tests"),
        },
        coords={"model": [one.model.name for one in fits], "test": [test.label for test in tests]},
        attrs={"title": "Models of friction under vibration against experiment", "source": f"sonolube {__version__}"},
    )


def comparison_csv(fits: tuple[ComparedFit, ...]) -> str:
    """Return one line for each model: errors, criterion, and what was fitted."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    sets = list(DATA_SETS)
    writer.writerow((*_HEADS, *(f"rms_in_{letter}" for letter in sets), "fitted"))
    for one in fits:
        judgement = one.judgement
        known = (
            (judgement.seen.rms, judgement.unseen.rms, judgement.seen.worst, judgement.seen.median_relative)
            if judgement
            else (None,) * 4
        )
        in_sets = (one.errors_in(letter) for letter in sets)
        writer.writerow(
            (
                one.model.name,
                one.model.source,
                one.sets,
                len(one.parameters),
                *(_number(value) for value in (*known, one.akaike)),
                *(_number(errors.rms if errors else None) for errors in in_sets),
                "; ".join(parameter_said(told) for told in one.parameters),
            )
        )
    return text.getvalue()


def parameter_said(told: FittedParameter) -> str:
    """Return a fitted parameter in words: whose it is, its value, and how well it is known."""
    rig = next((name for name, letters in RIGS.items() if letters == told.parameter.matters_in), None)
    unit = f" {told.parameter.unit}" if told.parameter.unit else ""
    said = f"{told.parameter.name}{f' of the {rig} rig' if rig else ''} {told.value:.3g}{unit}"
    if told.interval:
        said += f" (95 %: {told.interval[0]:.3g} to {told.interval[1]:.3g})"
    elif told.left_out_range:
        said += f" (one set left out: {told.left_out_range[0]:.3g} to {told.left_out_range[1]:.3g})"
    return said + (", at its bound" if told.at_bound else "")


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}"
