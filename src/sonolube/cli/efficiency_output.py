"""What the command `efficiency` says and writes."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.cli.design_page import notes_of
from sonolube.cli.output import closing_lines
from sonolube.errors import InvalidInput
from sonolube.figure import COLOURS, publication_style
from sonolube.metrics import (
    EfficiencyFit,
    PowerEstimate,
    efficiency_coefficient,
    efficiency_confidence_band,
    efficiency_prediction_band,
    fit_efficiency,
    power_estimate,
    require_fitted_speed,
)
from sonolube.report import Finding, write_findings
from sonolube.rig import Rig, dataset, write_netcdf
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_PRINTED = 1e9  # m2/N in mW mm2/(N W), D's unit
_ALL_GONE = 0.9  # reduction above which power was likely more than needed


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Calibration:
    """An efficiency line of one's own rig.

    Parameters
    ----------
    rig : Rig
    fit : EfficiencyFit
    sliding_speed : ndarray, shape (n,)
        Speed of each run. [m/s]
    efficiency_coefficient : ndarray, shape (n,)
        Its coefficient. [m2/N]
    saturated : int
        How many runs left less than a tenth of the friction.
    confidence_level : float
        Of band and interval. []
    friction_force : float or None
        Friction wanted. [N]
    wanted_speed : float or None
        Sliding speed at which it is wanted, in m/s.
    estimate : PowerEstimate or None
        What that friction takes.
    """

    rig: Rig
    fit: EfficiencyFit
    sliding_speed: Floats
    efficiency_coefficient: Floats
    saturated: int
    confidence_level: float
    friction_force: float | None
    wanted_speed: float | None
    estimate: PowerEstimate | None


def calibrated(
    rig: Rig,
    runs: "xr.Dataset",
    *,
    friction_force: float | None,
    sliding_speed: float | None,
    confidence_level: float,
) -> Calibration:
    """Return the efficiency line through measured runs, and the power for a friction wanted.

    Parameters
    ----------
    rig : Rig
        Gives load, nominal area and intrinsic friction where the runs do not.
    runs : xarray.Dataset
        Over `run`, with `friction_reduction`, `sliding_speed` and `actuator_power`.
    friction_force : float or None
        Friction wanted. [N]
    sliding_speed : float or None
        Sliding speed at which it is wanted; the rig's where absent. [m/s]
    confidence_level : float
        Of band and interval. []

    Returns
    -------
    Calibration

    Raises
    ------
    InvalidInput
        If a column is missing, or the runs make no line.
    OutsideRange
        If the speed is none that the runs cover.
    """
    for name in ("sliding_speed", "actuator_power"):
        if name not in runs:
            raise InvalidInput(f"measured runs need a column {name}")
    load = _column(runs, "normal_load", rig.normal_load)
    intrinsic = _column(runs, "intrinsic_friction_force", rig.friction_coefficient * load)
    reduction = runs["friction_reduction"].values
    speeds = runs["sliding_speed"].values
    coefficients = efficiency_coefficient(
        intrinsic_friction_force=intrinsic,
        reduced_friction_force=(1 - reduction) * intrinsic,
        sliding_speed=speeds,
        nominal_area=_column(runs, "nominal_area", rig.contact.nominal_area),
        normal_load=load,
        actuator_power=runs["actuator_power"].values,
    )
    fit = fit_efficiency(sliding_speed=speeds, efficiency_coefficient=coefficients)
    wanted = estimate = None
    if friction_force is not None:
        wanted = rig.sliding_speed if sliding_speed is None else sliding_speed
        estimate = power_estimate(
            fit,
            intrinsic_friction_force=rig.friction_coefficient * rig.normal_load,
            reduced_friction_force=friction_force,
            sliding_speed=wanted,
            nominal_area=rig.contact.nominal_area,
            normal_load=rig.normal_load,
            confidence_level=confidence_level,
        )
    elif sliding_speed is not None:
        require_fitted_speed(fit, sliding_speed=sliding_speed)
    return Calibration(
        rig=rig,
        fit=fit,
        sliding_speed=speeds,
        efficiency_coefficient=coefficients,
        saturated=int((reduction > _ALL_GONE).sum()),
        confidence_level=confidence_level,
        friction_force=friction_force,
        wanted_speed=wanted,
        estimate=estimate,
    )


def calibration_object(found: Calibration, written: list[Path]) -> dict[str, Any]:
    """Return a calibration as it goes into JSON."""
    fit = found.fit
    values = {
        "slope": fit.line.slope,
        "intercept": fit.line.intercept,
        "slope_uncertainty": fit.slope_uncertainty,
        "intercept_uncertainty": fit.intercept_uncertainty,
        "efficiency_deviation": fit.efficiency_deviation,
        "lowest_speed": fit.lowest_speed,
        "highest_speed": fit.highest_speed,
        "confidence_level": found.confidence_level,
    }
    if found.estimate is not None and found.friction_force is not None and found.wanted_speed is not None:
        values |= {"friction_force": found.friction_force, "sliding_speed": found.wanted_speed}
        values |= {"actuator_power": found.estimate.actuator_power, "lowest_power": found.estimate.lowest_power}
        if found.estimate.highest_power is not None:
            values["highest_power"] = found.estimate.highest_power
    return {
        "rig": found.rig.title,
        "runs": fit.runs,
        **{name: {"value": value, "unit": quantity(name).unit} for name, value in values.items()},
        "caveats": _caveats(found),
        "assumptions": dict(found.rig.assumptions),
        "files": [str(path) for path in written],
    }


def calibration_lines(found: Calibration, written: list[Path]) -> list[str]:
    """Return a calibration as lines."""
    return [
        f"{found.rig.title}, {found.fit.runs} runs",
        *[f"  {name:<18} {value}" for name, value in _facts(found)],
        *closing_lines(written, assumptions=found.rig.assumptions, caveats=_caveats(found)),
    ]


def write_calibration(found: Calibration, *, asked: list[tuple[str, str]], folder: Path, name: str) -> list[Path]:
    """Write the report with its figure, and the band as netCDF; return the files."""
    v = np.linspace(found.fit.lowest_speed, found.fit.highest_speed, 101)
    with publication_style():
        figure = calibration_figure(found)
    written = write_findings(
        title=f"Efficiency line: {found.rig.title}",
        asked=asked,
        facts=_facts(found),
        figures=[Finding(name=name, caption=_caption(found), figure=figure)],
        notes=notes_of(_caveats(found), found.rig.assumptions),
        folder=folder,
        name="efficiency",
    )
    line = found.fit.line.slope * v + found.fit.line.intercept
    results = dataset(
        {"sliding_speed": v, "efficiency_coefficient": line},
        along="sliding_speed",
        title=f"Efficiency line of {found.rig.title}",
    )
    for part, band in (("line", efficiency_confidence_band), ("run", efficiency_prediction_band)):
        low, high = band(found.fit, sliding_speed=v, confidence_level=found.confidence_level)
        results[f"lowest_{part}"] = ("sliding_speed", low, {"units": "m2/N"})
        results[f"highest_{part}"] = ("sliding_speed", high, {"units": "m2/N"})
    return [*written, write_netcdf(results, path=folder / f"{name}.nc")]


def calibration_figure(found: Calibration) -> "Figure":
    """Return measured coefficients over speed, the line and both bands."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.4, 3.5))
    axes = figure.subplots()
    v = np.linspace(found.fit.lowest_speed, found.fit.highest_speed, 101)
    level = f"{100 * found.confidence_level:g} %"
    for band, shade, label in (
        (efficiency_prediction_band, 0.12, f"one more run, {level}"),
        (efficiency_confidence_band, 0.3, f"line, {level}"),
    ):
        low, high = band(found.fit, sliding_speed=v, confidence_level=found.confidence_level)
        axes.fill_between(
            1e3 * v, _PRINTED * low, _PRINTED * high, color=COLOURS[0], alpha=shade, linewidth=0, label=label
        )
    line = found.fit.line.slope * v + found.fit.line.intercept
    axes.plot(1e3 * v, _PRINTED * line, color=COLOURS[0], label="least squares")
    axes.plot(
        1e3 * found.sliding_speed,
        _PRINTED * found.efficiency_coefficient,
        "o",
        color=COLOURS[1],
        markeredgecolor="white",
        label="runs",
    )
    axes.axhline(0, color="0.4", linewidth=0.8)
    axes.set(xlabel="Sliding speed [mm/s]", ylabel="Efficiency coefficient\n[mW mm²/(N W)]")
    axes.legend()
    return figure


def _column(runs: "xr.Dataset", name: str, otherwise: Any) -> Any:
    return runs[name].values if name in runs else otherwise


def _facts(found: Calibration) -> list[tuple[str, str]]:
    fit = found.fit
    slope, intercept = _PRINTED * fit.line.slope, _PRINTED * fit.line.intercept
    facts = [
        (
            "line",
            f"({slope:.3g} +- {_PRINTED * fit.slope_uncertainty:.2g}) v + ({intercept:.3g} +-"
            f" {_PRINTED * fit.intercept_uncertainty:.2g}), in mW mm2/(N W) with v in m/s",
        ),
        ("scatter of runs", f"{_PRINTED * fit.efficiency_deviation:.2g} mW mm2/(N W)"),
        ("speeds covered", f"{format_si(fit.lowest_speed, 'm/s')} to {format_si(fit.highest_speed, 'm/s')}"),
    ]
    if found.estimate is None or found.friction_force is None or found.wanted_speed is None:
        return facts
    low, high = found.estimate.lowest_power, found.estimate.highest_power
    upper = "no bound" if high is None else format_si(high, "W")
    told = (
        f"{format_si(found.estimate.actuator_power, 'W')} for {format_si(found.friction_force, 'N')} at"
        f" {format_si(found.wanted_speed, 'm/s')}; {format_si(low, 'W')} to {upper} with"
        f" {100 * found.confidence_level:g} %"
    )
    return [*facts, ("power", told)]


def _caveats(found: Calibration) -> list[str]:
    if not found.saturated:
        return []
    return [
        f"{found.saturated} runs left less than a tenth of the friction: power beyond what is needed makes the line low"
    ]


def _caption(found: Calibration) -> str:
    return (
        f"Efficiency coefficient (D 4.1) of {found.fit.runs} runs over sliding speed, with the line of least squares,"
        " the band of the line and that of one more run."
    )
