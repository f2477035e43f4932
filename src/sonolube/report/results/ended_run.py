"""Runs that are recorded, have ended, or that a dry run went through: outcome, record and next command."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from sonolube.facts.protocol import Protocol
from sonolube.laboratory import RunState, verdict_text
from sonolube.laboratory.dry_run import DryRun, dry_run_cells, dry_run_lines, dry_run_sums
from sonolube.laboratory.records import Observation, Run
from sonolube.laboratory.rehearsal import Rehearsal
from sonolube.laboratory.virtual_tribometer import ExpectedTime
from sonolube.operating_system import quoted
from sonolube.report.blocks import Block, Rows, Table, Verbatim
from sonolube.report.results.record_object import picked
from sonolube.rig import Rig
from sonolube.text.units import format_si
from sonolube.vocabulary import si, unit_of


def next_command(run: Run) -> str:
    """Command for what was recorded: decay length, calibration, friction, impedance, rotation, or to show it.

    Names the folder of the run where the command takes all parts of the recording.
    """
    parts = run.part_channels
    friction = _files_with(parts, "friction_force")
    gauges = [path for path in friction if "displacement" in parts[path]]
    lifts = any(note.facts.get("normal_load") == 0 for note in run.notes if note.kind == "conditions")
    if lifts and any("normal_load" in parts[path] for path in friction):
        return f"sonolube identify decay-length {quoted(str(run.folder))}"
    if gauges:
        applied = "".join(f" --apply {quoted(str(path))}" for path in gauges[1:])
        return f"sonolube measure calibration {quoted(str(gauges[0]))}{applied}"
    if friction:
        return f"sonolube measure friction {_files(run, friction)}"
    driven = [path for path in _files_with(parts, "voltage") if "current" in parts[path]]
    if driven:
        return f"sonolube measure impedance {_files(run, driven)}"
    turning = _files_with(parts, "gaussmeter")
    diameter = run.facts.get("groove_diameter")
    if turning and isinstance(diameter, int | float):
        groove = format_si(float(diameter), "m").replace(" ", "")
        return f"sonolube measure rotation {_files(run, turning)} --groove-diameter {groove}"
    return f"sonolube lab show {quoted(str(run.folder))}"


def _files_with(parts: dict[Path, tuple[str, ...]], channel: str) -> list[Path]:
    """Files of the parts with a channel."""
    return [path for path, channels in parts.items() if channel in channels]


def _files(run: Run, chosen: Sequence[Path]) -> str:
    """Folder of a run where all of its parts are chosen, else their files."""
    is_whole = len(chosen) == len(run.recordings)
    return quoted(str(run.folder)) if is_whole else " ".join(quoted(str(path)) for path in chosen)


SIMULATED = "friction is drawn from the prediction of the rig: no measurement"
"""Caveat of runs on a virtual tribometer."""

_SAME_LOAD = 1e-6  # relative
_MAX_SAMPLES = 10_000_000  # of a recording whose mean is computed


def run_blocks(result: RunState, run: Run, *, simulated: bool) -> list[Block]:
    """Outcome, what was recorded, and the next command."""
    summary = run.summary
    mean, (outcome, reason) = _mean_friction(run), _end(result, run)
    rows = [
        ("outcome", outcome + (f": {reason}" if reason else "")),
        ("motor and drive", verdict_text(result.verdict)),
        ("recorded", f"{format_si(summary.duration, 's')}, {summary.samples} samples of each channel"),
        ("channels", ", ".join(each.described for each in run.channels.values())),
        *(() if mean is None else (("mean friction", format_si(mean, "N", digits=3)),)),
        ("record", str(summary.folder)),
    ]
    after = [Verbatim(f"  next: {next_command(run)}")] if run.recordings else []
    return [summary.title + (" (virtual)" if simulated else ""), Rows(rows), *after]


def run_object(result: RunState, run: Run, *, simulated: bool) -> dict[str, Any]:
    """Outcome, folder and recordings, for JSON."""
    summary, (outcome, reason) = run.summary, _end(result, run)
    return {
        "title": summary.title,
        "outcome": outcome,
        "reason": reason,
        "state": result.state.value,
        "outputs": verdict_text(result.verdict),
        "simulated": simulated,
        "folder": str(summary.folder),
        "recordings": [str(path) for path in run.recordings],
        "clocks": {clock: [str(path) for path in paths] for clock, paths in run.clocks.items()},
        "samples": summary.samples,
        **si({"duration": summary.duration}, unit="s"),
        "tags": run.facts.get("tags", ""),
        **si({"friction_force": _mean_friction(run)}),
    }


def _end(result: RunState, run: Run) -> tuple[str, str]:
    """Outcome and reason of a run; those that its record could not take, as on a full disk, from the run itself."""
    summary = run.summary
    lacks_end = summary.outcome == "unfinished" and result.outcome
    return (result.outcome, result.reason) if lacks_end else (summary.outcome, summary.reason)


def rehearsed_blocks(rehearsed: Rehearsal) -> list[Block]:
    """What each channel of a map reads on the virtual rig."""
    return ["channels of the map on the virtual rig", Rows([(each.name, each.told) for each in rehearsed.channels])]


def rehearsed_object(rehearsed: Rehearsal) -> dict[str, Any]:
    """What each channel of a map reads on the virtual rig, whether that is simulated, and the faults, for JSON."""
    channels = {
        each.name: {"clock": each.clock, "reads": each.reads, "simulated": each.is_simulated}
        for each in rehearsed.channels
    }
    return {"virtual_channels": channels, "faults": [fault.described for fault in rehearsed.faults]}


def run_caveats(run: Run, rig: Rig | None) -> list[str]:
    """Caveats of the record of a virtual run, and settings in which the protocol overrules the rig file."""
    found = [*run.caveats]
    load, own = run.facts.get("normal_load"), None if rig is None else rig.normal_load
    if isinstance(load, float) and own is not None and abs(load - own) > _SAME_LOAD * own:
        set_load, of_rig = format_si(load, "N"), format_si(own, "N")
        found.append(f"the protocol sets {set_load}, and the rig file {of_rig}: the test is at {set_load}")
    applied = {str(note.facts["lubricant"]): 0 for note in run.notes if note.facts.get("lubricant")}
    if applied:
        found.append(f"the virtual rig knows no lubricant: with {', '.join(applied)} its friction is that without")
    if rig is not None and not rig.direction.is_normal:
        found.append(f"the vibration is {rig.direction.text}, of which no wear law is: it wears as without vibration")
    return [*found, SIMULATED]


def _mean_friction(run: Run) -> float | None:
    """Mean friction force over a recording of moderate length; None without one. [N]"""
    if not run.recordings or run.summary.samples > _MAX_SAMPLES:
        return None
    recording = run.dataset()
    return float(recording["friction_force"].mean()) if "friction_force" in recording else None


def dry_run_blocks(protocol: Protocol, found: DryRun, *, expected: ExpectedTime | None = None) -> list[Block]:
    """A row a set point, then time, data, drive and temperatures; what is impossible last."""
    points = [dry_run_cells(point, found) for point in found.points]
    virtual = () if expected is None else (("virtual run", expected.text),)
    sums = Rows([*dry_run_sums(found), *virtual])
    refused = [f"  impossible: {each}" for each in found.refusals]
    return [protocol.title, Table(("",) * 4, points), sums, *refused]


def dry_run_object(protocol: Protocol, found: DryRun, *, expected: ExpectedTime | None = None) -> dict[str, Any]:
    """Times, data and refusals, for JSON; the expected time, which no two runs have alike, is a text."""
    return {
        **({} if expected is None else {"virtual_run": expected.text}),
        "title": protocol.title,
        "possible": not found.refusals,
        "refusals": list(found.refusals),
        **si({"duration": found.duration}, unit="s"),
        "lines": dry_run_lines(found),
    }


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
