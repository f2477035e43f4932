"""The command that sets models of friction under vibration against experiment, and against each other on a rig."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Changes, Json


def compare(
    rig: Annotated[
        Path | None, typer.Argument(metavar="[RIG.toml]", help="A rig that every applicable model predicts too.")
    ] = None,
    models: Annotated[
        list[str] | None, typer.Option("--model", metavar="NAME", help="Only this model; may come again.")
    ] = None,
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for figures, table and netCDF file.")] = Path("out"),
    json: Json = False,
) -> None:
    """Models of friction under vibration against every published test: fitted, cross-validated, and on your rig.

    Example: sonolube compare examples/rigs/tribometer.toml --model stick-slip --model kinematic
    """
    import json as json_module

    from sonolube.cli.comparison_output import comparison_lines, comparison_object, write_comparison
    from sonolube.cli.progress import progress
    from sonolube.errors import InvalidInput
    from sonolube.rig import read_rig
    from sonolube.validation.compare import compare_models, predict_rig
    from sonolube.validation.models import compared_models
    from sonolube.validation.rig import vibrated_rig

    if rig is None and changes:
        raise InvalidInput("--set changes a rig: name one, such as examples/rigs/tribometer.toml")
    known = None if rig is None else read_rig(rig, changes=list(changes or ()))
    point = None if known is None else vibrated_rig(known)
    with progress("comparing") as advance:
        fits = compare_models(compared_models(models or ()), advance=advance)
        predictions = None if point is None else predict_rig(fits, point)
        written = write_comparison(fits, known, predictions, folder=out)
    if json:
        told = comparison_object(fits, known, predictions, written)
        typer.echo(json_module.dumps(told, indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(comparison_lines(fits, known, predictions, written)))
