"""Task `lab export`: the recording of a run as netCDF, TDMS or CSV."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from sonolube.laboratory.records import export_run
from sonolube.tasks.answer import Answer, Block, answer
from sonolube.tasks.lab.run_folders import RunFolder
from sonolube.tasks.parameters import OwnFolder, Parameter
from sonolube.tasks.task import task


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
