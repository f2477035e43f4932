"""Recorded runs: a run with its facts and events, and runs that were found, as rows, JSON and dataset."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from sonolube.laboratory.catalogue import CatalogueEntry
from sonolube.laboratory.records import Note, Run
from sonolube.report.results.record_object import picked
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr

FOUND_HEADS: Final = ("run", "outcome", "recorded", "pin", "disc", "load", "speed", "tags")
"""Heads of the table of runs that were found."""

_MAX_EVENTS: Final = 40


def run_rows(run: Run) -> list[tuple[str, str]]:
    """Outcome, channels, duration, facts, versions and files of a run."""
    summary, known = run.summary, run.known
    return [
        ("begun", summary.begun_text),
        ("outcome", summary.outcome + (f": {summary.reason}" if summary.reason else "")),
        ("channels", ", ".join(each.described for each in run.channels.values()) or "none"),
        *((f"clock {clock}", ", ".join(path.name for path in paths)) for clock, paths in run.clocks.items()),
        ("recorded", f"{summary.samples} samples, {format_si(summary.duration, 's')}, gaps: {summary.gaps}"),
        *((name, str(value)) for name, value in known.facts.items()),
        *((f"version of {name}", value) for name, value in known.versions.items()),
        *((name, f"sha256 {digest[:16]}...") for name, digest in known.files.items()),
    ]


def event_rows(run: Run) -> list[tuple[str, str]]:
    """Time and text of the first events of a run."""
    return [(_moment(note, run.summary.begun), _event(note)) for note in run.notes[:_MAX_EVENTS]]


def further_events(run: Run) -> list[str]:
    """Number of the events that are left out, where there are any."""
    count = len(run.notes) - _MAX_EVENTS
    return [f"  ... and {count} more events"] if count > 0 else []


def run_object(run: Run) -> dict[str, Any]:
    """Outcome, channels, facts, recordings and events of a run, in SI."""
    summary, known = run.summary, run.known
    notes = [picked(note, "kind", "time", "sample") | {"facts": dict(note.facts)} for note in run.notes]
    return {
        "folder": str(summary.folder),
        "title": summary.title,
        "begun": summary.begun_text,
        **picked(summary, "outcome", "reason"),
        "channels": list(summary.channels),
        **picked(summary, "samples", "duration", "gaps"),
        "facts": dict(known.facts),
        "versions": dict(known.versions),
        "sha256": dict(known.files),
        "quantities": {each.name: {"quantity": each.quantity, "unit": each.unit} for each in run.channels.values()},
        "recordings": [str(path) for path in run.recordings],
        "clocks": {clock: [str(path) for path in paths] for clock, paths in run.clocks.items()},
        "events": notes,
    }


def found_row(entry: CatalogueEntry) -> list[str]:
    """Row of a run: folder, outcome, duration, materials, load, speed and tags."""
    summary = entry.summary
    return [
        summary.folder.name,
        summary.outcome,
        format_si(summary.duration, "s") if summary.samples else "-",
        entry.pin_material or "-",
        entry.disc_material or "-",
        _range(entry.normal_loads, "N"),
        _range(entry.sliding_speeds, "m/s"),
        ", ".join(entry.tags) or "-",
    ]


def _range(values: Sequence[float], unit: str) -> str:
    """Value, or the lowest and highest of several, as text."""
    return " to ".join(format_si(value, unit) for value in sorted({*values[:1], *values[-1:]})) or "-"


def found_object(entry: CatalogueEntry) -> dict[str, Any]:
    """Run with all that it is found by."""
    content = asdict(entry)
    summary: dict[str, Any] = content.pop("summary")
    content.pop("text")
    single = {"normal_load": entry.normal_load, "sliding_speed": entry.sliding_speed}
    return summary | {"folder": str(entry.summary.folder), "begun": entry.summary.begun_text} | content | single


def found_runs_dataset(entries: Sequence[CatalogueEntry]) -> "xr.Dataset":
    """Runs that were found, over `run` by the names of their folders."""
    import numpy as np
    import xarray as xr

    numbers = {
        "duration": ("s", [entry.summary.duration for entry in entries]),
        "normal_load": ("N", [entry.normal_load for entry in entries]),
        "sliding_speed": ("m/s", [entry.sliding_speed for entry in entries]),
    }
    texts = {
        "folder": [str(entry.summary.folder) for entry in entries],
        "outcome": [entry.summary.outcome for entry in entries],
        "pin_material": [entry.pin_material for entry in entries],
        "disc_material": [entry.disc_material for entry in entries],
        "tags": [", ".join(entry.tags) for entry in entries],
    }
    variables: dict[str, Any] = {
        name: ("run", np.array(values, float), {"units": unit, "long_name": name.replace("_", " ")})
        for name, (unit, values) in numbers.items()
    }
    variables |= {name: ("run", np.array(values, str)) for name, values in texts.items()}
    names = np.array([entry.summary.folder.name for entry in entries], str)
    return xr.Dataset(variables, coords={"run": names})


def _moment(note: Note, begun: float) -> str:
    """Time of an event since the begin of the run."""
    return f"{note.time - begun:.3f} s" + ("" if note.sample is None else f", sample {note.sample}")


def _event(note: Note) -> str:
    """Event in words."""
    facts = ", ".join(f"{name} {value}" for name, value in note.facts.items() if value != "")
    return f"{note.kind}: {facts}".removesuffix(": ")
