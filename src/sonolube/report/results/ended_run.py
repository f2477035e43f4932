"""Run that has ended, or that a dry run went through: outcome, record and next command as text and JSON."""

from typing import Any

from sonolube.facts.protocol import Protocol
from sonolube.laboratory import RunResult, State
from sonolube.laboratory.dry_run import DryRun, dry_run_cells, dry_run_lines, dry_run_sums
from sonolube.laboratory.records import Run
from sonolube.report.blocks import Block, Rows, Table, Verbatim
from sonolube.report.results.next_step import next_command
from sonolube.report.results.record_object import picked
from sonolube.rig import Rig
from sonolube.text.units import format_si
from sonolube.vocabulary import si

SIMULATED = "friction is drawn from the prediction of the rig: no measurement"
"""Caveat of runs on a virtual tribometer."""

_SAME_LOAD = 1e-6  # relative
_MAX_SAMPLES = 10_000_000  # of a recording whose mean is computed


def run_blocks(result: RunResult, run: Run, *, simulated: bool) -> list[Block]:
    """Outcome, what was recorded, and the next command."""
    summary = run.summary
    mean = _mean_friction(run)
    rows = [
        ("outcome", summary.outcome + (f": {summary.reason}" if summary.reason else "")),
        ("motor and drive", off_text(is_off=result.state is State.SAFE)),
        ("recorded", f"{format_si(summary.duration, 's')}, {summary.samples} samples of each channel"),
        ("channels", ", ".join(each.described for each in run.channels.values())),
        *(() if mean is None else (("mean friction", format_si(mean, "N", digits=3)),)),
        ("record", str(summary.folder)),
    ]
    after = [Verbatim(f"  next: {next_command(run)}")] if run.recordings else []
    return [summary.title + (" (virtual)" if simulated else ""), Rows(rows), *after]


def run_object(result: RunResult, run: Run, *, simulated: bool) -> dict[str, Any]:
    """Outcome, folder and recordings, for JSON."""
    summary = run.summary
    return {
        **picked(summary, "title", "outcome", "reason"),
        "state": result.state.value,
        "simulated": simulated,
        "folder": str(summary.folder),
        "recordings": [str(path) for path in run.recordings],
        "clocks": {clock: [str(path) for path in paths] for clock, paths in run.clocks.items()},
        "samples": summary.samples,
        **si({"duration": summary.duration}, unit="s"),
        "tags": run.facts.get("tags", ""),
        **si({"friction_force": _mean_friction(run)}),
    }


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
    return [*found, SIMULATED]


def _mean_friction(run: Run) -> float | None:
    """Mean friction force over a recording of moderate length; None without one. [N]"""
    if not run.recordings or run.summary.samples > _MAX_SAMPLES:
        return None
    recording = run.dataset()
    return float(recording["friction_force"].mean()) if "friction_force" in recording else None


def dry_run_blocks(protocol: Protocol, found: DryRun) -> list[Block]:
    """A row a set point, then time, data, drive and temperatures; what is impossible last."""
    points = [dry_run_cells(point, found) for point in found.points]
    sums = Rows(list(dry_run_sums(found)))
    refused = [f"  impossible: {each}" for each in found.refusals]
    return [protocol.title, Table(("",) * 4, points), sums, *refused]


def dry_run_object(protocol: Protocol, found: DryRun) -> dict[str, Any]:
    """Times, data and refusals, for JSON."""
    return {
        "title": protocol.title,
        "possible": not found.refusals,
        "refusals": list(found.refusals),
        **si({"duration": found.duration}, unit="s"),
        "lines": dry_run_lines(found),
    }


def off_text(*, is_off: bool) -> str:
    """Whether motor and drive are off, in words."""
    return "off" if is_off else "NOT confirmed off: cut the power"
