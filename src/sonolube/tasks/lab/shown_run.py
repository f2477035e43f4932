"""Task `lab show`: a run with its facts, events, gaps and outcome, and a figure of its channels."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sonolube.laboratory.records import Note, Run, read_run
from sonolube.tasks.answer import Answer, answer
from sonolube.tasks.blocks import Block, Rows
from sonolube.tasks.lab.run_folders import RunFolder
from sonolube.tasks.task import task
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.report import Drawing

_MAX_EVENTS = 40


@answer
class ShownRun(Answer):
    """Record of a run.

    Parameters
    ----------
    run : Run
    """

    run: Run

    def blocks(self) -> Sequence[Block]:
        """Outcome, facts and events."""
        summary, known = self.run.summary, self.run.known
        rows = [
            ("begun", f"{summary.begun_text} UTC"),
            ("outcome", summary.outcome + (f": {summary.reason}" if summary.reason else "")),
            ("channels", ", ".join(summary.channels) or "none"),
            ("recorded", f"{summary.samples} samples, {format_si(summary.duration, 's')}, gaps: {summary.gaps}"),
            *((name, str(value)) for name, value in known.facts.items()),
            *((f"version of {name}", value) for name, value in known.versions.items()),
            *((name, f"sha256 {digest[:16]}...") for name, digest in known.files.items()),
        ]
        notes = self.run.notes
        events = [(_moment(note, summary.begun), _event(note)) for note in notes[:_MAX_EVENTS]]
        more = [f"  ... and {len(notes) - _MAX_EVENTS} more events"] if len(notes) > _MAX_EVENTS else []
        return [f"{summary.folder.name}: {summary.title}", Rows(rows), "events", Rows(events), *more]

    def object(self) -> dict[str, Any]:
        """Record for JSON, in SI."""
        summary, known = self.run.summary, self.run.known
        notes = [
            {"kind": note.kind, "time": note.time, "sample": note.sample, "facts": dict(note.facts)}
            for note in self.run.notes
        ]
        return {
            "folder": str(summary.folder),
            "title": summary.title,
            "begun": summary.begun_text,
            "outcome": summary.outcome,
            "reason": summary.reason,
            "channels": list(summary.channels),
            "samples": summary.samples,
            "duration": summary.duration,
            "gaps": summary.gaps,
            "facts": dict(known.facts),
            "versions": dict(known.versions),
            "sha256": dict(known.files),
            "recordings": [str(path) for path in self.run.recordings],
            "events": notes,
        }

    def caveats(self) -> Sequence[str]:
        """What speaks against the record."""
        return self.run.caveats

    def figures(self) -> "Mapping[str, Drawing]":
        """Channels over time."""
        if not self.run.recordings:
            return {}
        from sonolube.laboratory.records.channels_figure import channels_figure
        from sonolube.report import Drawing

        title = self.run.summary.title
        caption = f"{title}: the range of the samples of each channel over time."
        name = f"{self.run.folder.resolve().name}-channels"
        return {name: Drawing(draw=lambda: channels_figure(self.run.dataset()), caption=caption)}

    def dataset(self) -> "xr.Dataset":
        """Return the recording, where there is one."""
        return self.run.dataset().assign_attrs(self.notes()) if self.run.recordings else super().dataset()


@task
def show(run: RunFolder) -> ShownRun:
    """A recorded run: facts, events, gaps, outcome, and a figure of its channels.

    Example: sonolube lab show runs/20261123T014210Z-map-test --out out
    """
    return ShownRun(run=read_run(Path(run)))


def _moment(note: Note, begun: float) -> str:
    """Time of an event since the begin of the run."""
    return f"{note.time - begun:.3f} s" + ("" if note.sample is None else f", sample {note.sample}")


def _event(note: Note) -> str:
    """Event in words."""
    facts = ", ".join(f"{name} {value}" for name, value in note.facts.items() if value != "")
    return f"{note.kind}: {facts}".removesuffix(": ")
