"""The command on what one parameter of a rig does to its friction."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Changes, Json, RigPath


class Parameter(StrEnum):
    """What a study varies."""

    VOLTAGE = "voltage"
    SPEED = "speed"
    FREQUENCY = "frequency"
    POWER = "power"
    WAVEFORM = "waveform"
    LOAD = "load"


def study(
    rig: RigPath,
    of: Annotated[Parameter, typer.Option(help="What to vary.")],
    lowest: Annotated[str | None, typer.Option("--from", metavar="QUANTITY", help="Lowest value.")] = None,
    highest: Annotated[str | None, typer.Option("--to", metavar="QUANTITY", help="Highest value.")] = None,
    points: Annotated[int | None, typer.Option(help="How many values, both ends included.", min=2, max=10_000)] = None,
    voltages: Annotated[
        list[str] | None,
        typer.Option("--voltage", help="Drive, peak to peak, of one curve over speed or frequency; may come again."),
    ] = None,
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for the figure and the netCDF file.")] = Path("out"),
    json: Json = False,
) -> None:
    """Parametric study: friction over voltage, speed, frequency, waveform or load, or the power it takes.

    Example: sonolube study examples/rigs/tribometer.toml --of voltage --to 200V
    """
    import json as json_module

    from sonolube.cli.progress import progress
    from sonolube.cli.study_output import study_lines, study_object, write_study
    from sonolube.cli.study_range import study_of
    from sonolube.rig import read_rig

    known = read_rig(rig, changes=list(changes or ()))
    run = study_of(known, of=of.value, lowest=lowest, highest=highest, points=points, voltages=voltages)
    with progress("studying") as advance:
        result = run(advance=lambda done, total: advance(of.value, done, total))
        written = write_study(result, of.value, folder=out, name=f"{rig.stem}-{of.value}")
    if json:
        typer.echo(json_module.dumps(study_object(known, of.value, result, written), indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(study_lines(known, of.value, result, written)))
