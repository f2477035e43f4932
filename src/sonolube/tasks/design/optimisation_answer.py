"""Answer of the task `optimise`: best designs, Pareto front, amplifier, matching networks and a rig file."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import log
from typing import TYPE_CHECKING, Any

import tomli_w

from sonolube.design.optimisation import (
    OWN_ACTUATOR,
    DesignPoint,
    DriveElectronics,
    MatchedNetwork,
    Optimum,
    Tolerance,
    design_text,
    figures,
)
from sonolube.design.optimisation.designs_dataset import design_counts, designs_dataset
from sonolube.design.optimisation.evaluation import LIMITS
from sonolube.input_files import input_text
from sonolube.models.actuator import MatchingNetwork
from sonolube.report import Drawing, Page, PageTable
from sonolube.rig import Rig, read_rig
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block, Rows, Table
from sonolube.tasks.results.rig_text import operating_point, rig_settings
from sonolube.tasks.results.status_tables import count_table
from sonolube.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr


_DESIGN_QUANTITIES = (
    "vibration_amplitude",
    "actuator_power",
    "heat_rate",
    "peak_current",
    "dynamic_tension",
    "nominal_pressure",
    "temperature_rise",
    "horn_stress",
)
_ELEMENTS = ("series_inductance", "series_capacitance", "shunt_inductance", "shunt_capacitance")
_NO_LIMIT = "none set"
_AT_END = 0.002  # relative distance from an end of a range, within which a better design may lie beyond


@answer
class OptimisationAnswer(Answer):
    """Best designs and front of an optimisation, with the amplifier and the networks of the best."""

    rig: Rig
    optimum: Optimum
    electric: DriveElectronics

    def blocks(self) -> Sequence[Block]:
        """Best design, table of all, and actuators that were not used."""
        table = self._table()
        return [
            operating_point(self._space.rig),
            Rows(self._facts()),
            Table(table.heads, table.rows),
            *[f"  not used: {reason}" for reason in self.optimum.screening.refused.values()],
        ]

    def object(self) -> dict[str, Any]:
        """Best designs, front, number of designs, amplifier and networks."""
        optimum, screened, need = self.optimum, self.optimum.screening, self.electric.amplifier
        return {
            "rig": self._space.rig.title,
            "friction_model": self._space.rig.friction_model.name,
            "minimise": optimum.minimise,
            **si({"friction_ratio": optimum.problem.friction_ratio}),
            "designs": [_design_object(point) for point in optimum.designs],
            "front": [_design_object(point) for point in optimum.front],
            "screened": int(screened.frequency.size),
            "feasible": int(screened.feasible.sum()),
            "amplifier": si(asdict(need)),
            "networks": [_network_object(matched) for matched in self.electric.networks],
            "refused": screened.refused,
        }

    def caveats(self) -> Sequence[str]:
        """Values at the end of their range, heat beyond the amplifier's power, and a preload that is not given."""
        best, caveats = self.optimum.best, []
        values = {"frequency": best.frequency, **best.candidate.entries}
        for name, (low, high) in self._space.bounds.items():
            for end, side in ((low, "lowest"), (high, "highest")):
                if abs(log(values[name] / end)) < _AT_END:
                    caveats.append(f"{name} lies at the {side} value allowed: a better design may lie beyond")
        if best.objective("heat") > best.objective("power"):
            caveats.append(
                "more heat stays in the actuator than D 1.9 counts as the amplifier's power: near a resonance the"
                " motion takes real power, which that formula leaves out"
            )
        if best.evaluation.utilisation["tension"][0] == 0:
            caveats.append("no preload is given, so that tension in the stack is not judged: give bolt and preload")
        return caveats

    def assumptions(self) -> Mapping[str, str]:
        """Quality factor and loss tangent of the ceramics, and the assumptions of the rig file."""
        assumed = {}
        if any(point.candidate.actuator != OWN_ACTUATOR for point in self.optimum.designs):
            factor = self._space.mechanical_quality_factor
            assumed["quality factor"] = f"{factor:g} for the catalogue's ceramics; no sheet has it"
        loss = self.optimum.problem.limits.loss_tangent
        return assumed | {"loss tangent": f"{loss:g} for the ceramic, in its heat"} | dict(self._space.rig.assumptions)

    def figures(self) -> Mapping[str, Drawing]:
        """Objective over frequency, front, limits used, and power factor."""
        optimum, name = self.optimum, self._name
        drawings = {
            f"{name}-frequency": Drawing(
                chart=lambda: figures.frequency_chart(optimum),
                caption=f"Least {optimum.minimise} for the target at each frequency, over all structures of the"
                " screening; markers are the refined designs.",
            )
        }
        if optimum.front:
            drawings[f"{name}-front"] = Drawing(
                chart=lambda: figures.front_chart(optimum),
                caption=f"Pareto front of {optimum.minimise} and {optimum.second_objective} within the limits.",
            )
        if _tightest(optimum.best) != _NO_LIMIT:
            drawings[f"{name}-limits"] = Drawing(
                chart=lambda: figures.limits_chart(optimum.best),
                caption="Fraction of each limit, set or of the actuator, that the best design uses.",
            )
        drawings[f"{name}-power-factor"] = Drawing(
            chart=lambda: figures.power_factor_chart(optimum, self.electric),
            caption="Power factor at the amplifier about the drive's frequency (vertical line).",
        )
        return drawings

    def files(self) -> "Mapping[str, str | xr.Dataset]":
        """All designs as netCDF, and the best as a rig file."""
        content = self.rig.content()
        file = self.rig.file
        is_unchanged = file is not None and read_rig(file).content() == content
        source = input_text(file) if file is not None and is_unchanged else tomli_w.dumps(content)
        return {
            f"{self._name}.nc": designs_dataset(self.optimum),
            f"{self._name}.toml": design_text(source, content, self.optimum.problem, self.optimum.best),
        }

    def page(self) -> Page:
        """Page `optimise.html`."""
        optimum, rig = self.optimum, self._space.rig
        counts, total = design_counts(optimum), optimum.screening.frequency.size
        refused = [("not used", reason) for reason in optimum.screening.refused.values()]
        return Page(
            name="optimise",
            title=f"Least {optimum.minimise} for a friction ratio of {optimum.problem.friction_ratio:.3g}: {rig.title}",
            settings=rig_settings(rig),
            facts=[*self._facts(), *refused],
            tables=[self._table(), count_table("Screened designs by status", "designs", counts, total=total)],
        )

    @property
    def _space(self) -> Any:
        """Design space of the problem."""
        return self.optimum.problem.space

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig.name}-optimum"

    def _facts(self) -> list[tuple[str, str]]:
        """Target, best design, tightest limit, amplifier and networks."""
        optimum, best, need = self.optimum, self.optimum.best, self.electric.amplifier
        ratio, screened = optimum.problem.friction_ratio, optimum.screening
        coefficient = ratio * self._space.rig.friction_coefficient
        amplitude = float(best.evaluation.quantities["vibration_amplitude"][0])
        units = {name: "kg" if name.endswith("mass") else quantity(name).unit for name in best.candidate.entries}
        facts = {
            "target friction": f"coefficient {coefficient:.3g}, ratio {ratio:.3g}"
            f"{_tolerance_text(optimum.problem.tolerance)}",
            "actuator": self._actuator_title(best),
            "drive": f"{format_si(best.voltage_peak_to_peak, 'V', digits=4)} peak to peak,"
            f" {format_si(best.frequency, 'Hz', digits=5)}, {best.candidate.waveform}",
            **{
                name.replace("_", " "): format_si(value, units[name], digits=4)
                for name, value in best.candidate.entries.items()
            },
            "amplitude": format_si(amplitude, "m"),
            "power of amplifier": f"{format_si(best.objective('power'), 'W')} (D 1.9)",
            "heat in actuator": format_si(best.objective("heat"), "W"),
            "tightest limit": _tightest(best),
            "amplifier": f"{format_si(need.voltage_maximum, 'V')}, {format_si(need.peak_current, 'A')} peak,"
            f" {format_si(need.apparent_power, 'W').replace('W', 'VA')}, {need.slew_rate * 1e-6:.3g} V/us,"
            f" power factor {need.power_factor:.3g}",
            **{matched.name: _network_text(matched) for matched in self.electric.networks},
            "designs": f"{int(screened.feasible.sum())} of {screened.frequency.size} within all limits",
        }
        return list(facts.items())

    def _table(self) -> PageTable:
        """Designs of the front, or the best of each actuator and waveform, the best first."""
        points = self.optimum.front or self.optimum.designs
        entries = list(points[0].candidate.entries)
        heads = ["actuator", "waveform", "f [kHz]", "U_pp [V]", *[f"{name} [SI]" for name in entries]]
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
        heads += ["power [W]", "heat [W]", "tightest limit"]
        return PageTable(title="Designs, the best first", heads=tuple(heads), rows=rows)

    def _actuator_title(self, point: DesignPoint) -> str:
        """Title of the actuator of a design."""
        name = point.candidate.actuator
        return "the rig's own" if name == OWN_ACTUATOR else str(self._space.catalogue[name].title)


def _tightest(point: DesignPoint) -> str:
    """Limit of which a design uses most, with the fraction."""
    used = {name: float(values[0]) for name, values in point.evaluation.utilisation.items() if name in LIMITS}
    name = max(used, key=lambda each: used[each])
    return f"{LIMITS[name]}, {100 * used[name]:.3g} %" if used[name] > 0 else _NO_LIMIT


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
    """Design for JSON: candidate, drive, quantities and fractions of the limits."""
    numbers = point.evaluation.quantities
    return {
        "actuator": point.candidate.actuator,
        "waveform": point.candidate.waveform,
        **si({"frequency": point.frequency, "voltage_peak_to_peak": point.voltage_peak_to_peak}),
        **si(dict(point.candidate.entries)),
        **si({name: float(numbers[name][0]) for name in _DESIGN_QUANTITIES if name in numbers}),
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
