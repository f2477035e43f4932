"""The command that measures surfaces."""

from typing import Annotated

import typer

from sonolube.cli.measuring import Files, Report, Test, answer, each_file, quantity
from sonolube.cli.operate import Json

Spacing = Annotated[
    str | None,
    typer.Option("--spacing", metavar="LENGTH", help="Distance of pixels, for files that do not say; one or 'x,y'."),
]
Unit = Annotated[
    str | None,
    typer.Option("--length-unit", metavar="UNIT", help="For files that do not say, such as um."),
]


def surface(
    files: Files,
    pixel: Spacing = None,
    unit: Unit = None,
    form: Annotated[int, typer.Option(help="Degree of the form to take off: 1 tilt, 2 curvature.", min=0, max=12)] = 1,
    robust: Annotated[bool, typer.Option("--robust", help="Let pixels far from the form lose their weight.")] = False,
    short: Annotated[
        str | None, typer.Option("--short-cutoff", metavar="LENGTH", help="Take off shorter waves, as noise.")
    ] = None,
    long: Annotated[
        str | None, typer.Option("--long-cutoff", metavar="LENGTH", help="Take off longer waves, as waviness.")
    ] = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Surfaces: parameters of ISO 25178-2 and of profiles, spectra, and summits for the contact models.

    Example: sonolube measure surface plate.opd --long-cutoff 25um --report plate.html
    """
    from functools import partial

    from sonolube.report.measured.surface import SurfaceSettings, surface_sheet

    step_x, step_y = spacings(pixel)
    settings = SurfaceSettings(
        spacing_x=step_x,
        spacing_y=step_y,
        length_unit=unit,
        degree=form,
        robust=robust,
        short_cutoff_length=quantity(short, unit="m", option="--short-cutoff"),
        long_cutoff_length=quantity(long, unit="m", option="--long-cutoff"),
    )
    sheets, refused = each_file(files, partial(surface_sheet, settings=settings), what="measuring")
    used = {
        "spacing": pixel,
        "length unit": unit,
        "form": f"degree {form}{', robust' if robust else ''}",
        "short cutoff": short,
        "long cutoff": long,
    }
    answer("surfaces", sheets, refused, settings=used, page=report, test=test, as_json=json)


def spacings(text: str | None) -> tuple[float | None, float | None]:
    """Return the distances of columns and rows that an option gives, such as 0.5um or 0.5um,0.6um."""
    if text is None:
        return None, None
    first, _, second = text.partition(",")
    along = quantity(first, unit="m", option="--spacing")
    return along, quantity(second, unit="m", option="--spacing") if second else along
