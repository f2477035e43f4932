"""Protocols of the runs of a plan, one a run."""

from collections.abc import Iterator
from math import ceil, floor, log10
from typing import Any, Final

from sonolube.design.test_plan.plan import TestPlan
from sonolube.design.test_plan.run_order import PlannedRun, RunPart, RunState
from sonolube.design.test_plan.run_table import has_voltage
from sonolube.facts.protocol import Protocol, protocol_from
from sonolube.facts.protocol.quantity_text import exact_text
from sonolube.text.units import format_si

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
