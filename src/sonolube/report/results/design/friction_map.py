"""Maps of friction reduction and the efficiency line of a rig: facts, tables of a page, and objects for JSON."""

from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.design import map_layout
from sonolube.design.efficiency import EfficiencyCalibration
from sonolube.design.map_figures import panels_text
from sonolube.design.point_statistics import extreme_point, failure_counts
from sonolube.design.runs_map import MIN_RUNS
from sonolube.prediction.applicability import FrictionInterval
from sonolube.prediction.predicted_points import PredictedRig
from sonolube.report.blocks import Rows
from sonolube.report.page import Page, PageTable
from sonolube.report.results.design.sweep import status_tables
from sonolube.report.results.design.uncertainty import in_sentence
from sonolube.report.results.record_object import (
    amplitude_object,
    amplitude_rows,
    friction_model_text,
    picked,
    rig_settings,
)
from sonolube.rig import AMPLITUDE, VOLTAGE, PowerToSupply, Rig, power_to_supply
from sonolube.rig.power import POWERS, with_former_key
from sonolube.text.units import format_si
from sonolube.vocabulary import quantity, si

if TYPE_CHECKING:
    import xarray as xr

_SETTINGS = ("sliding_speed", "normal_load", "frequency", VOLTAGE.name, AMPLITUDE.name)


def map_blocks(rig: Rig, mapped: "xr.Dataset", predicted: str = "") -> tuple[str, Rows]:
    """Greatest reduction and what is predicted there, ridge, and points without a result."""
    failures = [("without result", f"{count}: {reason}") for reason, count in _failures(mapped).items()]
    return (
        f"{rig.title}, {mapped['status'].size} points, {friction_model_text(rig)}",
        Rows([*_facts(mapped, predicted), *amplitude_rows(rig), *failures]),
    )


def map_object(rig: Rig, mapped: "xr.Dataset") -> dict[str, Any]:
    """Greatest reduction with the point where it occurs, and the number of points without a result, for JSON."""
    return {
        "rig": rig.title,
        "map": str(mapped.attrs["map"]),
        "friction_model": rig.friction_model.name,
        **amplitude_object(rig),
        "same_panels": bool(panels_text(mapped)),
        "points": int(mapped["status"].size),
        "without_result": int(mapped["friction_reduction"].isnull().sum()),
        "most_reduction": si(with_former_key(_greatest(mapped))),
    }


def map_page(
    rig: Rig, mapped: "xr.Dataset", runs: "xr.Dataset | None", interpolated: "xr.Dataset | None", predicted: str = ""
) -> Page:
    """Page of a map: greatest reduction and what is predicted there, ridge, measured runs, and statuses."""
    across, up, panel = map_layout(mapped)
    over = " and ".join(in_sentence(name).partition(",")[0] for name in (across, up))
    return Page(
        name="map",
        title=f"Friction reduction over {over}: {rig.title}",
        settings=rig_settings(rig),
        facts=[("points", f"{mapped['status'].size}"), *_facts(mapped, predicted), *_run_facts(runs, interpolated)],
        tables=[*_panel_tables(mapped, panel), *status_tables(mapped, _failures(mapped))],
    )


def _failures(mapped: "xr.Dataset") -> dict[str, int]:
    """Number of points without a result, by the reason."""
    return failure_counts(mapped, outcome="friction_reduction")


def _greatest(mapped: "xr.Dataset") -> dict[str, float]:
    """Greatest reduction and the quantities where it occurs; empty where no point has a result."""
    point = extreme_point(mapped, outcome="friction_reduction", highest=True)
    if point is None:
        return {}
    names = ("friction_reduction", *(name for name in (*_SETTINGS, *POWERS) if name in mapped.variables))
    return {name: float(point[name]) for name in names if point[name].ndim == 0 and np.isfinite(point[name])}


def predicted_there(mapped: "xr.Dataset", predicted: PredictedRig) -> FrictionInterval | None:
    """Predicted friction ratio where a map has its greatest reduction; None where it has none."""
    at = _greatest(mapped)
    if not at:
        return None
    if predicted.chances is None:
        return FrictionInterval(reason=predicted.reason)
    settings = {name: at.get(name) for name in ("frequency", "sliding_speed")}
    low, median, high = predicted.chances.interval(vibration_amplitude=at[AMPLITUDE.name], **settings)
    return FrictionInterval(low=low, median=median, high=high)


def predicted_text(found: FrictionInterval | None) -> str:
    """Predicted reduction in words, or why there is none."""
    if found is None or found.low is None or found.median is None or found.high is None:
        return "" if found is None else found.text
    return f"{1 - found.median:.2g}, {1 - found.high:.2g} to {1 - found.low:.2g} (80 %, `sonolube predict`)"


def predicted_there_object(found: FrictionInterval | None) -> dict[str, Any]:
    """The same for JSON, as a friction ratio."""
    if found is None:
        return {}
    ends = None if found.low is None else [found.low, found.high]
    return {"predicted_friction_ratio": {"median": found.median, "interval_80": ends, "reason": found.reason or None}}


def _power(greatest: dict[str, float]) -> PowerToSupply | None:
    """Power to supply at the point of the greatest reduction."""
    return power_to_supply(
        charging_power=greatest.get("charging_power"), dissipated_power=greatest.get("dissipated_power")
    )


def _facts(mapped: "xr.Dataset", predicted: str) -> list[tuple[str, str]]:
    """Greatest reduction, what is predicted there, and the ridge where the map has one."""
    found: list[tuple[str, str]] = []
    greatest = _greatest(mapped)
    values = [format_si(greatest[name], quantity(name).unit) for name in greatest if name not in POWERS]
    power = _power(greatest)
    if values:
        supplied = [] if power is None else [f"{power.text} to supply"]
        found.append(("most reduction", f"{values[0]} at {', '.join([*values[1:], *supplied])}"))
        found += [("predicted there", predicted)] if predicted else []
    found += [("panels", text)] if (text := panels_text(mapped)) else []
    if power is not None:
        found.append(("energy", power.energy_balance))
    ridge = _ridge(mapped)
    if ridge:
        found.append(("ridge", f"{ridge}; beyond it doubling the power buys less than 5 %"))
    return found


def _run_facts(runs: "xr.Dataset | None", interpolated: "xr.Dataset | None") -> list[tuple[str, str]]:
    """Number of measured runs, their scatter and their leave-one-out error."""
    if runs is None:
        return []
    count = f"{runs.sizes['run']}"
    if interpolated is None:
        return [("measured runs", f"{count}; {MIN_RUNS} make a map of their own")]
    scatter, error = (100 * float(interpolated.attrs[name]) for name in ("scatter", "leave_one_out_error"))
    text = f"scatter {scatter:.2g} % about a smooth map, leave-one-out error {error:.2g} %"
    return [("measured runs", f"{count}; {text}")]


def caption(mapped: "xr.Dataset", *, has_runs: bool) -> str:
    """Caption of the contours."""
    text = "Friction reduction by the model."
    if _ridge(mapped):
        text += " Dashed: the power beyond which doubling it reduces friction by less than another 5 %."
    return f"{text} Circles: measured runs, with their reductions in percent." if has_runs else text


def _ridge(mapped: "xr.Dataset") -> str:
    """Range of the sufficient power; empty where the map does not reach it."""
    if "saturation_power" not in mapped or mapped["saturation_power"].isnull().all():
        return ""
    low, high = float(mapped["saturation_power"].min()), float(mapped["saturation_power"].max())
    return f"{format_si(low, 'W')} to {format_si(high, 'W')}"


def _panel_tables(mapped: "xr.Dataset", panel: str | None) -> list[PageTable]:
    """Greatest reduction in each panel, and the ridge where the map has one; none where all panels are the same."""
    if panel is None or panels_text(mapped):
        return []
    level = "power_to_supply" if "power_to_supply" in mapped.coords else AMPLITUDE.name
    names = [name for name in ("friction_reduction", "sliding_speed", level) if name != panel]
    rows = []
    for index in range(mapped.sizes[panel]):
        part = mapped.isel({panel: index})
        greatest = _greatest(part)
        texts = {name: format_si(value, quantity(name).unit) for name, value in greatest.items()}
        power = _power(greatest)
        texts |= {} if power is None else {"power_to_supply": power.text}
        value = format_si(float(part[panel]), quantity(panel).unit)
        rows.append((value, *(texts.get(name, "") for name in names), _ridge(part)))
    heads = (quantity(panel).meaning, *(quantity(name).meaning for name in names), "Ridge")
    columns = slice(None) if any(row[-1] for row in rows) else slice(-1)
    return [PageTable(title="Most reduction", heads=heads[columns], rows=tuple(row[columns] for row in rows))]


_PRINTED_UNIT = 1e9  # m2/N in mW mm2/(N W), the unit of D
_FITTED = ("slope_uncertainty", "intercept_uncertainty", "efficiency_deviation", "lowest_speed", "highest_speed")
_POWERS = ("actuator_power", "lowest_power", "highest_power")


def facts(found: EfficiencyCalibration) -> list[tuple[str, str]]:
    """Line, scatter and range of the runs, and the power."""
    fit = found.fit
    slope, intercept = _PRINTED_UNIT * fit.line.slope, _PRINTED_UNIT * fit.line.intercept
    facts = {
        "line": f"({slope:.3g} +- {_PRINTED_UNIT * fit.slope_uncertainty:.2g}) v + ({intercept:.3g} +-"
        f" {_PRINTED_UNIT * fit.intercept_uncertainty:.2g}), in mW mm2/(N W) with v in m/s",
        "scatter of runs": f"{_PRINTED_UNIT * fit.efficiency_deviation:.2g} mW mm2/(N W)",
        "speeds covered": f"{format_si(fit.lowest_speed, 'm/s')} to {format_si(fit.highest_speed, 'm/s')}",
    }
    if found.estimate is not None:
        power, low, high = (
            "no bound" if value is None else format_si(value, "W")
            for value in (getattr(found.estimate, name) for name in _POWERS)
        )
        at = format_si(found.target_speed or 0.0, "m/s")
        text = f"{power} for {format_si(found.friction_force or 0.0, 'N')} at {at}; {low} to {high} with"
        facts["power"] = f"{text} {100 * found.confidence_level:g} %"
    return list(facts.items())


def efficiency_object(found: EfficiencyCalibration) -> dict[str, Any]:
    """Slope and intercept with their uncertainties, range of speeds, and the power with its interval."""
    values = {
        "slope": found.fit.line.slope,
        "intercept": found.fit.line.intercept,
        **picked(found.fit, *_FITTED),
        "confidence_level": found.confidence_level,
    }
    if found.estimate is not None:
        values |= {"friction_force": found.friction_force, "sliding_speed": found.target_speed}
        values |= {name: value for name, value in picked(found.estimate, *_POWERS).items() if value is not None}
    return {"runs": found.fit.runs, **si(values)}
