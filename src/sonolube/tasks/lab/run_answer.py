"""Answers of runs of protocols: how a run ended and where its record is, or what a dry run says of it."""

from collections.abc import Mapping, Sequence
from typing import Any

from sonolube.facts.protocol import Protocol
from sonolube.laboratory import RunResult
from sonolube.laboratory.dry_run import DryRun, dry_run_chart
from sonolube.laboratory.records import Run
from sonolube.report import Drawing
from sonolube.report.results import ended_run as results
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Dataset, answer


@answer
class RunAnswer(Answer):
    """Outcome of a run, and the place of its record.

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
        return results.run_blocks(self.result, self.run, simulated=self.simulated)

    def object(self) -> dict[str, Any]:
        """Outcome, folder and recordings."""
        return results.run_object(self.result, self.run, simulated=self.simulated)

    def caveats(self) -> Sequence[str]:
        """Caveats of the record."""
        return results.run_caveats(self.run, self.rig) if self.simulated else self.run.caveats

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file, where the friction is that of the rig."""
        return {} if self.rig is None or not self.simulated else self.rig.assumptions

    def dataset(self) -> Dataset:
        """Recording, where there is one."""
        return self.run.dataset().assign_attrs(self.notes()) if self.run.recordings else super().dataset()

    @property
    def is_failure(self) -> bool:
        """Whether the run ended before its protocol."""
        return self.run.summary.outcome != "completed"


@answer
class DryRunAnswer(Answer):
    """Planned course of a protocol.

    Parameters
    ----------
    protocol : Protocol
    found : DryRun
    """

    protocol: Protocol
    found: DryRun

    def blocks(self) -> Sequence[Block]:
        """A row a set point, then time, data, drive and temperatures; what is impossible last."""
        return results.dry_run_blocks(self.protocol, self.found)

    def object(self) -> dict[str, Any]:
        """Times, data and refusals."""
        return results.dry_run_object(self.protocol, self.found)

    def figures(self) -> Mapping[str, Drawing]:
        """Speed, drive and temperatures over time."""
        return {"dry-run": Drawing(chart=lambda: dry_run_chart(self.found), forms=())}

    def caveats(self) -> Sequence[str]:
        """Caveats of the plan."""
        return self.found.caveats

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions about drive and heat."""
        return self.found.assumptions
