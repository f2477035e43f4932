"""Task `lab runs`: recorded runs by material, load, speed, date, tag and text."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from sonolube.laboratory.catalogue import FoundRuns, query_from, query_runs, take_in
from sonolube.report.results import recorded_runs as results
from sonolube.tasks.answer import Answer, Block, Dataset, Table, answer
from sonolube.tasks.lab.run_folders import RUNS, facts_of
from sonolube.tasks.parameters import File, KeyValues, Parameter
from sonolube.tasks.task import refuse_unused, shown, task


@answer
class FoundRunsAnswer(Answer):
    """Runs that were found, a row each.

    Parameters
    ----------
    place : Path
        Folder of all runs.
    found : FoundRuns
    """

    place: Path
    found: FoundRuns

    def blocks(self) -> Sequence[Block]:
        """Table of the runs."""
        entries = self.found.entries
        head = f"{len(entries)} of {self.found.of} runs in {self.place}"
        return [head, Table(results.FOUND_HEADS, list(map(results.found_row, entries)))] if entries else [head]

    def object(self) -> dict[str, Any]:
        """Runs with all that is known of them, in SI."""
        return {"runs": list(map(results.found_object, self.found.entries)), "of": self.found.of}

    def caveats(self) -> Sequence[str]:
        """Runs that cannot be read, and what was done to the index."""
        return self.found.caveats

    def dataset(self) -> Dataset:
        """Runs, over `run` by the names of their folders."""
        return results.found_runs_dataset(self.found.entries).assign_attrs(self.notes())


@task
def runs(
    folder: Annotated[str | Path, File("Folder of runs.", "DIR")] = RUNS,
    *,
    material: Annotated[Sequence[str], Parameter("Of pin or disc; may come again.", "NAME")] = (),
    load: Annotated[str | None, Parameter("Normal load: 5N, 3N..6N, or 3N.. and up.", "FORCE")] = None,
    speed: Annotated[str | None, Parameter("Sliding speed, such as 10mm/s..30mm/s.", "SPEED")] = None,
    since: Annotated[str | None, Parameter("Begun then or later, such as 2026-01-31.", "DATE")] = None,
    until: Annotated[str | None, Parameter("Begun before.", "DATE")] = None,
    tag: Annotated[Sequence[str], Parameter("Among the tags of the run; may come again.", "TAG")] = (),
    text: Annotated[Sequence[str], Parameter("In title, facts, protocol or notes.", "TEXT")] = (),
    outcome: Annotated[str | None, Parameter("completed, stopped, failed, interrupted or running.", "OUTCOME")] = None,
    add: Annotated[Sequence[str | Path], File("Take in a recording or a folder of them.", "PATH")] = (),
    fact: Annotated[
        Mapping[str, str | float] | None,
        KeyValues("Of what is taken in, such as normal_load=5; tags=map,old.", "NAME=VALUE"),
    ] = None,
) -> FoundRunsAnswer:
    """Runs that were recorded, with what they are found by.

    Example: sonolube lab runs runs --material brass --load 3N..6N --since 2026-01-01
    """
    place = Path(folder)
    if not add:
        refuse_unused("fact", because=f"without {shown('add')}, whose recordings it describes")
    facts = facts_of(fact or {})
    for source in add:
        take_in(place, Path(source), facts=facts)
    one = {"load": load, "speed": speed, "since": since, "until": until, "outcome": outcome}
    several = {"material": material, "tag": tag, "text": text}
    given: dict[str, Sequence[str]] = {key: [value] for key, value in one.items() if value is not None}
    given |= {key: list(values) for key, values in several.items() if values}
    return FoundRunsAnswer(place=place, found=query_runs(place, query_from(given)))
