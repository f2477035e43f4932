"""Command `measure groove`: width, depth and volume of wear grooves, wear of a ring, and its reduction by vibration."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.console.options import Json, refuse_unused, si_option
from sonolube.cli.measure.measured_files import Files, Report, Test, deliver_sheets, each_file
from sonolube.cli.measure.surface import Spacing, Unit
from sonolube.errors import InvalidInput, NoGroove
from sonolube.measurement.wear_track import WearTrack
from sonolube.models.surfaces.grooves.groove import Groove
from sonolube.report.measured.groove import RingSettings, cap_sheet, groove_sheet, ring_sheet, wear_reduction_sheet
from sonolube.report.measured.sheet import Sheet
from sonolube.report.measured.surface import SurfaceSettings, spacings


def groove(
    context: typer.Context,
    files: Files,
    diameter: Annotated[float | None, si_option("m", "Of the ring that the scans lie on.", "--groove-diameter")] = None,
    slid: Annotated[float | None, si_option("m", "Sliding distance on the ring.", "--sliding-distance")] = None,
    without: Annotated[
        list[Path] | None,
        typer.Option("--without-vibration", metavar="FILE", help="Scan or folder of a ring worn without vibration."),
    ] = None,
    tip: Annotated[float | None, si_option("m", "Of the pin, for ASTM G99's geometry.", "--tip-radius")] = None,
    pin: Annotated[
        list[Path] | None, typer.Option("--pin", metavar="FILE", help="Scan of the pin's tip; may come again.")
    ] = None,
    track: Annotated[
        int | None,
        typer.Option("--track", min=1, metavar="N", help="Of several tracks: from the left, or the innermost radius."),
    ] = None,
    pixel: Spacing = None,
    unit: Unit = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Wear grooves in scans: width, depth, volume, pile-up; wear of the ring and its reduction by vibration.

    Example: sonolube measure groove ring --groove-diameter 50mm --sliding-distance 292m --report ring.html
    """
    spacing_x, spacing_y = spacings(pixel, name="--spacing")
    settings = SurfaceSettings(spacing_x=spacing_x, spacing_y=spacing_y, length_unit=unit)
    ring = None
    if diameter is not None and slid is not None:
        ring = RingSettings(groove_diameter=diameter, sliding_distance=slid, tip_radius=tip)
    elif diameter or slid or without:
        raise InvalidInput("a ring needs --groove-diameter and --sliding-distance; --without-vibration is another ring")
    if ring is None and not pin:
        refuse_unused(context, "tip", because="without a ring or --pin, whose wear volume it is for")
    sheets: list[Sheet] = []
    refused: dict[str, str] = {}
    rings: list[WearTrack] = []
    for title, paths in (("the ring", files), ("the ring without vibration", without or [])):
        ring_sheets, ring_refused, found = _ring(title, paths, settings, ring, track)
        sheets += ring_sheets
        refused |= ring_refused
        rings += found
    if len(rings) == 2:
        sheets.append(wear_reduction_sheet(rings[1:], rings[:1]))
    if pin:
        measure = partial(cap_sheet, settings=settings, tip_radius=tip)
        caps, caps_refused = each_file(pin, measure, title="measuring")
        sheets += caps
        refused |= caps_refused
    deliver_sheets(context, "wear grooves", sheets, refused, page=report, test=test, as_json=json)


def _ring(
    title: str, paths: Sequence[Path], settings: SurfaceSettings, ring: RingSettings | None, track: int | None
) -> tuple[list[Sheet], dict[str, str], list[WearTrack]]:
    """Sheets of scans and of their ring, reasons of the files refused, and the ring where there is one."""
    grooves: list[tuple[str, Groove | str]] = []

    def measure(path: Path) -> Sheet:
        try:
            sheet, found = groove_sheet(path, settings=settings, track_number=track)
        except NoGroove as reason:
            grooves.append((path.name, str(reason)))
            raise
        grooves.append((path.name, found))
        return sheet

    sheets, refused = each_file(paths, measure, title="measuring")
    if ring is None or not sheets:
        return sheets, refused, []
    try:
        sheet, worn = ring_sheet(title, grooves, settings=ring)
    except InvalidInput as reason:
        return [*sheets, Sheet(title=title, not_found=(str(reason),))], refused, []
    return [*sheets, sheet], refused, [worn]
