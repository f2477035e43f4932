"""Task `measure groove`: width, depth and volume of wear grooves, wear of a ring, and its reduction by vibration."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Unpack

from sonolube.errors import InvalidInput, NoGroove
from sonolube.measurement.wear_track import WearTrack
from sonolube.models.surfaces.grooves.groove import Groove
from sonolube.report.measured.groove import RingSettings, cap_sheet, groove_sheet, ring_sheet, wear_reduction_sheet
from sonolube.report.measured.sheet import Sheet
from sonolube.report.measured.surface import SurfaceSettings, spacings
from sonolube.tasks.files import InputFile
from sonolube.tasks.measure.measured_files import Files, MeasuredFiles, TestSheet, conditions, each_file
from sonolube.tasks.measure.scanned_surface import LengthUnit, Spacing
from sonolube.tasks.parameters import File, Number, Parameter, Quantity, Watched
from sonolube.tasks.task import in_si, refuse_unused, shown, task


@task
def groove(
    files: Files,
    *,
    groove_diameter: Annotated[Number | None, Quantity("Of the ring that the scans lie on.", "groove_diameter")] = None,
    sliding_distance: Annotated[Number | None, Quantity("Sliding distance on the ring.", "sliding_distance")] = None,
    without_vibration: Annotated[
        Sequence[InputFile], File("Scan or folder of a ring worn without vibration.", "FILE")
    ] = (),
    tip_radius: Annotated[Number | None, Quantity("Of the pin, for ASTM G99's geometry.", "tip_radius")] = None,
    pin: Annotated[Sequence[InputFile], File("Scan of the pin's tip; may come again.", "FILE")] = (),
    track: Annotated[
        int | None, Parameter("Of several tracks: from the left, or the innermost radius.", "N", lowest=1)
    ] = None,
    spacing: Spacing = None,
    length_unit: LengthUnit = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Wear grooves in scans: width, depth, volume, pile-up; wear of the ring and its reduction by vibration.

    Example: sonolube measure groove ring --groove-diameter 50mm --sliding-distance 292m --report ring.html

    Examples
    --------
    >>> import io
    >>> import numpy as np
    >>> import sonolube as sl
    >>> from sonolube.tasks.files import NamedBytes
    >>> file, x = io.BytesIO(), 8e-6 * np.arange(160)
    >>> np.save(file, np.tile(-3e-6 * np.exp(-(((x - x.mean()) / 120e-6) ** 2)), (120, 1)))
    >>> answer = sl.measure.groove(NamedBytes("groove.npy", file.getvalue()), spacing="8um")
    >>> round(1e6 * float(answer["groove_depth"]), 1)
    3.0
    """
    spacing_x, spacing_y = spacings(spacing, name=shown("spacing"))
    settings = SurfaceSettings(spacing_x=spacing_x, spacing_y=spacing_y, length_unit=length_unit)
    tip = in_si("tip_radius", tip_radius)
    diameter, slid = in_si("groove_diameter", groove_diameter), in_si("sliding_distance", sliding_distance)
    ring = None
    if diameter is not None and slid is not None:
        ring = RingSettings(groove_diameter=diameter, sliding_distance=slid, tip_radius=tip)
    elif diameter or slid or without_vibration:
        needed = f"{shown('groove_diameter')} and {shown('sliding_distance')}"
        raise InvalidInput(f"a ring needs {needed}; {shown('without_vibration')} is another ring")
    if ring is None and not pin:
        refuse_unused("tip_radius", because=f"without a ring or {shown('pin')}, whose wear volume it is for")
    sheets: list[Sheet] = []
    refused: dict[str, str] = {}
    rings: list[WearTrack] = []
    for title, scans in (("the ring", files), ("the ring without vibration", without_vibration)):
        ring_sheets, ring_refused, found = _ring(title, scans, settings, ring, track)
        sheets += ring_sheets
        refused |= ring_refused
        rings += found
    if len(rings) == 2:
        sheets.append(wear_reduction_sheet(rings[1:], rings[:1]))
    if pin:
        caps, caps_refused = each_file(pin, partial(cap_sheet, settings=settings, tip_radius=tip), title="measuring")
        sheets += caps
        refused |= caps_refused
    return MeasuredFiles(title="wear grooves", sheets=sheets, refused=refused, test=conditions(test_sheet))


def _ring(
    title: str,
    scans: Sequence[InputFile] | InputFile,
    settings: SurfaceSettings,
    ring: RingSettings | None,
    track: int | None,
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

    sheets, refused = each_file(scans, measure, title="measuring")
    if ring is None or not sheets:
        return sheets, refused, []
    try:
        sheet, worn = ring_sheet(title, grooves, settings=ring)
    except InvalidInput as reason:
        return [*sheets, Sheet(title=title, not_found=(str(reason),))], refused, []
    return [*sheets, sheet], refused, [worn]
