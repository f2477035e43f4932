"""Task `plan`: the next tests of a rig, replicates and order, protocols, a table to fill and a sheet to print."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Unpack

import numpy as np

from sonolube.checks import Floats
from sonolube.design.test_plan.candidates import Factors, RigLimits, factor_values
from sonolube.design.test_plan.comparison import BLOCKINGS, COMPARISONS
from sonolube.design.test_plan.plan import Procedure, Question, TestPlan, plan_tests, published_distances
from sonolube.design.test_plan.run_protocols import has_results, plan_chart, run_protocols, run_table
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import protocol_text
from sonolube.prediction.inputs import RigInputs, rig_inputs
from sonolube.report import Drawing, Page, PageTable
from sonolube.report.measurement import pin_on_disc_checklist
from sonolube.report.results.design import plan_of_tests as results
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Rows, Table, answer
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.own_tables import MappedRuns, runs_of
from sonolube.tasks.parameters import (
    Disc,
    DrivenRigEntries,
    File,
    Number,
    Parameter,
    Pin,
    Quantity,
    RigFile,
    RunsSource,
    rig_of,
)
from sonolube.tasks.task import in_si, shown, task

_CAPTION = (
    "Left: candidates over speed and amplitude, coloured by the information that the replicates at one of them are"
    " expected to give about which friction model holds; the points of the plan are numbered, the rig's own first, the"
    " others in the order of their gain."
    " Right: predicted friction ratio at these points with its interval of 80 %, and the median of each model."
)


@answer
class PlanAnswer(Answer):
    """Plan of tests in words, a table of its runs, their protocols, a figure and a sheet to print."""

    rig: Rig
    plan: TestPlan

    def blocks(self) -> Sequence[Block]:
        """Difference to be shown, its power, and the points of the plan."""
        return [
            f"{self.rig.title}: {results.size_text(self.plan)}",
            Rows(results.facts(self.plan)),
            Table(results.POINT_HEADS, results.point_rows(self.plan)),
        ]

    def object(self) -> dict[str, Any]:
        """Question, scatter, replicates, points and runs."""
        return results.plan_object(self.rig, self.plan)

    def caveats(self) -> Sequence[str]:
        """Caveats of the plan."""
        return self.plan.caveats

    def figures(self) -> Mapping[str, Drawing]:
        """Candidates with their information, and the prediction at the points."""
        return {self._name: Drawing(chart=lambda: plan_chart(self.plan), caption=_CAPTION)}

    def files(self) -> Mapping[str, str]:
        """Table of the runs to be filled, and the protocol of each."""
        return {
            f"{self._name}-runs.csv": run_table(self.plan),
            **{f"{self._name}/{name}.toml": protocol_text(each) for name, each in run_protocols(self.plan).items()},
        }

    def page(self) -> Page:
        """Sheet to print: points, runs with empty cells, what to report, limits."""
        plan, limits = self.plan, next(iter(run_protocols(self.plan).values())).limits
        known = results.known_items(self.rig, plan)
        heads = tuple(map(str.capitalize, results.POINT_HEADS))
        facts = [(name.capitalize(), text) for name, text in results.facts(self.plan)]
        return Page(
            name=self._name,
            title=f"Test plan: {self.rig.title}",
            settings=(("Rig", self.rig.title), ("Source", self.rig.source)),
            facts=[("Plan", results.size_text(self.plan)), *facts],
            tables=(
                PageTable(title="Points", heads=heads, rows=tuple(map(tuple, results.point_rows(plan)))),
                PageTable(title="Runs in their order", heads=results.RUN_HEADS, rows=tuple(results.run_rows(plan))),
                PageTable(title="Limits", heads=("Limit", "Value"), rows=tuple(results.limit_rows(plan, limits))),
                PageTable(
                    title="To be reported, in the order of ASTM G99",
                    heads=("Part", "Item", "Value"),
                    rows=tuple(pin_on_disc_checklist(known)),
                ),
            ),
        )

    def keeps(self, name: str, present: str) -> bool:
        """Whether a table of runs holds results, which a new plan would lose."""
        return name.endswith("-runs.csv") and has_results(present)

    @property
    def _name(self) -> str:
        return f"{self.rig.name}-plan"


_SPEEDS, _AMPLITUDES = 7, 5  # values of a range without a count
_SPEED_RANGE = 3.0  # times the rig's speed, and its part
_MIN_AMPLITUDE = 0.2  # of the rig's


@task
def plan(
    rig: RigFile,
    *,
    runs: Annotated[
        RunsSource, File("Own earlier runs: they give the scatter and update the prediction.", "RUNS.csv")
    ] = None,
    mapping: MappedRuns = None,
    evidence: Evidence = None,
    speed: Annotated[
        str | None,
        Parameter("Sliding speeds, such as 20:200mm/s or 20,40,87mm/s; by default 1/3 to 3 times the rig's.", "VALUES"),
    ] = None,
    load: Annotated[str | None, Parameter("Normal loads, such as 3,5,7N; the rig's by default.", "VALUES")] = None,
    vibration: Annotated[
        str | None,
        Parameter("Vibration amplitudes, such as 0.5:2.3um; by default 1/5 of the rig's up to it.", "VALUES"),
    ] = None,
    voltage: Annotated[str | None, Parameter("Drive voltages, peak to peak, instead of amplitudes.", "VALUES")] = None,
    points: Annotated[int, Parameter("Number of conditions to test.", lowest=1)] = 4,
    difference: Annotated[Number, Quantity("Friction reduction to be shown.", "", kind="SHARE")] = "10%",
    power: Annotated[float, Parameter("Probability to show it where it is there.")] = 0.9,
    significance: Annotated[float, Parameter("Probability to show it where it is not.")] = 0.05,
    comparison: Annotated[
        Literal["paired", "separate"],
        Parameter("Each run without, with and again without vibration, or states on specimens of their own."),
    ] = "paired",
    scatter: Annotated[
        Number | None,
        Quantity("Standard deviation of friction between runs; by the runs, or D Table 2.3.", "", kind="SHARE"),
    ] = None,
    block: Annotated[
        Literal["day", "pair"], Parameter("What the runs of a block share: a day, or one pair of pin and disc.")
    ] = "day",
    running_in: Annotated[
        Number | None,
        Quantity("Sliding until friction is steady; the longest of the dissertation's Table 2.3 by default.", "m"),
    ] = None,
    measuring_time: Annotated[Number, Quantity("In steady friction, in each state.", "s")] = "12s",
    amplifier_voltage: Annotated[
        Number | None, Quantity("Greatest voltage of the amplifier, offset included.", "V")
    ] = None,
    amplifier_power: Annotated[Number | None, Quantity("Greatest power of the amplifier.", "W")] = None,
    temperature_rise: Annotated[
        Number, Quantity("Greatest rise of the contact by friction; needs both materials.", "K")
    ] = "50K",
    pin: Pin = None,
    disc: Disc = None,
    seed: Annotated[int, Parameter("Of the order of the runs.", lowest=0)] = 0,
    **entries: Unpack[DrivenRigEntries],
) -> PlanAnswer:
    """Plan the next tests of a rig: points that tell models apart, replicates, order, protocols, and a sheet to print.

    Example: sonolube plan examples/rigs/power_map.toml --speed 20:200mm/s --points 3
    """
    known = rig_of(rig)
    inputs = rig_inputs(known)
    result = plan_tests(
        known,
        _factors(known, inputs, speed=speed, load=load, vibration=vibration, voltage=voltage),
        question=Question(
            difference=in_si("difference", difference),
            power=power,
            significance=significance,
            comparison=COMPARISONS[comparison],
            scatter=in_si("scatter", scatter),
        ),
        procedure=_procedure(in_si("running_in", running_in), in_si("measuring_time", measuring_time), block),
        points=points,
        limits=RigLimits(
            voltage_maximum=in_si("amplifier_voltage", amplifier_voltage),
            power_to_supply=in_si("amplifier_power", amplifier_power),
            mean_temperature_rise=in_si("temperature_rise", temperature_rise),
        ),
        runs=runs_of(runs, mapping, known),
        evidence=evidence_of(evidence, known),
        pin=pin,
        disc=disc,
        seed=seed,
    )
    return PlanAnswer(rig=known, plan=result)


def _factors(
    rig: Rig, inputs: RigInputs, *, speed: str | None, load: str | None, vibration: str | None, voltage: str | None
) -> Factors:
    """Values of loads, speeds and amplitudes: as given, else about those of the rig."""
    about = inputs.sliding_speed
    speeds = f"{about / _SPEED_RANGE:.6g}:{about * _SPEED_RANGE:.6g} m/s" if speed is None else speed
    return Factors(
        normal_load=np.array([rig.normal_load])
        if load is None
        else factor_values(load, unit="N", option=shown("load"), count=3),
        sliding_speed=factor_values(speeds, unit="m/s", option=shown("speed"), count=_SPEEDS),
        vibration_amplitude=_amplitudes(inputs, vibration, voltage),
    )


def _amplitudes(inputs: RigInputs, vibration: str | None, voltage: str | None) -> Floats:
    """Amplitudes as given, by voltages, or up to the rig's."""
    if vibration is not None and voltage is not None:
        raise InvalidInput(f"{shown('vibration')} and {shown('voltage')} both set the amplitude; give one")
    if voltage is not None:
        if inputs.amplitude_per_volt is None:
            raise InvalidInput(
                f"{shown('voltage')} needs the rig's drive.voltage_peak_to_peak or vibration.calibration to scale by;"
                f" give {shown('vibration')}"
            )
        volts = factor_values(voltage, unit="V", option=shown("voltage"), count=_AMPLITUDES)
        return np.asarray(inputs.amplitude_per_volt * volts)
    if vibration is not None:
        return factor_values(vibration, unit="m", option=shown("vibration"), count=_AMPLITUDES)
    return inputs.amplitude.value * np.linspace(_MIN_AMPLITUDE, 1.0, _AMPLITUDES)


def _procedure(running_in: float | None, measuring_time: float, block: str) -> Procedure:
    """Form of each run."""
    without, vibrated = published_distances() if running_in is None else (running_in, running_in)
    return Procedure(
        intrinsic_distance=without, vibrated_distance=vibrated, measuring_time=measuring_time, blocking=BLOCKINGS[block]
    )
