"""Command `lab virtual`: a protocol on the virtual tribometer of a rig, as `lab run --device virtual`."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import Json
from sonolube.cli.lab.run import RUNS
from sonolube.cli.lab.running import RunPlan, exit_as, run_and_record, virtual_rig
from sonolube.errors import UnknownName
from sonolube.facts.protocol import protocol_by_name_or_file
from sonolube.laboratory.records import EXPORT_FORMATS, export_run
from sonolube.rig import read_rig


def virtual(
    rig: Annotated[Path, typer.Argument(metavar="RIG.toml", help="The rig, whose friction is taken.")],
    protocol: Annotated[str, typer.Option(metavar="PROTOCOL", help="Such as study_1, or a TOML file.")] = "map_test",
    seed: Annotated[int, typer.Option(help="Of all that is drawn: another specimen, other noise.", min=0)] = 0,
    file_format: Annotated[
        str, typer.Option("--format", metavar="netcdf|tdms|csv", help="Of the recording, beside netCDF.")
    ] = "netcdf",
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of all runs; each has a new one in it.")] = RUNS,
    json: Json = False,
) -> None:
    """Record a realistic test of a rig that exists in its file only.

    Example: sonolube lab virtual examples/rigs/power_map.toml --protocol map_test
    """
    if file_format not in EXPORT_FORMATS:
        raise UnknownName.among(EXPORT_FORMATS, kind="format", name=file_format)
    plan = RunPlan(
        protocol=protocol_by_name_or_file(protocol),
        name=Path(protocol).stem,
        rig=read_rig(rig),
        rig_file=rig,
        seed=seed,
    )
    made = virtual_rig(plan)
    answer = run_and_record(plan, made.devices, out=out, virtual=made)
    if file_format != "netcdf":
        export_run(answer.run.folder, file_format=file_format, out=answer.run.folder)
    deliver(answer, as_json=json)
    exit_as(answer)
