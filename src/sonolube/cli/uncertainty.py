"""The command that carries a rig's uncertainty through its models."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sonolube.cli.operate import Changes, Json, RigPath

if TYPE_CHECKING:
    from sonolube.checks import Floats
    from sonolube.cli.uncertainty_output import Identified


def uncertainty(
    context: typer.Context,
    rig: RigPath,
    of: Annotated[
        str, typer.Option(metavar="QUANTITY", help="What is wanted, such as vibration_amplitude or wear_rate_ratio.")
    ] = "friction_ratio",
    samples: Annotated[
        int, typer.Option(help="How many, up to the next power of two; with --sobol of each block.", min=32)
    ] = 1024,
    sobol: Annotated[
        bool, typer.Option("--sobol", help="Rank the entries by what each brings to the variance, by Sobol's indices.")
    ] = False,
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUES",
            help="A band over a key, first:last:count or one,two,...; given twice, a map of median and interval.",
        ),
    ] = None,
    identified: Annotated[
        bool,
        typer.Option("--identified", help="Draw the tribometer's masses, springs and dampers from what facts leave."),
    ] = False,
    seed: Annotated[int, typer.Option(help="Of the samples.", min=0)] = 0,
    workers: Annotated[int, typer.Option(help="Threads.", min=1)] = 2,
    changes: Changes = None,
    keep: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Keep parts here, where a run that was broken off goes on.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for uncertainty.html, figures and netCDF file.")] = Path("out"),
    json: Json = False,
) -> None:
    """Uncertainty of an outcome from the distributions in the rig's file, and which entry to measure better.

    Example: sonolube uncertainty examples/rigs/tribometer_uncertain.toml --samples 256
    """
    import json as json_module

    from sonolube.cli.design_page import asked_of, settings_of
    from sonolube.cli.progress import progress
    from sonolube.cli.uncertainty_output import uncertainty_lines, uncertainty_object, write_uncertainty
    from sonolube.design import propagate
    from sonolube.errors import InvalidInput
    from sonolube.rig import read_rig

    if sobol and (over or identified):
        raise InvalidInput("--sobol needs independent entries and one outcome each: leave out --over and --identified")
    known = read_rig(rig, changes=list(changes or ()))
    grid = _axes(list(over or ()))
    with progress("uncertainty") as advance:
        drawn = _identified(rig, seed, lambda done, total: advance("facts", done, total)) if identified else None
        result = propagate(
            rig,
            outcome=of,
            samples=samples,
            indices=sobol,
            over=grid,
            joint_samples=None if drawn is None else drawn.draws_by_key(),
            seed=seed,
            changes=list(changes or ()),
            folder=keep,
            workers=workers,
            advance=lambda done, total: advance("points", done, total),
        )
        asked = [*asked_of(context, title=known.title, source=known.source), *settings_of(known)]
        name = f"{rig.stem}-uncertainty-{of}"
        written = write_uncertainty(known, result, drawn, asked=asked, folder=out, name=name)
    if json:
        typer.echo(json_module.dumps(uncertainty_object(known, result, drawn, written), indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(uncertainty_lines(known, result, drawn, written)))


def _axes(over: list[str]) -> "dict[str, Floats]":
    """Return what a band or a map runs over."""
    import numpy as np

    from sonolube.cli.sweep_range import values_of
    from sonolube.errors import InvalidInput

    if len(over) > 2:
        raise InvalidInput(f"--over gives a band once and a map twice, not {len(over)} times")
    axes = {}
    for key, values in values_of(over).items():
        if values.dtype.kind == "U":
            raise InvalidInput(f"--over {key}: a band needs numbers to run over, not words")
        axes[key] = values.astype(np.float64)
        if values.size < 2 or np.any(np.diff(axes[key]) <= 0):
            raise InvalidInput(f"--over {key}: a band needs at least 2 values that rise")
    return axes


def _identified(path: Path, seed: int, advance: Callable[[int, int], None]) -> "Identified":
    """Return the tribometer's parameters as the facts that hold together leave them."""
    from dataclasses import astuple

    from sonolube.cli.uncertainty_output import Identified
    from sonolube.errors import InvalidInput
    from sonolube.identification import pin_on_disc_model, posterior
    from sonolube.rig import read_rig
    from sonolube.validation.tribometer import (
        BOUNDS,
        tribometer_identification,
        tribometer_stack,
        tribometer_test,
    )

    stack = read_rig(path).stack
    if stack is None or not all(
        own == its or (own and its and abs(own / its - 1) < 0.01)
        for own, its in zip(astuple(stack)[:5], astuple(tribometer_stack())[:5], strict=True)
    ):
        raise InvalidInput(f"{path}: --identified needs the tribometer's stack, which the facts are of")
    found = tribometer_identification(seed=seed)
    believed = [fact for fact in found.facts if fact.name in found.satisfied]
    drawn = posterior(pin_on_disc_model(tribometer_test()), facts=believed, bounds=BOUNDS, seed=seed, advance=advance)
    return Identified(posterior=drawn, unidentifiable_directions=found.unidentifiable_directions)
