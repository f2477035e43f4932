"""Commands that find a model's parameters from what is known of it outside."""

from pathlib import Path
from typing import Annotated

import typer

identify = typer.Typer(no_args_is_help=True, help="Find the parameters of a model from what is known of it outside.")


@identify.command("rig")
def identify_rig(
    base: Annotated[
        Path | None, typer.Argument(metavar="[RIG.toml]", help="Rig whose tables stack and structure to replace.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="File to write; standard output where absent.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of the search, which is the same for the same seed.", min=0)] = 0,
) -> None:
    """Masses, springs and dampers of the tribometer from the published facts, ranked, with what cannot hold together.

    Example: sonolube identify rig examples/rigs/tribometer.toml --out my-tribometer.toml
    """
    from sonolube.cli.progress import progress
    from sonolube.files import write_atomically
    from sonolube.identification import rig_tables
    from sonolube.rig import read_rig, with_tables
    from sonolube.validation.tribometer import tribometer_identification, tribometer_stack

    if base is not None:
        read_rig(base)
    with progress("identifying"):
        tables = rig_tables(tribometer_identification(seed=seed), tribometer_stack())
    text = tables if base is None else with_tables(base.read_text(encoding="utf-8-sig"), tables)
    if out is None:
        typer.echo(text, nl=False)
    else:
        typer.echo(str(write_atomically(out, text)))
