"""Command `lab export`: the recording of a run as netCDF, TDMS or CSV."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver
from sonolube.cli.console.options import OUT, Json
from sonolube.cli.console.outputs import OutputFolder
from sonolube.laboratory.records import export_run


class ExportFormat(StrEnum):
    """Formats of an export."""

    NETCDF = "netcdf"
    TDMS = "tdms"
    CSV = "csv"


def export(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of the run.")],
    file_format: Annotated[
        ExportFormat, typer.Option("--format", metavar="netcdf|tdms|csv", help="Of the files.")
    ] = ExportFormat.NETCDF,
    out: Annotated[Path, typer.Option(help="Folder for the files."), OutputFolder("{run}.* {run}-*")] = OUT,
    json: Json = False,
) -> None:
    """Write the recording of a run to files for other programs, one a part.

    Example: sonolube lab export runs/20261123T014210Z-map-test --format tdms --out out
    """
    deliver(Exported(paths=export_run(run, file_format=file_format.value, out=out)), folder=out, as_json=json)


@dataclass(frozen=True, kw_only=True)
class Exported(Answer):
    """Files that were written."""

    paths: list[Path]

    def lines(self) -> list[str]:
        """How many files."""
        return [f"{len(self.paths)} parts of the recording" if len(self.paths) > 1 else "the recording"]

    def object(self) -> dict[str, Any]:
        """Number of the parts."""
        return {"parts": len(self.paths)}

    def files(self) -> Mapping[str, Path]:
        """Files that exist already."""
        return {path.name: path for path in self.paths}
