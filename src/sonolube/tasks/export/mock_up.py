"""Task `export fmu`: plant and friction controller of a rig as units of the Functional Mock-up Interface (FMI)."""

import re
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated, Any, Literal, Unpack

import numpy as np

from sonolube.design import control as loops
from sonolube.design.fmu.mock_up_unit import MockUpUnit, c_compiler, controller_unit, plant_unit
from sonolube.design.fmu.plant import PinHeat, PlantTables, plant_ranges
from sonolube.design.fmu.tabulation import plant_tables
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import many_points
from sonolube.report.results.record_object import amplitude_rows, operating_point, picked
from sonolube.rig import AMPLITUDE, Rig, commanded_quantity, operating_caveats, thermal_solid
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.tasks.answer import Answer, Block, Rows, answer, si
from sonolube.tasks.design.control import ClosedLoop, Coupling, Delay, Quality, Rate, resonance_without_structure
from sonolube.tasks.own_tables import Values, ends_by_key, refuse_replaced
from sonolube.tasks.parameters import Disc, KeyValues, Number, Parameter, Pin, Quantity, RigFile, WatchedRig, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.text.units import format_si

_OVER = KeyValues(
    "A range of an input: drive.voltage_peak_to_peak (vibration.vibration_amplitude of a rig without a voltage),"
    " drive.frequency, contact.normal_load or sliding.sliding_speed. May come again; the rig's own voltage, 0.5 % of"
    " the frequency and a factor of 1.25 of the load and 2 of the speed either way by default.",
    "KEY=FIRST:LAST",
)
_CAPACITY = Quantity("Heat capacity of the pin.", "J/K", kind="CAPACITY")
_CONDUCTANCE = Quantity("Thermal conductance from the pin to its surroundings.", "W/K", kind="CONDUCTANCE")
_ENVELOPE = (
    "a slow model of the envelope, not of every cycle: the vibration follows the drive as one resonance with the"
    " contact linearised, and friction follows the vibration at once"
)
_UNTRIED = "the units were validated and run with FMPy; neither Modelica nor Simulink has been tried"


@answer
class UnitsAnswer(Answer):
    """Plant and controller of a rig as units, with the ranges of their inputs and the error of the plant's tables."""

    rig: Rig
    tables: PlantTables
    study: loops.ControlDesign
    plant: MockUpUnit
    controller: MockUpUnit
    assumed: Mapping[str, str]

    def blocks(self) -> Sequence[Block]:
        """Operating point, ranges, error and controller."""
        tables, process, gains = self.tables, self.study.controller.process, self.study.controller.gains
        size = tables.slow_ratio.coefficients.size
        names = [[each.name for each in unit.description.variables] for unit in (self.plant, self.controller)]
        ranges = [
            (
                f"{each.name} from",
                f"{format_si(each.lowest, each.unit, digits=4)} to {format_si(each.highest, each.unit, digits=4)}",
            )
            for each in self.plant.description.variables
            if each.is_input
        ]
        rows = [
            (
                "interface",
                f"FMI {self.plant.version}.0, co-simulation, binary for {self.plant.platform or 'no platform'}",
            ),
            ("plant", ", ".join(names[0])),
            *ranges,
            (
                "error",
                f"{tables.relative_error:.1e} at points that the tables, {size} coefficients, were not made from",
            ),
            ("follows", f"the drive with a time constant of {format_si(self.study.mode.time_constant, 's')}"),
            ("controller", ", ".join(names[1])),
            (
                "tuning",
                f"K_c {gains.proportional_gain:.3g}, tau_I {format_si(gains.integral_time, 's')}, a sample every"
                f" {format_si(process.sample_interval, 's')}",
            ),
        ]
        return [operating_point(self.rig), Rows([*amplitude_rows(self.rig), *rows])]

    def object(self) -> dict[str, Any]:
        """Interface, variables, error, time constant and tuning."""
        return {
            "rig": self.rig.title,
            "interface": f"FMI {self.plant.version}.0",
            "platform": self.plant.platform or None,
            "model": "slow envelope",
            "plant": _variables(self.plant),
            "controller": _variables(self.controller),
            **si(
                {
                    "relative_error": self.tables.relative_error,
                    "time_constant": self.study.mode.time_constant,
                    "sample_interval": self.study.controller.process.sample_interval,
                    **picked(self.study.controller.gains, "proportional_gain", "integral_time"),
                    **_heat_values(self.tables),
                }
            ),
        }

    def caveats(self) -> Sequence[str]:
        """Those of the rig, the kind of model, outputs that are missing, a missing binary, and importers not tried."""
        missing = []
        if not self.tables.has_current:
            missing.append("the plant has no current: the rig has no voltage, or its resonance no capacitance")
        low, high = self.tables.ranges.frequency
        if low == high:
            source, at = resolved_rig(self.rig).vibration.source, format_si(low, "Hz", digits=4)
            missing.append(
                f"the amplitude {source} holds at {at} only: the plant takes no other frequency, and the controller"
                " tracks no resonance"
            )
        if self.tables.heat is None:
            missing.append("the plant has no temperature, which needs the materials of pin and disc")
        if self.plant.missing:
            missing.append(self.plant.missing)
        return (*operating_caveats(self.rig), _ENVELOPE, *missing, _UNTRIED)

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file, of the resonance and of the pin's bulk."""
        found = {**self.rig.assumptions, **self.assumed}
        heat = self.tables.heat
        if heat is not None:
            found["temperature"] = (
                f"bulk of a pin of {heat.heat_capacity:g} J/K that loses {heat.thermal_conductance:g} W/K, heat over"
                " the nominal area, none of the vibration"
            )
        return found

    def files(self) -> Mapping[str, bytes]:
        """Both units."""
        return {
            f"{self.rig.name}-plant.fmu": self.plant.content,
            f"{self.rig.name}-controller.fmu": self.controller.content,
        }


@task
def fmu(
    rig: RigFile,
    *,
    fmi: Annotated[Literal["2", "3"], Parameter("Version of the Functional Mock-up Interface, 2.0 or 3.0.")] = "3",
    over: Annotated[Values | None, _OVER] = None,
    delay: Delay = "1ms",
    rate: Rate = "5kHz",
    closed_loop: ClosedLoop = None,
    track: Annotated[bool, Parameter("Follow the resonance by the phase of the impedance.")] = True,
    quality: Quality = 50.0,
    coupling: Coupling = 0.2,
    pin: Pin = None,
    disc: Disc = None,
    heat_capacity: Annotated[Number, _CAPACITY] = "1.5J/K",
    conductance: Annotated[Number, _CONDUCTANCE] = "0.05W/K",
    **watch: Unpack[WatchedRig],
) -> UnitsAnswer:
    """Plant and friction controller as units of the Functional Mock-up Interface (FMI), for Modelica and Simulink.

    Example: sonolube export fmu examples/rigs/collar.toml --fmi 2
    """
    known = rig_of(rig)
    refuse_replaced(known, over or {})
    if known.structure is not None:
        refuse_unused("quality", "coupling", because="for a rig whose file has the table structure")
    if commanded_quantity(known) is AMPLITUDE:
        refuse_unused("coupling", "track", because="for an amplitude that is commanded")
    heat = _heat(known, pin, disc, heat_capacity, conductance)
    sampling, dead_time = in_si("rate", rate), in_si("delay", delay)
    if not sampling > 0:
        raise InvalidInput(f"{shown('rate')} {rate} must be positive")
    interval = 1 / sampling
    mode, assumed = resonance_without_structure(known, quality, coupling)
    resolved = resolved_rig(known)
    ranges = plant_ranges(resolved, over=ends_by_key(over or {}))
    is_fixed = ranges.frequency[0] == ranges.frequency[1]
    if is_fixed:
        refuse_unused("track", because="for an amplitude that holds at one frequency")
    with stage("tabulating") as advance, many_points():
        tables = plant_tables(resolved, ranges, mode=mode, heat=heat, advance=partial(advance, "vibrations"))
    highest = ranges.level[1]
    limits: dict[str, Any] = (
        {"amplitude_maximum": highest}
        if tables.quantity is AMPLITUDE
        else {"amplifier": loops.Amplifier(voltage_maximum=highest)}
    )
    settings = loops.ControlSettings(
        **limits,
        dead_time=dead_time,
        sample_interval=interval,
        closed_loop_time=in_si("closed_loop", closed_loop),
        tracking=track and not is_fixed,
        duration=_SAMPLES * interval,
    )
    with stage("controlling"), many_points():
        study = loops.design_control(known, settings, mode=mode)
    with stage("compiling"):
        shared: dict[str, Any] = {"version": fmi, "tool": _tool(), "compiler": c_compiler()}
        word = _word(known.name)
        plant = plant_unit(tables, identifier=f"{word}_plant", **shared)
        controller = controller_unit(
            study.controller, study.tracker, rig=known, identifier=f"{word}_controller", **shared
        )
    return UnitsAnswer(rig=known, tables=tables, study=study, plant=plant, controller=controller, assumed=assumed)


_SAMPLES = 1000  # of the run in closed loop, whose tuning is exported


def _heat(rig: Rig, pin: str | None, disc: str | None, capacity: Number, conductance: Number) -> PinHeat | None:
    """Bodies of the contact, where both materials are given or the rig's."""
    names = pin or rig.pin_material, disc or rig.disc_material
    if None in names:
        refuse_unused("pin", "disc", because="alone; the temperature needs both materials")
        refuse_unused("heat_capacity", "conductance", because="without the materials of pin and disc")
        return None
    values = {"heat_capacity": in_si("heat_capacity", capacity), "conductance": in_si("conductance", conductance)}
    for name, value in values.items():
        if not value > 0:
            raise InvalidInput(f"{shown(name)} must be positive")
    return PinHeat(
        pin=thermal_solid(str(names[0])),
        disc=thermal_solid(str(names[1])),
        heat_capacity=values["heat_capacity"],
        thermal_conductance=values["conductance"],
    )


def _heat_values(tables: PlantTables) -> dict[str, float]:
    """Heat partition at the rig's own speed, and the bulk of the pin, where the plant has a temperature."""
    if tables.heat is None or tables.heat_partition is None:
        return {}
    own = np.clip(tables.rig.sliding_speed, *tables.ranges.sliding_speed)
    return {
        "heat_partition": float(tables.heat_partition(own)),
        "heat_capacity": tables.heat.heat_capacity,
        "thermal_conductance": tables.heat.thermal_conductance,
    }


def _variables(unit: MockUpUnit) -> dict[str, Any]:
    """Variables of a unit by name: causality, unit and range."""
    return {
        each.name: {
            "causality": "input" if each.is_input else "output",
            "unit": each.unit,
            "lowest": each.lowest if each.is_input and abs(each.lowest) < float("inf") else None,
            "highest": each.highest if each.is_input and abs(each.highest) < float("inf") else None,
        }
        for each in unit.description.variables
    }


def _word(name: str) -> str:
    """Name of a rig as a word of C."""
    word = re.sub(r"\W", "_", name, flags=re.ASCII)
    return word if word[:1].isalpha() else f"rig_{word}"


def _tool() -> str:
    from sonolube import __version__

    return f"sonolube {__version__}"
