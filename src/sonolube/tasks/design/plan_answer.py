"""Answer of `plan`: points and replicates as text, table and protocols as files, a sheet to print as the page."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sonolube.design.test_plan.figure import plan_chart
from sonolube.design.test_plan.plan import TestPlan
from sonolube.design.test_plan.run_order import RunState
from sonolube.design.test_plan.run_protocols import run_protocols
from sonolube.design.test_plan.run_table import has_results, run_table
from sonolube.facts.protocol import Protocol, protocol_text
from sonolube.report import Drawing, Page, PageTable
from sonolube.report.pin_on_disc_sheet import pin_on_disc_checklist
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block, Rows, Table
from sonolube.units import format_like, format_si

_HEADS = (
    "point",
    "load",
    "speed",
    "voltage",
    "amplitude",
    "friction ratio, 80 %",
    "chance of the difference",
    "amplifier",
    "contact hotter by",
    "information",
)
_TO_FILL = ("Friction without (N)", "Friction with (N)", "Measured amplitude", "Remarks")
_RUN_HEADS = ("Load (N)", "Speed (mm/s)", "Voltage (V)", "Amplitude (um)", "Vibration (s)")
_ORDERS = {
    1: "off, on, off in each run, the middle measured twice as long: a linear drift, such as running-in, leaves the"
    " difference of the means as it is",
    2: "the pair without vibration first in odd blocks, the one with vibration in even ones",
}
"""Order of the states, by the pairs of specimens of a run."""

_CAPTION = (
    "Left: candidates over speed and amplitude, coloured by the information that the replicates at one of them are"
    " expected to give about which closure holds; the points of the plan are numbered, the rig's own first, the"
    " others in the order of their gain."
    " Right: predicted friction ratio at these points with its interval of 80 %, and the median of each closure."
)


@answer
class PlanAnswer(Answer):
    """Plan of tests in words, a table of its runs, their protocols, a figure and a sheet to print."""

    rig: Rig
    plan: TestPlan

    def blocks(self) -> Sequence[Block]:
        """What is shown how surely, and the points of the plan."""
        return [f"{self.rig.title}: {self._size()}", Rows(self._facts()), Table(_HEADS, self._point_rows())]

    def object(self) -> dict[str, Any]:
        """Question, scatter, replicates, points and runs."""
        plan, at = self.plan, self.plan.candidates
        return {
            "rig": self.rig.title,
            "comparison": plan.question.comparison.name,
            "difference": plan.question.difference,
            "significance": plan.question.significance,
            "power": plan.power,
            "scatter": {"value": plan.question.comparison.deviation(plan.scatter), "source": plan.scatter.source},
            "replicates": plan.replicates,
            "duration": si({"duration": plan.duration})["duration"],
            "closures": plan.weights,
            "information": {"value": plan.batch.information[-1], "of": self._entropy(), "unit": "bit"},
            "points": [
                si(
                    {
                        name: _finite(getattr(at, name)[point])
                        for name in (
                            *("normal_load", "sliding_speed", "voltage_peak_to_peak", "vibration_amplitude"),
                            *("actuator_power", "mean_temperature_rise"),
                        )
                    }
                )
                | {
                    "friction_ratio": {
                        "median": float(plan.median[point]),
                        "interval_80": [float(each) for each in plan.interval[:, point]],
                    },
                    "information": float(plan.information[point]),
                }
                for point in plan.batch.points
            ],
            "left_out": [
                si({name: float(getattr(at, name)[index]) for name in ("sliding_speed", "vibration_amplitude")})
                | {"reason": reason}
                for index, reason in enumerate(at.refused)
                if reason
            ],
            "runs": [
                {
                    "run": run.run,
                    "block": run.block,
                    "point": run.point + 1,
                    "specimens": list(run.specimens),
                    "vibrated": [list(part.vibrated) for part in run.parts],
                }
                for run in plan.runs
            ],
        }

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
            **{f"{self._name}/{name}.toml": protocol_text(each) for name, each in self._protocols().items()},
        }

    def page(self) -> Page:
        """Sheet to print: points, runs with empty cells, what to report, limits."""
        return Page(
            name=self._name,
            title=f"Test plan: {self.rig.title}",
            settings=(("Rig", self.rig.title), ("Source", self.rig.source)),
            facts=[("Plan", self._size()), *((name.capitalize(), text) for name, text in self._facts())],
            tables=(
                PageTable(
                    title="Points", heads=tuple(map(str.capitalize, _HEADS)), rows=tuple(map(tuple, self._point_rows()))
                ),
                PageTable(title="Runs in their order", heads=self._run_heads(), rows=tuple(self._run_rows())),
                PageTable(title="Limits", heads=("Limit", "Value"), rows=tuple(self._limit_rows())),
                PageTable(
                    title="To be reported, in the order of ASTM G99",
                    heads=("Part", "Item", "Value"),
                    rows=tuple(pin_on_disc_checklist(self._known())),
                ),
            ),
        )

    def keeps(self, name: str, present: str) -> bool:
        """Whether a table of runs holds results, which a new plan would lose."""
        return name.endswith("-runs.csv") and has_results(present)

    @property
    def _name(self) -> str:
        return f"{self.rig.name}-plan"

    def _protocols(self) -> dict[str, Protocol]:
        """Protocol of each run by its name."""
        return run_protocols(self.plan)

    def _size(self) -> str:
        """Number of points, replicates and runs, and the time they take."""
        plan = self.plan
        points, runs, specimens = len(plan.batch.points), len(plan.runs), plan.question.comparison.specimens
        pairs = len({name for run in plan.runs for name in run.specimens})
        tests = f"{runs * specimens} tests" if specimens > 1 else f"{runs} runs"
        bodies = f"{pairs} pairs of specimens"
        return f"{points} points, {plan.replicates} times each: {tests} on {bodies}, {_hours(plan.duration)}"

    def _facts(self) -> list[tuple[str, str]]:
        """Comparison, scatter, information and order."""
        plan, question = self.plan, self.plan.question
        deviation = question.comparison.deviation(plan.scatter)
        weights = ", ".join(f"{name} {100 * weight:.0f} %" for name, weight in plan.weights.items())
        return [
            (
                "comparison",
                f"{question.comparison.title}: a reduction of {100 * question.difference:.3g} % is shown at each point"
                f" with power {plan.power:.2f} at significance {question.significance:g}",
            ),
            ("scatter", f"{100 * deviation:.2g} % of friction for one difference ({plan.scatter.source})"),
            (
                "closures",
                f"{weights}; the plan is expected to give {plan.batch.information[-1]:.2f} of {self._entropy():.2f} bit"
                " about which holds",
            ),
            (
                "blocks",
                f"{plan.replicates}, each of every point once in random order, the first point first; each is"
                f" {plan.procedure.blocking.title}",
            ),
            ("order", _ORDERS[question.comparison.specimens]),
        ]

    def _entropy(self) -> float:
        """Entropy of the weights of the closures, in bits: what there is to be learned."""
        weights = np.array(list(self.plan.weights.values()))
        weights = weights[weights > 0]
        return float(-np.sum(weights * np.log2(weights)))

    def _point_rows(self) -> list[list[str]]:
        """Points of the plan with their prediction."""
        return [[f"{number}", *self._point(point)] for number, point in enumerate(self.plan.batch.points, 1)]

    def _point(self, point: int) -> list[str]:
        """Conditions, prediction and demands of a point."""
        plan = self.plan
        low, high = plan.interval[:, point]
        return [
            *self._conditions(point),
            f"{plan.median[point]:.2f} ({low:.2f} to {high:.2f})",
            f"{100 * plan.chance[point]:.0f} %",
            _text(plan.candidates.actuator_power[point], "W"),
            _text(plan.candidates.mean_temperature_rise[point], "K"),
            f"{plan.information[point]:.3f} bit",
        ]

    def _conditions(self, point: int) -> list[str]:
        """Load, speed, voltage and amplitude of a candidate."""
        at, points = self.plan.candidates, list(self.plan.batch.points)
        columns = ((at.normal_load, "N"), (at.sliding_speed, "m/s"), (at.voltage_peak_to_peak, "V"))
        place = points.index(point)
        return [
            format_like([float(values[each]) for each in points], unit)[place].replace("nan V", "-")
            for values, unit in (*columns, (at.vibration_amplitude, "m"))
        ]

    def _run_heads(self) -> tuple[str, ...]:
        """Heads of the table of runs on the sheet."""
        return ("Run", "Block", "Pair", *_RUN_HEADS, *_TO_FILL)

    def _run_rows(self) -> list[tuple[str, ...]]:
        """Runs in their order with empty cells."""
        plan = self.plan
        rows = []
        for run in plan.runs:
            point = plan.candidate(run)
            at = plan.candidates
            voltage = at.voltage_peak_to_peak[point]
            settings = (
                f"{at.normal_load[point]:.3g}",
                f"{1e3 * at.sliding_speed[point]:.3g}",
                f"{voltage:.3g}" if np.isfinite(voltage) else "-",
                f"{1e6 * at.vibration_amplitude[point]:.3g}",
                "; ".join(_states_text(plan.states(run, part)) for part in run.parts),
            )
            rows.append((f"{run.run}", f"{run.block}", ", ".join(run.specimens), *settings, *("" for _ in _TO_FILL)))
        return rows

    def _limit_rows(self) -> list[tuple[str, str]]:
        """Limits of the protocols, and of the rig."""
        limits = next(iter(self._protocols().values())).limits
        plan = self.plan.limits
        rows = [
            ("Voltage, its offset included", self._voltage_limit(limits.voltage_maximum)),
            ("Friction force", format_si(limits.friction_force_maximum or np.nan, "N")),
            ("Temperature of the actuator", ""),
        ]
        if plan.actuator_power is not None:
            rows.append(("Power of the amplifier", format_si(plan.actuator_power, "W")))
        if self.plan.materials is not None and plan.mean_temperature_rise is not None:
            rows.append(("Rise of the contact by friction", format_si(plan.mean_temperature_rise, "K")))
        return rows

    def _voltage_limit(self, volts: float) -> str:
        """Limit of the voltage, where the plan sets a voltage."""
        return format_si(volts, "V") if volts > 0 else "not planned: the vibration is switched by hand"

    def _known(self) -> dict[str, dict[str, str]]:
        """Items of the report that the plan settles."""
        plan, points = self.plan, list(self.plan.batch.points)
        at, drive = plan.candidates, self.rig.drive
        distances = plan.procedure.intrinsic_distance, plan.procedure.vibrated_distance
        frequency = "" if drive is None else f"{format_si(drive.frequency, 'Hz')}, "
        amplitudes = _range(at.vibration_amplitude[points], "m")
        pin, disc = plan.materials or ("", "")
        return {
            "parameters": {
                "normal_load": _range(at.normal_load[points], "N"),
                "sliding_speed": _range(at.sliding_speed[points], "m/s"),
                "sliding_distance": " and ".join(format_si(each, "m") for each in distances)
                + f" running-in without and with vibration, then {plan.procedure.measuring_time:g} s each",
                "vibration": f"{frequency}{amplitudes} zero to peak, normal to the disc",
            },
            "pin": {"material": pin},
            "disc": {"material": disc},
        }


def _states_text(states: Sequence[RunState]) -> str:
    """Durations of the states of a run."""
    return ", ".join(f"{'on' if state.vibrated else 'off'} {state.duration:.0f}" for state in states)


def _hours(duration: float) -> str:
    """Time of sliding in words."""
    return f"{duration / 3600:.2g} h of sliding" if duration >= 3600 else f"{duration / 60:.2g} min of sliding"


def _text(value: float, unit: str) -> str:
    """Value with its unit, or a dash where it is not known."""
    return format_si(value, unit) if np.isfinite(value) else "-"


def _finite(value: float) -> float | None:
    """Value, or None where it is not known."""
    return float(value) if np.isfinite(value) else None


def _range(values: "np.ndarray[Any, np.dtype[np.float64]]", unit: str) -> str:
    """Lowest and highest value, or the one."""
    ends = dict.fromkeys(format_si(float(each), unit) for each in (values.min(), values.max()))
    return " to ".join(ends)
