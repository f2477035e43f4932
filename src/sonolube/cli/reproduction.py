"""The command that reproduces the dissertation."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Json


def reproduce(
    chapter: Annotated[int | None, typer.Option(help="Only this chapter: 2, 3 or 4.", min=2, max=4)] = None,
    out: Annotated[Path, typer.Option(help="Folder for the report, its figures and validation.json.")] = Path("out"),
    json: Json = False,
) -> None:
    """Every published number beside the one computed, as a report with figures.

    Example: sonolube reproduce --chapter 3 --out out
    """
    import json as json_module

    from sonolube.cli.progress import progress
    from sonolube.report import summary, validation_object, write_report
    from sonolube.reproduce import reproduction

    with progress("reproducing") as advance:
        result = reproduction(chapter=chapter)
        written = write_report(result, folder=out, advance=advance)
    typer.echo(json_module.dumps(validation_object(result), indent=2) if json else summary(result, written=written))
