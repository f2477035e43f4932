"""Optimum of a design: facts, table of designs, caveats, and the object for JSON."""

from collections.abc import Mapping
from dataclasses import asdict
from math import log
from typing import Any, Final

from sonolube.design.optimisation import (
    OBJECTIVES,
    OWN_ACTUATOR,
    DesignPoint,
    DriveElectronics,
    MatchedNetwork,
    Optimum,
    Tolerance,
)
from sonolube.design.optimisation.confident_optimum import ReachedChance
from sonolube.design.optimisation.design_output import design_changes
from sonolube.design.optimisation.evaluation import LIMITS
from sonolube.models.actuator import MatchingNetwork
from sonolube.rig.power import POWERS, with_former_key
from sonolube.text.units import format_si
from sonolube.vocabulary import quantity, si

_DESIGN_QUANTITIES = (
    "vibration_amplitude",
    *POWERS,
    "heat_rate",
    "dynamic_tension",
    "nominal_pressure",
    "temperature_rise",
    "horn_stress",
)
_ELEMENTS = ("series_inductance", "series_capacitance", "shunt_inductance", "shunt_capacitance")
NO_LIMIT: Final = "none set"
"""Text where a design has no limit."""
_AT_END = 0.002  # relative distance from an end of a range, within which a better design may lie beyond


def facts(optimum: Optimum, electric: DriveElectronics) -> list[tuple[str, str]]:
    """Target, best design, tightest limit, amplifier and networks."""
    best, need, space = optimum.best, electric.amplifier, optimum.problem.space
    ratio, screened = optimum.problem.friction_ratio, optimum.screening
    coefficient = ratio * space.rig.friction_coefficient
    amplitude = float(best.evaluation.quantities["vibration_amplitude"][0])
    units = {name: "kg" if name.endswith("mass") else quantity(name).unit for name in best.candidate.entries}
    facts = {
        "target friction": f"coefficient {coefficient:.3g}, ratio {ratio:.3g}"
        f"{_tolerance_text(optimum.problem.tolerance)}",
        "actuator": _actuator_title(optimum),
        "drive": f"{format_si(best.voltage_peak_to_peak, 'V', digits=4)} peak to peak,"
        f" {format_si(best.frequency, 'Hz', digits=5)}, {best.candidate.waveform}",
        **{
            name.replace("_", " "): format_si(value, units[name], digits=4)
            for name, value in best.candidate.entries.items()
        },
        "amplitude": format_si(amplitude, "m"),
        "power to supply": format_si(best.objective("power"), "W"),
        "of which": _parts_text(best),
        "heat in actuator": f"{format_si(best.objective('heat'), 'W')}, the dielectric loss included",
        "tightest limit": tightest_limit(best),
        "amplifier": f"{format_si(need.voltage_maximum, 'V')}, {format_si(need.peak_current, 'A')} peak,"
        f" {format_si(need.apparent_power, 'W').replace('W', 'VA')}, {need.slew_rate * 1e-6:.3g} V/us,"
        f" power factor {need.power_factor:.3g}",
        **{matched.name: _network_text(matched) for matched in electric.networks},
        "designs": f"{int(screened.feasible.sum())} of {screened.frequency.size} within all limits",
    }
    return list(facts.items())


def _parts_text(point: DesignPoint) -> str:
    """Both parts of the power to supply, of which the larger is supplied."""
    charge, heat = (
        format_si(float(point.evaluation.quantities[name][0]), "W") for name in ("charging_power", "dissipated_power")
    )
    return f"the larger of {charge}, charge of the capacitance (D 1.9), and {heat}, heat of the motion"


def designs_table(optimum: Optimum) -> tuple[list[str], list[tuple[str, ...]]]:
    """Heads and rows: designs of the front, or the best of each actuator and waveform, the best first."""
    points = optimum.front or optimum.designs
    entries = list(points[0].candidate.entries)
    heads = ["actuator", "waveform", "f [kHz]", "U_pp [V]", *[f"{name} [SI]" for name in entries]]
    rows: list[tuple[str, ...]] = [
        (
            point.candidate.actuator,
            point.candidate.waveform,
            f"{1e-3 * point.frequency:.3f}",
            f"{point.voltage_peak_to_peak:.4g}",
            *[f"{point.candidate.entries[name]:.4g}" for name in entries],
            f"{point.objective('power'):.4g}",
            f"{point.objective('heat'):.4g}",
            tightest_limit(point),
        )
        for point in points
    ]
    return [*heads, "power [W]", "heat [W]", "tightest limit"], rows


def optimum_caveats(optimum: Optimum) -> list[str]:
    """Values at the end of their range, and a preload that is not given."""
    best, caveats = optimum.best, []
    values = {"frequency": best.frequency, **best.candidate.entries}
    for name, (low, high) in optimum.problem.space.bounds.items():
        for end, side in ((low, "lowest"), (high, "highest")):
            if abs(log(values[name] / end)) < _AT_END:
                caveats.append(f"{name} lies at the {side} value allowed: a better design may lie beyond")
    if best.evaluation.utilisation["tension"][0] == 0:
        caveats.append("no preload is given, so that tension in the stack is not judged: give bolt and preload")
    return caveats


def chance_object(chance: ReachedChance | None) -> dict[str, Any]:
    """Chance of the target by the best design, and its friction ratio with the 80 % interval; empty where unknown."""
    if chance is None:
        return {}
    return {
        "predicted": {
            "target_reduction": chance.friction_reduction,
            "confidence": chance.wanted,
            "chance": chance.chance,
            "friction_ratio": {"median": chance.median, "interval_80": [chance.low, chance.high]},
        }
    }


def optimum_object(optimum: Optimum, electric: DriveElectronics, *, content: Mapping[str, Any]) -> dict[str, Any]:
    """Best designs, front, number of designs, amplifier and networks; `content` is that of the file of the rig."""

    def design(point: DesignPoint) -> dict[str, Any]:
        return _design_object(point) | {"changes": design_changes(content, optimum.problem, point)}

    screened, rig = optimum.screening, optimum.problem.space.rig
    return {
        "rig": rig.title,
        "friction_model": rig.friction_model.name,
        "minimise": optimum.minimise,
        "pareto": optimum.second_objective,
        **si({"friction_ratio": optimum.problem.friction_ratio}),
        "designs": [design(point) for point in optimum.designs],
        "front": [design(point) for point in optimum.front],
        "screened": int(screened.frequency.size),
        "feasible": int(screened.feasible.sum()),
        "amplifier": si(asdict(electric.amplifier)),
        "networks": [_network_object(matched) for matched in electric.networks],
        "refused": screened.refused,
    }


def tightest_limit(point: DesignPoint) -> str:
    """Limit of which a design uses most, with the fraction."""
    used = {name: float(values[0]) for name, values in point.evaluation.utilisation.items() if name in LIMITS}
    name = max(used, key=lambda each: used[each])
    return f"{LIMITS[name]}, {100 * used[name]:.3g} %" if used[name] > 0 else NO_LIMIT


def _actuator_title(optimum: Optimum) -> str:
    """Title of the actuator of the best design."""
    name = optimum.best.candidate.actuator
    return "the rig's own" if name == OWN_ACTUATOR else str(optimum.problem.space.catalogue[name].title)


def _tolerance_text(tolerance: Tolerance | None) -> str:
    """Deviations under which the target is reached."""
    if tolerance is None:
        return ""
    deviation = f"{100 * tolerance.manufacturing_tolerance:g} %"
    if tolerance.quantile is None:
        return f", at every corner of {deviation}"
    return f", by {100 * tolerance.quantile:g} % of rigs with a standard deviation of {deviation}"


def _network_text(matched: MatchedNetwork) -> str:
    """Elements, band, power factor with the capacitance off, and voltage gain of a matching network."""
    low, high = matched.band
    return (
        f"{_element_text(matched.network)}; power factor above 0.9 from {1e-3 * low:.4g} to {1e-3 * high:.4g} kHz,"
        f" at least {matched.detuned_power_factor:.2g} with the capacitance off by 20 %;"
        f" voltage gain {matched.voltage_gain:.3g}"
    )


def _element_text(network: MatchingNetwork) -> str:
    """Elements of a matching network with their places."""
    places = {"series": "in the line", "shunt": "across it"}
    return ", ".join(
        f"{format_si(value, quantity(name).unit)} {places[name.partition('_')[0]]}"
        for name, value in _elements(network).items()
    )


def _elements(network: MatchingNetwork) -> dict[str, float]:
    """Inductances and capacitances that a matching network has."""
    return {name: value for name in _ELEMENTS if (value := getattr(network, name)) is not None}


def _design_object(point: DesignPoint) -> dict[str, Any]:
    """Design for JSON: candidate, drive, quantities, objectives in SI and fractions of the limits."""
    numbers = point.evaluation.quantities
    return {
        "actuator": point.candidate.actuator,
        "waveform": point.candidate.waveform,
        **si({"frequency": point.frequency, "voltage_peak_to_peak": point.voltage_peak_to_peak}),
        **si(dict(point.candidate.entries)),
        **si(with_former_key({name: float(numbers[name][0]) for name in _DESIGN_QUANTITIES if name in numbers})),
        "objectives": {name: point.objective(name) for name in OBJECTIVES},
        "limits_used": {name: float(point.evaluation.utilisation[name][0]) for name in LIMITS},
    }


def _network_object(matched: MatchedNetwork) -> dict[str, Any]:
    """Matching network for JSON."""
    return {
        "name": matched.name,
        **si(_elements(matched.network)),
        **si({"lowest_frequency": matched.band[0], "highest_frequency": matched.band[1]}),
        "detuned_power_factor": matched.detuned_power_factor,
        "voltage_gain": matched.voltage_gain,
    }
