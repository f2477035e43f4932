"""The command that maps the friction reduction of a rig."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sonolube.cli.backend import Backend, BackendName, told_if_unused
from sonolube.cli.operate import Changes, Json, RigPath

if TYPE_CHECKING:
    import xarray as xr


class Kind(StrEnum):
    """What a map runs over."""

    VELOCITY_STRESS = "velocity-stress"
    VELOCITY_POWER = "velocity-power"
    FREQUENCY_VOLTAGE = "frequency-voltage"


class Form(StrEnum):
    """How a map is written."""

    PNG = "png"
    PDF = "pdf"
    SVG = "svg"
    HTML = "html"


def map(  # noqa: A001 - the command's name
    context: typer.Context,
    rig: RigPath,
    kind: Annotated[Kind, typer.Option(help="What to map friction reduction over.")] = Kind.VELOCITY_POWER,
    over: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUES",
            help="Other values of an axis, first:last:count or one,two,...: sliding.sliding_speed, contact.normal_load,"
            " drive.voltage_peak_to_peak or drive.frequency. May come again.",
        ),
    ] = None,
    measured: Annotated[
        Path | None,
        typer.Option(metavar="RUNS.csv", help="Measured runs to draw beside, and to interpolate where there are six."),
    ] = None,
    forms: Annotated[
        list[Form] | None, typer.Option("--form", help="png, pdf, svg or an interactive html; may come again.")
    ] = None,
    changes: Changes = None,
    backend: BackendName = Backend.CPU,
    out: Annotated[Path, typer.Option(help="Folder for the report map.html, figures and netCDF file.")] = Path("out"),
    json: Json = False,
) -> None:
    """Map of friction reduction: over sliding speed and stress, speed and power, or drive frequency and voltage.

    Example: sonolube map examples/rigs/power_map.toml --kind velocity-power
    """
    import json as json_module

    from sonolube.cli.design_page import asked_of, settings_of
    from sonolube.cli.map_axes import axes_of
    from sonolube.cli.map_output import map_lines, map_object, require_drawable, write_map
    from sonolube.cli.progress import progress
    from sonolube.cli.runs_table import read_runs
    from sonolube.design import MAPS
    from sonolube.rig import read_rig

    known = read_rig(rig, changes=list(changes or ()))
    axes = axes_of(known, kind.value, list(over or ()))
    runs: xr.Dataset | None = None if measured is None else read_runs(measured)
    if runs is not None:
        require_drawable(runs, kind=kind.value)
    with told_if_unused(), progress("mapping"):
        result = MAPS[kind.value](known, **axes, backend=backend.value)
        wanted = [form.value for form in forms or (Form.PNG, Form.PDF)]
        asked = [*asked_of(context, title=known.title, source=known.source), *settings_of(known)]
        name = f"{rig.stem}-{kind.value}"
        written = write_map(known, result, runs, asked=asked, folder=out, name=name, forms=wanted)
    if json:
        typer.echo(json_module.dumps(map_object(known, result, written), indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(map_lines(known, result, written)))
