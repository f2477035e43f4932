"""Answers of runs of protocols: how a run ended and where its record is, or what a dry run says of it."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from sonolube.facts.protocol import Protocol
from sonolube.laboratory import RunResult, State
from sonolube.laboratory.dry_run import DryRun, dry_run_cells, dry_run_chart, dry_run_lines, dry_run_sums
from sonolube.laboratory.records import Run
from sonolube.report import Drawing
from sonolube.report.blocks import Block, Rows, Table
from sonolube.report.results.next_step import next_command
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, answer, si
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr

SIMULATED = "friction is drawn from the prediction of the rig: no measurement"
"""Caveat of runs on a virtual tribometer."""

_SAME_LOAD = 1e-6  # relative
_MAX_SAMPLES = 10_000_000  # of a recording whose mean is computed


@answer
class RunAnswer(Answer):
    """How a run ended, and where its record is.

    Parameters
    ----------
    result : RunResult
    run : Run
        Read back from its folder.
    simulated : bool
    rig : Rig or None
    """

    result: RunResult
    run: Run
    simulated: bool
    rig: Rig | None = None

    def blocks(self) -> Sequence[Block]:
        """Outcome, what was recorded, and the next command."""
        summary = self.run.summary
        mean = self._mean_friction()
        rows = [
            ("outcome", summary.outcome + (f": {summary.reason}" if summary.reason else "")),
            ("motor and drive", off_text(is_off=self.result.state is State.SAFE)),
            ("recorded", f"{format_si(summary.duration, 's')}, {summary.samples} samples of each channel"),
            ("channels", ", ".join(summary.channels)),
            *(() if mean is None else (("mean friction", format_si(mean, "N", digits=3)),)),
            ("record", str(summary.folder)),
        ]
        after = [f"  next: {next_command(self.run)}"] if self.run.recordings else []
        return [summary.title + (" (virtual)" if self.simulated else ""), Rows(rows), *after]

    def object(self) -> dict[str, Any]:
        """Outcome, folder and recordings."""
        summary = self.run.summary
        return {
            "title": summary.title,
            "outcome": summary.outcome,
            "reason": summary.reason,
            "state": self.result.state.value,
            "simulated": self.simulated,
            "folder": str(summary.folder),
            "recordings": [str(path) for path in self.run.recordings],
            "samples": summary.samples,
            **si({"duration": summary.duration}, unit="s"),
            "tags": self.run.facts.get("tags", ""),
            **si({"friction_force": self._mean_friction()}),
        }

    def caveats(self) -> Sequence[str]:
        """What speaks against the record."""
        return (*self.run.caveats, *self._differences(), SIMULATED) if self.simulated else self.run.caveats

    def _differences(self) -> list[str]:
        """What the virtual rig does not do as the protocol says, and in what the protocol overrules the rig file."""
        found = []
        load, own = self.run.facts.get("normal_load"), None if self.rig is None else self.rig.normal_load
        if isinstance(load, float) and own is not None and abs(load - own) > _SAME_LOAD * own:
            set_load, of_rig = format_si(load, "N"), format_si(own, "N")
            found.append(f"the protocol sets {set_load}, and the rig file {of_rig}: the test is at {set_load}")
        applied = {str(note.facts["lubricant"]): 0 for note in self.run.notes if note.facts.get("lubricant")}
        if applied:
            found.append(f"the virtual rig knows no lubricant: with {', '.join(applied)} its friction is that without")
        return found

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file, where the friction is that of the rig."""
        return {} if self.rig is None or not self.simulated else self.rig.assumptions

    def dataset(self) -> "xr.Dataset":
        """Return the recording, where there is one."""
        return self.run.dataset().assign_attrs(self.notes()) if self.run.recordings else super().dataset()

    @property
    def is_failure(self) -> bool:
        """Whether the run ended before its protocol."""
        return self.run.summary.outcome != "completed"

    def _mean_friction(self) -> float | None:
        """Mean friction force over a recording of moderate length; None without one. [N]"""
        if not self.run.recordings or self.run.summary.samples > _MAX_SAMPLES:
            return None
        recording = self.run.dataset()
        return float(recording["friction_force"].mean()) if "friction_force" in recording else None


@answer
class DryRunAnswer(Answer):
    """What a protocol will do.

    Parameters
    ----------
    protocol : Protocol
    found : DryRun
    """

    protocol: Protocol
    found: DryRun

    def blocks(self) -> Sequence[Block]:
        """A row a set point, then time, data, drive and temperatures; what is impossible last."""
        points = [dry_run_cells(point, self.found) for point in self.found.points]
        sums = Rows(list(dry_run_sums(self.found)))
        refused = [f"  impossible: {each}" for each in self.found.refusals]
        return [self.protocol.title, Table(("",) * 4, points), sums, *refused]

    def object(self) -> dict[str, Any]:
        """Times, data and refusals."""
        return {
            "title": self.protocol.title,
            "possible": not self.found.refusals,
            "refusals": list(self.found.refusals),
            **si({"duration": self.found.duration}, unit="s"),
            "lines": dry_run_lines(self.found),
        }

    def figures(self) -> Mapping[str, Drawing]:
        """Speed, drive and temperatures over time."""
        return {"dry-run": Drawing(chart=lambda: dry_run_chart(self.found), forms=())}

    def caveats(self) -> Sequence[str]:
        """What may not hold."""
        return self.found.caveats

    def assumptions(self) -> Mapping[str, str]:
        """What drive and heat assume."""
        return self.found.assumptions


def off_text(*, is_off: bool) -> str:
    """Whether motor and drive are off, in words."""
    return "off" if is_off else "NOT confirmed off: cut the power"
