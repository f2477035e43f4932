"""The command that runs a rig over any of its parameters."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sonolube.cli.backend import Backend, BackendName, told_if_unused
from sonolube.cli.operate import Changes, Json, RigPath

if TYPE_CHECKING:
    from sonolube.design import SweepPlan


class Sample(StrEnum):
    """How points are chosen."""

    GRID = "grid"
    LHS = "lhs"
    LIST = "list"


def sweep(
    context: typer.Context,
    rig: RigPath,
    over: Annotated[
        list[str],
        typer.Option(
            metavar="KEY=VALUES",
            help="A key of the file with its values: first:last:count, first:last:count:log or one,two,...;"
            " first:last alone for --sample lhs. May come again.",
        ),
    ],
    sample: Annotated[
        Sample, typer.Option(help="Every value with every other, points drawn by Latin hypercube, or row by row.")
    ] = Sample.GRID,
    points: Annotated[int | None, typer.Option(help="How many points to draw.", min=1)] = None,
    seed: Annotated[int, typer.Option(help="Of the points drawn.", min=0)] = 0,
    workers: Annotated[int, typer.Option(help="Threads, or processes of a local cluster.", min=1)] = 2,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler to work on, or local for processes here.")
    ] = None,
    chunk: Annotated[int, typer.Option(help="Points computed and kept together.", min=1)] = 100_000,
    backend: BackendName = Backend.CPU,
    changes: Changes = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for report, figure, netCDF file and chunks, where a run that was broken off goes on;"
            " one of its own in out where absent."
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Sweep: the rig over any of its parameters, with a status for each point; goes on where it was broken off.

    Example: sonolube sweep examples/rigs/tribometer.toml --over drive.voltage_peak_to_peak=2V:28V:27
    """
    import json as json_module

    from sonolube.cli.progress import progress
    from sonolube.cli.sweep_output import sweep_lines, sweep_object, write_sweep
    from sonolube.design import sweep as swept
    from sonolube.dynamics.backend import usable_backend

    plan = _plan(rig, over, sample, points, seed, list(changes or ()))
    with told_if_unused():
        chosen = usable_backend(backend.value)
    folder = out or Path("out") / f"{rig.stem}-sweep-{plan.digest[:8]}{'-gpu' if chosen == 'gpu' else ''}"
    with told_if_unused(), progress("sweeping") as advance:
        result = swept(
            plan,
            folder=folder,
            chunk_points=chunk,
            workers=workers,
            scheduler=scheduler,
            advance=lambda done, total: advance("points", done, total),
            backend=chosen,
        )
    told = sweep_object(plan, result)
    written = write_sweep(context, plan, result, told, folder=folder)
    told["files"] = [str(path) for path in (*written, folder / "sweep.nc")]
    typer.echo(json_module.dumps(told, indent=2, allow_nan=False) if json else "\n".join(sweep_lines(told)))


def _plan(rig: Path, over: list[str], sample: Sample, points: int | None, seed: int, changes: list[str]) -> "SweepPlan":
    from sonolube.cli.sweep_range import ends_of, values_of
    from sonolube.design import grid_plan, latin_hypercube_plan, list_plan
    from sonolube.errors import InvalidInput

    if sample is Sample.LHS:
        if points is None:
            raise InvalidInput("--sample lhs needs --points, how many to draw")
        return latin_hypercube_plan(rig, over=ends_of(over), points=points, seed=seed, changes=changes)
    if points is not None:
        raise InvalidInput(f"--points has no meaning for --sample {sample}; it is for lhs")
    return (grid_plan if sample is Sample.GRID else list_plan)(rig, over=values_of(over), changes=changes)
