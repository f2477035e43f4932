"""Protocols, table and figure of the runs of a plan."""

import csv
import io
from collections.abc import Iterator
from math import ceil, floor, log10
from typing import Any, Final

import numpy as np

from sonolube.charts import Axis, Chart, Panel, Part, Points, Rule
from sonolube.checks import Floats
from sonolube.design.test_plan.comparison import PlannedRun, RunPart, RunState
from sonolube.design.test_plan.plan import TestPlan
from sonolube.facts.protocol import Protocol, protocol_from
from sonolube.facts.protocol.quantity_text import exact_text
from sonolube.text.units import format_si

_COLUMNS = (
    ("normal_load", "N", 1.0),
    ("sliding_speed", "mm/s", 1e3),
    ("voltage_peak_to_peak", "V", 1.0),
    ("vibration_amplitude", "um", 1e6),
)
_FORCES: Final = ("friction_force [N]", "intrinsic_friction_force [N]")
RESULTS: Final = (*_FORCES, "friction_coefficient", "intrinsic_friction_coefficient")
"""Columns of which the laboratory fills the two that it measures: forces, or coefficients of friction."""


def run_table(plan: TestPlan) -> str:
    """CSV text of the runs in their order, to be filled and read by `sonolube.measurement.measured_runs.read_runs`."""
    known = [each for each in _COLUMNS if each[0] != "voltage_peak_to_peak" or has_voltage(plan)]
    lines = [",".join(["run", "block", *(f"{name} [{unit}]" for name, unit, _ in known), *RESULTS])]
    for run in plan.runs:
        index = plan.candidate(run)
        cells = [f"{scale * getattr(plan.candidates, name)[index]:.6g}" for name, _, scale in known]
        lines.append(",".join([f"{run.run}", f"{run.block}", *cells, *("" for _ in RESULTS)]))
    return "\n".join(lines) + "\n"


def has_results(text: str) -> bool:
    """Whether a table of runs holds any result, which must not be replaced by an empty one."""
    rows = list(csv.DictReader(io.StringIO(text)))
    filled = any((row.get(name) or "").strip() for row in rows for name in RESULTS)
    return not rows or filled or any(name not in row for row in rows for name in _FORCES)


def has_voltage(plan: TestPlan) -> bool:
    """Whether the drive voltage of the points is known."""
    return bool(plan.candidates.voltage_peak_to_peak[0] > 0)


_REST: Final = 0.5  # s, for the zero of the force, as in D 4.1.2
_SAMPLE_RATE: Final = "400 Hz"  # D Table 2.2
_CHANNELS: Final = ("friction_force", "voltage", "current", "temperature", "gaussmeter")  # D Fig. 4.2
_MARGIN: Final = 1.05  # of limits over what is planned
_FORCE_MARGIN: Final = 3.0  # of the friction limit over the intrinsic friction


def run_protocols(plan: TestPlan) -> dict[str, Protocol]:
    """Protocol of each run by a name with their number, so that files of another plan are not mistaken for these.

    Such as `run-01-of-28`, or `run-01-without-of-28` and `run-01-with-of-28` on specimens of their own.
    """
    count = len(plan.runs)
    return {
        f"run-{run.run:0{len(str(count))}d}{_suffix(part)}-of-{count}": _protocol(plan, run, part)
        for run in plan.runs
        for part in run.parts
    }


def _suffix(part: RunPart) -> str:
    """State of a part that has one only, for its name."""
    return "" if len(part.vibrated) > 1 else "-with" if part.vibrated[0] else "-without"


def _protocol(plan: TestPlan, run: PlannedRun, part: RunPart) -> Protocol:
    """Protocol of a run on one specimen."""
    index = plan.candidate(run)
    at = plan.candidates
    load, speed = float(at.normal_load[index]), float(at.sliding_speed[index])
    states = plan.states(run, part)
    total = _REST + sum(state.duration for state in states)
    materials = (
        {} if plan.materials is None else dict(zip(("pin_material", "disc_material"), plan.materials, strict=True))
    )
    text = f"{format_si(load, 'N')}, {format_si(speed, 'm/s')}, {format_si(at.vibration_amplitude[index], 'm')}"
    return protocol_from(
        {
            "title": f"Run {run.run}{_suffix(part).replace('-', ' ')}: {text}",
            "source": "sonolube plan; preparation by D 2.3.2 and appendix A 2.4, form of runs by D 4.1.2, interleaved",
            "limits": _limits(plan, total),
            "metadata": {
                **materials,
                "normal_load": exact_text(load, unit="N"),
                "specimen": part.specimen,
                "run": run.run,
                "block": run.block,
            },
            "steps": [
                *_preparation(plan, part.specimen, load),
                {
                    "kind": "acquire",
                    "channels": list(_CHANNELS),
                    "sample_rate": _SAMPLE_RATE,
                    "duration": exact_text(total, unit="s"),
                },
                {"kind": "wait", "duration": exact_text(_REST, unit="s"), "reason": "zero of the force"},
                {"kind": "motor_speed", "sliding_speed": exact_text(speed, unit="m/s")},
                *(step for number, state in enumerate(states) for step in _state(plan, index, state, first=not number)),
            ],
        }
    )


def _limits(plan: TestPlan, total: float) -> dict[str, str]:
    """Limits of a run: those of the rig where they are given, else of the plan, with a margin."""
    at, points = plan.candidates, list(plan.batch.points)
    highest = 0.0
    if has_voltage(plan):
        highest = float(max(abs(at.voltage_offset[points]) + at.voltage_peak_to_peak[points] / 2))
    voltage = plan.limits.voltage_maximum or _MARGIN * highest
    force = _FORCE_MARGIN * plan.friction_coefficient * float(at.normal_load[points].max())
    return {
        "voltage_maximum": exact_text(voltage, unit="V"),
        "duration_maximum": exact_text(_MARGIN * total, unit="s"),
        "friction_force_maximum": exact_text(_rounded_up(force), unit="N"),
    }


def _rounded_up(value: float) -> float:
    """Limit that an operator sets: with three digits, not below the value."""
    step = 10.0 ** (floor(log10(value)) - 2)
    return float(f"{step * ceil(value / step * (1 - 1e-12)):.3g}")


def _preparation(plan: TestPlan, specimen: str, load: float) -> Iterator[dict[str, Any]]:
    """Steps of the operator before a run."""
    kept = "the pair of this block" if plan.procedure.blocking.shares_specimens else "new"
    yield {"kind": "prompt", "task": "mounting", "text": f"Mount pin and disc {specimen} ({kept})."}
    yield {"kind": "prompt", "task": "cleaning", "text": "Wipe pin and disc with ethanol, with gloves; let them dry."}
    yield {"kind": "prompt", "task": "load", "text": f"Apply {format_si(load, 'N')}; bring the pin into contact."}


def _state(plan: TestPlan, index: int, state: RunState, *, first: bool) -> Iterator[dict[str, Any]]:
    """Steps of one state of a run: switch, time to settle, time to measure."""
    if state.vibrated:
        yield _vibration(plan, index)
    elif not first:
        yield _stillness(plan)
    friction = f"friction {'with' if state.vibrated else 'without'} vibration"
    if state.settling > 0:
        reason = f"{friction} settles{', running-in' if first else ''}"
        yield {"kind": "wait", "duration": exact_text(state.settling, unit="s"), "reason": reason}
    yield {"kind": "wait", "duration": exact_text(state.measuring, unit="s"), "reason": f"{friction}, measured"}


def _stillness(plan: TestPlan) -> dict[str, Any]:
    """Step that switches the vibration off."""
    if plan.rig.drive is None or not has_voltage(plan):
        return {"kind": "prompt", "task": "other", "text": "Switch the vibration off."}
    return {"kind": "drive", "voltage_peak_to_peak": "0 V"}


def _vibration(plan: TestPlan, index: int) -> dict[str, Any]:
    """Step that switches the vibration on."""
    at, drive = plan.candidates, plan.rig.drive
    if drive is None or not has_voltage(plan):
        amplitude = format_si(at.vibration_amplitude[index], "m")
        return {"kind": "prompt", "task": "other", "text": f"Switch the vibration on, {amplitude} zero to peak."}
    return {
        "kind": "drive",
        "voltage_peak_to_peak": exact_text(float(at.voltage_peak_to_peak[index]), unit="V"),
        "voltage_offset": exact_text(float(at.voltage_offset[index]), unit="V"),
        "frequency": exact_text(drive.frequency, unit="Hz"),
        "waveform": _WAVEFORM,
    }


_WAVEFORM: Final = "sine"  # that closures are learned for


_MAX_DESCRIBED = 4  # points whose conditions are written below the axis


def plan_chart(plan: TestPlan) -> Chart:
    """Candidates over speed and amplitude, coloured by information, and the prediction at the points of a plan."""
    panels = (_candidate_panel(plan), _ratios(plan))
    return Chart(panels=panels, size=(7.4, 3.7), columns=2, widths=(1.25, 1.0), legend="top", legend_columns=3)


def _candidate_panel(plan: TestPlan) -> Panel:
    """Candidates, coloured by information, the greatest over the loads; those of the plan with their numbers."""
    at = plan.candidates
    speed, amplitude = 1e3 * at.sliding_speed, 1e6 * at.vibration_amplitude
    refused = np.array([bool(reason) for reason in at.refused])
    order = np.argsort(plan.information)
    order = order[~refused[order]]
    greatest = float(plan.information[order].max(initial=0.0))
    parts: list[Part] = [
        Points(
            x=speed[order],
            y=amplitude[order],
            size=1.7,
            shades=plan.information[order],
            scale_text="Expected information [bit]",
            scale_ends=(0.0, greatest),
        )
    ]
    if refused.any():
        parts.append(Points(x=speed[refused], y=amplitude[refused], label="exceeds a limit", colour="0.5", marker=6))
    points = list(plan.batch.points)
    places = dict.fromkeys(zip(speed[points], amplitude[points], strict=True))
    numbers = [
        ", ".join(str(n) for n, p in enumerate(points, 1) if (speed[p], amplitude[p]) == place) for place in places
    ]
    x, y = np.array(list(places)).T
    parts.append(Points(x=x, y=y, texts=tuple(numbers), label="point of the plan", colour=1, size=2.3, is_hollow=True))
    ticks = _ticks(np.unique(speed))
    words = tuple(f"{tick:.3g}" for tick in ticks)
    return Panel(
        x=Axis("Sliding speed", "mm/s", logarithmic=True, ticks=ticks, words=words),
        y=Axis("Vibration amplitude", "µm"),
        parts=tuple(parts),
    )


def _ticks(values: Floats) -> tuple[float, ...]:
    """At most seven of the values."""
    chosen = np.unique(np.linspace(0, values.size - 1, min(values.size, 7)).round().astype(int))
    return tuple(float(each) for each in values[chosen])


def _ratios(plan: TestPlan) -> Panel:
    """Predicted friction ratio at each point with its interval, the closures apart, and the difference to be shown."""
    points = list(plan.batch.points)
    numbers = np.arange(1.0, len(points) + 1)
    low, high = plan.interval[:, points]
    middle = plan.median[points]
    error = np.array([middle - low, high - middle])
    parts: list[Part] = [Points(x=numbers, y=middle, y_error=error, label="prediction, 80 %", colour="0.25", size=0.8)]
    for place, (name, medians) in enumerate(plan.closure_medians.items()):
        shifted = numbers + 0.14 * (2 * place - len(plan.closure_medians) + 1)
        label = name.replace("_", " ")
        parts.append(Points(x=shifted, y=medians[points], label=label, colour=place, marker=place, size=1.2))
    parts.append(Rule(value=1 - plan.question.difference, along="y", label="difference to be shown"))
    words = [str(number) for number in range(1, len(points) + 1)]
    if len(points) <= _MAX_DESCRIBED:
        words = [f"{word}\n{_condition(plan, point)}" for word, point in zip(words, points, strict=True)]
    x = Axis(
        "Point of the plan", ticks=tuple(numbers.tolist()), words=tuple(words), lowest=0.5, highest=len(points) + 0.5
    )
    return Panel(x=x, y=Axis("Friction ratio", lowest=-0.03, highest=1.08), parts=tuple(parts))


def _condition(plan: TestPlan, point: int) -> str:
    """Speed and amplitude of a point, and its load where it varies."""
    at = plan.candidates
    load = f"\n{format_si(at.normal_load[point], 'N')}" if np.unique(at.normal_load).size > 1 else ""
    return f"{1e3 * at.sliding_speed[point]:.3g} mm/s\n{1e6 * at.vibration_amplitude[point]:.3g} µm{load}"
