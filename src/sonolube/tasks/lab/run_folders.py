"""Tasks on recorded runs: `lab runs`, `lab show`, `lab recover` and `lab export`; arguments for folders of runs."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.laboratory.catalogue import FoundRuns, query_from, query_runs, take_in
from sonolube.laboratory.records import Recovery, Run, drop_raw_blocks, export_run, read_run, recover_run, run_folders
from sonolube.report.results import recorded_runs as results
from sonolube.rig import Rig
from sonolube.rig.file.rig_folder import RECORDS, folder_of
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, Table, answer
from sonolube.tasks.parameters import DeviceParameter, File, KeyValues, OwnFolder, Parameter
from sonolube.tasks.task import given_arguments, refuse_unused, shown, task

if TYPE_CHECKING:
    from sonolube.report import Drawing

RUNS = "runs"
"""Folder of all runs, where none is given."""

RunFolder = Annotated[str | Path, File("Folder of the run.", "RUN")]
AllRuns = Annotated[
    str | Path,
    OwnFolder("Folder of all runs; each has a new one in it. Of a rig that is a folder, its records.", "DIR"),
]
Tags = Annotated[Sequence[str], Parameter("For the catalogue; may come again.", "TAG")]
Seed = Annotated[int, Parameter("Of a virtual tribometer.", lowest=0)]
RealTime = Annotated[bool, Parameter("Let a virtual test take its time.")]
NoSelfTest = Annotated[
    bool, Parameter("Do not compare voltages that are set and measured, before the first step and at every block.")
]
Device = Annotated[str | Path, DeviceParameter("What to run on.", "virtual|MAP.toml", option="--device")]


def place_of_records(out: str | Path, rig: Rig | None) -> Path:
    """Folder of all runs of the running task: as given, else that of the records of the folder of a rig."""
    folder = None if rig is None else folder_of(rig)
    return Path(out) if folder is None or given_arguments(("out",)) else folder / RECORDS


def facts_of(given: Mapping[str, str | float]) -> dict[str, str | float]:
    """Facts with numbers in SI as numbers.

    Raises
    ------
    InvalidInput
        If a name is none.
    """
    facts: dict[str, str | float] = {}
    for name, value in given.items():
        if not name.isidentifier():
            raise InvalidInput(f"{shown('fact')} {name}={value} must be NAME=VALUE, such as normal_load=5")
        try:
            facts[name] = float(value)
        except ValueError:
            facts[name] = str(value)
    return facts


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
    given: dict[str, Sequence[str]] = {key: [value] for key, value in one.items() if value is not None}
    given |= {"material": material, "tag": tag, "text": text}
    return FoundRunsAnswer(place=place, found=query_runs(place, query_from(given)))


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
        from sonolube.laboratory.records.recorded_part import channels_chart
        from sonolube.report import Drawing

        title = self.run.summary.title
        caption = f"{title}: the range of the samples of each channel over time."
        name = f"{self.run.folder.resolve().name}-channels"
        of_clocks = {
            f"{name}-{clock}": Drawing(
                chart=lambda clock=clock: channels_chart(self.run.dataset(clock=clock)),  # type: ignore[misc]
                caption=f"{caption[:-1]}, by the clock {clock}.",
            )
            for clock in self.run.clocks
        }
        return {name: Drawing(chart=lambda: channels_chart(self.run.dataset()), caption=caption)} | of_clocks

    def dataset(self) -> Dataset:
        """Recording, where there is one."""
        return self.run.dataset().assign_attrs(self.notes()) if self.run.recordings else super().dataset()


@task
def show(run: RunFolder) -> ShownRun:
    """A recorded run: facts, events, gaps, outcome, and a figure of its channels.

    Example: sonolube lab show runs/20261123T014210Z-map-test --out out
    """
    return ShownRun(run=read_run(Path(run)))


@answer
class RecoveredRuns(Answer):
    """Runs with what was mended.

    Parameters
    ----------
    recovered : mapping of Path to Recovery
    refused : mapping of str to str
        Reasons of runs that could not be recovered, by their folders.
    """

    recovered: Mapping[Path, Recovery]
    refused: Mapping[str, str]

    def blocks(self) -> Sequence[Block]:
        """Mended records, run by run."""
        mended = {path: each for path, each in self.recovered.items() if each.done}
        lines = [f"{len(mended)} of {len(self.recovered)} runs recovered"]
        for path, each in mended.items():
            summary = each.summary
            lines.append(f"  {path.name}: {summary.outcome}, {summary.samples} samples")
            lines += [f"    {line}" for line in each.done]
        return lines

    def object(self) -> dict[str, Any]:
        """Runs for JSON."""
        return {
            "runs": [
                {
                    "folder": str(path),
                    "outcome": each.summary.outcome,
                    "samples": each.summary.samples,
                    "done": list(each.done),
                }
                for path, each in self.recovered.items()
            ]
        }

    def refusals(self) -> Mapping[str, str]:
        """Reasons of runs that are at work or cannot be written."""
        return self.refused


@task
def recover(
    folder: Annotated[str | Path, OwnFolder("A run, or a folder of runs.", "DIR")],
    *,
    drop_blocks: Annotated[bool, Parameter("Remove raw blocks whose every sample was found in the recording.")] = False,
) -> RecoveredRuns:
    """Complete the records of runs whose program was killed; what was damaged is kept aside.

    Example: sonolube lab recover runs
    """
    recovered, refused = {}, {}
    for each in run_folders(Path(folder)) or [Path(folder)]:  # a run itself, or refused as none
        try:
            found = recover_run(each)
            dropped = drop_raw_blocks(each) if drop_blocks else ()
            recovered[each] = replace(found, done=(*found.done, *dropped))
        except SonolubeError as failure:
            refused[str(each)] = str(failure)
    if not recovered:
        raise InvalidInput(next(iter(refused.values())))
    return RecoveredRuns(recovered=recovered, refused=refused)


@answer
class ExportedRecording(Answer):
    """Files that were written.

    Parameters
    ----------
    paths : sequence of Path
        One a part.
    """

    paths: Sequence[Path]

    def blocks(self) -> Sequence[Block]:
        """Number of files."""
        return [f"{len(self.paths)} parts of the recording" if len(self.paths) > 1 else "the recording"]

    def object(self) -> dict[str, Any]:
        """Number of the parts."""
        return {"parts": len(self.paths)}

    def files(self) -> Mapping[str, Path]:
        """Files that exist already."""
        return {path.name: path for path in self.paths}


@task
def export(
    run: RunFolder,
    *,
    file_format: Annotated[Literal["netcdf", "tdms", "csv"], Parameter("Of the files.", option="--format")] = "netcdf",
    out: Annotated[str | Path, OwnFolder("Folder for the files.")] = "out",
) -> ExportedRecording:
    """Write the recording of a run to files for other programs, one a part.

    Example: sonolube lab export runs/20261123T014210Z-map-test --format tdms --out out
    """
    return ExportedRecording(paths=export_run(Path(run), file_format=file_format, out=Path(out)))
