"""Efficiency line of a rig from measured runs (D 4.1 to 4.3) with its figure, and the power for a friction force."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sonolube.charts import Axis, Band, Chart, Line, Part, Points, Rule, one_panel
from sonolube.checks import Floats
from sonolube.facts.metrics import (
    EfficiencyFit,
    PowerEstimate,
    efficiency_coefficient,
    efficiency_confidence_band,
    efficiency_prediction_band,
    fit_efficiency,
    power_estimate,
    require_fitted_speed,
)
from sonolube.measurement.measured_runs import run_caveats, setting, with_columns
from sonolube.rig import Rig, dataset

if TYPE_CHECKING:
    import xarray as xr

_NEARLY_ALL = 0.9  # friction reduction above which the power was probably more than needed
_SPEEDS = 101  # at which line and bands are evaluated


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class EfficiencyCalibration:
    """Efficiency line of a rig by least squares through measured runs.

    Parameters
    ----------
    rig : Rig
    fit : EfficiencyFit
    sliding_speed : ndarray, shape (n,)
        Speed of each run. [m/s]
    efficiency_coefficient : ndarray, shape (n,)
        Efficiency coefficient of each run (D 4.1). [m2/N]
    saturated_runs : int
        Number of runs that left less than a tenth of the friction.
    confidence_level : float
        Of the bands and of the interval of the power. []
    friction_force : float or None
        Target of the friction. [N]
    target_speed : float or None
        Sliding speed of that target, in m/s.
    estimate : PowerEstimate or None
        Power that the target requires.
    caveats : tuple of str
        About runs that were left out.
    """

    rig: Rig
    fit: EfficiencyFit
    sliding_speed: Floats
    efficiency_coefficient: Floats
    saturated_runs: int
    confidence_level: float
    friction_force: float | None
    target_speed: float | None
    estimate: PowerEstimate | None
    caveats: tuple[str, ...] = ()


def calibrate_efficiency(
    rig: Rig, runs: "xr.Dataset", *, friction_force: float | None, sliding_speed: float | None, confidence_level: float
) -> EfficiencyCalibration:
    r"""Least-squares line of the efficiency coefficient over sliding speed, and the power for a target friction.

    The efficiency coefficient of a run (D 4.1), with nominal area A_n, load F_N and power P, is

    .. math:: e = \frac{(F_{t0} - F_t)\,v\,A_n}{F_N\,P}

    and the line is :math:`e = a v + b` (D 4.2).

    See Also
    --------
    sonolube.facts.metrics.efficiency_coefficient, sonolube.facts.metrics.fit_efficiency,
    sonolube.facts.metrics.power_estimate
    """
    runs, skipped = with_columns(runs, "sliding_speed", "actuator_power")
    load = setting(runs, "normal_load", rig.normal_load)
    intrinsic = setting(runs, "intrinsic_friction_force", rig.friction_coefficient * load)
    reduction = runs["friction_reduction"].values
    speeds = runs["sliding_speed"].values
    coefficients = efficiency_coefficient(
        intrinsic_friction_force=intrinsic,
        reduced_friction_force=(1 - reduction) * intrinsic,
        sliding_speed=speeds,
        nominal_area=setting(runs, "nominal_area", rig.contact.nominal_area),
        normal_load=load,
        actuator_power=runs["actuator_power"].values,
    )
    fit = fit_efficiency(sliding_speed=speeds, efficiency_coefficient=coefficients)
    target_speed = estimate = None
    if friction_force is not None:
        target_speed = rig.sliding_speed if sliding_speed is None else sliding_speed
        estimate = power_estimate(
            fit,
            intrinsic_friction_force=rig.friction_coefficient * rig.normal_load,
            reduced_friction_force=friction_force,
            sliding_speed=target_speed,
            nominal_area=rig.contact.nominal_area,
            normal_load=rig.normal_load,
            confidence_level=confidence_level,
        )
    elif sliding_speed is not None:
        require_fitted_speed(fit, sliding_speed=sliding_speed)
    return EfficiencyCalibration(
        rig=rig,
        fit=fit,
        sliding_speed=speeds,
        efficiency_coefficient=coefficients,
        saturated_runs=int((reduction > _NEARLY_ALL).sum()),
        confidence_level=confidence_level,
        friction_force=friction_force,
        target_speed=target_speed,
        estimate=estimate,
        caveats=(*run_caveats(runs), *skipped),
    )


def efficiency_dataset(calibration: EfficiencyCalibration) -> "xr.Dataset":
    """Efficiency line with its confidence band and the prediction band of one more run, over sliding speed.

    Over `sliding_speed`, from the lowest to the highest speed of the runs.
    """
    fit = calibration.fit
    v = np.linspace(fit.lowest_speed, fit.highest_speed, _SPEEDS)
    results = dataset(
        {"sliding_speed": v, "efficiency_coefficient": fit.line.slope * v + fit.line.intercept},
        along="sliding_speed",
        title=f"Efficiency line of {calibration.rig.title}",
    )
    for name, band in (("line", efficiency_confidence_band), ("run", efficiency_prediction_band)):
        low, high = band(fit, sliding_speed=v, confidence_level=calibration.confidence_level)
        results[f"lowest_{name}"] = ("sliding_speed", low, {"units": "m2/N"})
        results[f"highest_{name}"] = ("sliding_speed", high, {"units": "m2/N"})
    return results


_PRINTED_UNIT = 1e9  # m2/N in mW mm2/(N W), the unit of D


def efficiency_chart(calibration: EfficiencyCalibration) -> Chart:
    """Efficiency coefficients of runs over sliding speed, with the line, its band and the prediction band."""
    line = efficiency_dataset(calibration)
    v = 1e3 * line["sliding_speed"].values
    level = f"{100 * calibration.confidence_level:g} %"
    bands: list[Part] = []
    for name, opacity, label in (("run", 0.12, f"one more run, {level}"), ("line", 0.3, f"line, {level}")):
        low, high = (_PRINTED_UNIT * line[f"{end}_{name}"].values for end in ("lowest", "highest"))
        bands.append(Band(x=v, low=low, high=high, label=label, opacity=opacity))
    speeds, coefficients = calibration.sliding_speed, calibration.efficiency_coefficient
    parts = (
        *bands,
        Line(x=v, y=_PRINTED_UNIT * line["efficiency_coefficient"].values, label="least squares"),
        Points(x=1e3 * speeds, y=_PRINTED_UNIT * coefficients, label="runs", colour=1),
        Rule(value=0.0, along="y", dash=0),
    )
    return one_panel(
        Axis("Sliding speed", "mm/s"), Axis("Efficiency coefficient", "mW mm²/(N W)"), parts, size=(5.4, 3.5)
    )
