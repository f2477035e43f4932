"""Command `measure surface`: areal and profile parameters, spectra and summits of height maps."""

from functools import partial
from typing import Annotated

import typer

from sonolube.cli.console.options import Json, si_option
from sonolube.cli.measure.measured_files import Files, Report, Test, deliver_sheets, each_file
from sonolube.report.measured.surface import SurfaceSettings, spacings, surface_sheet

Spacing = Annotated[
    str | None,
    typer.Option("--spacing", metavar="LENGTH", help="Distance of pixels, for files that lack it; one or 'x,y'."),
]
Unit = Annotated[str | None, typer.Option("--length-unit", metavar="UNIT", help="For files that lack it, such as um.")]


def surface(
    context: typer.Context,
    files: Files,
    pixel: Spacing = None,
    unit: Unit = None,
    form: Annotated[
        int, typer.Option(help="Degree of the form that is removed: 1 tilt, 2 curvature.", min=0, max=12)
    ] = 1,
    robust: Annotated[bool, typer.Option("--robust", help="Weight pixels far from the form less.")] = False,
    short: Annotated[float | None, si_option("m", "Remove shorter waves, as noise.", "--short-cutoff")] = None,
    long: Annotated[float | None, si_option("m", "Remove longer waves, as waviness.", "--long-cutoff")] = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Surfaces: parameters of ISO 25178-2 and of profiles, spectra, and summits for the contact models.

    Example: sonolube measure surface plate.opd --long-cutoff 25um --report plate.html
    """
    spacing_x, spacing_y = spacings(pixel, name="--spacing")
    settings = SurfaceSettings(
        spacing_x=spacing_x,
        spacing_y=spacing_y,
        length_unit=unit,
        degree=form,
        robust=robust,
        short_cutoff_length=short,
        long_cutoff_length=long,
    )
    sheets, refused = each_file(files, partial(surface_sheet, settings=settings), title="measuring")
    deliver_sheets(context, "surfaces", sheets, refused, page=report, test=test, as_json=json)
