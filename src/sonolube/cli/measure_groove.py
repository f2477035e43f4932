"""The command that measures wear grooves."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sonolube.cli.measure_surface import Spacing, Unit, spacings
from sonolube.cli.measuring import Files, Report, Test, answer, each_file, quantity
from sonolube.cli.operate import Json

if TYPE_CHECKING:
    from sonolube.measurement.wear_track import WearTrack
    from sonolube.report.measured.groove import RingSettings
    from sonolube.report.measured.sheet import Sheet
    from sonolube.report.measured.surface import SurfaceSettings
    from sonolube.surfaces.grooves.groove import Groove


def groove(
    files: Files,
    diameter: Annotated[
        str | None, typer.Option("--groove-diameter", metavar="LENGTH", help="Of the ring that the scans go round.")
    ] = None,
    slid: Annotated[str | None, typer.Option("--sliding-distance", metavar="LENGTH", help="Slid on the ring.")] = None,
    without: Annotated[
        list[Path] | None,
        typer.Option("--without-vibration", metavar="FILE", help="Scan or folder of a ring worn without vibration."),
    ] = None,
    tip: Annotated[
        str | None, typer.Option("--tip-radius", metavar="LENGTH", help="Of the pin, for ASTM G99's geometry.")
    ] = None,
    pin: Annotated[
        list[Path] | None, typer.Option("--pin", metavar="FILE", help="Scan of the pin's tip; may come again.")
    ] = None,
    pixel: Spacing = None,
    unit: Unit = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Wear grooves in scans: width, depth, volume, pile-up; wear of the ring and what vibration takes off it.

    Example: sonolube measure groove ring --groove-diameter 50mm --sliding-distance 292m --report ring.html
    """
    from functools import partial

    from sonolube.errors import InvalidInput
    from sonolube.report.measured.groove import RingSettings, cap_sheet, wear_reduction_sheet
    from sonolube.report.measured.surface import SurfaceSettings

    step_x, step_y = spacings(pixel)
    settings = SurfaceSettings(spacing_x=step_x, spacing_y=step_y, length_unit=unit)
    tip_radius = quantity(tip, unit="m", option="--tip-radius")
    around = None
    if diameter is not None and slid is not None:
        around = RingSettings(
            groove_diameter=quantity(diameter, unit="m", option="--groove-diameter") or 0.0,
            sliding_distance=quantity(slid, unit="m", option="--sliding-distance") or 0.0,
            tip_radius=tip_radius,
        )
    elif diameter or slid or without:
        raise InvalidInput("a ring needs --groove-diameter and --sliding-distance")
    sheets: list[Sheet] = []
    refused: dict[str, str] = {}
    rings: list[WearTrack] = []
    for title, paths in (("the ring", files), ("the ring without vibration", without or [])):
        measured, missed, ring = _ring(title, paths, settings, around)
        sheets += measured
        refused |= missed
        rings += ring
    if len(rings) == 2:
        sheets.append(wear_reduction_sheet(rings[1:], rings[:1]))
    if pin:
        caps, missed = each_file(pin, partial(cap_sheet, settings=settings, tip_radius=tip_radius), what="measuring")
        sheets += caps
        refused |= missed
    used = {
        "groove diameter": diameter,
        "sliding distance": slid,
        "without vibration": ", ".join(path.name for path in without or ()) or None,
        "tip radius": tip,
        "spacing": pixel,
        "length unit": unit,
    }
    answer("wear grooves", sheets, refused, settings=used, page=report, test=test, as_json=json)


def _ring(
    title: str, paths: Sequence[Path], settings: "SurfaceSettings", around: "RingSettings | None"
) -> tuple[list["Sheet"], dict[str, str], list["WearTrack"]]:
    """Return the sheets of scans and of their ring, the files refused, and the ring where there is one."""
    from sonolube.errors import InvalidInput, NoGroove
    from sonolube.report.measured.groove import groove_sheet, ring_sheet
    from sonolube.report.measured.sheet import Sheet

    grooves: list[tuple[str, Groove | str]] = []

    def measured(path: Path) -> Sheet:
        try:
            sheet, found = groove_sheet(path, settings=settings)
        except NoGroove as reason:
            grooves.append((path.name, str(reason)))
            raise
        grooves.append((path.name, found))
        return sheet

    sheets, refused = each_file(paths, measured, what="measuring")
    if around is None or not sheets:
        return sheets, refused, []
    try:
        sheet, ring = ring_sheet(title, grooves, settings=around)
    except InvalidInput as reason:
        return [*sheets, Sheet(title=title, not_found=(str(reason),))], refused, []
    return [*sheets, sheet], refused, [ring]
