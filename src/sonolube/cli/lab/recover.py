"""Command `lab recover`: records of killed runs completed."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver
from sonolube.cli.console.options import Json
from sonolube.cli.console.outputs import ContinuedFolder
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.laboratory.records import Recovery, recover_run, run_folders
from sonolube.printable_text import printable


def recover(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A run, or a folder of runs."), ContinuedFolder()],
    json: Json = False,
) -> None:
    """Complete the records of runs whose program was killed; what was damaged is kept aside.

    Example: sonolube lab recover runs
    """
    folders = run_folders(folder)
    if not folders:
        folders = [folder]  # a run, or refused as none
    recovered, refused = {}, []
    for each in folders:
        try:
            recovered[each] = recover_run(each)
        except SonolubeError as failure:
            refused.append(str(failure))
    if not recovered:
        raise InvalidInput(refused[0])
    deliver(RecoveredRuns(recovered=recovered), as_json=json)
    for reason in refused:
        typer.echo(printable(f"sonolube lab: {reason}"), err=True)
    if refused:
        raise typer.Exit(1)


@dataclass(frozen=True, kw_only=True)
class RecoveredRuns(Answer):
    """Runs with what was mended."""

    recovered: Mapping[Path, Recovery]

    def lines(self) -> list[str]:
        """What was mended, run by run."""
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
