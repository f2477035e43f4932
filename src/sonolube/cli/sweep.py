"""The command that runs a rig over any of its parameters."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sonolube.cli.operate import Changes, Json, RigPath

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.design import SweepPlan

_TOLD = ("friction_ratio", "vibration_amplitude", "actuator_power", "dissipated_power")


class Sample(StrEnum):
    """How points are chosen."""

    GRID = "grid"
    LHS = "lhs"
    LIST = "list"


def sweep(
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
    changes: Changes = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the chunks and the netCDF file, where a run that was broken off goes on;"
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
    from sonolube.design import sweep as swept

    plan = _plan(rig, over, sample, points, seed, list(changes or ()))
    folder = out or Path("out") / f"{rig.stem}-sweep-{plan.digest[:8]}"
    with progress("sweeping") as advance:
        result = swept(
            plan,
            folder=folder,
            chunk_points=chunk,
            workers=workers,
            scheduler=scheduler,
            advance=lambda done, total: advance("points", done, total),
        )
    told = _summary(plan, result, folder / "sweep.nc")
    typer.echo(json_module.dumps(told, indent=2, allow_nan=False) if json else "\n".join(_lines(told)))


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


def _summary(plan: "SweepPlan", result: "xr.Dataset", path: Path) -> dict[str, Any]:
    import numpy as np

    from sonolube.vocabulary import quantity

    ratio = result["friction_ratio"].values.ravel()
    names = result["status"].attrs["flag_meanings"].split()
    codes, counts = np.unique(result["status"].values, return_counts=True)
    failed = np.isnan(ratio)
    reasons, failures = np.unique(result["reason"].values.ravel()[failed], return_counts=True)
    least = {}
    if not failed.all():
        place = int(np.nanargmin(ratio))
        settings = {key: array[0] for key, array in plan.rows(place, place + 1).items()}
        least = {key: value.item() for key, value in settings.items()}
        least |= {name: _number(result[name].values.ravel()[place], quantity(name).unit) for name in _TOLD}
    return {
        "rig": result.attrs["rig"],
        "points": int(ratio.size),
        "statuses": {names[code]: int(count) for code, count in zip(codes, counts, strict=True)},
        "without_result": [
            {"reason": str(result["reason_text"].values[code]), "points": int(count)}
            for code, count in zip(reasons, failures, strict=True)
        ],
        "least_friction": least,
        "files": [str(path)],
    }


def _number(value: float, unit: str) -> dict[str, Any]:
    return {"value": float(value), "unit": unit}


def _lines(told: dict[str, Any]) -> list[str]:
    from sonolube.units import engineering
    from sonolube.vocabulary import quantities

    lines = [f"{told['rig']}, {told['points']} points"]
    lines += [f"  {name:<14} {count}" for name, count in told["statuses"].items()]
    lines += [f"  without result: {row['points']}: {row['reason']}" for row in told["without_result"]]
    if told["least_friction"]:
        lines.append("  least friction")
    for key, value in told["least_friction"].items():
        if isinstance(value, dict):
            text = engineering(value["value"], value["unit"])
        elif isinstance(value, str):
            text = value
        else:
            known = quantities().get(key.rpartition(".")[2])
            text = engineering(value, known.unit if known else "")
        lines.append(f"    {key:<28} {text}")
    return [*lines, *[f"  {path}" for path in told["files"]]]
