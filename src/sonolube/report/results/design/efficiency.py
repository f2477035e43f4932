"""Efficiency line of a rig: facts, and the object for JSON."""

from typing import Any

from sonolube.design.efficiency import EfficiencyCalibration
from sonolube.report.results.record_object import picked
from sonolube.text.units import format_si
from sonolube.vocabulary import si

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
