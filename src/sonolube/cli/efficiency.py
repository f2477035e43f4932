"""The command that calibrates the efficiency line of one's own rig."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Changes, Json


def efficiency(
    context: typer.Context,
    runs: Annotated[Path, typer.Argument(metavar="RUNS.csv", help="Measured runs, a row to each.")],
    rig: Annotated[
        Path, typer.Option(metavar="RIG.toml", help="The rig: what the table of runs does not say is its own.")
    ],
    friction: Annotated[
        str | None, typer.Option("--target-friction", metavar="FORCE", help="Friction wanted, for its power.")
    ] = None,
    speed: Annotated[str | None, typer.Option(metavar="SPEED", help="Sliding speed of that friction.")] = None,
    level: Annotated[float, typer.Option(help="Confidence level.", min=0.5, max=0.9999)] = 0.95,
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for the report efficiency.html and its figure.")] = Path("out"),
    json: Json = False,
) -> None:
    """Efficiency line from measured runs (D 4.1 to 4.3), and the power that a friction takes.

    Example: sonolube efficiency examples/efficiency-runs.csv --rig examples/rigs/power_map.toml
    """
    import json as json_module

    from sonolube.cli.design_page import asked_of, settings_of
    from sonolube.cli.efficiency_output import calibrated, calibration_lines, calibration_object, write_calibration
    from sonolube.cli.runs_table import read_runs
    from sonolube.rig import read_rig
    from sonolube.units import to_si

    known = read_rig(rig, changes=list(changes or ()))
    found = calibrated(
        known,
        read_runs(runs),
        friction_force=None if friction is None else to_si(friction, unit="N", name="--target-friction"),
        sliding_speed=None if speed is None else to_si(speed, unit="m/s", name="--speed"),
        confidence_level=level,
    )
    asked = [*asked_of(context, title=known.title, source=known.source), *settings_of(known)]
    written = write_calibration(found, asked=asked, folder=out, name=f"{runs.stem}-efficiency")
    if json:
        typer.echo(json_module.dumps(calibration_object(found, written), indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(calibration_lines(found, written)))
