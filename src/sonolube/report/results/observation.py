"""A run that is being recorded, as it was seen last: lines of text."""

from typing import Any, Final

from sonolube.laboratory.records import Observation
from sonolube.operating_system import quoted
from sonolube.report.blocks import Block, Rows
from sonolube.report.results.ended_run import SIMULATED
from sonolube.report.results.record_object import picked
from sonolube.text.units import format_si
from sonolube.vocabulary import si, unit_of

_QUIET: Final = 5.0  # s without a block or event that are reported
_SHOWN: Final = ("friction_force", "normal_load", "temperature", "voltage_peak_to_peak")


def observation_line(seen: Observation) -> str:
    """Line of a look at a run: state, step, time, means of the last second, set points, and what is wrong."""
    parts = [seen.state, step_text(seen), time_text(seen), means_text(seen), set_points_text(seen), *warnings(seen)]
    return "; ".join(filter(None, parts))


def observation_object(seen: Observation) -> dict[str, Any]:
    """State, step, times, means, set points and limits of a look at a run, in SI."""
    return {
        "folder": str(seen.folder),
        "title": seen.known.title,
        "simulated": bool(seen.known.facts.get("simulated", False)),
        **picked(seen, "outcome", "reason", "state", "step", "step_kind"),
        **si(picked(seen, "protocol_time", "duration", "time_left"), unit="s"),
        "means": {name: {"value": value, "unit": unit} for name, (value, unit) in seen.means.items()},
        "set_points": si(seen.set_points),
        "trips": list(seen.trips),
        "gaps": seen.gaps,
        **si({"silence": seen.silence if seen.is_running else None}, unit="s"),
    }


def step_text(seen: Observation) -> str:
    """Step with its kind."""
    return f"step {seen.step} {seen.step_kind.replace('_', ' ')}".rstrip() if seen.step else ""


def time_text(seen: Observation) -> str:
    """Time into the protocol and left."""
    if seen.duration is None or seen.time_left is None:
        return f"{seen.protocol_time:.1f} s"
    return f"{seen.protocol_time:.1f} s of {seen.duration:.1f} s, {seen.time_left:.1f} s left"


def means_text(seen: Observation) -> str:
    """Friction, load and temperature with units, and the voltage where it is not among the set points."""
    shown = [name for name in _SHOWN if name in seen.means and name not in seen.set_points]
    found = [(name, *seen.means[name]) for name in shown]
    return ", ".join(
        f"{name.replace('_', ' ')} {'no number' if value is None else format_si(value, unit)}"
        for name, value, unit in found
    )


def set_points_text(seen: Observation) -> str:
    """Set points of motor and drive while they are on."""
    known = seen.set_points
    shown = [name for name in known if name != "rotation_speed" or "sliding_speed" not in known]
    texts = [f"{name.replace('_', ' ')} {format_si(known[name], unit_of(name))}" for name in shown]
    return f"set {', '.join(texts)}" if texts else ""


def warnings(seen: Observation) -> list[str]:
    """Limits that were exceeded, gaps, and silence while the run should write."""
    told = list(seen.trips)
    if seen.gaps:
        told.append(f"samples are missing in {seen.gaps} places")
    if seen.is_running and seen.means and seen.silence > _QUIET:
        told.append(f"nothing was written for {seen.silence:.0f} s")
    return told


def observation_blocks(seen: Observation) -> list[Block]:
    """Outcome or state, and what was seen last."""
    outcome = seen.outcome + (f": {seen.reason}" if seen.reason and not seen.is_running else "")
    rows = [
        ("outcome", outcome),
        ("state", seen.state + (f": {seen.reason}" if seen.reason and seen.is_running else "")),
        ("step", step_text(seen).removeprefix("step ")),
        ("time", time_text(seen)),
        ("last second", means_text(seen)),
        ("set", set_points_text(seen).removeprefix("set ")),
        *(("limit", trip) for trip in seen.trips),
    ]
    return [f"{seen.folder.name}: {seen.known.title}", Rows([row for row in rows if row[1]])]


def observation_caveats(seen: Observation) -> list[str]:
    """A writer that has died, samples that are missing, and a run that writes nothing."""
    told = [line for line in warnings(seen) if line not in seen.trips]
    if seen.outcome == "unfinished":
        remedy = f"sonolube lab recover {quoted(str(seen.folder))}"
        told.append(f"the program died during the run, and motor or drive may be on; {remedy} completes its record")
    if seen.known.facts.get("simulated"):
        told.append(SIMULATED)
    return told
