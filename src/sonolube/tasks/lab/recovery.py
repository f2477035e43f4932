"""Task `lab recover`: records of killed runs completed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.laboratory.records import Recovery, drop_raw_blocks, recover_run, run_folders
from sonolube.tasks.answer import Answer, Block, answer
from sonolube.tasks.parameters import OwnFolder, Parameter
from sonolube.tasks.task import task


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
