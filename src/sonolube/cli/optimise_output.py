"""What the command `optimise` says and writes."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube import __version__
from sonolube.actuator import MatchingNetwork
from sonolube.cli.design_page import notes_of
from sonolube.cli.optimise_figures import (
    LIMITS,
    frequency_figure,
    front_figure,
    limits_figure,
    power_factor_figure,
)
from sonolube.cli.output import closing_lines
from sonolube.design.optimisation import (
    OWN_ACTUATOR,
    DesignPoint,
    DriveElectronics,
    MatchedNetwork,
    Optimum,
    design_text,
)
from sonolube.figure import publication_style
from sonolube.files import write_atomically
from sonolube.report import Finding, FindingTable, write_findings
from sonolube.rig import write_netcdf
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_NUMBERS = (
    "vibration_amplitude",
    "actuator_power",
    "heat_rate",
    "peak_current",
    "dynamic_tension",
    "nominal_pressure",
    "temperature_rise",
    "horn_stress",
)
_NEED = ("voltage_maximum", "peak_current", "effective_current", "apparent_power", "dissipated_power", "slew_rate")
_ELEMENTS = ("series_inductance", "series_capacitance", "shunt_inductance", "shunt_capacitance")
_NO_LIMIT = "none set"
_NEAR_END = 0.002  # of a range, in ratio: there a better design may lie beyond


def optimum_object(found: Optimum, electric: DriveElectronics, written: list[Path]) -> dict[str, Any]:
    """Return what was found as it goes into JSON."""
    space = found.problem.space
    return {
        "rig": space.rig.title,
        "friction_model": space.rig.friction_model.name,
        "minimise": found.minimise,
        "friction_ratio": {"value": found.problem.friction_ratio, "unit": ""},
        "designs": [_design_object(point) for point in found.designs],
        "front": [_design_object(point) for point in found.front],
        "screened": int(found.screening.frequency.size),
        "feasible": int(found.screening.feasible.sum()),
        "amplifier": {
            **{name: _valued(name, getattr(electric.amplifier, name)) for name in _NEED},
            "power_factor": _valued("power_factor", electric.amplifier.power_factor),
        },
        "networks": [_network_object(matched) for matched in electric.networks],
        "refused": found.screening.refused,
        "caveats": _caveats(found),
        "assumptions": _assumed(found),
        "files": [str(path) for path in written],
    }


def optimum_lines(found: Optimum, electric: DriveElectronics, written: list[Path]) -> list[str]:
    """Return what was found as lines."""
    rig = found.problem.space.rig
    return [
        f"{rig.title}, {format_si(rig.normal_load, 'N')}, {format_si(rig.sliding_speed, 'm/s')},"
        f" friction model {rig.friction_model.name}",
        *[f"  {name:<20} {value}" for name, value in _facts(found, electric)],
        *_table_lines(_table(found.front or found.designs)),
        *[f"  not used: {why}" for why in found.screening.refused.values()],
        *closing_lines(written, assumptions=_assumed(found), caveats=_caveats(found)),
    ]


def write_optimum(
    rig_file: Path,
    content: Mapping[str, Any],
    found: Optimum,
    electric: DriveElectronics,
    *,
    asked: list[tuple[str, str]],
    folder: Path,
    name: str,
) -> list[Path]:
    """Write the report with its figures, all designs as netCDF, and the best as a rig file; return the files."""
    text = design_text(rig_file.read_text(encoding="utf-8-sig"), content, found.problem, found.best)
    with publication_style():
        figures = [
            Finding(name=f"{name}-frequency", caption=_frequency_caption(found), figure=frequency_figure(found)),
            *(
                [Finding(name=f"{name}-front", caption=_front_caption(found), figure=front_figure(found))]
                if found.front
                else []
            ),
            *([_limits(found, name)] if _tightest(found.best) != _NO_LIMIT else []),
            Finding(
                name=f"{name}-power-factor",
                caption="Power factor that the amplifier sees around the drive's frequency (vertical line).",
                figure=power_factor_figure(found, electric),
            ),
        ]
    written = write_findings(
        title=f"Least {found.minimise} for a friction ratio of {found.problem.friction_ratio:.3g}:"
        f" {found.problem.space.rig.title}",
        asked=asked,
        facts=_facts(found, electric),
        tables=[_table(found.front or found.designs), *_beyond(found)],
        figures=figures,
        notes=[f"Not used: {why}." for why in found.screening.refused.values()]
        + notes_of(_caveats(found), _assumed(found)),
        folder=folder,
        name="optimise",
    )
    written.append(write_netcdf(_dataset(found), path=folder / f"{name}.nc"))
    return [*written, write_atomically(folder / f"{name}.toml", text)]


def _limits(found: Optimum, name: str) -> Finding:
    return Finding(
        name=f"{name}-limits",
        caption="What the best design uses of each limit that was set or that its actuator has.",
        figure=limits_figure(found.best),
    )


def _facts(found: Optimum, electric: DriveElectronics) -> list[tuple[str, str]]:
    best, need = found.best, electric.amplifier
    intrinsic = found.problem.space.rig.friction_coefficient
    ratio = found.problem.friction_ratio
    tolerance = found.problem.tolerance
    numbers = {key: float(values[0]) for key, values in best.evaluation.quantities.items()}
    return [
        ("friction wanted", f"coefficient {ratio * intrinsic:.3g}, ratio {ratio:.3g}" + _stood(tolerance)),
        ("actuator", _title(found, best)),
        (
            "drive",
            f"{format_si(best.voltage_peak_to_peak, 'V', digits=4)} peak to peak,"
            f" {format_si(best.frequency, 'Hz', digits=5)}, {best.candidate.waveform}",
        ),
        *[
            (key.replace("_", " "), format_si(value, "kg" if key.endswith("mass") else quantity(key).unit, digits=4))
            for key, value in best.candidate.entries.items()
        ],
        ("amplitude", format_si(numbers["vibration_amplitude"], "m")),
        ("power of amplifier", f"{format_si(best.objective('power'), 'W')} (D 1.9)"),
        ("heat in actuator", format_si(best.objective("heat"), "W")),
        ("tightest limit", _tightest(best)),
        (
            "amplifier",
            f"{format_si(need.voltage_maximum, 'V')}, {format_si(need.peak_current, 'A')} peak,"
            f" {format_si(need.apparent_power, 'W').replace('W', 'VA')}, {need.slew_rate * 1e-6:.3g} V/us,"
            f" power factor {need.power_factor:.3g}",
        ),
        *[(matched.name, _network_text(matched)) for matched in electric.networks],
        ("designs", f"{int(found.screening.feasible.sum())} of {found.screening.frequency.size} within all limits"),
    ]


def _table(points: tuple[DesignPoint, ...]) -> FindingTable:
    entries = list(points[0].candidate.entries)
    heads = ["actuator", "waveform", "f [kHz]", "U_pp [V]", *[f"{name} [SI]" for name in entries]]
    heads += ["power [W]", "heat [W]", "tightest limit"]
    rows = tuple(
        (
            point.candidate.actuator,
            point.candidate.waveform,
            f"{1e-3 * point.frequency:.3f}",
            f"{point.voltage_peak_to_peak:.4g}",
            *[f"{point.candidate.entries[name]:.4g}" for name in entries],
            f"{point.objective('power'):.4g}",
            f"{point.objective('heat'):.4g}",
            _tightest(point),
        )
        for point in points
    )
    return FindingTable(title="Designs, the best first", heads=tuple(heads), rows=rows)


def _table_lines(table: FindingTable) -> list[str]:
    widths = [max(map(len, column)) for column in zip(table.heads, *table.rows, strict=True)]
    return [
        "  " + "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in (table.heads, *table.rows)
    ]


def _beyond(found: Optimum) -> list[FindingTable]:
    """Return how many of all designs looked at each limit rules out."""
    utilisation, total = found.screening.utilisation, found.screening.frequency.size
    reached = np.isfinite(found.screening.voltage_peak_to_peak)
    ruled_out = {text: int((utilisation[name][reached] > 1).sum()) for name, text in LIMITS.items()}
    rows = (
        ("within all limits", int(found.screening.feasible.sum())),
        ("friction wanted not reached by any voltage", int((~reached).sum())),
        *((f"beyond the limit on {text}", count) for text, count in ruled_out.items() if count),
    )
    heads = ("status", "designs", "share")
    told = tuple((name, f"{count}", f"{count / total:.1%}") for name, count in rows)
    return [FindingTable(title="What became of the designs looked at", heads=heads, rows=told)]


def _tightest(point: DesignPoint) -> str:
    used = {name: float(values[0]) for name, values in point.evaluation.utilisation.items() if name in LIMITS}
    name = max(used, key=lambda each: used[each])
    return f"{LIMITS[name]}, {100 * used[name]:.3g} %" if used[name] > 0 else _NO_LIMIT


def _title(found: Optimum, point: DesignPoint) -> str:
    name = point.candidate.actuator
    return "the rig's own" if name == OWN_ACTUATOR else found.problem.space.catalogue[name].title


def _stood(tolerance: Any) -> str:
    if tolerance is None:
        return ""
    share = f"{100 * tolerance.manufacturing_tolerance:g} %"
    if tolerance.quantile is None:
        return f", at every corner of {share}"
    return f", by {100 * tolerance.quantile:g} % of rigs with a standard deviation of {share}"


def _network_text(matched: MatchedNetwork) -> str:
    low, high = matched.band
    return (
        f"{_elements(matched.network)}; power factor above 0.9 from {1e-3 * low:.4g} to {1e-3 * high:.4g} kHz,"
        f" {matched.detuned_power_factor:.2g} at worst with the capacitance off by 20 %;"
        f" {matched.voltage_gain:.3g} x voltage"
    )


def _elements(network: MatchingNetwork) -> str:
    places = {"series": "in the line", "shunt": "across it"}
    told = []
    for name in _ELEMENTS:
        value = getattr(network, name)
        if value is not None:
            told.append(f"{format_si(value, quantity(name).unit)} {places[name.partition('_')[0]]}")
    return ", ".join(told)


def _caveats(found: Optimum) -> list[str]:
    best, caveats = found.best, []
    values = {"frequency": best.frequency, **best.candidate.entries}
    for name, (low, high) in found.problem.space.bounds.items():
        for end, side in ((low, "lowest"), (high, "highest")):
            if abs(np.log(values[name] / end)) < _NEAR_END:
                caveats.append(f"{name} lies at the {side} value allowed: a better design may lie beyond")
    if best.objective("heat") > best.objective("power"):
        caveats.append(
            "more heat stays in the actuator than D 1.9 counts as the amplifier's power: near a resonance the motion"
            " takes real power, which that formula leaves out"
        )
    stack = best.evaluation.utilisation["tension"][0]
    if stack == 0:
        caveats.append("no preload is stated, so that tension in the stack is not judged: give --bolt and --preload")
    return caveats


def _assumed(found: Optimum) -> dict[str, str]:
    space, assumed = found.problem.space, {}
    if any(point.candidate.actuator != OWN_ACTUATOR for point in found.designs):
        assumed["quality factor"] = f"{space.mechanical_quality_factor:g} for the catalogue's ceramics; no sheet has it"
    assumed["loss tangent"] = f"{found.problem.limits.loss_tangent:g} for the ceramic, in its heat"
    return assumed | dict(space.rig.assumptions)


def _design_object(point: DesignPoint) -> dict[str, Any]:
    numbers = point.evaluation.quantities
    return {
        "actuator": point.candidate.actuator,
        "waveform": point.candidate.waveform,
        "frequency": _valued("frequency", point.frequency),
        "voltage_peak_to_peak": _valued("voltage_peak_to_peak", point.voltage_peak_to_peak),
        **{name: _valued(name, value) for name, value in point.candidate.entries.items()},
        **{name: _valued(name, float(numbers[name][0])) for name in _NUMBERS if name in numbers},
        "limits_used": {name: float(point.evaluation.utilisation[name][0]) for name in LIMITS},
    }


def _network_object(matched: MatchedNetwork) -> dict[str, Any]:
    network = matched.network
    return {
        "name": matched.name,
        **{name: _valued(name, value) for name in _ELEMENTS if (value := getattr(network, name)) is not None},
        "lowest_frequency": _valued("lowest_frequency", matched.band[0]),
        "highest_frequency": _valued("highest_frequency", matched.band[1]),
        "detuned_power_factor": matched.detuned_power_factor,
        "voltage_gain": matched.voltage_gain,
    }


def _valued(name: str, value: float) -> dict[str, Any]:
    return {"value": value, "unit": quantity(name).unit}


def _dataset(found: Optimum) -> "xr.Dataset":
    import xarray as xr

    land = found.screening
    columns = {
        "frequency": land.frequency,
        "voltage_peak_to_peak": land.voltage_peak_to_peak,
        "actuator_power": land.objectives["power"],
        "heat_rate": land.objectives["heat"],
        **{
            name: np.array([candidate.entries[name] for candidate in land.candidates])[land.candidate_index]
            for name in found.problem.space.ranges
        },
    }
    data: dict[str, Any] = {
        name: ("design", values, {"units": quantity(name).unit, "long_name": quantity(name).meaning})
        for name, values in columns.items()
    }
    for name in ("actuator", "waveform"):
        data[name] = (
            "design",
            np.array([getattr(candidate, name) for candidate in land.candidates])[land.candidate_index],
        )
    for name, text in LIMITS.items():
        data[f"used_{name}"] = ("design", land.utilisation[name], {"units": "1", "long_name": f"Share used: {text}"})
    data["feasible"] = ("design", land.feasible.astype(np.int8), {"long_name": "Whether it keeps to every limit"})
    return xr.Dataset(
        data,
        attrs={
            "title": f"Designs for a friction ratio of {found.problem.friction_ratio:.4g},"
            f" {found.problem.space.rig.title}",
            "source": f"sonolube {__version__}",
            "friction_model": found.problem.space.rig.friction_model.name,
        },
    )


def _frequency_caption(found: Optimum) -> str:
    return (
        f"Least {found.minimise} for the friction wanted at each frequency, over all structures looked at; markers are"
        " the designs refined."
    )


def _front_caption(found: Optimum) -> str:
    return (
        f"Designs that no other beats in both {found.minimise} and {found.second_objective},"
        " among all that keep to the limits."
    )
