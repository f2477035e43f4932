"""Plan of tests: rows of tables, facts, items of the report, and the object for JSON."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from sonolube.design.test_plan.candidates import Candidates
from sonolube.design.test_plan.comparison import RunState
from sonolube.design.test_plan.plan import TestPlan
from sonolube.facts.protocol import Limits
from sonolube.report.results.record_object import finite, picked
from sonolube.rig import Rig
from sonolube.rig.power import power_text, with_former_key
from sonolube.text.units import format_like, format_si
from sonolube.vocabulary import si

POINT_HEADS: Final = (
    "point",
    "load",
    "speed",
    "voltage",
    "amplitude",
    "friction ratio, 80 %",
    "chance of the difference",
    "power to supply",
    "contact hotter by",
    "information",
)
"""Heads of the table of points."""

_POINT = (
    *("normal_load", "sliding_speed", "voltage_peak_to_peak", "vibration_amplitude"),
    *("power_to_supply", "charging_power", "dissipated_power", "mean_temperature_rise"),
)
_TO_FILL = ("Friction without (N or coefficient)", "Friction with", "Measured amplitude", "Remarks")
_SETTINGS = ("Load (N)", "Speed (mm/s)", "Voltage (V)", "Amplitude (um)", "Vibration (s)")
RUN_HEADS: Final = ("Run", "Block", "Pair", *_SETTINGS, *_TO_FILL)
"""Heads of the table of runs of a sheet to print."""

_ORDERS = {
    1: "off, on, off in each run, the middle measured twice as long: a linear drift, such as running-in, leaves the"
    " difference of the means as it is",
    2: "the pair without vibration first in odd blocks, the one with vibration in even ones",
}
"""Order of the states, by the pairs of specimens of a run."""


def size_text(plan: TestPlan) -> str:
    """Number of points, replicates and runs, and the time they take."""
    points, runs, specimens = len(plan.batch.points), len(plan.runs), plan.question.comparison.specimens
    pairs = len({name for run in plan.runs for name in run.specimens})
    tests = f"{runs * specimens} tests" if specimens > 1 else f"{runs} runs"
    bodies = f"{pairs} pairs of specimens"
    return f"{points} points, {plan.replicates} times each: {tests} on {bodies}, {_hours(plan.duration)}"


def facts(plan: TestPlan) -> list[tuple[str, str]]:
    """Comparison, scatter, information and order."""
    question = plan.question
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
            "friction models",
            f"{weights}; the plan is expected to give {plan.batch.information[-1]:.2f} of {plan.entropy:.2f} bit"
            " about which holds",
        ),
        (
            "blocks",
            f"{plan.replicates}, each of every point once in random order, the first point first; each is"
            f" {plan.procedure.blocking.title}",
        ),
        ("order", _ORDERS[question.comparison.specimens]),
    ]


def point_rows(plan: TestPlan) -> list[list[str]]:
    """Points of the plan with their prediction."""
    return [[f"{number}", *_point(plan, point)] for number, point in enumerate(plan.batch.points, 1)]


def run_rows(plan: TestPlan) -> list[tuple[str, ...]]:
    """Runs in their order with empty cells."""
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


def limit_rows(plan: TestPlan, limits: Limits) -> list[tuple[str, str]]:
    """Limits of the protocols, and of the rig."""
    voltage, of_rig = limits.voltage_maximum, plan.limits
    rows = [
        (
            "Voltage, its offset included",
            format_si(voltage, "V") if voltage > 0 else "not planned: the vibration is switched by hand",
        ),
        ("Friction force", format_si(limits.friction_force_maximum or np.nan, "N")),
        ("Temperature of the actuator", ""),
    ]
    if of_rig.power_to_supply is not None:
        rows.append(("Power of the amplifier", format_si(of_rig.power_to_supply, "W")))
    if plan.materials is not None and of_rig.mean_temperature_rise is not None:
        rows.append(("Rise of the contact by friction", format_si(of_rig.mean_temperature_rise, "K")))
    return rows


def known_items(rig: Rig, plan: TestPlan) -> dict[str, dict[str, str]]:
    """Items of the report that the plan settles."""
    points = list(plan.batch.points)
    at, drive = plan.candidates, rig.drive
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


def plan_object(rig: Rig, plan: TestPlan) -> dict[str, Any]:
    """Question, scatter, replicates, points and runs."""
    at = plan.candidates
    return {
        "rig": rig.title,
        "comparison": plan.question.comparison.name,
        **picked(plan.question, "difference", "significance"),
        "power": plan.power,
        "scatter": {"value": plan.question.comparison.deviation(plan.scatter), "source": plan.scatter.source},
        "replicates": plan.replicates,
        "duration": si({"duration": plan.duration})["duration"],
        "friction_models": plan.weights,
        "information": {"value": plan.batch.information[-1], "of": plan.entropy, "unit": "bit"},
        "points": [
            si(with_former_key({name: finite(values[point]) for name, values in picked(at, *_POINT).items()}))
            | ({"at_least": ["power_to_supply"]} if np.isnan(at.dissipated_power[point]) else {})
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
                **picked(run, "run", "block"),
                "point": run.point + 1,
                "specimens": list(run.specimens),
                "vibrated": [list(part.vibrated) for part in run.parts],
            }
            for run in plan.runs
        ],
    }


def _point(plan: TestPlan, point: int) -> list[str]:
    """Conditions, prediction and demands of a point."""
    low, high = plan.interval[:, point]
    return [
        *_conditions(plan, point),
        f"{plan.median[point]:.2f} ({low:.2f} to {high:.2f})",
        f"{100 * plan.chance[point]:.0f} %",
        _power_text(plan.candidates, point),
        _text(plan.candidates.mean_temperature_rise[point], "K"),
        f"{plan.information[point]:.3f} bit",
    ]


def _conditions(plan: TestPlan, point: int) -> list[str]:
    """Load, speed, voltage and amplitude of a candidate."""
    at, points = plan.candidates, list(plan.batch.points)
    columns = ((at.normal_load, "N"), (at.sliding_speed, "m/s"), (at.voltage_peak_to_peak, "V"))
    place = points.index(point)
    return [
        format_like([float(values[each]) for each in points], unit)[place].replace("nan V", "-")
        for values, unit in (*columns, (at.vibration_amplitude, "m"))
    ]


def _states_text(states: Sequence[RunState]) -> str:
    """Durations of the states of a run."""
    return ", ".join(f"{'on' if state.vibrated else 'off'} {state.duration:.0f}" for state in states)


def _hours(duration: float) -> str:
    """Time of sliding in words."""
    return f"{duration / 3600:.2g} h of sliding" if duration >= 3600 else f"{duration / 60:.2g} min of sliding"


def _power_text(at: Candidates, point: int) -> str:
    """Power to supply at a point, or a dash where it is not known."""
    power, heat = float(at.power_to_supply[point]), float(at.dissipated_power[point])
    return power_text(power, is_at_least=bool(np.isnan(heat))) if np.isfinite(power) else "-"


def _text(value: float, unit: str) -> str:
    """Value with its unit, or a dash where it is not known."""
    return format_si(value, unit) if np.isfinite(value) else "-"


def _range(values: "np.ndarray[Any, np.dtype[np.float64]]", unit: str) -> str:
    """Lowest and highest value, or the one."""
    ends = dict.fromkeys(format_si(float(each), unit) for each in (values.min(), values.max()))
    return " to ".join(ends)
