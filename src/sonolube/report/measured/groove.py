"""Scans of wear grooves as sheets: width, depth, volume and pile-up of a scan, wear of a ring, wear reduction."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from sonolube.measurement.friction.wear_track import WearReduction, WearRing, ring_of_grooves, wear_reduction_of_rings
from sonolube.measurement.surface_files.reader import read_surface_file
from sonolube.report.measured import groove_figures as figures
from sonolube.report.measured.sheet import (
    Sheet,
    SheetColumn,
    SheetFigure,
    SheetSection,
    SheetTable,
    SheetValue,
    attempted_section,
    quantity_value,
    sheet_from_sections,
)
from sonolube.report.measured.surface import SurfaceSettings, surface_source
from sonolube.report.measured.surface_figures import abbott
from sonolube.surfaces import disc_groove_volume, material_ratio_curve, measure_groove, track_marks, worn_cap
from sonolube.surfaces.grooves.groove import Groove

_STRAIGHT = 100  # lengths of track, beyond which a diameter is the scan's whim


@dataclass(frozen=True, kw_only=True, slots=True)
class RingSettings:
    """What the wear of a ring depends on beside its scans.

    Parameters
    ----------
    groove_diameter : float
        Diameter of the ring. [m]
    sliding_distance : float
        Distance the pin slid on it. [m]
    tip_radius : float or None
        Radius of the pin's tip, for the volume by ASTM G99's geometry. [m]
    """

    groove_diameter: float
    sliding_distance: float
    tip_radius: float | None = None


def groove_sheet(path: Path, *, settings: SurfaceSettings) -> tuple[Sheet, Groove]:
    """Return what a scan says of the groove in it, and the groove for its ring.

    Parameters
    ----------
    path : Path
        In any format of `read_surface_file`, as measured.
    settings : SurfaceSettings
        Of which spacing and unit are taken.

    Returns
    -------
    Sheet
    Groove

    Raises
    ------
    NoGroove
        If nothing stands out of the scan as a groove.
    InvalidInput
        If the file cannot be read or too little was measured.
    """
    file = read_surface_file(
        path, spacing_x=settings.spacing_x, spacing_y=settings.spacing_y, length_unit=settings.length_unit
    )
    groove = measure_groove(file.height_map)
    values = [
        quantity_value("wear_volume", groove.wear_volume, uncertainty=groove.wear_volume_uncertainty),
        SheetValue(
            name="pile_up_volume", label="Volume of ridges and projections", value=groove.pile_up_volume, unit="m3"
        ),
        SheetValue(name="net_volume", label="Volume that has left the field", value=groove.net_volume, unit="m3"),
        quantity_value("groove_width", groove.groove_width),
        SheetValue(
            name="groove_depth", label="Greatest depth of the mean section", value=groove.groove_depth, unit="m"
        ),
        SheetValue(
            name="cross_section_area", label="Area of the mean section", value=groove.cross_section_area, unit="m2"
        ),
        SheetValue(name="track_length", label="Length of track in the field", value=groove.track_length, unit="m"),
    ]
    if groove.track.groove_diameter < _STRAIGHT * groove.track_length:
        values.append(
            quantity_value("groove_diameter", groove.track.groove_diameter, label="Diameter of the track's arc")
        )
    caveats = (groove.caveat,) if groove.caveat else ()
    parts = [
        SheetSection(values=tuple(values), figures=_figures(groove), caveats=caveats),
        attempted_section(partial(_marks, groove), what="marks along the track"),
    ]
    return sheet_from_sections(parts, title=f"{path.parent.name}/{path.name}", source=surface_source(file)), groove


def ring_sheet(
    title: str, grooves: Sequence[tuple[str, Groove | str]], *, settings: RingSettings
) -> tuple[Sheet, WearRing]:
    """Return the wear of a ring from the grooves of its scans.

    Parameters
    ----------
    title : str
        Which ring it is.
    grooves : sequence of (str, Groove or str)
        Name of each scan, and its groove or why it shows none.
    settings : RingSettings

    Returns
    -------
    Sheet
    WearRing

    Raises
    ------
    InvalidInput
        If fewer than two scans show a whole groove.
    """
    ring = ring_of_grooves(
        [groove for _, groove in grooves],
        groove_diameter=settings.groove_diameter,
        sliding_distance=settings.sliding_distance,
    )
    counted = [name for name, groove in grooves if isinstance(groove, Groove) and groove.complete]
    values = [
        SheetValue(
            name="ring_volume",
            label="Wear volume of the ring",
            value=ring.wear_volume,
            unit="m3",
            uncertainty=ring.wear_volume_uncertainty,
        ),
        SheetValue(
            name="ring_pile_up_volume",
            label="Ridges and projections of the ring",
            value=ring.pile_up_volume,
            unit="m3",
        ),
        SheetValue(name="ring_net_volume", label="Volume that has left the disc", value=ring.net_volume, unit="m3"),
        quantity_value("wear_rate", ring.wear_rate, interval=ring.wear_rate_interval),
    ]
    if settings.tip_radius is not None:
        width = float(np.mean([g.groove_width for _, g in grooves if isinstance(g, Groove) and g.complete]))
        volume = disc_groove_volume(
            groove_diameter=settings.groove_diameter, groove_width=width, tip_radius=settings.tip_radius
        )
        label = "The same by ASTM G99's geometry, from width and tip"
        values.append(SheetValue(name="geometric_volume", label=label, value=float(volume), unit="m3"))
    table = SheetTable(
        name="sections",
        title="Area of the mean section by scan",
        columns=(
            SheetColumn(name="scan", label="Scan"),
            SheetColumn(name="cross_section_area", label="Area", unit="m2"),
        ),
        rows=tuple(zip(counted, map(float, ring.section_area), strict=True)),
    )
    drawn = SheetFigure(
        name="ring",
        title="Sections round the ring",
        caption="Area of the mean section of each scan; the line is the mean, the band its 95 % interval.",
        draw=partial(figures.ring, ring),
    )
    part = SheetSection(values=tuple(values), tables=(table,), figures=(drawn,), caveats=ring.left_out)
    return sheet_from_sections([part], title=title, source={}), ring


def wear_reduction_sheet(without: Sequence[WearRing], with_vibration: Sequence[WearRing]) -> Sheet:
    """Return what vibration takes off the wear.

    Parameters
    ----------
    without, with_vibration : sequence of WearRing
        One a specimen.

    Returns
    -------
    Sheet
    """
    found: WearReduction = wear_reduction_of_rings(without, with_vibration)
    caveats: tuple[str, ...] = ()
    if not found.between_specimens:
        caveats = (
            "the interval knows the scatter round each ring only, not that between specimens: wear more of them",
        )
    value = quantity_value("wear_reduction", found.wear_reduction, interval=found.interval)
    title = f"{len(with_vibration)} ring with vibration against {len(without)} without"
    return sheet_from_sections([SheetSection(values=(value,), caveats=caveats)], title=title, source={})


def cap_sheet(path: Path, *, settings: SurfaceSettings, tip_radius: float | None) -> Sheet:
    """Return what a pin has lost at its tip.

    Parameters
    ----------
    path : Path
        A scan of the tip.
    settings : SurfaceSettings
        Of which spacing and unit are taken.
    tip_radius : float or None
        Radius of the tip, fitted to what is unworn where None. [m]

    Returns
    -------
    Sheet

    Raises
    ------
    SonolubeError
        If the file cannot be read or shows no scar.
    """
    file = read_surface_file(
        path, spacing_x=settings.spacing_x, spacing_y=settings.spacing_y, length_unit=settings.length_unit
    )
    cap = worn_cap(file.height_map, tip_radius=tip_radius)
    values = (
        SheetValue(
            name="pin_volume",
            label="Wear volume of the pin",
            value=cap.wear_volume,
            unit="m3",
            uncertainty=cap.wear_volume_uncertainty,
        ),
        SheetValue(name="scar_diameter", label="Diameter of the scar", value=cap.scar_diameter, unit="m"),
        quantity_value("tip_radius", cap.tip_radius),
    )
    drawn = SheetFigure(
        name="cap",
        title="Scar of the pin",
        caption="Heights over the ball; the line goes round the scar.",
        draw=partial(figures.height_map, cap.levelled, cap.worn),
    )
    return sheet_from_sections(
        [SheetSection(values=values, figures=(drawn,))], title=path.name, source=surface_source(file)
    )


def _figures(groove: Groove) -> tuple[SheetFigure, ...]:
    return (
        SheetFigure(
            name="view",
            title="The groove",
            caption="Heights over the unworn surface, the vertical stretched.",
            draw=partial(figures.view, groove),
        ),
        SheetFigure(
            name="sections",
            title="Cross-sections",
            caption="Single sections square to the track in grey, the mean in colour, its edges where it meets the"
            " unworn surface.",
            draw=partial(figures.sections, groove),
        ),
        SheetFigure(
            name="map",
            title="Map",
            caption="Heights over the unworn surface; the line goes round what counts as worn.",
            draw=partial(figures.height_map, groove.levelled, groove.worn),
        ),
        SheetFigure(
            name="abbott",
            title="Abbott curve",
            caption="Of the whole field over the unworn surface; the groove is its tail.",
            draw=partial(abbott, material_ratio_curve(groove.levelled)),
        ),
    )


def _marks(groove: Groove) -> SheetSection:
    marks = track_marks(groove)
    if marks.dot_spacing is None:
        return SheetSection(not_found=(f"marks along the track: {marks.reason}",))
    drawn = SheetFigure(
        name="marks",
        title="Spectrum along the track",
        caption="Power of the groove's floor along the track over its background; the peak is the marks' spacing.",
        draw=partial(figures.marks, marks),
    )
    value = quantity_value("dot_spacing", marks.dot_spacing, uncertainty=marks.dot_spacing_uncertainty)
    return SheetSection(values=(value,), figures=(drawn,))
