"""Commands on how a rig moves: its response to small voltages, and its start from rest."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Changes, Json, RigPath


def response(
    rig: RigPath,
    lowest: Annotated[str, typer.Option("--from", metavar="FREQUENCY", help="Lowest frequency.")] = "1kHz",
    highest: Annotated[str, typer.Option("--to", metavar="FREQUENCY", help="Highest frequency.")] = "100kHz",
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for the figure and the netCDF file.")] = Path("out"),
    json: Json = False,
) -> None:
    """Linear response: tip amplitude per volt and electrical impedance over frequency.

    Example: sonolube response examples/rigs/tribometer.toml --from 15kHz --to 35kHz
    """
    import json as json_module

    from sonolube.cli.response_output import response_lines, response_object, write_response
    from sonolube.errors import InvalidInput
    from sonolube.rig import frequency_grid, frequency_response, read_rig
    from sonolube.units import to_si

    low, high = (to_si(text, unit="Hz", name=name) for text, name in ((lowest, "--from"), (highest, "--to")))
    if not 0 < low < high:
        raise InvalidInput(f"--from {lowest} must lie above 0 Hz and below --to {highest}")
    known = read_rig(rig, changes=list(changes or ()))
    result = frequency_response(known, frequency=frequency_grid(known, lowest=low, highest=high))
    written = write_response(known, result, folder=out, name=f"{rig.stem}-response")
    if json:
        typer.echo(json_module.dumps(response_object(known, result, written), indent=2))
    else:
        typer.echo("\n".join(response_lines(known, result, written)))


def transient(
    rig: RigPath,
    lasting: Annotated[str, typer.Option("--duration", metavar="TIME", help="How long to follow the rig.")] = "0.1s",
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for the figure and the netCDF file.")] = Path("out"),
    json: Json = False,
) -> None:
    """Start-up from rest: settling of the tip's vibration, step by step.

    Example: sonolube transient examples/rigs/tribometer.toml --duration 0.06s
    """
    import json as json_module

    from sonolube.cli.progress import progress
    from sonolube.cli.transient_output import start_up_lines, start_up_object, write_start_up
    from sonolube.rig import read_rig, start_up
    from sonolube.units import to_si

    seconds = to_si(lasting, unit="s", name="--duration")
    known = read_rig(rig, changes=list(changes or ()))
    with progress("marching"):
        result = start_up(known, duration=seconds)
        written = write_start_up(known, result, folder=out, name=f"{rig.stem}-transient")
    if json:
        typer.echo(json_module.dumps(start_up_object(known, result, written), indent=2))
    else:
        typer.echo("\n".join(start_up_lines(known, result, written)))
