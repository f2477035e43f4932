"""Task `lab show`: a run with its facts, events, gaps and outcome, and a figure of its channels."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sonolube.laboratory.records import Run, read_run
from sonolube.report.results import recorded_runs as results
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer
from sonolube.tasks.lab.run_folders import RunFolder
from sonolube.tasks.task import task

if TYPE_CHECKING:
    from sonolube.charts import Chart
    from sonolube.report import Drawing


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
        summary, events = self.run.summary, results.event_rows(self.run)
        title = f"{summary.folder.name}: {summary.title}"
        return [title, Rows(results.run_rows(self.run)), "events", Rows(events), *results.further_events(self.run)]

    def object(self) -> dict[str, Any]:
        """Record for JSON, in SI."""
        return results.run_object(self.run)

    def caveats(self) -> Sequence[str]:
        """Caveats of the record."""
        return self.run.caveats

    def figures(self) -> "Mapping[str, Drawing]":
        """Channels over time."""
        if not self.run.recordings:
            return {}
        from sonolube.laboratory.records.channels_figure import channels_chart
        from sonolube.report import Drawing

        title = self.run.summary.title
        caption = f"{title}: the range of the samples of each channel over time."
        name = f"{self.run.folder.resolve().name}-channels"
        of_clocks = {
            f"{name}-{clock}": Drawing(
                chart=partial(_chart_of_clock, self.run, clock), caption=f"{caption[:-1]}, by the clock {clock}."
            )
            for clock in self.run.clocks
        }
        return {name: Drawing(chart=lambda: channels_chart(self.run.dataset()), caption=caption)} | of_clocks

    def dataset(self) -> Dataset:
        """Recording, where there is one."""
        return self.run.dataset().assign_attrs(self.notes()) if self.run.recordings else super().dataset()


def _chart_of_clock(run: Run, clock: str) -> "Chart":
    """Chart of the channels of another clock."""
    from sonolube.laboratory.records.channels_figure import channels_chart

    return channels_chart(run.dataset(clock=clock))


@task
def show(run: RunFolder) -> ShownRun:
    """A recorded run: facts, events, gaps, outcome, and a figure of its channels.

    Example: sonolube lab show runs/20261123T014210Z-map-test --out out
    """
    return ShownRun(run=read_run(Path(run)))
